"""What `run` and `analyze` print, line by line: each number against the files, each sentence against its condition.

The files themselves are compared with the true motion elsewhere. A line that no rule knows is told as not checked.
"""

import math
import re
from collections.abc import Callable
from typing import Any

from case import Case
from check_sharing import dissipates
from comparing import Tally
from scene_keys import blows, kicks

PREFIXES = {"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
NUMBER = r"[-+]?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|nan|inf)"

Said = list[tuple[str, Any]]
"""Words, and the number that each should be."""


def says(word: str, value: Any) -> bool:
    """Whether a word is a number, rounded as it is printed."""
    word = word.strip()
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return word in ("nan", "-", "inf")
    try:
        number = float(word.rstrip("%"))
    except ValueError:
        return False
    value = 100.0 * value if word.endswith("%") else float(value)
    mantissa, _, exponent = word.rstrip("%").lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    return abs(number - value) <= 0.5001 * 10.0 ** (int(exponent or 0) - digits) + 1e-9 * abs(value)


RULES: list[tuple[str, Callable[[Case, Any], Said | bool]]] = []


def rule(pattern: str) -> Any:
    """A kind of line: what is to be said there, or whether it holds."""

    def add(function: Any) -> Any:
        RULES.append((pattern.replace("<n>", f"({NUMBER}%?)"), function))
        return function

    return add


def check(case: Case, tally: Tally) -> None:
    """All lines of all commands."""
    for command, text in case.printed.items():
        lines = text.splitlines()
        place = 0
        while place < len(lines):
            title, after = _title(case, lines, place)
            if title is not None:
                place = _table(case, tally, command, title, lines, after)
            else:
                _line(case, tally, command, lines[place])
                place += 1


def _title(case: Case, lines: list[str], place: int) -> tuple[str | None, int]:
    """What a table that begins at a line is of, and the place of its head; a long title goes over several lines."""
    if lines[place].startswith(f"{case.scene.name}: "):
        for after in range(place + 1, min(place + 4, len(lines))):
            whole = " ".join(line.strip() for line in lines[place:after])
            name = re.sub(r" from t = .*", "", whole.removeprefix(f"{case.scene.name}: "))
            if name in TABLES and re.match(r"\s*(bead|chain|force at) ", lines[after]):
                return name, after
    return None, place


def _line(case: Case, tally: Tally, command: str, line: str) -> None:
    for pattern, of in RULES:
        match = re.fullmatch(pattern, line.rstrip())
        if match is None:
            continue
        found = of(case, match)
        if isinstance(found, bool):
            tally.claim(f"{command}: {_kind(pattern)}", holds=found, what=line)
            return
        tally.sentences[f"{command}: {_kind(pattern)}"] += 1
        for word, value in found:
            tally.numbers[f"printed by {command}"] += 1
            if not says(word, value):
                tally.wrong.append(f"{command} prints {line!r}: {word} where {value!r} is right")
        return
    tally.unchecked[f"{command} prints: {re.sub(NUMBER, 'N', line)[:90]}"] += 1


def _kind(pattern: str) -> str:
    return pattern.replace(f"({NUMBER}%?)", "N").replace("\\", "")[:60]


# --- tables -----------------------------------------------------------------------------------------------------------


def _table(case: Case, tally: Tally, command: str, title: str, lines: list[str], place: int) -> int:
    """Rows of a table whose head is a line; where it ends."""
    ends = [match.end() for match in re.finditer(r"\S+(?: \S+)*", lines[place])]
    names = [match[0] for match in re.finditer(r"\S+(?: \S+)*", lines[place])]
    place += 1
    before: dict[str, str] = {}
    while place < len(lines):
        cells = {
            names[ends.index(match.end())]: match[0]
            for match in re.finditer(r"\S+(?: \S+)*", lines[place])
            if match.end() in ends
        }
        words = len(re.findall(r"\S+(?: \S+)*", lines[place]))
        if len(cells) < words or (len(cells) < len(names) - 1 and not re.search(r"\bof \d+", lines[place])):
            break
        row = {names[0]: before.get(names[0], "")} | cells
        before = row
        place += 1
        if row.get("chain", "").startswith("of "):
            continue
        for name, (word, value) in TABLES[title](case, row).items():
            tally.numbers[f"printed by {command}"] += 1
            if not says(word, value):
                tally.wrong.append(f"{command} prints {title}, {row}: {name} where {value!r} is right")
    return place


def _waves(case: Case, row: dict[str, str]) -> dict[str, tuple[str, Any]]:
    rows = case.directory.table("waves.csv")
    chain, bead = int(row["chain"]), int(row["bead"])
    own = next(one for one in rows if (one["chain"], one["bead"]) == (chain, bead))
    peak = own["peak_velocity"]
    due = {"arrival": own["arrival"], "peak velocity": peak, "speed": own["speed"]}
    found = {name: (row[_named(row, name)], value) for name, value in due.items()}
    if "peak velocity / V" in row:
        found["over V"] = (row["peak velocity / V"], peak / case.unit.velocity)
    return found


def _named(row: dict[str, str], name: str) -> str:
    return next(key for key in row if re.sub(r" \(.*\)", "", key) == name)


def _shares(case: Case, row: dict[str, str]) -> dict[str, tuple[str, Any]]:
    chain, energy = int(row["chain"]) - 1, case.report["energy"]
    share = [one[chain] for one in energy["share"]]
    later = share[1:] or share
    time = energy["time"][1:] or energy["time"]
    found = {}
    for name, find in (("least", min), ("most", max)):
        word, _, at = row[next(key for key in row if key.startswith(name))].partition(" at ")
        found[name] = (word, find(later))
        found[f"{name} at"] = (at, time[later.index(find(later))])
    place, _, off = row["there, around bead"].partition(" +- ")
    last = (energy["centre"][-1][chain], energy["spread"][-1][chain])
    return found | {"end": (row["at the end"], share[-1]), "centre": (place, last[0]), "spread": (off, last[1])}


def _forces(case: Case, row: dict[str, str]) -> dict[str, tuple[str, Any]]:
    entry = next(
        one for one in case.report["forces"] if (one["name"], one["chain"]) == (row["force at"], int(row["chain"]))
    )
    names = {"largest": "largest", "at": "at", "impulse": "impulse", "dwell": "dwell"}
    if entry["static"] is not None:
        names = {"static": "static", "largest total": "largest", "largest dynamic": "dynamic", "at": "at",
                 "dynamic impulse": "impulse", "dwell above static": "dwell"}  # fmt: skip
    found = {}
    for name, key in names.items():
        word, value = row[_named(row, name)], entry[key]
        if key == "dwell":
            value = None if entry["at"] is None else value
            found["ended"] = ("0" if word.endswith(" so far") else "1", entry["dwell_ended"] is not False)
        found[name] = (word.removesuffix(" so far"), value)
    return found


def _spectra(case: Case, row: dict[str, str]) -> dict[str, tuple[str, Any]]:
    entry = next(
        one
        for one in case.report["spectra"]["beads"]
        if (one["bead"], one["chain"]) == (int(row["bead"]), int(row["chain"]))
    )
    found = {
        "line": (row[_named(row, "highest line at")], entry["frequency"]),
        "velocity": (row[_named(row, "its velocity")], entry["amplitude"]),
    }
    passed = [word for key, word in row.items() if ", over bead" in key]
    for k, (word, drive) in enumerate(zip(passed, entry["at_drive"], strict=True)):
        found[f"drive {k}"] = (word, drive["transmissibility"])
    return found


TABLES: dict[str, Callable[[Case, dict[str, str]], dict[str, tuple[str, Any]]]] = {
    "leading pulse": _waves,
    "share of the energy": _shares,
    "forces": _forces,
    "spectra": _spectra,
}


# --- lines of `run` ---------------------------------------------------------------------------------------------------


@rule(r".*: (\d+) steps in <n> s \(LAMMPS (\d+), \d+ ranks?\)")
def _steps(case: Case, match: Any) -> Said:
    record = case.directory.record
    return [(match[1], record["steps"]), (match[2], record["engine_seconds"]), (match[3], record["lammps"])]


@rule(r".*: (\d+) steps, resumed from steps? [\d, ]+, in <n> s \(LAMMPS (\d+), \d+ ranks?\)")
def _resumed(case: Case, match: Any) -> Said:
    record = case.directory.record
    return [(match[1], record["steps"]), (match[2], record["wall_seconds"]), (match[3], record["lammps"])]


@rule(
    r"error( in the front half of the window)?: velocities <n> V(?: \(bead (\d+) of chain (\d+), t = <n>(?: s)?\))?, "
    r"peaks (\S+) V, arrivals (\S+) T; uncertainty of the reference <n> V, <n> T"
)
def _error(case: Case, match: Any) -> Said:
    check, unit = case.directory.record["check"], case.unit
    found = [(match[2], check["velocity"]), (match[6], check["amplitude"]), (match[7], check["arrival"])]
    found += [(match[8], check["reference"]["velocity"]), (match[9], check["reference"]["arrival"])]
    if match[3] is not None:
        where = check["where"]
        found += [(match[3], where["bead"]), (match[4], where["chain"]), (match[5], where["time"] * unit.time)]
    return found


@rule(r"that is more than <n> V; .*")
def _too_far(case: Case, match: Any) -> bool:
    return bool(case.directory.record["check"]["velocity"] > float(match[1]))


@rule(r"inconclusive: the uncertainty of the reference is too large to compare with <n> V; .*")
def _cannot(case: Case, match: Any) -> bool:
    check, asked = case.directory.record["check"], float(match[1])
    far = check["velocity"] > asked or check["reference"]["velocity"] > asked
    return bool(far and not check["velocity"] - check["reference"]["velocity"] > asked)


@rule(
    r"contacts: overlaps (reach|are at most) <n> of the radius \(<n> m\), forces <n> N, pressures <n> Pa; elastic only if "  # noqa: E501
    r"the yield strength is above <n> Pa .*"
)
def _contacts(case: Case, match: Any) -> Said:
    told = case.directory.record["contacts"] if "contacts" in case.directory.record else case.report["contacts"]
    assert (match[1] == "reach") == told["measured"]
    names = ("overlap", "radius", "force", "pressure", "yield_strength")
    return [(match[k + 2], told[name]) for k, name in enumerate(names)]


@rule(r"that (is|may be) beyond Hertz's law, which wants contacts small .*")
def _beyond(case: Case, match: Any) -> bool:
    told = case.directory.record["contacts"]
    return bool(told["overlap"] > 0.1 and told["measured"] == (match[1] == "is"))


@rule(
    r".*: units: V = <n>(?: m/s)? \((?:largest )?[a-z ]+\), T = <n>(?: ([numkMG]?)s)?, L = <n>(?: ([pnumkMG]?)m)?"
    r"(?:, kappa = <n>)?(?: \(reduced units\))?"
)
def _units(case: Case, match: Any) -> Said:
    time, length = (case.unit.time / PREFIXES[match[3] or ""], case.unit.length / PREFIXES[match[5] or ""])
    found = [(match[1], case.unit.velocity), (match[2], time), (match[4], length)]
    return found + ([(match[6], case.report["kappa"])] if match[6] else [])


# --- lines of `analyze` -----------------------------------------------------------------------------------------------


@rule(r"(does not apply|no energy exchange|too short|beating|equipartitioned|inconclusive|the chains are).*")
def _verdict(case: Case, match: Any) -> bool:
    return case.scene.chains > 1 and bool(match[0] == case.report["equipartition"]["verdict"])


@rule(r"no pulse keeps its shape in this scene")
def _no_pulse(case: Case, _: Any) -> bool:
    return case.scene.chains == 1 and not case.pulse


@rule(
    r"asymptotic amplitude <n> \+- <n> V, <n> (above|below) (the kick|the velocity that the push gives a free bead) "
    r"\(V = <n>(?: m/s)?\)(?:; leading waves have <n> of the energy input)?"
)
def _amplitude(case: Case, match: Any) -> Said | bool:
    told = case.report["equipartition"]
    value = told["final"]["value"]
    most = max(abs(blow) for *_, blow in blows(case.scene))
    by_kick = any(abs(abs(velocity) / case.unit.velocity - most) < 1e-9 for *_, velocity in kicks(case.scene))
    if (match[4] == "above") != (value > 1.0) or (match[5] == "the kick") != by_kick or not case.pulse:
        return False
    found = [(match[1], value), (match[2], max(told["final"]["uncertainty"], 1e-6)), (match[3], abs(1.0 - value))]
    found.append((match[6], case.unit.velocity))
    return found + ([(match[7], told["energy_share"]["measured"])] if match[7] else [])


@rule(
    r"no asymptotic amplitude: (.*); peak velocities of <n> to <n> V over beads (\d+) to (\d+) \(V = <n>(?: m/s)?\)"
    r"(?:; leading waves have <n> of the energy input)?"
)
def _no_amplitude(case: Case, match: Any) -> Said | bool:
    told = case.report["equipartition"]
    if told["final"] is not None or (match[1] == "energy is dissipated") != dissipates(case):
        return False
    found = [(match[k + 2], told["range"][name]) for k, name in enumerate(("least", "largest", "first", "last"))]
    found.append((match[6], case.unit.velocity))
    return found + ([(match[7], told["energy_share"]["measured"])] if match[7] else [])


@rule(r"energy at the end: mean bead <n>, standard deviation <n>")
def _where(case: Case, match: Any) -> Said | bool:
    told = case.report["energy"]
    return case.scene.chains == 1 and [(match[1], told["centre"][-1][0]), (match[2], told["spread"][-1][0])]


@rule(r"decay as \(1 - n / n\*\)\*\*2\.5 over beads (\d+) to (\d+): n\* = <n> \+- <n>(?:, theory <n>)?")
def _decay(case: Case, match: Any) -> Said:
    told = case.report["equipartition"]["decay_law"]
    names = ("first", "last", "n_star", "n_star_error", "n_star_expected")
    return [
        (match[k + 1], told[name]) for k, name in enumerate(names) if match[k + 1] is not None or told[name] is not None
    ]


@rule(r"train of (\d+) pulses at bead (\d+) of chain (\d+): (.*?)(?:, \.\.\.)? V; intervals (.*?)(?:, \.\.\.)? (s|T)")
def _train(case: Case, match: Any) -> Said | bool:
    told = case.report["train"]
    velocity, time = case.unit.velocity, 1.0
    if told["pulses"] < 2 or (match[6] == "s") != case.unit.si:
        return False
    found = [(match[1], told["pulses"]), (match[2], told["bead"]), (match[3], told["chain"])]
    for words, peak, off in zip(match[4].split(", "), told["peak_velocity"], told["uncertainty"], strict=False):
        word, _, varies = words.partition(" +- ")
        found.append((word, peak / velocity))
        if varies:
            found.append((varies, max(off / velocity, 1e-6)))
    return found + [(word, gap * time) for word, gap in zip(match[5].split(", "), told["spacing"], strict=False)]


@rule(r"chain (\d+): (solitary|not solitary|steady|not steady|decaying)(?: \((.*)\))? at bead (\d+): (.*)")
def _leading(case: Case, match: Any) -> Said | bool:
    chain, bead = int(match[1]), int(match[4])
    varies = re.search(f"amplitude varies by ({NUMBER})", match[5])
    there = [one for one in _leaders(case) if (one["chain"], one["bead"]) == (chain, bead)]
    # pulses of either way may lead at one bead
    entry = min(
        there, key=lambda one: abs((one["variation"] or 0.0) - float(varies[1] if varies else 0.0)), default=None
    )
    if entry is None or entry["solitary"] != (match[2] in ("solitary", "steady")):
        return False
    if match[2] == "decaying" and not dissipates(case):
        return False
    if match[2].endswith("solitary") and match[3] is not None and match[3].split(", ") != entry["fails"]:
        return False
    parts = {
        "residual": r"shape differs by <n>",
        "speed_excess": r"speed by <n> from",
        "variation": r"amplitude varies by <n>",
    }
    found = {name: re.search(part.replace("<n>", f"({NUMBER})"), match[5]) for name, part in parts.items()}
    return [(one[1], entry[name]) for name, one in found.items() if one is not None]


@rule(r"chain (\d+): at bead (\d+): fewer than two beads of its mass among the last ten, .*")
def _few(case: Case, match: Any) -> bool:
    entry = next(one for one in _leaders(case) if (one["chain"], one["bead"]) == (int(match[1]), int(match[2])))
    return entry["speed_excess"] is None and entry["variation"] is None


@rule(r"chain (\d+): at bead (\d+): not recorded long enough around its passage to compare its shape")
def _not_whole(case: Case, match: Any) -> bool:
    entry = next(one for one in _leaders(case) if (one["chain"], one["bead"]) == (int(match[1]), int(match[2])))
    return entry["residual"] is None


@rule(r"(\d+) solitary waves: shape within <n>, speed <n> of the exact wave, amplitude varies by up to <n>")
def _many(case: Case, match: Any) -> Said | bool:
    leaders = _leaders(case)
    most = [max(abs(one[name]) for one in leaders if one[name] is not None)
            for name in ("residual", "speed_excess", "variation")]  # fmt: skip
    if not all(one["solitary"] for one in leaders):
        return False
    return [(match[1], len(leaders)), *((match[k + 2], value) for k, value in enumerate(most))]


def _leaders(case: Case) -> list[dict[str, Any]]:
    return [one for one in case.report["pulses"] if one["leading"]]


@rule(r"(?:(\d+) other pulses|one other pulse), with peak velocities up to <n> V \(analysis.json has all\)")
def _others(case: Case, match: Any) -> Said | bool:
    others = [one for one in case.report["pulses"] if not one["leading"]]
    most = max(one["peak_velocity"] for one in others) / case.unit.velocity
    if float(match[2]) < most - 5.1e-4:  # it may have been higher on its way
        return False
    return [(match[1] or "1", len(others))]


@rule(r"sound waves, with peak velocities up to <n> V")
def _crests(case: Case, match: Any) -> Said:
    return [(match[1], case.report["sound"]["crest"] / case.unit.velocity)]


@rule(r"arrival: centre of the impulse until the bead is fastest")
def _impulse(case: Case, _: Any) -> bool:
    return case.report["arrival"] == "impulse"


@rule(r"arrivals are maxima, which are not defined at (?:(\d+) beads that fly|a bead that flies) freely .*")
def _free(case: Case, match: Any) -> Said:
    rows = case.directory.table("waves.csv")
    along = (lambda bead: bead) if case.way > 0 else (lambda bead: case.scene.beads + 1 - bead)
    free = [row for row in rows if row["arrival"] is None and along(row["bead"]) <= case.scene.beads - 5]
    return [(match[1] or "1", len(free))]


@rule(
    r"uncertainty by frames <n>(?: s)? apart: of peak velocities up to <n> V \(bead (\d+) of chain (\d+)\)"
    r"(?:, of arrivals up to <n>(?: s)?)?; of each in waves.csv"
)
def _sure(case: Case, match: Any) -> Said | bool:
    rows, unit = case.directory.table("waves.csv"), case.unit
    worst = max(rows, key=lambda row: row["peak_velocity_error"])
    late = max((row["arrival_error"] for row in rows if row["arrival_error"] is not None), default=0.0)
    if not worst["peak_velocity_error"] / unit.velocity > 1e-4:
        return False
    return [
        (match[1], case.every * unit.time),
        (match[2], worst["peak_velocity_error"] / unit.velocity),
        (match[3], worst["bead"]),
        (match[4], worst["chain"]),
        *([(match[5], late)] if late > 0.0 else []),
    ]


@rule(r"frames are more than <n>(?: s)? apart: small pulses may be missed between them")
def _far(case: Case, match: Any) -> bool:
    return says(match[1], 1.4 * case.unit.time) and case.every > 1.4


@rule(r"drift: (?:energy <n>)?(?:, )?(?:momentum <n>)? of (the kick's|the input)")
def _drifts(case: Case, match: Any) -> Said | bool:
    told = case.report
    if (match[3] == "the kick's") == case.exchanges or (match[1] is not None and case.exchanges):
        return False
    return [(match[k], told[name]) for k, name in ((1, "energy_drift"), (2, "momentum_drift")) if match[k] is not None]


@rule(r"energy input <n>(?: J)? until t = <n>(?: s)?, (?:at most <n>(?: J)? before|of which (.*))")
def _budget(case: Case, match: Any) -> Said:
    told = case.report["budget"]
    total = told["energy_input"][-1]
    found = [(match[1], total), (match[2], told["time"][-1])]
    if match[3] is not None:
        found.append((match[3], max(map(abs, told["energy_input"]))))
    for part in (match[4] or "").split(", "):
        word, _, name = part.partition(" ")
        if word:
            lost = {f"lost in {key.replace('_', ' ')}": values[-1] for key, values in told["lost"].items()}
            here = {key: values[-1] for key, values in told.items() if isinstance(values, list)}
            found.append((word, (lost | here)[name] / total))
    return found


@rule(
    r"energy balance closed to <n> of the energy input; exchange between frames uncertain by <n>(?:; error of the run <n> V)?"  # noqa: E501
)
def _closed(case: Case, match: Any) -> Said:
    told = case.report["budget"]
    found = [(match[1], told["closed"]), (match[2], told["between_frames"])]
    return found + ([(match[3], told["stated"])] if match[3] else [])


@rule(
    r"(.* wall), chain (\d+): (?:largest (dynamic )?force <n> times that at (contact \d+))?(?:, )?"
    r"(?:the first pulse is reflected at <n> \+- <n> of its peak velocity \(incident: beads (\d+) to (\d+), "
    r"reflected: (\d+) to (\d+), extrapolated to the wall(; chains exchange energy meanwhile)?\))?"
)
def _at_walls(case: Case, match: Any) -> Said | bool:
    told = {(one["name"], one["chain"]): one for one in case.report["forces"]}
    chain = int(match[2])
    wall, found = told[match[1], chain], []
    if match[4] is not None:
        key = "largest" if wall["dynamic"] is None else "dynamic"
        if (match[3] is not None) != (key == "dynamic"):
            return False
        found.append((match[4], wall[key] / told[match[5], chain][key]))
    if match[6] is not None:
        if bool(match[12]) != bool(case.nature.springs) or wall["reflected"] is None:
            return False
        beads = wall["reflected"]["incident_beads"] + wall["reflected"]["reflected_beads"]
        found += [(match[6], wall["reflected"]["ratio"]), (match[7], wall["reflected"]["uncertainty"])]
        found += [(match[k], bead) for k, bead in zip(range(8, 12), beads, strict=True)]
    return found


@rule(
    r"the record ends \(t = <n>(?: s)?\) inside a pulse: the force still differs from (0|the static force) "
    r"\(by a share of its largest difference\) at (.*?)(?: and (\d+) more)?; impulses and largest values there .*"
)
def _inside(case: Case, match: Any) -> Said | bool:
    told = {f"{one['name']}, chain {one['chain']}": one["last"] for one in case.report["forces"]}
    over = [name for name, value in told.items() if value is not None and abs(value) >= 0.01]
    named = dict(re.findall(r"([a-z0-9 ]+, chain \d+) \((\S+)\)", match[3]))
    if len(named) + int(match[4] or 0) != len(over) or (match[2] != "0") != case.nature.loaded:
        return False
    return [
        (match[1], case.directory.duration * case.unit.time),
        *((word, told[n.strip()]) for n, word in named.items()),
    ]


@rule(r"no dispersion map: (.*)")
def _no_map(case: Case, match: Any) -> bool:
    return bool(match[1] == case.report["dispersion"]["why"])


@rule(
    r"sound: c0 = <n>(?: to <n>)? beads(?:/s| per unit time)(?: \(<n> m/s\))?(?:; the leading pulse runs at <n> c0 past beads (\d+) to (\d+), F_m/F_0 = <n>(?:: <n> of the long-wave theory .*)?)?"  # noqa: E501
)
def _sound(case: Case, match: Any) -> Said:
    told = case.report["sound"]
    wave = told["pulse"]
    if wave is None:
        found = [(match[1], told["speed"][0]), (match[2] or match[1], told["speed"][1])]
        return found + ([(match[3], told["metres"][1])] if match[3] else [])
    names = {4: "over_sound", 5: "first", 6: "last", 7: "force_ratio", 8: "over_theory"}
    found = [(match[1], wave["sound"])]
    if match[3]:
        found.append((match[3], told["metres"][1] * wave["sound"] / told["speed"][1]))
    return found + [(match[k], wave[name]) for k, name in names.items() if match[k] is not None]


@rule(
    r"sound: long waves do not run, for springs to the ground hold the beads(?:; small ones have frequencies from <n> to <n> .*)?"  # noqa: E501
)
def _held(case: Case, match: Any) -> Said | bool:
    if case.report["sound"]["speed"] is not None:
        return False
    return [] if match[1] is None else [(match[2], case.report["sound"]["cutoff"])]


@rule(r"window: .*")
def _window(case: Case, match: Any) -> bool:
    return bool(match[0] == case.report["window"]["sentence"])


@rule(
    r"chain (\d+): the leading pulse has <n> of the energy input at bead (\d+)"
    r"(?:; from bead (\d+) on (less than )?<n> of the energy input remains in each (?:bead|cell of (\d+) beads))?"
)
def _carries(case: Case, match: Any) -> Said | bool:
    cells = case.report["cells"]
    told = cells["chains"][int(match[1]) - 1]
    found = [(match[2], told["carried"]), (match[3], told["last"])]
    if match[4] is None:
        return found if told["per_cell"] is None else False
    found += [(match[4], told["first"]), (match[7] or "1", cells["beads"])]
    return found if match[5] and told["per_cell"] <= float(match[6]) else [*found, (match[6], told["per_cell"])]


@rule(r"chain (\d+): largest kinetic energy of its last bead <n> of the energy input")
def _last(case: Case, match: Any) -> Said:
    return [(match[2], case.report["cells"]["last_bead"][int(match[1]) - 1])]


@rule(
    r"bead (\d+) of chain (\d+): at the end its chain has <n> of the energy input in beads before it, <n> in it, "
    r"<n> in beads beyond"
)
def _split(case: Case, match: Any) -> Said:
    places = ((one["bead"], one["chain"]) for one in case.report["cells"]["replaced"])
    told = case.report["cells"]["replaced"][list(places).index((int(match[1]), int(match[2])))]
    return [(match[k + 3], told[name]) for k, name in enumerate(("before", "at", "beyond"))]


@rule(r"  it reflects <n> of the energy input; <n> is incident")
def _sent(case: Case, match: Any) -> bool:
    told = case.report["cells"]["replaced"]
    return any(
        one["reflected"] is not None and says(match[1], one["reflected"]) and says(match[2], one["incident"])
        for one in told
    )


@rule(r".*: (.*waves\.csv.*)")
def _names(case: Case, match: Any) -> bool:
    return all((case.directory.path / name).is_file() for name in match[1].split(", "))


@rule(r"incomplete: .*|compiling the reference.*|")
def _other(case: Case, match: Any) -> bool:
    return not match[0].startswith("incomplete") or not case.report["complete"]
