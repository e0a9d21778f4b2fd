"""Scene files that cannot be used, one mistake each, with what the one line about it has to say.

For the tests of the library and of the command line. `BadScene.place` makes the file and returns its path.
"""

import json
import os
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, strict_yaml

_GOOD = {"name": "test", "beads": "10", "kick": "{bead: 1, velocity: 1.0}", "duration": "5"}


def scene_text(**lines: str | None) -> str:
    """YAML of a small good scene with some lines changed, added, or (None) left out."""
    return "".join(f"{key}: {value}\n" for key, value in {**_GOOD, **lines}.items() if value is not None)


def assert_one_line(error: InputError, start: str) -> None:
    """The message begins with what it is about, and prints as one line of readable length on any terminal."""
    message = str(error)
    assert message.startswith(start)
    assert len(message.splitlines()) == 1
    assert message.isprintable()
    assert len(message) < len(start) + 250


@dataclass(frozen=True)
class BadScene:
    """One mistake.

    Attributes:
        kind: what is wrong, for people.
        content: the file, or a function that makes something else at its path.
        key: what the message must name beside the file: a key, or a line.
        says: what else the message must say, so that it helps.
        possible: whether this machine and user can have this mistake.
    """

    kind: str
    content: str | bytes | Callable[[Path], object]
    key: str
    says: str
    possible: bool = True

    def place(self, directory: Path) -> Path:
        """Make the file in a directory."""
        path = directory / "bad.yaml"
        if isinstance(self.content, str):
            path.write_text(self.content, encoding="utf-8")
        elif isinstance(self.content, bytes):
            path.write_bytes(self.content)
        else:
            self.content(path)
        return path


def _without_permission(path: Path) -> None:
    path.write_text(scene_text())
    path.chmod(0)


def _changed(kind: str, key: str, says: str, **lines: str | None) -> BadScene:
    return BadScene(kind, scene_text(**lines), key, says)


_BALL = "{radius: 4.76e-3, density: 8000, youngs_modulus: 193e9, poisson_ratio: 0.3}"
_OTHER = "radius: 4.76e-3, density: 7000, youngs_modulus: 2e11, poisson_ratio: 0.2"
_STEEL = "radius: 4.76e-3, density: 8000, youngs_modulus: 193e9"


def _in(number: str) -> str:
    """A steel ball with one of its numbers in another unit."""
    key = number.partition(":")[0]
    return re.sub(rf"{key}: [^,}}]*", number, _BALL)


_FILES = [
    BadScene("missing file", lambda _: None, "", "no such file"),
    BadScene("directory", lambda path: path.mkdir(), "", "directory"),
    BadScene("no permission to read", _without_permission, "", "Permission denied", possible=os.geteuid() != 0),
    BadScene(
        "file that cannot be read",
        lambda path: path.symlink_to("/proc/self/mem"),
        "",
        "cannot be read",
        possible=sys.platform == "linux",
    ),
    BadScene("symbolic link to itself", lambda path: path.symlink_to(path), "", "cannot be read"),
    BadScene("empty file", "", "", "is empty; `granchain show two-chains` prints a scene to start from"),
    BadScene("sweep", "scene: two-chains\nvary: {gap: [1]}\n", "", "looks like a sweep, not a scene; `granchain sweep"),
    BadScene("design", "scene: two-chains\nvary: {}\nminimize: delay\n", "", "looks like a design, not a scene;"),
    BadScene("only comments", "# soon\n", "", "is empty"),
    BadScene("binary file", bytes(range(256)), "", "not a text file"),
    BadScene("zeros", bytes(4096), "", "unacceptable character"),
    BadScene("UTF-16", scene_text().encode("utf-16"), "", "not a text file"),
    BadScene("huge file", b"#" * (1 << 24), "", "8192 KiB"),
]

_YAML = [
    BadScene("list", "- 1\n- 2\n", "", "list"),
    BadScene("lone word", "two chains\n", "", "`key: value`"),
    BadScene("lone number", "12\n", "", "`key: value`"),
    BadScene("two documents", scene_text() + "---\n" + scene_text(), "line 5", "another document"),
    BadScene("tab", "name: test\n\tbeads: 10\n", "line 2", "'\\t'"),
    BadScene("open bracket", scene_text(kick="{bead: 1"), "line 4", "close the bracket of line 3"),
    BadScene("no space behind a colon", scene_text() + "gap:2\nchains: 2\n", "line 5", "space after the colon"),
    BadScene("two indentations", scene_text() + "coupling:\n stiffness: 1\n  rows: [1, 2]\n", "line 7", "same"),
    BadScene("open quote", scene_text(name="'test"), "line 5", "quoted"),
    BadScene("key twice", scene_text() + "beads: 12\n", "line 5", "'beads' is given twice"),
    BadScene("key twice within", scene_text(output="{every: 1, every: 2}"), "line 5", "'every' is given twice"),
    BadScene("alias", scene_text(chains="&n 2", beads="*n"), "line", "aliases"),
    BadScene("anchor", scene_text(beads="&n 10"), "line 2", "anchors"),
    BadScene("deep list", scene_text(output="[" * 5_000), "", "nested too deeply"),
    BadScene("deep mapping", "{a: " * 5_000, "", "nested too deeply"),
    BadScene("object of Python", scene_text(name="!!python/object/apply:os.system [ls]"), "line 1", "tags"),
    BadScene("tag on nothing", scene_text(gap='!!int ""'), "line 5", "tags"),
    BadScene("number as key", scene_text() + "1.5: 4\n", "line 5", "plain words"),
    BadScene(
        "decimal comma between braces",
        scene_text() + "coupling: {model: linear, stiffness: 0,1}\n",
        "line 5",
        "write a number with a point: 0.1",
    ),
    BadScene("list as key", scene_text() + "? [a, b]\n: 4\n", "line 5", "plain words"),
    BadScene("escape sequence as key", scene_text() + '"\\e[31m": 4\n', "line 5", "plain words"),
    BadScene("control character", scene_text() + "\x07", "", "unacceptable character"),
    BadScene("integer of 5000 digits", scene_text(beads="9" * 5000), "", "number too long"),
    BadScene("character that does not exist", scene_text(name='"\\UFFFFFFFF"'), "", "character that does not exist"),
]

_KEYS = [
    _changed("two mistakes", "beads:", "'ten' given; kick.bead: should", beads="ten", kick="{bead: a, velocity: 1}"),
    _changed("misspelt key and another mistake", "kick.velocty:", "; beads: should", kick="{velocty: 1}", beads="ten"),
    _changed(
        "key of a part",
        "velocity:",
        "(did you mean `striker.velocity` or `kick.velocity` or `drive.velocity`",
        velocity="1",
    ),
    _changed("key of a scene in a part", "kick.gap:", "(did you mean `gap`?)", kick="{velocity: 1, gap: 2}"),
    _changed("no value", "beads:", "nothing given", beads=""),
    _changed("unknown key", "colour:", "known here: name", colour="red"),
    _changed("misspelt key", "durration:", "did you mean `duration`?", durration="5", duration=None),
    _changed("misspelt key within", "kick.velocty:", "did you mean `velocity`?", kick="{velocty: 1}"),
    _changed("misspelt key in one kick of two", "kick[2].bed:", "`bead`?", kick="[{velocity: 1}, {bed: 2}]"),
    _changed("case", "Beads:", "did you mean `beads`?", Beads="10", beads=None),
    _changed("merge key", "<<:", "unknown key", **{"<<": "{beads: 3}"}),
    _changed("nothing as key", "'':", "unknown key", **{"''": "3"}),
    _changed("no beads", "beads:", "missing", beads=None),
    _changed("no name", "name:", "missing", name=None),
    _changed("no kick", "kick:", "missing", kick=None),
    _changed("coupling without stiffness", "coupling.stiffness:", "missing", coupling="{model: linear}"),
    _changed("misspelt material", "material.name:", "did you mean `steel`?", material="{name: stel, radius: 1e-3}"),
    _changed("material of other constants", "material:", "steel is named", material=f"{{name: steel, {_OTHER}}}"),
    _changed("material without ratio", "material.poisson_ratio:", "missing", material=f"{{{_STEEL}}}"),
]

_TYPES = [
    _changed("text for a count", "beads:", "whole number, 'ten' given", beads="ten"),
    _changed("fraction for a count", "beads:", "whole number, 10.5 given", beads="10.5"),
    _changed("point in a count", "beads:", "without a point or exponent, 10", beads="10.0"),
    _changed("exponent in a count", "beads:", "without a point or exponent, 1000000000000", beads="1e12"),
    _changed("truth value for a count", "chains:", "whole number, true given", chains="true"),
    _changed("text for a number", "duration:", "number, '192 s' given", duration="192 s"),
    _changed("decimal comma", "duration:", "number, '0,5' given", duration="0,5"),
    _changed("sexagesimal", "duration:", "number, '1:30' given", duration="1:30"),
    _changed("hexadecimal", "duration:", "number, '0x10' given", duration="0x10"),
    _changed("underscored", "duration:", "number, '1_000' given", duration="1_000"),
    _changed("list for a number", "duration:", "number, [1, 2] given", duration="[1, 2]"),
    _changed("list for a name", "name:", "text, ['a'] given", name="[a]"),
    _changed("number for a name", "name:", "text, 7 given", name="7"),
    _changed("number for a coupling", "coupling:", "such as `coupling: {stiffness: 0.1}`, 0.1", coupling="0.1"),
    _changed("number for a kick", "kick[1]:", "`key: value`", kick="1.0"),
    _changed("nothing for an output", "output:", "`key: value`", output=""),
    _changed("text in a list of beads", "output.beads:", "`all` or a list", output="{beads: [1, two]}"),
    _changed("word for a list of beads", "output.beads:", "`all` or a list", output="{beads: some}"),
]

_VALUES = [
    _changed("negative count", "beads:", "-10 given", beads="-10"),
    _changed("one bead", "beads:", "equal to 2", beads="1"),
    _changed("no chains", "chains:", "equal to 1", chains="0"),
    _changed("2**31 beads", "beads:", "2147483648 given", beads=str(2**31)),
    _changed("more beads in all than LAMMPS numbers", "beads:", "2147483647", chains="1000", beads=str(10**8)),
    _changed("400 digits for a count", "chains:", "999... given", chains="9" * 400),
    _changed("400 digits for a number", "gap:", "999... given", gap="9" * 400),
    _changed("NaN", "duration:", "finite", duration=".nan"),
    _changed("infinity", "kick.velocity:", "finite", kick="{velocity: .inf}"),
    _changed("overflow", "duration:", "finite", duration="1e999"),
    _changed("huge number", "duration:", "1e+300 given", duration="1e300"),
    _changed("negative duration", "duration:", "-5 given", duration="-5"),
    _changed("zero duration", "duration:", "greater than 0", duration="0"),
    _changed("negative time step", "timestep:", "-0.01 given", timestep="-0.01"),
    _changed("time step that does not divide", "timestep:", "or try 0.025", timestep="0.03", output="{every: 0.1}"),
    _changed(
        "time step longer than a frame",
        "timestep:",
        "leave it out for an accuracy of 0.0002 V",
        timestep="1",
        output="{every: 0.1}",
    ),
    _changed("vanishing time step", "output.every:", "longer steps", timestep="1e-320"),
    _changed("too many steps", "duration:", "at most 1e+12", duration="1e29"),
    _changed("too many steps in a frame", "output.every:", "record more often", output="{every: 1e9}"),
    _changed("peaks found on the way", "output.peaks:", "unknown key", output="{peaks: true}"),
    _changed("zero cadence", "output.every:", "greater than 0", output="{every: 0}"),
    _changed("negative gap", "gap:", "-0.5 given", gap="-0.5"),
    _changed("gap that never closes", "kick: none ever closes", "the gap of 1", gap="1", kick="{velocity: -1.0}"),
    _changed("accuracy and time step", "accuracy:", "give either", accuracy="1e-3", timestep="0.01"),
    _changed("accuracy below rounding", "accuracy:", "or equal to 0.0000000001, 1e-11 given", accuracy="1e-11"),
    _changed("accuracy of no use", "accuracy:", "less than or equal to 0.1, 0.5 given", accuracy="0.5"),
    _changed("accuracy in words", "accuracy:", "should be a number, 'high' given", accuracy="high"),
    _changed("gap in which positions lose their digits", "gap:", "at most 1e+08", gap="1e20"),
    _changed("wrong coupling model", "coupling.model:", "'linear'", coupling="{model: cubic, stiffness: 1}"),
    _changed("negative coupling", "coupling.stiffness:", "-0.1 given", coupling="{stiffness: -0.1}"),
    _changed("rigid coupling", "coupling.stiffness:", "at most 1e12", chains="2", coupling="{stiffness: 1e20}"),
    _changed("zero kick", "kick.velocity:", "needs a velocity", kick="{velocity: 0}"),
    _changed("kick next to zero", "kick.velocity:", "needs a velocity", kick="{velocity: 1e-40}"),
    _changed("no kick in the list", "kick:", "at least one", kick="[]"),
    _changed("bead kicked twice", "kick:", "add the velocities", kick="[{velocity: 1}, {velocity: 2}]"),
    _changed("kick of bead 0", "kick.bead:", "0 given", kick="{bead: 0, velocity: 1}"),
    _changed("kick outside the chain", "kick.bead:", "beads 1 to 10", kick="{bead: 11, velocity: 1}"),
    _changed("kick outside the array", "kick.chain:", "chains 1 to 1", kick="{chain: 2, velocity: 1}"),
    _changed("two ends", "duration:", "both are given", until_bead="5"),
    _changed("no end", "duration:", "neither is given", duration=None),
    _changed("end beyond the chain", "until_bead:", "beads 1 to 10", until_bead="11", duration=None),
    _changed("end at bead 0", "until_bead:", "0 given", until_bead="0", duration=None),
    _changed("record outside the chain", "output.beads:", "beads 1 to 10", output="{beads: [1, 11]}"),
    _changed("record nothing", "output.beads:", "at least one", output="{beads: []}"),
    _changed("record a bead twice", "output.beads:", "named twice", output="{beads: [3, 3]}"),
    _changed("snapshots of earlier releases", "output.snapshots:", "leave it out", output="{snapshots: 1, beads: [1]}"),
    _changed("Poisson's ratio 0.7", "material.poisson_ratio:", "0.5", material=f"{{{_STEEL}, poisson_ratio: 0.7}}"),
    _changed(
        "spheres without mass",
        "kick:",
        "check the material",
        material="{radius: 1e-200, density: 8000, youngs_modulus: 193e9, poisson_ratio: 0.3}",
    ),
    _changed("faster than sound", "kick:", "4912 m/s", kick="{velocity: 5000}", material=_BALL),
    _changed("a radius for a speed", "kick:", "faster than sound", kick="{velocity: 1e6}", material=_BALL),
    _changed(
        "beads that would be flattened",
        "kick:",
        "an overlap of at least 1.7 times the radius",
        kick="[{velocity: 2100}, {bead: 2, velocity: -2100}]",
        material=_BALL,
    ),
    _changed(
        "modulus in GPa", "material.youngs_modulus:", "youngs_modulus in Pa?", material=_in("youngs_modulus: 193")
    ),
    _changed("density in g/cm3", "material.density:", "8 g/cm3 is 8000 kg/m3", material=_in("density: 8")),
    _changed(
        "modulus of a kind in GPa",
        "kinds.soft.youngs_modulus:",
        "103 GPa is 1.03e+11 Pa",
        material=_BALL,
        kinds="{soft: {youngs_modulus: 103}}",
        pattern="[soft]",
    ),
    _changed(
        "push in us", "push:", "faster than sound", material=_BALL, push="{peak: 100, duration: 50, shape: half-sine}"
    ),
    _changed("load in kN", "precompression:", "an overlap of at least", material=_BALL, precompression="{force: 1e7}"),
    _changed(
        "spheres without stiffness",
        "kick:",
        "check the material",
        material="{radius: 1e-200, density: 8000, youngs_modulus: 1e-300, poisson_ratio: 0.3}",
    ),
]

NAMES = (
    "../escape",
    "..",
    "/etc/passwd",
    ".hidden",
    "a/b",
    "a\\b",
    "two chains",
    " padded ",
    "line\nbreak",
    "ends\n",
    "carriage\rreturn",
    "a'quote",
    'a"quote',
    "${x}",
    "$(1+1)",
    "$x",
    "`ls`",
    "a;ls",
    "a|b",
    "a&",
    "#a",
    "-rf",
    "",
    "nul\0",
    "ünïcode",
    "a\u2028b",
    "x" * 65,
)
"""Names that could become a command, a path or a mess."""

_NAMES = [
    *(_changed(f"name {name[:20]!r}", "name:", "letters, digits", name=json.dumps(name)) for name in NAMES),
    _changed("description of two lines", "description:", "one line", description='"a\\nb"'),
]

BAD_SCENES = [*_FILES, *_YAML, *_KEYS, *_TYPES, *_VALUES, *_NAMES]


# --- what ingredients refuse ------------------------------------------------------------------------------------------

_COUPLED = {
    "name": "test",
    "chains": 2,
    "beads": 12,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 20.0,
}


def _refused(message: str, **changes: Any) -> BadScene:
    """Two coupled chains with other keys, without those of None; the message follows the file's name."""
    keys = {key: value for key, value in {**_COUPLED, **changes}.items() if value is not None}
    return BadScene(f"{message} {changes}", strict_yaml.dump(keys), message, "")


_RAMP = {"from": 1.0, "to": 4.0, "contacts": [2, 5]}


def _exponents(message: str, **changes: Any) -> BadScene:
    """Two chains whose contacts have exponents of their own."""
    return _refused(message, **{"contact": {"exponent": [1.5] * 10 + [1.0]}, **changes})


def _graded(message: str, strength: Any) -> BadScene:
    """Two chains with strengths of the contacts."""
    return _refused(f"contact.strength{message}", contact={"strength": strength})


def _yields(message: str, given: Any, force: str | None = None, **more: Any) -> BadScene:
    return _refused(message, contact={"yield": given, **({} if force is None else {"force": force})}, **more)


def _tied(message: str, **keys: Any) -> BadScene:
    """Three chains with another coupling."""
    return _refused(f"coupling.{message}", chains=3, coupling=keys)


def _edges(message: str, *edges: list[float]) -> BadScene:
    return _tied(message, stiffness=0.1, topology={"edges": list(edges)})


def _damped(message: str, more: dict[str, Any] = {}, **keys: Any) -> BadScene:  # noqa: B006 -- never changed
    return _refused(f"damping{message}", damping=keys, **more)


_EITHER = "displacement: give either displacement, force, velocity or table"


def _driven(message: str, *drives: dict[str, float], **more: Any) -> BadScene:
    return _refused(message, kick=None, drive=list(drives), **more)


def _pushed(message: str, push: dict[str, Any], **more: Any) -> BadScene:
    return _refused(f"push{message}", kick=None, push=push, **more)


def _kinds(message: str, **more: Any) -> BadScene:
    """Dimers, unless it has another pattern or other kinds."""
    return _refused(message, **{"kinds": {"heavy": {}, "light": {"mass": 0.5}}, "pattern": ["heavy", "light"], **more})


def _kind(message: str, **kind: float) -> BadScene:
    return _kinds(message, kinds={"a": kind}, pattern=["a"])


def _walled(message: str, walls: dict[str, Any], **more: Any) -> BadScene:
    return _refused(f"walls{message}", walls=walls, **more)


def _gauged(message: str, forces: dict[str, Any], **more: Any) -> BadScene:
    return _refused(f"output.{message}", **{"walls": {"right": "bead"}, "output": {"forces": forces}, **more})


_RESONATOR = {"mass": 0.1, "stiffness": 1.0}


def _resonant(message: str, **keys: Any) -> BadScene:
    return _refused(message, resonators={**_RESONATOR, **keys})


def _bed(message: str, stiffness: Any, **more: Any) -> BadScene:
    return _refused(message, foundation={"stiffness": stiffness, **more})


_SI = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
_RISING = {"from": 1, "to": 2}
_WAVE = {"depth": 0.5, "frequency": 0.1}
_WINDOW = {"beads": 100, "window": 64}
_SQUARE = {"contact": {"exponent": 2.0}}
_HALF_SINE = {"peak": 1.0, "duration": 2.0, "shape": "half-sine"}
_MOVED = {"displacement": 0.5, "frequency": 0.3}
_FORCED = {"chain": 2, "bead": 4, "force": 0.4, "frequency": 0.2}
_LOAD = {"precompression": {"force": 0.3}}
_UNLIKE_ENDS = {
    "kinds": {"heavy": {}, "light": {"mass": 0.5, "stiffness": 2.0}},
    "pattern": [["heavy", "heavy", "light", "light"], ["light", "light", "heavy", "heavy"]],
}
_GAPS = {"contacts": {"1": 0.1}}
_BY_MASS = {"mass": 0.03, "contact": {"stiffness": 1e7}}
_FOR_SPHERES = "the contact constant of such a wall is known for spheres, of exponent 1.5, not 2"

REFUSED = [
    _refused("contact.exponent: should be greater than or equal to 1, 0.9 given", contact={"exponent": 0.9}),
    _refused("contact.exponent: should be less than or equal to 3, 3.1 given", contact={"exponent": 3.1}),
    _refused("contact.stiffness: is missing", contact={"exponent": 2.0}, material=_SI),
    _refused("contact.stiffness: the material determines", material=_SI, contact={"exponent": 1.5, "stiffness": 1e9}),
    _refused("contact.exponent: how the contacts of beads of unlike radius", **_SQUARE, taper=0.02),
    _refused("contact: contacts of an exponent below 1.5 open", contact={"exponent": 1.2}, scheme="suzuki4"),
    _tied("stiffness: is missing"),
    _tied("topology.lattice: 2 x 2 places for 3 chains", stiffness=0.1, topology={"lattice": [2, 2]}),
    _edges("topology.edges[2]: 4 is outside the array (chains 1 to 3)", [1, 2], [1, 4]),
    _edges("topology.edges[1]: ties chain 2 to itself", [2, 2]),
    _edges("topology.edges[2]: chains 1 and 2 are tied twice", [1, 2], [2, 1]),
    _edges("stiffness: every edge has a stiffness of its own", [1, 2, 0.3]),
    _tied("rows: 5 to 13 given; from a bead to a later one, within 12", stiffness=0.1, rows=[5, 13]),
    _tied("stiffness.rows: 5 to 5 given", stiffness={"from": 0.1, "to": 0.2, "rows": [5, 5]}),
    _tied("stiffness.to: is missing", stiffness={"from": 0.1, "rows": [1, 5]}),
    _tied("stiffness: 1e+13 in dimensionless units", topology={"edges": [[1, 2, 1e13]]}),
    _tied("cubic: 1e+13 in dimensionless units", cubic=1e13),
    _tied("stiffness: should be a number", stiffness="much"),
    _tied("topology: should be 'open' or 'ring', or hold pairs, `{lattice, edges}`, 'star'", topology="star"),
    _tied("cubic: should be greater than or equal to 0, -1.0 given", stiffness=0.1, cubic=-1.0),
    _refused("coupling.rows: a window takes rows", coupling={"stiffness": 0.1, "rows": [1, 50]}, **_WINDOW),
    _refused(
        "coupling.stiffness: a window takes rows from its tail to its head with the springs they have",
        coupling={"stiffness": {"from": 0.0, "to": 0.1, "rows": [3, 9]}},
        **_WINDOW,
    ),
    _damped(": give contact, beads or coupling"),
    _damped(".law: belongs to damping.contact", law="linear"),
    _damped(".contact: 1.2 is no restitution", contact=1.2, law="restitution"),
    _damped(".tension: the law restitution needs tensile forces", contact=0.9, law="restitution", tension="cut"),
    _damped(".coupling: there is no coupling between chains", {"coupling": None}, coupling=0.1),
    _damped(": 2e+03 in dimensionless units; at most 1000", contact=2e3),
    _damped(": suzuki4 has steps backwards in time", {"scheme": "suzuki4"}, contact=0.1),
    _damped(": a window restarts with forces from velocities other", _WINDOW, contact=0.1),
    _damped(".tension: is cut where dashpots pull harder", _SQUARE, contact=0.1, tension="cut"),
    _damped(
        ".tension: is cut at the force of equal",
        {"disorder": {"mass": 0.1}, "coupling": None},
        contact=0.1,
        tension="cut",
    ),
    _driven(f"drive[1]: {_EITHER} (none is given)", {"frequency": 1.0}),
    _driven(f"drive[1]: {_EITHER} (displacement and force are given)", {**_MOVED, "force": 1.0}),
    _driven("drive[1]: frequency: is missing; a harmonic drive needs it", {"displacement": 1.0}),
    _driven("drive[1]: frequency: goes with displacement or force only", {"velocity": 1.0, "frequency": 1.0}),
    _driven("drive[1]: until: goes with velocity only", {**_MOVED, "until": 1.0}),
    _driven("drive[1]: velocity: a piston needs a velocity (at least 1e-30) (0 given)", {"velocity": 0.0}),
    _driven("drive[1]: until: must be later than the start at 2", {"velocity": 1.0, "from": 2.0, "until": 2.0}),
    _driven("drive[1]: quantity: is missing; a table without names", {"table": [[0.0, 0.0], [1.0, 1.0]]}),
    _driven("drive.table: has 1 points; 2 to 100000 are needed", {"table": [[0.0, 1.0]], "quantity": "velocity"}),
    _driven(
        "drive.table: times must increase; 0 follows 0", {"table": [[0.0, 1.0], [0.0, 2.0]], "quantity": "velocity"}
    ),
    _driven("drive.table: has no motion", {"table": [[0.0, 0.0], [1.0, 0.0]], "quantity": "velocity"}),
    _driven(
        "drive[1]: table: must begin with a displacement of 0",
        {"table": [[0.0, 0.1], [1.0, 0.0]], "quantity": "displacement"},
    ),
    _driven(
        "drive[1].velocity: bead 1 of chain 1 is pushed, too", {"velocity": 1.0}, {**_FORCED, "chain": 1, "bead": 1}
    ),
    _driven("drive.bead: 13 is outside the array (beads 1 to 12)", {**_MOVED, "bead": 13}),
    _driven("drive.chain: 3 is outside the array (chains 1 to 2)", {**_MOVED, "chain": 3}),
    _driven("drive.frequency: should be greater than 0", {**_MOVED, "frequency": 0.0}),
    _driven("drive: a window would take", _MOVED, **_WINDOW),
    _driven("drive: suzuki4 steps back", _MOVED, scheme="suzuki4"),
    _refused("drive.displacement: prescribes the motion of the bead", drive=_MOVED),
    _driven("drive[1].displacement: bead 1 of chain 1 is pushed, too", _MOVED, {**_FORCED, "chain": 1, "bead": 1}),
    _driven("output.spectra.beads: 13 is outside the array", _FORCED, output={"spectra": {"beads": [13]}}),
    _driven("output.spectra.beads: 2 not recorded", _FORCED, output={"spectra": {"beads": [2]}, "beads": [1]}),
    _resonant("resonators.mass: should be greater than or equal to 0, -1.0 given", mass=-1.0),
    _resonant("resonators.mass: should be a finite number, nan given", mass=float("nan")),
    _resonant("resonators.mass: 1e-09 of the reference bead's; at least 1e-06, or 0 for none", mass=1e-9),
    _resonant("resonators.mass: 3 numbers for 2 chains; one, or one for each", mass=[1.0, 2.0, 3.0]),
    _resonant("resonators.stiffness: is 0 beside a damping", stiffness=0.0, damping=1.0),
    _resonant("resonators.stiffness: an angular frequency of 3.16e+07", stiffness=1e14),
    _resonant("resonators.damping: 1e+04 times the mass", damping=1e3),
    _resonant("resonators.rows: 5 to 13 given", rows=[5, 13]),
    _resonant("resonators.springs: unknown key", springs=1.0),
    _resonant("resonators.mass: 2e+06 times the reference bead's; at most 1e+06", mass=2e6),
    _refused("resonators[1].mass: should be", resonators=[{**_RESONATOR, "mass": -1.0}, _RESONATOR]),
    _refused("resonators[1].mass: 1e-09 of the", resonators=[{**_RESONATOR, "mass": 1e-9}, _RESONATOR]),
    _refused("resonators[2].rows: 5 to 13 given", resonators=[_RESONATOR, {**_RESONATOR, "rows": [5, 13]}]),
    _refused(
        "material.yield_strength: contacts that yield are not known beside resonators; leave one of them out",
        material={**_SI, "yield_strength": 1e9},
        resonators={"mass": 1e-4, "stiffness": 1e3},
    ),
    _refused("resonators: resonators behind a window keep oscillating", resonators=_RESONATOR, window=64, beads=200),
    _driven("drive[2].bead: 13 is outside the array", _FORCED, {**_FORCED, "bead": 13}),
    _refused("foundation.stiffness: should be greater than or equal to 0", foundation={"stiffness": -1.0}),
    _refused("foundation.stiffness: 3 numbers for 2 chains; one, or one", foundation={"stiffness": [1.0, 2.0, 3.0]}),
    _refused("foundation.rows: 5 to 13 given", foundation={"stiffness": 1.0, "rows": [5, 13]}),
    _refused("foundation.rows: 5 to 4 given", foundation={"stiffness": 1.0, "rows": [5, 4]}),
    _bed("foundation.stiffness: a ramp is along `rows` or over `times` (neither is given)", _RISING),
    _bed("foundation.stiffness.rows: 5 to 13 given", {**_RISING, "rows": [5, 13]}),
    _bed("foundation.stiffness[2].times: 4 to 4 given", [1.0, {**_RISING, "times": [4, 4]}]),
    _bed("foundation.stiffness.to: should be greater than or equal to 0", {"from": 1, "to": -1, "times": [0, 4]}),
    _refused("foundation.stiffness: is missing beside modulation", foundation={"modulation": _WAVE}),
    _bed("foundation.modulation.depth: should be less than", 1.0, modulation={**_WAVE, "depth": 2}),
    _refused(
        "foundation: its stiffness depends on time, and suzuki4",
        foundation={"stiffness": 1.0, "modulation": _WAVE},
        scheme="suzuki4",
    ),
    _refused("foundation.stifness: unknown key (did you mean `stiffness`?)", foundation={"stifness": 1.0}),
    _refused("foundation.stiffness: so stiff that the beads do not move", foundation={"stiffness": 1e13}),
    _refused("foundation: beads behind a window", foundation={"stiffness": 1.0}, **_WINDOW),
    _refused("gap: beads under a static load touch", **_LOAD, gap=0.1),
    _refused("gap: contact.force acts at a distance", contact={"force": "A*s", "A": 1, "tension": "allowed"}, gap=0.1),
    _refused("precompression: a window lets go of rows", **_LOAD, **_WINDOW),
    _refused("precompression.force: should be greater than 0", precompression={"force": 0.0}),
    _refused("precompression: give either force or overlap (both", precompression={"force": 0.1, "overlap": 0.1}),
    _refused("precompression: give either force or overlap (neither", precompression={}),
    _refused("precompression.overlap: should be greater than 0, -0.1", precompression={"overlap": -0.1}),
    _refused("precompression: 3.16e+07 times m V / T", precompression={"overlap": 1e5}),
    _changed(
        "overlap in mm",
        "precompression.overlap: 1 m is 2.1e+02",
        "1 mm is 0.001 m",
        material=_BALL,
        precompression="{overlap: 1}",
    ),
    _kinds("precompression.overlap: the contacts differ", precompression={"overlap": 0.1}, taper=0.01),
    _refused("precompression.overlap: the force", precompression={"overlap": 0.1}, contact={"yield": {"overlap": 0.1}}),
    _kinds("pattern: '0*light' should be the name of a kind, or N*name", pattern=["heavy", "0*light"]),
    _kinds("pattern: '-2*light' should be the name of a kind, or N*name", pattern=["-2*light"]),
    _kinds("pattern: '1.5*light' should be the name of a kind, or N*name", pattern=["1.5*light"]),
    _kinds("pattern: 'light*2' should be the name of a kind, or N*name", pattern=["light*2"]),
    _kinds("pattern: '999999999*light' makes it 1000000000 kinds long", pattern=["heavy", "999999999*light"]),
    _kinds("pattern: 'lead' is not among the kinds (heavy, light)", pattern=["heavy", "3*lead"]),
    _refused("mass: is in SI units, which need the constant A", mass=0.03),
    _refused("mass: the material determines it", mass=0.03, material=_SI),
    _refused("mass: should be greater than 0, 0", mass=0, contact={"stiffness": 1e7}),
    _refused("mass: is in SI units, which need the constant A", mass=0.03, contact={"exponent": [1.5] * 11}),
    _kinds(
        "kinds.heavy.radius: beads given by `mass` have no", **_BY_MASS, kinds={"heavy": {"radius": 0.01}, "light": {}}
    ),
    _refused("precompression: 1e+07 times m V / T", precompression={"force": 1e7}),
    _refused("precompression: 1e-17 times m V / T", precompression={"force": 1e-17}),  # its overlap is off by 1e-3
    _kinds("precompression: chains that differ are compressed", **_LOAD, **_UNLIKE_ENDS),
    _walled(".right: matched is sqrt(k m), and contacts that just touch", {"right": "matched"}),
    _walled(".left: matched is sqrt(k m) of beads alone", {"left": "matched"}, foundation={"stiffness": 1.0}),
    _walled(".right: give one of stiffness, material and damping", {"right": {"stiffness": 1.0, "damping": 1.0}}),
    _walled(".right: 1e+04 in dimensionless units", {"right": {"damping": 1e4}}),
    _refused("gravity: nothing holds the column", walls={"right": {"damping": 1.0}}, gravity=0.1),
    _refused("gravity: nothing holds the column", gravity=0.1),
    _refused("gravity: nothing holds the column", walls={"left": "flat"}, gravity=0.1),
    _refused("gap: beads under a static load touch; leave the gap out, or let the beads fall", gap=1.0, gravity=0.1),
    _refused("gravity.acceleration: should be greater than 0, -0.1 given", gravity=-0.1),
    _refused("gravity.acceleration: should be a number", gravity="strong"),
    _pushed(".shape: should be 'half-sine' or 'rectangular'", {**_HALF_SINE, "shape": "sine"}),
    _pushed("[1]: shape: is missing; a push needs peak, duration and shape", {"peak": 1.0, "duration": 2.0}),
    _pushed("[1]: peak: give either a table or peak, duration and", {"peak": 1.0, "table": [[0.0, 1.0], [1.0, 0.0]]}),
    _pushed("[1]: peak: a push needs a force", {**_HALF_SINE, "peak": 0.0}),
    _pushed(".bead: 13 is outside the array", {**_HALF_SINE, "bead": 13}),
    _pushed(".chain: 3 is outside the array", {**_HALF_SINE, "chain": 3}),
    _pushed(": suzuki4 steps back in time", _HALF_SINE, scheme="suzuki4"),
    _pushed(": a window would take the bead that it acts on", _HALF_SINE, **_WINDOW),
    _kinds("kinds: neither pattern nor replace names any of them", pattern=None),
    _kinds("pattern: 'ligth' is not among the kinds (heavy, light)", pattern=["heavy", "ligth"]),
    _kinds("pattern: should be a list of kinds", pattern=[]),
    _kinds("pattern: 3 lists for 2 chains", pattern=[["heavy"], ["light"], ["light"]]),
    _kinds("replace[1].kind: ", replace=[{"bead": 3}, {"bead": 4, "kind": "light"}]),
    _kinds("replace[2].bead: 13 is", replace=[{"bead": 3, "kind": "light"}, {"bead": 13, "kind": "light"}]),
    _kinds("replace.bead: 13 is outside the array (beads 1 to 12)", replace={"bead": 13, "kind": "light"}),
    _kinds("replace: one bead is replaced twice", replace=[{"bead": 3, "kind": "light"}, {"bead": 3, "kind": "heavy"}]),
    _kinds("window: its rows represent one row after another", **_WINDOW),
    _kind("kinds.a.mas: unknown key (did you mean `mass`?)", mas=2.0),
    _kind("kinds.a.mass: should be greater than 0", mass=-2.0),
    _kind("kinds.a.density: is in SI units", density=2.0),
    _kind("pattern: the mass goes from 1e-07 to 1e-07 of the reference bead's; at most a million", mass=1e-7),
    _refused("taper: the mass goes from", taper=0.9),
    _refused("taper: should be greater than or equal to 0, -0.1 given", taper=-0.1),
    _refused("disorder.mass: should be less than or equal to 0.9, 1.0 given", disorder={"mass": 1.0}),
    _refused("kick: one bead is kicked twice", striker={"mass": 2.0, "velocity": 1.0}),
    _exponents("contact.exponent: 2 numbers for the 11 contacts of a chain", contact={"exponent": [1.5, 1]}),
    _exponents("contact.exponent[2]: should be less than or equal to 3, 5 given", contact={"exponent": [1.5, 5]}),
    _exponents("contact.exponent: should be a number, 'x' given", contact={"exponent": "x"}),
    _exponents("contact.exponent.to: is missing beside from", contact={"exponent": {"from": 1.0}}),
    _exponents("contact.exponent.spred: unknown key (did you mean `spread`?)", contact={"exponent": {"spred": 0.1}}),
    _exponents(
        "contact.exponent: goes from 0.752235 to 2.21019; from 1 to 3", contact={"exponent": {"spread": 0.5, "seed": 3}}
    ),
    _exponents(
        "contact.stiffness: is no key of contacts of several exponents",
        contact={"exponent": [1.5] * 10 + [1.0], "stiffness": 2},
    ),
    _exponents("material: is known for contacts of one exponent", material=_SI),
    _exponents("walls: is known for contacts of one exponent", walls={"right": "bead"}),
    _exponents("precompression: is known for contacts of one exponent", precompression={"force": 0.1}),
    _exponents("damping.law: is known for contacts of one", damping={"contact": 0.1, "law": "viscoelastic"}),
    _exponents("contact.exponent: how the contacts", kinds={"a": {"radius": 2.0}, "b": {}}, pattern=["a", "b"]),
    _graded(": names nothing; valid: `strength: {from: 1, to: 4", {}),
    _graded(": should be greater than 0, 0.0 given", 0.0),
    _graded(": should be a number, 'x' given", "x"),
    _graded(".to: is missing beside from", {"from": 1.0, "contacts": [2, 5]}),
    _graded(".contacts: 5 to 12 given; from a contact to a later one, within 11", {**_RAMP, "contacts": [5, 12]}),
    _graded(".too: unknown key (did you mean `to`?)", {**_RAMP, "too": 2.0}),
    _graded(".wavenumber: is missing beside amplitude", {"amplitude": 0.3}),
    _graded(".amplitude: 1 given; smaller than the mean, 1", {"amplitude": 1.0, "wavenumber": 0.1}),
    _graded(".spread: is missing beside seed", {"seed": 2}),
    _graded(": 3 numbers for the 11 contacts of a chain", [1.0, 2.0, 3.0]),
    _graded("[11]: should be greater than 0, -1.0 given", [1.0] * 10 + [-1.0]),
    _graded(": 3 lists for 2 chains; one, or one for each", [[1.0] * 11 for _ in range(3)]),
    _graded(": the contact strength goes from 1 to 1e+07 of the", {**_RAMP, "to": 1e7}),
    _refused("window: its rows represent one row after another", contact={"strength": _RAMP}, **_WINDOW),
    _refused("gap: 2 numbers for the 11 contacts of a chain", gap=[0.1, 0.2]),
    _refused("gap: should be a number, 'x' given", gap="x"),
    _refused("gap: give either contacts or mean (neither is given); valid: `gap: {mean: 0.1", gap={}),
    _refused("gap: give either contacts or mean (both are given)", gap={**_GAPS, "mean": 0.1}),
    _refused("gap.spread: is missing beside mean", gap={"mean": 0.1}),
    _refused("gap.mean: is missing beside seed", gap={**_GAPS, "seed": 2}),
    _refused("gap.contacts: 12 is outside the chain (contacts 1 to 11)", gap={"contacts": {"12": 0.1}}),
    _refused("gap.contacts: should hold numbers of contacts and their gaps", gap={"contacts": {"one": 0.1}}),
    _refused("gap.contacts.1: should be greater than or equal to 0, -0.1 given", gap={"contacts": {"1": -0.1}}),
    _refused("window: its rows represent one row after another, and the gaps differ", gap=_GAPS, **_WINDOW),
    _refused("gap: beads under a static load touch", gap=_GAPS, precompression={"force": 0.1}),
    _refused("kick: none ever closes the gap", gap=_GAPS, kick={"bead": 1, "velocity": -1.0}),
    _refused("contact: names nothing; valid: `contact: {exponent: 2}`", contact={}),
    _yields("contact.yield.overlap: should be greater than 0, 0.0 given", {"overlap": 0.0}),
    _yields("contact.yield.overlap: should be", {"overlap": "nan"}),
    _yields("contact.yield: ", 0.1),
    _yields("contact.yield.overlap: contacts yield at once", {"overlap": 1e-9}),
    _refused("material.yield_strength: contacts yield at once", material={**_SI, "yield_strength": 0.25}),
    _yields("contact.yield.overlap: is missing; valid: `yield: {overlap: 0.1}`", {}),
    _yields("contact.yield.restitution: is missing; valid: `yield: {law: w", {"law": "walton-braun"}),
    _yields("contact.yield.restitution: is no key of the law thornton", {"overlap": 0.1, "restitution": 0.5}),
    _yields("contact.yield.law: should be 'thornton' or 'walton-braun'", {"law": "hertz"}),
    _yields("contact.yield: unloading waves run faster", {"overlap": 0.1}, **_WINDOW),
    _yields("contact.yield: suzuki4 steps back in time", {"overlap": 0.1}, scheme="suzuki4"),
    _yields("damping.contact: contacts that yield have no dashpots", {"overlap": 0.1}, damping={"contact": 0.1}),
    _yields("walls.right.stiffness: the overlap at which", {"overlap": 0.1}, walls={"right": {"stiffness": 2.0}}),
    _yields("contact.yield: material.yield_strength makes", {"overlap": 1e-6}, material={**_SI, "yield_strength": 1e9}),
    _refused("contact.exponent: 1.5 with the law thornton", contact={"exponent": 2.0, "yield": {"overlap": 0.1}}),
    _yields(
        "precompression: the static overlap is known for powers",
        {"law": "walton-braun", "restitution": 0.8},
        precompression={"force": 0.1},
    ),
    _refused("material.yield_strength: should be greater than 0", material={**_SI, "yield_strength": -1.0}),
    _refused(
        "material: yield_strength: catalogue holds that of steel, aluminium, titanium; 'brass' given; valid: 0.25e9",
        material={"name": "brass", "radius": 1e-3, "yield_strength": "catalogue"},
    ),
    _refused("material: yield_strength: catalogue holds", material={**_SI, "yield_strength": "catalogue"}),
    _refused(
        "material: yield_strength: should be a number (Pa) or catalogue, 'soft'",
        material={**_SI, "yield_strength": "soft"},
    ),
    _yields(
        "output.beads: frames of all beads hold the memory",
        {"overlap": 0.1},
        output={"beads": [3, 4], "forces": {"contacts": [3]}},
    ),
    _yields("contact.yield: is no key of contacts of a force by formula", {"overlap": 0.1}, force="s^2"),
    _refused(
        "contact: other contacts than spheres, which alone yield by material.yield_strength",
        contact={"exponent": 2.0, "stiffness": 1e9},
        material={**_SI, "yield_strength": 1e9},
    ),
    _kinds("kinds.a.yield_strength: needs", kinds={"a": {"yield_strength": 1e8}}, pattern=["a"], material=_SI),
    _kinds(
        "kinds.a.yield_strength: is missing beside material.yield_strength",
        kinds={"a": {"material": "brass"}},
        pattern=["a"],
        material={**_SI, "yield_strength": 1e9},
    ),
    _walled(": name left, right or both", {}),
    _walled(
        ".right: should be 'bead', 'flat', 'rigid' or 'matched', or hold pairs, `{stiffness, material, damping}`",
        {"right": "soft"},
    ),
    _walled(".right.material: is in SI units", {"right": {"material": "steel"}}),
    _walled(".right: give one of stiffness, material and damping", {"right": {}}),
    _walled(f".right: {_FOR_SPHERES}", {"right": "flat"}, **_SQUARE),
    _walled(f".left: {_FOR_SPHERES}", {"left": "rigid"}, **_SQUARE),
    _walled(".right.stiffness: should be greater than 0, 0.0 given", {"right": {"stiffness": 0.0}}),
    _walled(".right.stifness: unknown key (did you mean `stiffness`?)", {"right": {"stifness": 2.0}}),
    _walled(".right.stiffness: 1e+07 times that of two beads", {"right": {"stiffness": 1e7}}),
    _walled(".rigth: unknown key (did you mean `right`?)", {"rigth": "bead"}),
    _walled(": a window lets go of the rows that pulses come back through", {"right": "bead"}, **_WINDOW),
    _gauged("forces: name wall: true, contacts or sensors", {}),
    _gauged("forces.wall: the chains have no wall", {"wall": True}, walls=None),
    _gauged("forces.contacts: bead 12 has no next one (beads 1 to 11 have)", {"contacts": [12]}),
    _gauged("forces.contacts: name at least one bead", {"contacts": []}),
    _gauged("forces.sensors: bead 1 has no bead on either side (beads 2 to 11 have)", {"sensors": [1]}),
    _gauged("forces.sensors: a bead is named twice", {"sensors": [3, 3]}),
    _gauged(
        "forces.sensors: needs beads 6, 7 too; add them to output.beads",
        {},
        output={"beads": [5, 12], "forces": {"wall": True, "sensors": [6]}},
    ),
]
"""Scenes whose file is right, and whose keys an ingredient refuses, each with the beginning of the message."""
