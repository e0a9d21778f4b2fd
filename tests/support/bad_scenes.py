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

from lammps_inputs import InputError

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
    BadScene("huge file", b"#" * (1 << 21), "", "512 KiB"),
]

_YAML = [
    BadScene("list", "- 1\n- 2\n", "", "list"),
    BadScene("lone word", "two chains\n", "", "`key: value`"),
    BadScene("lone number", "12\n", "", "`key: value`"),
    BadScene("two documents", scene_text() + "---\n" + scene_text(), "line 5", "another document"),
    BadScene("tab", "name: test\n\tbeads: 10\n", "line 2", "'\\t'"),
    BadScene("open bracket", scene_text(kick="{bead: 1"), "line 4", "expected ',' or '}'"),
    BadScene("open quote", scene_text(name="'test"), "line 5", "quoted"),
    BadScene("key twice", scene_text() + "beads: 12\n", "line 5", "'beads' is given twice"),
    BadScene("key twice within", scene_text(output="{every: 1, every: 2}"), "line 5", "'every' is given twice"),
    BadScene("alias", scene_text(chains="&n 2", beads="*n"), "line", "aliases"),
    BadScene("anchor", scene_text(beads="&n 10"), "line 2", "anchors"),
    BadScene("deep list", scene_text(output="[" * 100_000), "", "nested too deeply"),
    BadScene("deep mapping", "{a: " * 100_000, "", "nested too deeply"),
    BadScene("object of Python", scene_text(name="!!python/object/apply:os.system [ls]"), "line 1", "tags"),
    BadScene("tag on nothing", scene_text(gap='!!int ""'), "line 5", "tags"),
    BadScene("number as key", scene_text() + "3: 4\n", "line 5", "plain words"),
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
    _changed("material without ratio", "material.poisson_ratio:", "missing", material=f"{{{_STEEL}}}"),
]

_TYPES = [
    _changed("text for a count", "beads:", "whole number, 'ten' given", beads="ten"),
    _changed("fraction for a count", "beads:", "whole number, 10.5 given", beads="10.5"),
    _changed("point in a count", "beads:", "without a point or exponent, 10", beads="10.0"),
    _changed("exponent in a count", "beads:", "without a point or exponent, 1000000000000", beads="1e12"),
    _changed("truth value for a count", "chains:", "whole number, True given", chains="true"),
    _changed("text for a number", "duration:", "number, '192 s' given", duration="192 s"),
    _changed("decimal comma", "duration:", "number, '0,5' given", duration="0,5"),
    _changed("sexagesimal", "duration:", "number, '1:30' given", duration="1:30"),
    _changed("hexadecimal", "duration:", "number, '0x10' given", duration="0x10"),
    _changed("underscored", "duration:", "number, '1_000' given", duration="1_000"),
    _changed("list for a number", "gap:", "number, [1, 2] given", gap="[1, 2]"),
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
    _changed("time step that does not divide", "timestep:", "or try 0.0142857142857", timestep="0.03"),
    _changed("time step longer than a frame", "timestep:", "leave it out for an accuracy of 0.0002 V", timestep="1"),
    _changed("vanishing time step", "output.every:", "longer steps", timestep="1e-320"),
    _changed("too many steps", "duration:", "at most 1e+12", duration="1e29"),
    _changed("too many steps in a frame", "output.every:", "record more often", output="{every: 1e9}"),
    _changed("zero cadence", "output.every:", "greater than 0", output="{every: 0}"),
    _changed("negative gap", "gap:", "-0.5 given", gap="-0.5"),
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
