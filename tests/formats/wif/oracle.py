"""What a WIF says, worked out without the program: Python's own INI parser, sets of shafts, one crossing at a time."""

import configparser
import math


def parsed(path):
    data = path.read_bytes()
    text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    while lines and not lines[0].strip().startswith("["):
        lines.pop(0)
    # Keys are kept in lower case; the first of several equal ones counts, which ConfigParser cannot do.
    ini, section = {}, None
    reader = configparser.RawConfigParser(delimiters=("=",), comment_prefixes=(";",), allow_no_value=True, strict=False)
    seen = set()
    kept = []
    for line in lines:
        word = line.strip()
        if word.startswith("[") and word.endswith("]"):
            section = word.lower()
        key = (section, line.split("=")[0].strip().lower())
        if "=" in line and not word.startswith(";"):
            if key in seen:
                continue
            seen.add(key)
        kept.append(word)
    reader.read_string("\n".join(kept))
    for name in reader.sections():
        target = ini.setdefault(name.strip().lower(), {})
        for key, value in reader.items(name):
            target.setdefault(key, value)
    return ini


def bare(value):
    return (value or "").split(";")[0].strip()


def numbers(value):
    return {int(part) for part in bare(value).split(",") if part.strip()} - {0}


def sets(section, most):
    return {int(key): numbers(value) for key, value in section.items() if int(key) <= most}


def is_true(value):
    return bare(value).lower() in ("true", "on", "yes", "1")


class Wif:
    """ends, picks; rows of '0' and '1'; for each system the colours of its threads and their spacing in mm."""

    def __init__(self, path):
        ini = parsed(path)
        counts = [
            int(bare(ini[name].get("threads")) or 10**9) if "threads" in ini[name] else 10**9
            for name in ("warp", "weft")
        ]
        threading = sets(ini["threading"], counts[0])
        plan, treadling = ini.get("liftplan"), ini.get("treadling")
        if plan and treadling and not is_true(ini.get("contents", {}).get("liftplan", "true")):
            plan = None
        if plan:
            lifts = sets(plan, counts[1])
        else:
            tieup = sets(ini["tieup"], 10**9)
            lifts = {
                pick: set().union(*(tieup.get(treadle, set()) for treadle in treadles))
                for pick, treadles in sets(treadling, counts[1]).items()
            }
        rises = is_true(ini["weaving"].get("rising shed", "true"))
        self.ends, self.picks = max(threading), max(lifts)
        self.rows = [
            "".join(
                "1" if bool(threading.get(end, set()) & lifts.get(pick, set())) == rises else "0"
                for end in range(1, self.ends + 1)
            )
            for pick in range(1, self.picks + 1)
        ]
        self.colors = {
            "warp": self.system_colors(ini, "warp", self.ends),
            "weft": self.system_colors(ini, "weft", self.picks),
        }
        self.spacing = {
            "warp": self.system_spacing(ini, "warp", self.ends),
            "weft": self.system_spacing(ini, "weft", self.picks),
        }

    @staticmethod
    def system_colors(ini, name, count):
        low, high = (int(part) for part in bare(ini.get("color palette", {}).get("range", "0,255")).split(","))
        table = {
            int(key): tuple(math.floor((int(part) - low) * 255 / (high - low) + 0.5) for part in bare(value).split(","))
            for key, value in ini.get("color table", {}).items()
        }
        own = ini.get(f"{name} colors", {})
        common = bare(ini[name].get("color")).split(",")[0]
        return [table.get(int(bare(own.get(str(i))) or common or 0)) for i in range(1, count + 1)]

    @staticmethod
    def system_spacing(ini, name, count):
        unit = {"decipoints": 25.4 / 720, "inches": 25.4, "centimeters": 10}.get(
            bare(ini[name].get("units")).lower(), 10
        )
        own = ini.get(f"{name} spacing", {})
        common = bare(ini[name].get("spacing"))
        given = [float(text) for i in range(1, count + 1) if (text := bare(own.get(str(i))) or common)]
        return sum(given) / len(given) * unit if given else None
