"""Run files made or changed by hand get the digest of their content, for tests: seal.py FILE..."""
import hashlib
import pathlib
import re
import sys

for name in sys.argv[1:]:
    file = pathlib.Path(name)
    content = re.sub(rb'(, "sha256": "\w*")?\}\s*\}\s*\Z', b"", file.read_bytes())
    digest = hashlib.sha256(content).hexdigest()
    file.write_bytes(content + f', "sha256": "{digest}"}}\n}}\n'.encode())
