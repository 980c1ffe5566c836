"""docs/adding.md as it stands: its files are written, its commands run, with the installed program."""
import os
import re

from trial import demand, finish, folder, program, read, run, source, write

PREFIX = program.parents[1]
PARTS = PREFIX / "share/impact-damper/figures"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)


def shell(script: str, code=0):
    return run("sh", "-euc", script, code=code, env=dict(os.environ, PATH=f"{PREFIX / 'bin'}:{os.environ['PATH']}"))


page = (source / "docs/adding.md").read_text(encoding="utf-8")
commands, end = "", 0
for block in BLOCK.finditer(page):
    if block[1] == "sh":
        commands += block[2]
    else:
        name = re.findall(r"`(own/\S+)`:\s*$", page[end:block.start()])
        demand(len(name) == 1, f"the file before this is not named: {block[2]}")
        (folder / name[0]).parent.mkdir(parents=True, exist_ok=True)
        write(name[0], block[2])
    end = block.end()
demand(commands.startswith("parts=/usr/local/share/impact-damper/figures\n"), commands)
commands = commands.replace("/usr/local", str(PREFIX), 1)

done = shell(commands)
demand(not done.stderr, done.stderr + done.stdout)
demand("1 claims of the paper: 1 reproduced" in done.stdout and "all as recorded" in done.stdout, done.stdout)
picture = read("own/fig16.svg")
for text in ("Loss factor with a mass ratio of 8 %", "ν = 8 %", "loss factor η", "closed forms"):
    demand(text in picture, f"the picture does not say {text}")
for form in ("pdf", "png"):
    demand((folder / f"own/fig16.{form}").stat().st_size > 5000, form)

# What goes wrong first, with somebody's own figure.
draw = "own/fig16.dat Title own/other 0.1.0"
done = shell(f"{PARTS}/draw {PARTS}/fig08.gp {draw}", code=1)
demand(done.stderr == "other: own/fig16.dat: gnuplot failed: block curve-2 is not in the table\n", done.stderr)
(folder / "own/missing.gp").write_text('load folder."/mising.gp"\n')
done = shell(f"{PARTS}/draw own/missing.gp {draw}", code=1)
demand(f"{PARTS}/mising.gp" in done.stderr and done.stderr.count("\n") < 6, done.stderr)
done = shell(f"{PARTS}/draw own/none.gp {draw}", code=1)
demand(done.stderr == "other: own/none.gp: is missing or empty\n", done.stderr)
demand(not list((folder / "own").glob("other*")), "a failed drawing leaves files")

# A scene that no figure draws.
catalogue = read("own/catalogue.json")
idle = catalogue.replace('"scenes": [', '"scenes": [{"scene": "idle", "record": ["half_cycles"]}, ')
write("own/catalogue.json", idle)
shell("impact-damper figures own/catalogue.json && impact-damper check catalogue own/catalogue.json")
demand(idle != catalogue, "the catalogue has no list of scenes")
finish()
