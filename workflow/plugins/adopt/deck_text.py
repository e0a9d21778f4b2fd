"""Text of a user's deck: its commands with file and line, and a copy that LAMMPS executes without harm.

LAMMPS itself evaluates variables, loops and includes. The copy marks every command in the log before it is executed,
and lacks those that only write (dumps, logs, restarts), those that reach outside LAMMPS, and those that no scene has.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from granchain import InputError

MARK = "@@granchain"
"""First word of lines that the copy prints into the log; the number of a command follows, or `STEPS` or `EVERY`."""

STEPS, EVERY = "steps", "every"
"""What follows the mark before the steps of a `run`, and before the steps between the frames of a `dump`."""


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


WITHOUT_EFFECT = _names(
    "balance comm_style dump dump_modify echo info log package print processors restart shell suffix thermo "
    "thermo_modify thermo_style timer undump write_coeff write_data write_dump write_restart"
)
"""Commands that do not move a bead; the copy lacks them."""

EXECUTED = _names(
    "atom_modify atom_style bond_coeff bond_style boundary box change_box clear comm_modify compute compute_modify "
    "create_atoms create_bonds create_box delete_atoms delete_bonds dimension displace_atoms fix fix_modify group if "
    "include jump label labelmap lattice mass min_modify min_style minimize neigh_modify neighbor newton next "
    "pair_coeff pair_modify pair_style quit read_data region replicate reset_atoms reset_timestep run run_style set "
    "special_bonds timestep uncompute unfix "
    "units variable velocity"
)
"""Commands that LAMMPS executes: none of them writes a file or starts a program."""

UNITS = ("lj", "si", "cgs", "micro", "nano")
PAIR_STYLES = _names(
    "granular gran/hertz/history gran/hooke gran/hooke/history lepton lepton/sphere hybrid/overlay dpd/ext/tstat zero"
)
BOND_STYLES = ("harmonic", "class2", "lepton", "hybrid", "none", "zero")
FIXES = _names(
    "nve nve/sphere setforce lineforce planeforce freeze enforce2d wall/gran spring/self addforce gravity viscous move "
    "store/state property/atom"
)
FIXES_WITHOUT_EFFECT = _names("ave/atom ave/chunk ave/correlate ave/histo ave/time balance print vector")
MOTIONS = ("linear", "wiggle", "variable")
"""Motions of `fix move` along an axis."""

VARIABLES = _names("atom delete equal format index internal loop string uloop ulist universe vector world")
ADHESION = {"dmt", "jkr", "mdr"}
"""Laws of `pair_style granular` that attract or depend on the past."""

_WORDS = re.compile(r'"""(.*?)"""|"([^"]*)"|\'([^\']*)\'|(\S+)', re.DOTALL)
_COMMENT = re.compile(r'("""(?:.*?)"""|"[^"]*"|\'[^\']*\')|#[^\n]*', re.DOTALL)
_SUFFIX = re.compile(r"/(gpu|intel|kk|omp|opt)$")


@dataclass(frozen=True)
class Command:
    """One command of a deck.

    Attributes:
        file: name of its file as the user knows it.
        line: number of its first line.
        text: the command without comments.
        refusal: why no scene can have it, and what is supported; empty where LAMMPS may execute it.
    """

    file: str
    line: int
    text: str
    refusal: str = ""

    @property
    def place(self) -> str:
        """File, line and first words, for messages."""
        shown = " ".join(self.text.split())
        return f"{self.file}:{self.line}: {shown if len(shown) <= 60 else shown[:57] + '...'}"

    @property
    def style(self) -> str:
        """Name of the command; of a fix with the fix's style."""
        words = words_of(self.text)
        return f"fix {_plain(words[3])}" if words[0] == "fix" and len(words) > 3 else words[0]


class Deck:
    """A user's deck and the files that it includes.

    Attributes:
        path: file of the deck.
        commands: all commands, file after file; a mark in the log has the place of a command in this list.
    """

    def __init__(self, path: Path) -> None:
        """Read a deck.

        Raises:
            InputError: a file is missing, or no text.
        """
        self.path = path
        self.commands: list[Command] = []
        self._copies: dict[Path, list[str]] = {}
        self._read(path, str(path))

    def write(self, folder: Path, run: Path, before: int = 0) -> Path:
        """Write the copies that LAMMPS executes into a folder; the path of that of the deck itself.

        Args:
            folder: folder of the copies.
            run: file of LAMMPS commands, executed in place of every `run`.
            before: number of runs that LAMMPS executes as they are, before those that are replaced.
        """
        copies = {path: folder / f"{number}.lammps" for number, path in enumerate(self._copies)}
        names = {_file(path): str(copy) for path, copy in copies.items()}
        for path, lines in self._copies.items():
            text = "\n".join(lines) + "\n"
            if path == self.path and before:
                text = f"variable {_COUNTER} loop {MOST_RUNS}\n{text}"
            text = _RUN.sub(lambda match: _run_or(match[1], run, before), text)
            for name, copy in names.items():
                text = text.replace(name, copy)
            copies[path].write_text(text, encoding="utf-8")
        return copies[self.path]

    def _read(self, path: Path, name: str) -> None:
        try:
            text = path.read_text(encoding="utf-8-sig")
        except FileNotFoundError:
            raise InputError(f"{name}: no such file") from None
        except (OSError, UnicodeDecodeError):
            raise InputError(f"{name}: cannot be read as text (UTF-8)") from None
        self._copies[path] = lines = []
        for number, command in logical_lines(text):
            lines += self._copy_of(Command(name, number, command, refusal(words_of(command))))

    def _copy_of(self, command: Command) -> list[str]:
        """Lines of the copy in place of a command: its mark, and the command or what LAMMPS executes for it."""
        words, text = words_of(command.text), command.text
        if words[0] in ("include", "jump") and not command.refusal and words[1] != "SELF":
            path = self.path.parent / words[1]
            if not path.is_file():
                command = Command(command.file, command.line, text, "there is no such file")
            elif path not in self._copies:
                self._read(path, str(path))
            text = " ".join([words[0], _file(path), *words[2:]])
        self.commands.append(command)
        lines = [f'print "{MARK} {len(self.commands) - 1}"']
        if words[0] == "dump" and len(words) > 4:
            lines.append(_printed(EVERY, words[4]))
        if command.refusal or words[0] in WITHOUT_EFFECT or _writes_only(words):
            return lines
        if words[0] == "run" and words[1] != "0":
            upto = "$(step)" if "upto" in words else "-"
            return [*lines, _printed(STEPS, f"{words[1]} {upto}"), f"@granchain-run: {' '.join(words)}@"]
        return [*lines, " ".join(damped_wall(words)) or text]


_RUN = re.compile(r"^@granchain-run: (.*)@$", re.MULTILINE)
_COUNTER = "granchain_run"

MOST_RUNS = 10_000_000
"""Runs of a deck that are counted."""


def _run_or(command: str, run: Path, before: int) -> str:
    """What the copy has in place of a `run`: the command itself the first times, other commands from then on."""
    if not before:
        return f"include {run}"
    return f'if "${{{_COUNTER}}} <= {before}" then "{command}" else "include {run}"\nnext {_COUNTER}'


def _file(path: Path) -> str:
    return f"@granchain-file:{path}@"


def _printed(word: str, text: str) -> str:
    """Command that prints a text of the deck into the log, with its variables replaced by their values."""
    return f'print """{MARK} {word} {text}"""'


def words_of(text: str) -> list[str]:
    """Words of a command, quoted text as one."""
    return [next((group for group in match.groups() if group is not None), "") for match in _WORDS.finditer(text)]


def logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Number of the first line and text of every command, without comments; continued lines are joined."""
    parts: list[str] = []
    first = 1
    for number, line in enumerate(text.splitlines(), 1):
        first = first if parts else number
        parts.append(line)
        command = "\n".join(parts)
        if command.count('"""') % 2:
            continue
        command = _COMMENT.sub(lambda match: match[1] or "", command).rstrip()
        if command.endswith("&"):
            parts = [command[:-1]]
            continue
        parts = []
        if command.strip():
            yield first, command.replace("\n", " ") if '"""' not in command else command
    if parts and "".join(parts).strip():
        yield first, " ".join(parts)


def damped_wall(words: list[str]) -> list[str]:
    """Words of a `fix wall/gran` whose gamma_n is 0, by which LAMMPS divides, with one that has no effect; or none."""
    if words[0] != "fix" or len(words) < 8 or _plain(words[3]) != "wall/gran" or words[4] not in _DIVIDING_WALLS:
        return []
    return [*words[:7], "1e-30", *words[8:]] if re.fullmatch(r"0+\.?0*|0*\.0+", words[7]) else []


_DIVIDING_WALLS = ("hooke", "hooke/history", "hertz/history")
"""Laws of `fix wall/gran` whose coefficients follow as in older releases."""


def _plain(style: str) -> str:
    """Name of a style without the suffix of an accelerator."""
    return _SUFFIX.sub("", style)


def _writes_only(words: list[str]) -> bool:
    return words[0] == "fix" and len(words) > 3 and _plain(words[3]) in FIXES_WITHOUT_EFFECT


def refusal(words: list[str]) -> str:
    """Why no scene can have a command, and what is supported; empty where LAMMPS may execute it, or need not."""
    name, rest = words[0], words[1:]
    if "$" in name:
        return "its name is a variable; write it out"
    if name in WITHOUT_EFFECT or _writes_only(words):
        return ""
    if name not in EXECUTED:
        return _REASONS.get(name, "is no command of LAMMPS, or none that a scene can express")
    return _CHECKS.get(name, lambda _: "")(rest)


_REASONS = {
    "communicate": "is of LIGGGHTS; LAMMPS has `comm_modify`, and a scene needs none",
    "python": "Python code is not executed; supported: `variable` of styles equal, index, loop, string",
    "read_restart": "a restart does not state its contacts; supported: `read_data`, `create_atoms`",
    "rerun": "has no dynamics; supported: `run`",
}


_LIGGGHTS_PROPERTIES = {
    "youngsModulus": "a scene has `material: {youngs_modulus: ...}`",
    "poissonsRatio": "a scene has `material: {poisson_ratio: ...}`",
    "coefficientRestitution": "a scene has `damping: {contact: e, law: restitution}`",
    "coefficientFriction": "friction does not act in chains; leave it out",
    "coefficientRollingFriction": "friction does not act in chains; leave it out",
    "characteristicVelocity": "a scene has `contact: {exponent: 1, stiffness: ...}` for linear contacts",
}

_LIGGGHTS_FIXES = ("insert", "particletemplate", "particledistribution", "mesh")
"""Beginnings of the names of LIGGGHTS's fixes that place particles and walls."""


def _supported(kind: str, names: tuple[str, ...]) -> str:
    return f"no such {kind} in a scene; supported: {', '.join(names)}"


def _units(rest: list[str]) -> str:
    return "" if rest[:1] and rest[0] in UNITS else _supported("units", UNITS)


def _atom_style(rest: list[str]) -> str:
    if rest[:1] == ["granular"]:
        return "is of LIGGGHTS; LAMMPS has atom_style sphere, and a scene `material: {radius: ..., density: ...}`"
    return "" if "sphere" in rest else "beads are spheres; supported: atom_style sphere, hybrid sphere bond"


def _pair_style(rest: list[str]) -> str:
    if rest[:2] == ["gran", "model"]:
        law = "`contact: {exponent: 1}`" if "hooke" in rest else "Hertz's contacts, its default"
        return f"is of LIGGGHTS; a scene has {law}, and `material`"
    allowed = {*PAIR_STYLES, "limit_damping", "nocoeff"}
    return "" if _styles(rest) <= allowed else _supported("contacts", PAIR_STYLES)


def _pair_coeff(rest: list[str]) -> str:
    laws = sorted(ADHESION & set(rest))
    return f"contacts of {laws[0]} attract, those of a scene do not; supported: hertz, hertz/material" if laws else ""


def _bond_style(rest: list[str]) -> str:
    return "" if _styles(rest) <= {*BOND_STYLES} else _supported("springs", BOND_STYLES)


def _styles(rest: list[str]) -> set[str]:
    """Names of the styles, and of the options, after `pair_style` or `bond_style`."""
    hybrid = rest[:1] and rest[0].startswith("hybrid")
    return {_plain(word) for word in (rest if hybrid else rest[:1]) if not word[:1].isdigit()}


def _fix(rest: list[str]) -> str:
    if len(rest) < 3 or "$" in rest[2]:
        return "its style is missing or a variable; write it out"
    style, options = _plain(rest[2]), rest[3:]
    if style == "move":
        motion = options[0] if options else ""
        if "$" in rest[0] + rest[1]:
            return "its name or its group is a variable; write it out"
        return "" if motion in MOTIONS else _supported("motion", tuple(f"move {name}" for name in MOTIONS))
    if style == "property/global":
        key = _LIGGGHTS_PROPERTIES.get(options[0] if options else "", "a scene has `material`, `contact` and `damping`")
        return f"is of LIGGGHTS; {key}"
    if style.startswith(_LIGGGHTS_FIXES):
        return "is of LIGGGHTS; a scene has `beads`, `gap`, `material: {radius: ..., density: ...}` and `walls`"
    if style == "wall/gran" and options[:1] == ["model"]:
        return "is of LIGGGHTS; a scene has `walls: {left: flat, right: flat}`"
    if style == "wall/gran" and {"wiggle", "shear"} & set(options):
        return "moves a wall, which is not read; a bead at the end with the `drive` of a scene is such a wall"
    return "" if style in FIXES else _REASONS.get(f"fix {style}", _supported("fix", FIXES))


def _run_style(rest: list[str]) -> str:
    return "" if rest[:1] == ["verlet"] else _supported("integrator", ("verlet",))


def _variable(rest: list[str]) -> str:
    return "" if len(rest) > 1 and rest[1] in VARIABLES else _supported("variable", VARIABLES)


def _run(rest: list[str]) -> str:
    if not rest:
        return "its number of steps is missing"
    return "commands during a run are no part of a scene; supported: `run N`, `run N upto`" if "every" in rest else ""


def _files(rest: list[str]) -> str:
    return "the file's name is missing or a variable; write it out" if not rest or "$" in rest[0] else ""


def _if(rest: list[str]) -> str:
    """Commands in the branches of a condition: what may not be executed cannot be left out there."""
    branch = False
    for word in rest:
        if word in ("then", "else", "elif"):
            branch = word != "elif"
            continue
        inner = words_of(word)
        if not branch or not inner:
            continue
        writes = inner[0] in WITHOUT_EFFECT and (inner[0] != "print" or {"file", "append"} & set(inner))
        reason = "it only writes or runs" if writes or inner[0] in ("run", "minimize", "include") else refusal(inner)
        if inner[0] == "jump" and inner[1:2] != ["SELF"]:
            reason = "jumps out of the file"
        if reason:
            return f"its command {inner[0]!r} is not executed ({reason}); write it outside of `if`"
    return ""


_CHECKS = {
    "atom_style": _atom_style,
    "bond_style": _bond_style,
    "fix": _fix,
    "if": _if,
    "include": _files,
    "jump": _files,
    "pair_coeff": _pair_coeff,
    "pair_style": _pair_style,
    "run": _run,
    "run_style": _run_style,
    "units": _units,
    "variable": _variable,
}
