"""The words that the commands `run` and `response` take for entries of the catalogue, as figures/CMakeLists.txt has them."""


def rerun(entry: dict, scenes) -> list:
    """Of the catalogue's further runs; `scenes` is the folder of the scenes."""
    engine = dict(entry.get("engine", {"name": "exact"}))
    words = ["run", "--scene", f"{scenes}/{entry['scene']}.json", "--engine", engine.pop("name"),
             *(["--stuck", "paper"] if "stuck_speed" in engine else []), "--record", ",".join(entry["record"])]
    for key, value in {**entry.get("set", {}), **engine}.items():
        words += ["--" + key.replace("_", "-")] + ([] if value is True else [str(value)])
    return words


def drawn_runs(catalogue: dict) -> list:
    """Those further runs that figures draw."""
    names = {curve[key] for figure in catalogue["figures"] for curve in figure.get("curves", [])
             for key in ("run", "alone") if key in curve}
    return [entry for entry in catalogue["runs"] if entry["name"] in names]


def respond(entry: dict, scenes) -> list:
    """Of the catalogue's responses."""
    words = ["response", entry["kind"], "--scene", f"{scenes}/{entry['scene']}.json", "--quiet"]
    for name, value in [*entry.get("set", {}).items(), *entry.get("rule", {}).items()]:
        words.append(f"--{name.replace('_', '-')}={value}")
    for axis in entry["vary"]:
        count = f":{axis['count']}" if "count" in axis else ""
        words.append(f"--vary={axis['number']}={axis['from']}:{axis['to']}{count}")
    return words + [f"--start={s['x']}:{s['v']}:{s['y']}:{s['w']}" for s in entry.get("start", [])]
