"""LAMMPS input for a scene: ``in.chains`` and ``data.chains``, rendered in memory and written once.

The deck is the equation of motion and nothing else: what the scene does not name leaves no line. It runs with a stock
``lmp`` (GRANULAR and, for coupled chains, MOLECULE) from the 29Sep2021 release on, serial or with MPI, without Python.

How the equation becomes LAMMPS:

- dimensionless at V = 1, which are LAMMPS's default units; large or small kicks never reach its floating point;
- beads sit at multiples of a power of two, so touching is exact;
- neighbours never change on a line, so the neighbour list is built once and no bead is ever moved between ranks;
- a spring joins beads of one row, so ranks divide the rows, never a row.
"""

import io
from pathlib import Path

import numpy as np

from lammps_inputs import scheme, strict_yaml, window
from lammps_inputs.lines import Lines
from lammps_inputs.links import Across, Along
from lammps_inputs.numbers import text
from lammps_inputs.problem import Problem
from lammps_inputs.scene import Scene
from lammps_inputs.units import sphere_density

DECK = "in.chains"
DATA = "data.chains"
DUMP = "chains.dump.bin"
SNAPSHOTS = "chains.snapshots.bin"
PEAKS, PEAKS_STATE = "peaks.csv", "chains.peaks.npz"
LOG = "log.lammps"
SCENE = "scene.yaml"
COLUMNS = ("id", "x", "vx")
WINDOW_COLUMNS = ("id", "mol", "x", "vx")


def render(scene: Scene) -> dict[str, str]:
    """File name -> text of everything LAMMPS needs, and the scene itself.

    Raises:
        ValueError: the scene ends at a bead, not at a time (see `Scene.problem`).
    """
    problem = scene.problem()
    return {
        SCENE: strict_yaml.dump(scene.resolved().plain()),
        DECK: render_deck(problem),
        DATA: render_data(problem),
    }


def write(scene: Scene, directory: Path) -> None:
    """Write the deck of a scene into an existing directory."""
    for name, content in render(scene).items():
        (directory / name).write_text(content, encoding="utf-8", newline="\n")


def render_deck(problem: Problem) -> str:
    """The text of ``in.chains``."""
    sections = [
        _title(problem),
        _variables(problem),
        [
            "processors * 1 1                 # ranks divide the rows, so no row is cut",
            "newton off                       # bit for bit the same on any number of ranks",
            f"atom_style {_atom_style(problem)}",
            "boundary s f f                   # a bead thrown back is kept; no periodic images",
            *neighbour_lines(problem),
            f"read_data {DATA}",
            "set group all mass 1.0           # exact; the data file's density is within rounding",
        ],
        *interactions(problem),
        motion_lines(problem, "all"),
    ]
    sections.append(
        [
            f"set atom {_atom(problem, chain, bead)} vx ${{kick{number}}}"
            for number, (chain, bead, _) in enumerate(problem.kicks, 1)
        ]
    )
    if problem.window is not None:
        sections.append(window.setup_lines(problem.window, problem.beads, problem.spacing, problem.scheme))
    sections.append(
        [
            *([] if problem.recorded is None else ["group recorded type 2"]),
            *output_lines(problem, "${every}", DUMP),
        ]
    )
    sections.append([scheme.timestep_command(problem.scheme), *travel_lines(problem)])
    return "\n\n".join("\n".join(lines) for lines in sections) + "\n"


def neighbour_lines(problem: Problem) -> list[str]:
    """The neighbour list, built once with the beads at rest."""
    return [
        "atom_modify sort 0 0",
        "comm_modify vel yes",
        f"neighbor {text(_skin(problem))} bin",
        "neigh_modify once yes            # on a line, neighbours stay neighbours",
    ]


def spelling(problem: Problem) -> list[Lines]:
    """What the laws on the links are to LAMMPS, in the order of the links.

    Raises:
        ValueError: LAMMPS has no words for one of them.
    """
    found = []
    for link in problem.links:
        kind = "along" if isinstance(link, Along) else "across" if isinstance(link, Across) else "ground"
        spell = getattr(link.law, kind, None)
        if spell is None:
            raise ValueError(f"{link.name}: LAMMPS does not know this force; use the reference engine")
        found.append(spell(link.name, problem))
    return found


def interactions(problem: Problem) -> list[list[str]]:
    """Contacts, and springs where there are any."""
    return [list(lines.interactions) for lines in spelling(problem) if lines.interactions]


def motion_lines(problem: Problem, group: str) -> list[str]:
    """Newton's equation for the beads of a group."""
    lines = [f"fix motion {group} nve", *(line for found in spelling(problem) for line in found.motion)]
    if problem.coupled:
        lines.append("fix line all lineforce 1 0 0     # beads move along their chain only")
    return lines


def output_lines(problem: Problem, every: str, dump: str, snapshots: str = SNAPSHOTS) -> list[str]:
    """Frames into a file, snapshots into another, and the log.

    The group ``recorded`` exists where not all beads are.
    """
    recorded = "all" if problem.recorded is None else "recorded"
    whole = [
        f"dump snapshots all custom $({problem.frames_per_snapshot}*v_every:%.0f) {snapshots} {' '.join(COLUMNS)}",
        "dump_modify snapshots flush yes time yes",
    ]
    return [
        f"dump frames {recorded} custom {every} {dump} {' '.join(columns(problem))}",
        "dump_modify frames flush yes time yes   # whole frames survive a kill, and know their time",
        *(whole if problem.frames_per_snapshot is not None else []),
        "thermo_style custom step",
        "thermo_modify lost error",
        "thermo ${thermo}",
    ]


def columns(problem: Problem) -> tuple[str, ...]:
    """Columns of the dump."""
    return COLUMNS if problem.window is None else WINDOW_COLUMNS


def _bonded(problem: Problem) -> bool:
    """Whether atoms carry bonds and molecules."""
    return problem.coupled or problem.window is not None


def _atom_style(problem: Problem) -> str:
    return "hybrid sphere bond" if _bonded(problem) else "sphere"


def travel_lines(problem: Problem) -> list[str]:
    """The run from start to end."""
    if problem.window is None:
        return scheme.run_lines(problem.scheme, "${steps}")
    travel = [
        window.stretch_line(problem.timestep, scheme.cycle(problem.scheme)),
        *window.travel_lines(problem.scheme),
    ]
    return travel if problem.scheme == "verlet" else [*scheme.QUIET, *travel, *scheme.LOUD]


def _title(problem: Problem) -> list[str]:
    parts = [f"{problem.chains} chain{'s' * (problem.chains > 1)} of {problem.beads} beads"]
    if problem.gap:
        parts.append(f"gap {problem.gap:.6g}")
    if problem.coupled:
        parts.append(f"coupling {problem.kappa:.6g}")
    return [
        f"# {problem.name}: {', '.join(parts)}; dimensionless at V = 1",
        f"# lmp -in {DECK}     or: mpirun -np 4 lmp -in {DECK}     or: lmp -in {DECK} -var steps 1000",
    ]


def _variables(problem: Problem) -> list[str]:
    kicks = [
        f"variable kick{number} index {text(velocity)}   # bead {bead} of chain {chain}"
        for number, (chain, bead, velocity) in enumerate(problem.kicks, 1)
    ]
    return [
        "# change these here, or with -var NAME VALUE",
        *number_lines(problem),
        *kicks,
        *scheme.variable_lines(problem.scheme),
    ]


def number_lines(problem: Problem) -> list[str]:
    """The numbers of a run as LAMMPS variables."""
    return [
        f"variable timestep index {text(problem.timestep)}",
        f"variable steps index {problem.steps}",
        f"variable every index {problem.steps_per_frame}   # steps from frame to frame",
        f"variable thermo index {min(max(1, problem.steps // 20), 2**31 - 1)}   # steps from line to line of the log",
        *(line for found in spelling(problem) for line in found.variables),
    ]


def _atom(problem: Problem, chain: int, bead: int) -> int:
    return (chain - 1) * problem.rows + bead


def _skin(problem: Problem) -> float:
    """Neighbour distance beyond contact that takes in the next bead of the chain and nothing else."""
    return problem.gap + problem.diameter / 2.0


def render_data(problem: Problem) -> str:
    """The text of ``data.chains``; atom number = (chain - 1) * rows + row, and type 2 marks recorded beads.

    Columns of an atom: ``id type diameter density x y z``, and ``id type x y z diameter density molecule`` with bonds.
    The molecule is the chain, or in a window the row.
    """
    chains, beads, spacing = problem.chains, problem.rows, problem.spacing
    edges = [edge for link in problem.across for edge in link.edges]
    types = 1 if problem.recorded is None else 2
    out = io.StringIO()
    out.write(f"granchain: {problem.name}\n\n{chains * beads} atoms\n{types} atom types\n")
    if problem.coupled:
        out.write(f"{len(edges) * beads} bonds\n1 bond types\n")
    side = text(2.0 * spacing)
    out.write(f"\n0 {text((beads + 1) * spacing)} xlo xhi\n")
    out.write(f"-{side} {text(2.0 * spacing * chains)} ylo yhi\n-{side} {side} zlo zhi\n")
    kind = np.ones(beads, dtype=int)
    if problem.recorded is not None:
        kind[problem.recorded_beads - 1] = 2
    size = f"{text(problem.diameter)} {text(sphere_density(problem.diameter))}"
    rows = [(str(t), text(x)) for t, x in zip(kind, np.arange(1, beads + 1) * spacing, strict=True)]
    out.write(f"\nAtoms # {_atom_style(problem)}\n\n")
    for chain in range(chains):
        first, y = chain * beads + 1, text(2.0 * spacing * chain)
        if problem.window is not None:
            out.writelines(f"{first + i} {t} {x} {y} 0 {size} {i + 1}\n" for i, (t, x) in enumerate(rows))
        elif problem.coupled:
            out.writelines(f"{first + i} {t} {x} {y} 0 {size} {chain + 1}\n" for i, (t, x) in enumerate(rows))
        else:
            out.writelines(f"{first + i} {t} {size} {x} {y} 0\n" for i, (t, x) in enumerate(rows))
    if problem.coupled:
        out.write("\nBonds\n\n")
        for number, (one, other) in enumerate(edges):
            bond, lower, higher = (beads * chain + 1 for chain in (number, one, other))
            out.writelines(f"{bond + i} 1 {lower + i} {higher + i}\n" for i in range(beads))
    return out.getvalue()
