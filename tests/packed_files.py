#!/usr/bin/env python3
r"""Many small files in one text that can be read and compared line by line: those of tests/corpus, tests/cli, tests/fuzz.

    packed_files.py unpack PACKED FOLDER     writes the files into FOLDER, which is made anew
    packed_files.py add PACKED FILE...       appends each FILE, under its name without folders; of a folder all files in it, by
                                             their paths there. PACKED need not be there yet

A line `== NAME`, or `== NAME | NOTE`, begins a file, and the lines up to the next such line are its content. Empty lines
and lines that begin with # belong to no file. In the content \xNN stands for a byte and \\ for a backslash. A \ at the end
of a line says that the content has no line break there. A text whose name ends in .gz is compressed: many files that
programs have made and no one reads, such as the fuzzer's.
"""
import gzip
import pathlib
import re
import shutil
import sys

HEADER = re.compile(r"== ([\w./-]+)(?: \|(.*))?")
ESCAPE = re.compile(rb"\\(?:x([0-9a-f]{2})|(\\)|(\n)|)")


def byte_of(escape):
    if not any(escape.groups()):
        raise ValueError(r"a \ must be followed by xNN, another \, or the end of the line")
    return bytes.fromhex(escape[1].decode()) if escape[1] else escape[2] or b""


def text_of(packed):
    content = packed.read_bytes()
    return gzip.decompress(content) if packed.suffix == ".gz" else content


def read(packed):
    """Of each file in `packed`, by its name: its note and its content."""
    files, lines = {}, None
    for number, line in enumerate(text_of(packed).split(b"\n"), 1):
        if line.startswith(b"=="):
            header = HEADER.fullmatch(line.decode())
            if not header or header[1] in files:
                raise ValueError(f"{packed}:{number}: must be `== NAME` or `== NAME | NOTE`, with a new name")
            lines = []
            files[header[1]] = (header[2] or "").strip(), lines
        elif line and not line.startswith(b"#"):
            if lines is None:
                raise ValueError(f"{packed}:{number}: content before the first `== NAME`")
            try:
                lines.append(ESCAPE.sub(byte_of, line + b"\n"))
            except ValueError as error:
                raise ValueError(f"{packed}:{number}: {error}") from None
    return {name: (note, b"".join(lines)) for name, (note, lines) in files.items()}


def unpack(packed, folder):
    """Writes the files of `packed` into `folder`, which is made anew; returns the note of each, by the name."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    notes = {}
    for name, (note, content) in read(packed).items():
        notes[name] = note
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return notes


def escaped(line):
    """A line of a content as it is packed: printable characters, none that would be taken for something else."""
    escapes = {ord("\\"): "\\\\"}
    for each in set(line):
        if not each.isprintable():
            escapes[ord(each)] = "".join(f"\\x{byte:02x}" for byte in each.encode(errors="surrogateescape"))
    line = line.translate(escapes)
    if line.startswith(("#", "==")):
        line = f"\\x{ord(line[0]):02x}{line[1:]}"
    return line[:-1] + "\\x20" if line.endswith(" ") else line


def entry(name, content):
    """A file with this content as it is packed."""
    *lines, last = content.decode(errors="surrogateescape").split("\n")
    packed = [f"== {name}", *(escaped(line) or "\\x0a\\" for line in lines)]
    return "\n".join([*packed, escaped(last) + "\\"] if last else packed) + "\n"


def main():
    command, *paths = sys.argv[1:] or [""]
    paths = [pathlib.Path(path) for path in paths]
    if command == "unpack" and len(paths) == 2:
        unpack(*paths)
    elif command == "add" and len(paths) > 1:
        packed, *given = paths
        files = {}
        for path in given:
            files |= {str(file.relative_to(path)): file for file in sorted(path.rglob("*")) if file.is_file()} if path.is_dir() else \
                {path.name: path}
        known, text = (read(packed), text_of(packed)) if packed.exists() else ({}, b"")
        for name, file in files.items():
            if name in known or not HEADER.fullmatch(f"== {name}"):
                sys.exit(f"{file}: must have a new name, of letters, digits, _, ., - and /")
        text += "".join(entry(name, file.read_bytes()) for name, file in files.items()).encode()
        packed.write_bytes(gzip.compress(text, mtime=0) if packed.suffix == ".gz" else text)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
