"""The words that the command `response` takes for an entry of the catalogue's responses, as figures/CMakeLists.txt has them."""


def respond(entry: dict, scenes) -> list:
    """`scenes` is the folder of the scenes."""
    words = ["response", entry["kind"], "--scene", f"{scenes}/{entry['scene']}.json", "--quiet"]
    for name, value in [*entry.get("set", {}).items(), *entry.get("rule", {}).items()]:
        words.append(f"--{name.replace('_', '-')}={value}")
    for axis in entry["vary"]:
        count = f":{axis['count']}" if "count" in axis else ""
        words.append(f"--vary={axis['number']}={axis['from']}:{axis['to']}{count}")
    return words + [f"--start={s['x']}:{s['v']}:{s['y']}:{s['w']}" for s in entry.get("start", [])]
