"""The program as `make install` puts it in place finds its files, from any folder; its man page and completions name
every option.

    installed.py PROGRAM FOLDER BUILT RUNS

PROGRAM is where it was installed, under a DESTDIR; BUILT the same program in its build folder; RUNS has the catalogue's runs.
"""
import json
import os
import re
import shutil
from pathlib import Path

import trial
from trial import demand, finish, folder, program, skip, source, write

PREFIX = program.parents[1]
BUILT, RUNS = (Path(each).resolve() for each in trial.words)
SHARE = PREFIX / "share/impact-damper"


def run(*command, folder=folder, code=0, **options) -> str:
    """Standard output; with another exit code than 0 expected, standard error."""
    done = trial.run(*command, code=code, cwd=folder, **options)
    # Progress is told where it takes long.
    said = re.sub(r"^(compare|design|report|response|run|sweep|verify): .*\n", "", done.stderr, flags=re.M)
    demand(code or not said, f"{command}: says {said}")
    return done.stderr if code else done.stdout


def same_as_in_the_source_folder(*arguments):
    demand(run(program, *arguments) == run(BUILT, *arguments, folder=source), f"{arguments} differs")


def finds_its_files():
    for arguments in (["scenes"], ["figures"], ["cite"], ["cite", "--figure", "8"], ["cite", "--figure", "A"]):
        same_as_in_the_source_folder(*arguments)
    same_as_in_the_source_folder("series", "--runs", RUNS, "--figure", "7")
    catalogue = json.loads((SHARE / "figures/catalogue.json").read_text())
    files = [file for name in [each["scene"] for each in catalogue["scenes"]] + [each["name"] for each in catalogue["runs"]]
             for file in (RUNS / f"{name}.json", *sorted((RUNS / f"{name}.members").iterdir()))]
    demand(run(program, "check", "run", *files).count("\n") == len(files) ==
           (len(catalogue["scenes"]) + len(catalogue["runs"])) * catalogue["members"], "check")
    done = trial.run(program, "verify", "--runs", RUNS, "--members", "2", code=None)
    claims = [claim for claim in json.loads((SHARE / "data/claims.json").read_text())["claims"] if "source" not in claim]
    demand(done.returncode in (0, 1) and f"\nengine exact, {len(claims)} claims of the paper: " in done.stdout,
           done.stderr + done.stdout)


def finds_what_is_named():
    """data/... as an argument, of every command and from a plan: the very results of the source folder."""
    mast, wind, plan = "data/examples/mast.json", "data/examples/mast_in_wind.json", "data/examples/mast_plan.json"
    for arguments in (["run", "--scene", mast], ["check", "scene", mast, wind], ["check", "plan", plan],
                      ["report", "--scene", mast, "--members", "1", "--without-figures"], ["scenes", "data/examples/../scenes"],
                      ["response", "lyapunov", "--scene", wind, "--periods", "10", "--discard", "0"],
                      ["design", "--scene", mast, "--dampers", "1", "--to", "10"], ["figures", "figures/catalogue.json"],
                      ["series", "--catalogue", "figures/catalogue.json", "--scenes", "data/scenes", "--runs", RUNS, "--figure", "7"]):
        found = run(program, *arguments).replace(f"{SHARE}/", "")
        demand(found == run(BUILT, *arguments, folder=source), f"{arguments} differs")
    demand("data/examples/mast.csv: cannot be read: No such file" in
           run(program, "compare", "--scene", mast, "--measured", "data/examples/mast.csv", code=5), "what is nowhere has its name")
    write("plan.json", (source / plan).read_text().replace('"mast.json"', f'"{mast}"'))
    demand(run(program, "check", "plan", "plan.json") == "plan.json: valid\n", "a plan that names a scene")


def the_current_folder_comes_first():
    own = folder / "own"
    (own / "data/scenes").mkdir(parents=True)
    (own / "data/scenes/mine.json").write_text('{"until_time": 5}')
    (own / "data/examples").mkdir()
    (own / "data/examples/mast.json").write_text('{"until_time": 5, "x0": 1.25}')
    demand('"x0": 1.25,' in run(program, "run", "--scene", "data/examples/mast.json", folder=own), "the current folder's own mast")
    run(program, "check", "scene", "examples/mast.json", folder=own, code=5)
    lines = run(program, "scenes", folder=own).splitlines()
    demand(len(lines) == 2 and lines[1].startswith("mine "), lines)
    demand("nu2-e06" in run(program, "figures", folder=own), "what the current folder lacks is found with the program")


def a_link_and_a_copy():
    (folder / "link").symlink_to(program)
    demand("nu2-e06" in run(folder / "link", "scenes"), "a link to the program")
    alone = folder / "alone/bin/impact-damper"
    alone.parent.mkdir(parents=True)
    shutil.copy(program, alone)
    demand(run(alone, "figures", code=5) == "figures/catalogue.json: cannot be read: No such file or directory\n", "alone")
    demand("@misc{" in run(alone, "cite"), "cite needs no file")
    demand("data/reference/manifest.json: cannot be read" in run(alone, "cite", "--figure", "8", code=5), "--figure does")


def commands() -> list:
    text = run(program, "--help")
    return re.findall(r"^  (\w+) ", text[text.index("Subcommands:"):], re.M)


def options(command: str) -> set:
    """By --help: -o,--output FILE is two."""
    return {name for line in re.findall(r"^  (-\S+)", run(program, command, "--help"), re.M) for name in line.split(",")}


def pages_name_every_option():
    demand({"run", "verify", "generate"} <= set(commands()), commands())
    page = run("groff", "-man", "-Tutf8", "-ww", "-P-bcou", "-Kutf8", PREFIX / "share/man/man1/impact-damper.1")
    for command in commands():
        demand(len(options(command)) > 0, command)
        section = re.search(rf"^{command}\n(.*?)(?=^\w|\Z)", page, re.M | re.S)
        demand(section is not None, f"no section on {command}")
        named = set(re.findall(r"(?<![\w-])--?\w[\w-]*", section[1]))
        demand(options(command) <= named, f"{command}: the man page lacks {options(command) - named}")
    demand(program.name in page[:page.index("SYNOPSIS")], page[:300])


def headers_include_what_is_installed():
    headers = {str(file.relative_to(PREFIX / "include")): file.read_text() for file in (PREFIX / "include").rglob("*.h*")}
    demand(len(headers) > 40, headers.keys())
    for name, text in headers.items():
        lacking = {each for each in re.findall(r'^#include "(.*)"', text, re.M) if each not in headers}
        demand(not lacking, f"{name} includes what is not installed: {lacking}")


def bash_completes(*words) -> set:
    script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _impact_damper; '
              '[ ${#COMPREPLY[@]} -eq 0 ] || printf "%s\\n" "${COMPREPLY[@]}"')
    return set(run("bash", "-c", script, "bash", PREFIX / "share/bash-completion/completions/impact-damper",
                   "impact-damper", *words).split())


def fish_completes(line: str) -> set:
    script = 'source $argv[1]; complete -C "$argv[2]"'
    environment = dict(os.environ, HOME=str(folder), XDG_CONFIG_HOME=str(folder / "config"))
    return {each.split("\t")[0] for each in run("fish", "-N", "-c", script, PREFIX / "share/fish/vendor_completions.d/impact-damper.fish",
                                                line, env=environment).splitlines()}


def zsh_completes(line: str) -> str:
    """The screen of a terminal in which that was typed, and then the tabulator key."""
    script = """zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell 'PS1=; fpath=($fpath '"$1"'); autoload -Uz compinit && compinit -u -D; unsetopt beep; bindkey "^I" complete-word; setopt list_ambiguous no_always_last_prompt; LISTMAX=1000; echo rea""dy'
zpty -r shell out '*ready'
zpty -w -n shell "$2"$'\\t\\t'
sleep 1
while zpty -r -t shell out; do print -rn -- $out; done
zpty -d shell
"""
    environment = dict(os.environ, HOME=str(folder), TERM="dumb", COLUMNS="200", LINES="100")
    return run("zsh", "-f", "-c", script, "zsh", PREFIX / "share/zsh/site-functions", line, env=environment)


def terminals_can_be_made() -> bool:
    try:
        for end in os.openpty():
            os.close(end)
        return True
    except OSError:
        return False


def shells_complete_every_option():
    all_options = {command: options(command) for command in commands()}
    engines = {"exact", "restitution", "cem"}
    schema = json.loads((PREFIX / "share/impact-damper/data/schema/scene.schema.json").read_text())
    keys = {"--" + key.replace("_", "-") for key in schema["properties"]}
    demand("--natural-frequency" in bash_completes("run", "-") & fish_completes("impact-damper run --"), "keys are not completed")
    demand(set(commands()) <= bash_completes(""), bash_completes(""))
    demand(set(commands()) <= fish_completes("impact-damper "), fish_completes("impact-damper "))
    for command, names in all_options.items():
        longs = {name for name in names if name.startswith("--")}
        # The keys of scenes in units are options of which --help has one line.
        demand(names <= bash_completes(command, "-") <= names | keys, f"bash: {command}: {bash_completes(command, '-')}")
        demand(longs <= fish_completes(f"impact-damper {command} --"), f"fish: {command}")
    demand(bash_completes("run", "--engine", "") == engines, "bash: --engine")
    demand(bash_completes("run", "--engine", "=", "re") == {"restitution"}, "bash: --engine=re")
    demand(bash_completes("check", "s") == {"scene", "sweep"}, "bash: check")
    demand(bash_completes("run", "--scene", "") == set(), "bash: file names are left to readline")
    demand(fish_completes("impact-damper run --engine ") == engines, fish_completes("impact-damper run --engine "))
    if not terminals_can_be_made():
        unless_faulty("completions in zsh, for want of a pseudo-terminal, as in a chroot without /dev/pts")
    screen = zsh_completes("impact-damper run --engine ")
    demand(all(engine in screen for engine in engines), screen)
    screen = zsh_completes("impact-damper verify --")
    demand(all(name in screen for name in all_options["verify"] if name.startswith("--")), screen)


def unless_faulty(why):
    """Ends the script: this cannot be tried here."""
    if trial.faults:
        finish()
    skip(why)


finds_its_files()
finds_what_is_named()
the_current_folder_comes_first()
a_link_and_a_copy()
headers_include_what_is_installed()
pages_name_every_option()
missing = [tool for tool in ("fish", "zsh") if not shutil.which(tool)]
if missing:
    unless_faulty(f"completions, for want of {missing}: make deps-check")
shells_complete_every_option()
finish()
