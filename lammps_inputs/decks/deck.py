"""LAMMPS input for a problem: ``in.chains`` and ``data.chains``.

The deck is the equation of motion and nothing else: what the scene does not name leaves no line. It runs with a stock
``lmp`` (GRANULAR; MOLECULE for coupled chains, CLASS2 for cubic springs, DPD-BASIC for damped ones) from the 29Sep2021
release on, serial or with MPI, without Python; contacts that yield of many beads alone need `granchain run`.

How the equation becomes LAMMPS:

- dimensionless at V = 1, which are LAMMPS's default units; large or small kicks never reach its floating point;
- beads sit at multiples of a power of two, so touching is exact;
- neighbours never change on a line, so the neighbour list is built once and no bead is ever moved between ranks;
- a spring joins beads of one row, so ranks divide the rows, never a row.

Examples:
    >>> problem = granchain.load("one-chain").problem()
    >>> sorted(deck.files_of(problem))
    ['data.chains', 'in.chains']
    >>> deck.columns(problem)
    ('id', 'x', 'vx')
    >>> deck.refusal(problem.system)  # LAMMPS can compute it
    ''
"""

import collections
import functools
import io
import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import engine_limits, file_names, laws, loads, physics, scheme, static_load, window
from lammps_inputs.deck_lines import AtomTypes, BeadLayout, DeckLines
from lammps_inputs.laws import dashpot, spring
from lammps_inputs.laws.contact_lines import wall_lines
from lammps_inputs.layout import across_of, ends_of_box, layout_of, wall_of
from lammps_inputs.links import Links
from lammps_inputs.numbers import text
from lammps_inputs.problem import Problem
from lammps_inputs.system import System
from lammps_inputs.units import Scale, sphere_density

START = (
    "units lj                         # dimensionless",
    "processors * 1 1                 # ranks divide the rows; beads of one row are on one rank",
    "newton off                       # bitwise the same result on any number of ranks",
)
"""First commands of a deck and of its continuation."""

STATED = "info variables out log           # the log states the values; granchain compares them with the scene's"
"""Command after the last parameter of a deck and of its continuation, see `lammps_inputs.decks.parameters`."""


def files_of(problem: Problem) -> dict[str, str]:
    """File name -> text of what LAMMPS needs; the data come last, so that all is there where they are."""
    tables = loads.tables(problem.system)
    return {
        file_names.DECK: render_deck(problem),
        **({file_names.TABLES: tables} if tables else {}),
        file_names.DATA: render_data(problem),
    }


def render_deck(problem: Problem, start: Sequence[str] = (), opening: float = 0.0) -> str:
    """The text of ``in.chains``.

    Args:
        problem: what is computed.
        start: commands that set positions and velocities at the start, in place of the kicks.
        opening: how much farther apart than at rest neighbours start, at most, in units of L.
    """
    sections = [
        _title(problem),
        [
            "# parameters; a value on the command line, -var NAME VALUE, replaces the one here",
            *number_lines(problem),
            *(() if start else kick_lines(problem)),
            *scheme.variable_lines(problem.scheme),
            STATED,
        ],
        [
            *START,
            f"atom_style {_atom_style(problem)}",
            _boundary(problem),
            *neighbour_lines(problem, opening or _opening(problem)),
            *number_fix(problem),
            f"read_data {file_names.DATA}" + " fix numbers NULL Numbers" * bool(number_fix(problem)),
            *_held_start_lines(problem, start),
            *group_lines(problem),
            *_mass_lines(problem),
        ],
        *interactions(problem),
        motion_lines(problem, "all"),
    ]
    if start:
        sections.append(list(start))
    elif lines := start_lines(problem):
        sections.append(lines)
    if problem.rows.follow:
        sections.append(window.setup_lines(problem))
    run = window.travel_lines(problem) if problem.rows.follow else scheme.run_lines(problem.scheme, "${steps}")
    sections.append(output_lines(problem, file_names.DUMP))
    sections.append([scheme.timestep_command(problem.scheme), *moved_lines(problem), *run])
    return "\n\n".join("\n".join(lines) for lines in sections) + "\n"


def _boundary(problem: Problem) -> str:
    if problem.system.closing:
        return "boundary p f f                   # x: chains are rings; y, z: no periodic images"
    return "boundary s f f                   # x: the box follows rebounding beads; y, z: no periodic images"


def neighbour_lines(problem: Problem, opening: float = 0.0) -> list[str]:
    """The neighbour list, built once: with the beads at rest, or with neighbours farther apart by an opening.

    Second neighbours may be in it, but exert no force: beads are so large that they never touch (`layout.layout_of`).
    """
    return [
        "atom_modify sort 0 0",
        "comm_modify vel yes",
        f"neighbor {text(_skin(problem) + opening)} bin",
        "neigh_modify once yes            # neighbours on a line never change",
    ]


def group_lines(problem: Problem) -> list[str]:
    """The group of the beads; none where these are all atoms."""
    group = problem.layout.group
    return [] if group == "all" else [f"group {group} id 1:{problem.chains * problem.beads}"]


def spelling(problem: Problem) -> list[DeckLines]:
    """LAMMPS commands of the laws on the links, and of the loads, in their order.

    Raises:
        EngineLimitError: LAMMPS cannot compute one of them.
    """
    return [*link_lines(problem), *_load_lines(problem.system, problem.layout)]


def _spelled(system: System) -> tuple[Links, ...]:
    """The links that have lines of their own, in the order of these; dashpots of contacts and walls are with those, and
    contacts that close rings with the others.
    """
    dampers = (link for link in system.dampers if not link.touching)
    links = (link for link in system.links_of_chains if link.kind != "closing")
    return (*links, *dampers, *system.ties)


@functools.lru_cache(maxsize=1)  # types of atoms that distinguish contacts take a second of many beads
def link_lines(problem: Problem) -> tuple[DeckLines, ...]:
    """LAMMPS commands of the laws on the links, in their order.

    Raises:
        EngineLimitError: LAMMPS cannot compute one of them.
    """
    return _lines_of(problem.system, problem.layout)


def _lines_of(system: System, layout: BeadLayout) -> tuple[DeckLines, ...]:
    return tuple(_of_link(link, system, layout) for link in _spelled(system))


def _load_lines(system: System, layout: BeadLayout) -> list[DeckLines]:
    return loads.lines(system.loads, system.motions, layout)


def _of_link(link: Links, system: System, layout: BeadLayout) -> DeckLines:
    """The law's own lines; contacts whose law spells no dashpots of its own have them beside."""
    if getattr(link.law, _kind(link)) is None:
        raise engine_limits.FORCES.error(link.name)
    if link.edges and not system.is_tie(link) and not physics.one_gap(system) and np.any(np.ptp(layout.places, axis=0)):
        raise engine_limits.ROWS.error(link.name)
    if _kind(link) == "wall":
        return wall_lines(wall_of(link, system), layout)
    law: Any = link.law
    if link.kind == "along" and system.closing:
        ends_of_box(system)
        law = physics.law_of_contacts(system)
    lines: DeckLines = getattr(law, _kind(link))(across_of(link, system) if link.edges else link.name, layout)
    damped = link.kind == "along" and layout.contact_loss is not None
    return dashpot.beside(lines, layout) if damped and not lines.damped else lines


def refusal(system: System) -> str:
    """Why LAMMPS cannot compute the forces of a system, see `lammps_inputs.engine_limits`; empty where it can."""
    layout = layout_of(system)
    try:
        parts = (
            [link.name for link in _spelled(system)] + ["push"] * len(system.loads) + ["drive"] * len(system.motions)
        )
        lines = [*_lines_of(system, layout), *_load_lines(system, layout)]
        _refuse_groups(parts, lines)
    except ValueError as error:  # also of a law that a user has written
        return str(error)
    return ""


def _refuse_groups(parts: Sequence[str], lines: Sequence[DeckLines]) -> None:
    """Refuse more groups of atoms than LAMMPS has, of the part that has most of them; LAMMPS gives up when it runs."""
    of_part = collections.Counter[str]()
    for part, of_link in zip(parts, lines, strict=True):
        commands = (line.split() for line in (*of_link.interactions, *of_link.motion, *of_link.moved))
        of_part[part] += len({words[1] for words in commands if words[0] == "group"})
    if of_part:
        engine_limits.GROUPS.check(of_part.most_common(1)[0][0], of_part.total())


def _kind(link: Links) -> str:
    """Lines that LAMMPS has for a law on such a link."""
    return "at_wall" if link.kind == "wall" and link.law.at_wall is not None else link.kind


def interactions(problem: Problem) -> list[list[str]]:
    """Contacts, and springs where there are any."""
    spelled = spelling(problem)
    groups = [list(lines.interactions) for lines in spelled if lines.interactions and not lines.style]
    if bonded := [lines for lines in spelled if lines.style]:
        groups.append(spring.tied(bonded))
    beside = [lines.beside for lines in spelled if lines.beside]
    return groups if not beside else [dashpot.overlaid(groups[0], beside), *groups[1:]]


def motion_lines(problem: Problem, group: str) -> list[str]:
    """Newton's equation for the beads of a group."""
    system = problem.system
    lines = [
        f"fix motion {group} nve",
        *static_load.place_lines(system),
        *(line for part in link_lines(problem) for line in part.motion),
        *static_load.hold_lines(system),
        *loads.include_lines(system),
        *(line for part in _load_lines(system, problem.layout) for line in part.motion),
    ]
    if _tied(system):
        lines.append("fix line all lineforce 1 0 0     # beads move along their chains only")
    return lines


def moved_lines(problem: Problem) -> list[str]:
    """Fixes that move beads by a formula of the time; they need the time step, and the beads at rest."""
    return [line for part in spelling(problem) for line in part.moved]


def output_lines(problem: Problem, dump: str) -> list[str]:
    """Frames into a file, and the log; with a group of the recorded beads if not all are."""
    atoms_dumped, group = "all", []
    if not problem.rows.neighbours:
        atoms = problem.chains * problem.beads  # first:last:stride is one bead of every chain
        listed = " ".join(f"{bead}:{atoms}:{problem.beads}" for bead in problem.rows.numbers)
        atoms_dumped, group = "recorded", [f"group recorded {'type 2' if _types(problem) is None else f'id {listed}'}"]
    return [
        *group,
        f"dump frames {atoms_dumped} custom ${{every}} {dump} {' '.join(columns(problem))}",
        "dump_modify frames flush yes time yes   # each frame is written at once, with its time",
        *_thermo_lines(problem),
        "thermo ${thermo}",
    ]


def _thermo_lines(problem: Problem) -> list[str]:
    """Columns of the log: kinetic energy and momentum where a line is written every many steps.

    Only the step is written where each substep is a separate run, which LAMMPS begins and ends with a line, and where
    its masses are not those of the beads.
    """
    if problem.scheme == "verlet" and all(lines.heavier is None for lines in spelling(problem)):
        return [
            "# in the log: sums of m vx^2/2 and of m vx over all atoms",
            "compute kinetic all temp/partial 1 0 0",
            "compute_modify kinetic extra/dof 0",
            "variable momentum equal mass(all)*vcm(all,x)",
            "thermo_style custom step ke v_momentum",
            "thermo_modify temp kinetic norm no lost error",
        ]
    return ["thermo_style custom step", "thermo_modify lost error"]


def _mass_lines(problem: Problem) -> list[str]:
    """Masses that all are 1, exactly; others stand in the data file, as densities, within rounding."""
    heavier, group = [lines.heavier for lines in spelling(problem) if lines.heavier is not None], problem.layout.group
    if heavier:
        mass = "1.0" if isinstance(problem.system.mass, float) else "mass"
        half = "".join(f"+0.5*v_timestep*{drag}" for drag in heavier)
        return [
            "# masses increased by half of drag times time step: the step is of order 2 with drag",
            f"variable heavier atom {mass}{half}",
            f"set group {group} mass v_heavier",
        ]
    if not isinstance(problem.system.mass, float):
        return []
    return [f"{f'set group {group} mass 1.0':33}# exact; by the density in the data file, within rounding"]


def number_fix(problem: Problem) -> list[str]:
    """Fix that holds numbers of every bead; none where no law has them."""
    numbers = _numbers(problem)
    return [] if numbers is None else ["fix numbers all property/atom " + " ".join(numbers)]


def _numbers(problem: Problem) -> dict[str, NDArray[np.float64]] | None:
    return next((lines.numbers for lines in link_lines(problem) if lines.numbers is not None), None)


def _types(problem: Problem) -> AtomTypes | None:
    """Types by which contacts are distinguished; None where they need not be."""
    return next((lines.types for lines in spelling(problem) if lines.types is not None), None)


def columns(problem: Problem) -> tuple[str, ...]:
    """Columns of the dump."""
    return ("id", *problem.columns)


def _tied(system: System) -> bool:
    """Whether atoms of different lines are bonded."""
    return bool(system.across)


def _atom_style(problem: Problem) -> str:
    """Atoms carry bonds and molecules where they need them."""
    return "hybrid sphere bond" if _tied(problem.system) or problem.rows.follow else "sphere"


def _title(problem: Problem) -> list[str]:
    system = problem.system
    parts = [f"{problem.chains} chain{'s' * (problem.chains > 1)} of {problem.beads} beads"]
    if physics.gap(system):
        least, largest = float(np.min(system.along[0].gap)), physics.gap(system)
        parts.append(f"gap {largest:.6g}" if physics.one_gap(system) else f"gaps {least:.6g} to {largest:.6g}")
    if physics.loaded(system):
        parts.append("under a static load")
    if physics.coupled(system):
        parts.append(f"coupling {_coupling(system)}")
    run = f"lmp -in {file_names.DECK}"
    return [
        f"# {problem.name}: {', '.join(parts)}",
        f"# {run}     or: mpirun -np 4 {run}     or: {run} -var steps 1000",
        *_scale_lines(problem.scale),
    ]


def _coupling(system: System) -> str:
    """Stiffness at rest of links across, least and largest where they differ, and what they tie if not neighbours."""
    stiffness = np.concatenate([np.ravel(laws.stiffness(link.law, 0.0)) for link in system.couplings])
    least, largest = float(np.min(stiffness)), float(np.max(stiffness))
    shapes = [link.shape for link in system.couplings if link.shape]
    return ", ".join([f"{largest:.6g}" if least == largest else f"{least:.6g} to {largest:.6g}", *shapes])


def _scale_lines(scale: Scale) -> list[str]:
    """The scene's units in comments; none where all scales are 1."""
    names = ("length", "time", "velocity", "force", "mass", "energy")
    scales = [(name, float(getattr(scale, name))) for name in names]
    if all(value == 1.0 for _, value in scales):
        return ["# all quantities are dimensionless and those of the scene (reduced units)"]
    units = "SI" if scale.si else "reduced"
    return [
        f"# all quantities are dimensionless; multiplied by these scales, they are in {units} units:",
        *(f"# {name:10}{text(value)}{scale.after(name)}" for name, value in scales),
    ]


def number_lines(problem: Problem) -> list[str]:
    """The numbers of a run as LAMMPS variables."""
    return [
        f"variable timestep index {text(problem.timestep)}",
        f"variable steps index {problem.steps}",
        f"variable every index {problem.steps_per_frame}   # steps between frames",
        f"variable thermo index {min(max(1, problem.steps // 20), 2**31 - 1)}   # steps between lines of the log",
        *(line for part in spelling(problem) for line in part.variables),
    ]


def kick_lines(problem: Problem) -> list[str]:
    """LAMMPS variables that are the velocities of the kicked beads."""
    return [
        f"variable kick{number} index {text(velocity)}   # bead {bead} of chain {chain}"
        for number, (chain, bead, velocity) in enumerate(problem.system.kicks, 1)
    ]


def start_lines(problem: Problem) -> list[str]:
    """LAMMPS commands that displace beads and set them in motion; none where all start at rest."""
    system, layout = problem.system, problem.layout
    lines = []
    if system.start is not None:
        lines = [
            "variable place atom x+f_start[2]",
            "variable velocity atom f_start[1]",
            "set group all x v_place vx v_velocity",
            "unfix start",
        ]
    lines += loads.start_lines(system.motions, layout)
    for number, (chain, bead, _) in enumerate(system.kicks, 1):
        before = 0.0 if system.start is None else float(system.start.velocity[chain - 1, bead - 1])
        kick = f"$({text(before)}+v_kick{number}:%.17g)" if before else f"${{kick{number}}}"
        lines.append(f"set atom {layout.atom(chain, bead)} vx {kick}")
    return lines


def _held_start_lines(problem: Problem, start: Sequence[str]) -> list[str]:
    """LAMMPS commands that keep the start that the data file has until the forces at rest are known, of no velocity."""
    if problem.system.start is None or start:
        return []
    return [
        "# the data file has velocities at the start, and displacements in place of vy",
        "fix start all store/state 0 vx vy",
        "set group all vx 0.0 vy 0.0",
    ]


def _opening(problem: Problem) -> float:
    """How much farther apart than at rest neighbours start, at most, in units of L."""
    if problem.system.start is None:
        return 0.0
    x = problem.system.start.displacement[: problem.chains]
    return max(0.0, *(float(np.max(-link.rate(x))) for link in problem.system.contacts))


def _bonds(problem: Problem) -> list[tuple[int, int, NDArray[np.int64]]]:
    """Both chains of every edge, from 0, and the types of its bonds in the rows that exist; 0 where there is none."""
    bonds, before = [], 0
    for link, lines in zip(_spelled(problem.system), link_lines(problem), strict=True):
        if lines.bonds is not None:
            numbered = np.where(lines.bonds > 0, lines.bonds + before, 0)
            before += len(lines.coefficients)
            edges = zip(link.edges, numbered, strict=True)
            bonds += [(lower, higher, types[: problem.rows.existing]) for (lower, higher), types in edges]
    return bonds


def _skin(problem: Problem) -> float:
    """Neighbour distance beyond contact that takes in the next bead of the chain and nothing else."""
    system = problem.system
    if physics.loaded(system):
        rest = max(float(np.max(link.law.rest)) for link in system.along)
        return min(problem.layout.diameter / 2.0, problem.layout.diameter / 2.0 - rest)
    return physics.gap(system) + problem.layout.diameter / 2.0


def render_data(problem: Problem) -> str:
    """The text of ``data.chains``; atom number = (chain - 1) * rows + row, and type 2 marks recorded beads
    where types do not distinguish contacts. Atoms of further lines are small and of the last type.

    Columns of an atom: ``id type diameter density x y z``, and ``id type x y z diameter density molecule`` with bonds.
    The molecule is the chain, or in a window the row.
    """
    system = problem.system
    lines, beads, spacing = physics.lines(system), problem.rows.existing, problem.layout.spacing
    mass = np.broadcast_to(physics.masses(system), (lines, system.beads))[:, :beads]
    bonds = _bonds(problem)
    by_contact = _types(problem)
    types = by_contact.count if by_contact is not None else 1 if problem.rows.neighbours else 2
    types += lines > problem.chains
    atoms = np.count_nonzero(mass)
    out = io.StringIO()
    out.write(f"granchain: {problem.name}\n\n{atoms} atoms\n{types} atom types\n")
    if _tied(system):
        count, kinds = sum(np.count_nonzero(kind) for *_, kind in bonds), max(int(kind.max()) for *_, kind in bonds)
        out.write(f"{count} bonds\n{kinds} bond types\n")
    apart = 2.0 * (problem.layout.diameter + physics.gap(system))
    side = text(max(apart, _skin(problem) + _opening(problem)))  # of a box smaller than the skin LAMMPS warns
    ends = ends_of_box(system) if system.closing else (0, (beads + 1) * spacing)
    out.write(f"\n{' '.join(map(text, ends))} xlo xhi\n")
    out.write(f"-{side} {text(apart * lines)} ylo yhi\n-{side} {side} zlo zhi\n")
    out.write(f"\nAtoms # {_atom_style(problem)}\n\n")
    places = [text(x) for x in problem.layout.places[0, :beads]]
    for line, type_of_each in enumerate(_type_of_each(problem, types)):
        if not physics.even(system):
            places = [text(x) for x in problem.layout.places[system.chain_of_line[line]]]
        out.writelines(_atom_lines(problem, line, mass[line].tolist(), type_of_each.tolist(), places))
    if _tied(system):
        out.write("\nBonds\n\n")
        bond = 0
        for chain, partner, kind_of in bonds:
            tied, lower, higher = np.flatnonzero(kind_of), beads * chain + 1, beads * partner + 1
            numbered = enumerate(zip(tied.tolist(), kind_of[tied].tolist(), strict=True), bond + 1)
            out.writelines(f"{number} {t} {lower + i} {higher + i}\n" for number, (i, t) in numbered)
            bond += len(tied)
    out.writelines(_number_lines(problem))
    out.writelines(_lines_of_start(problem))
    return out.getvalue()


def _type_of_each(problem: Problem, last: int) -> NDArray[np.int64]:
    """Type of each atom, [line, bead]; atoms that are no beads are of the last type."""
    by_contact, of_beads = _types(problem), slice(problem.chains)
    types = np.full((physics.lines(problem.system), problem.rows.existing), last)
    types[of_beads] = 1 if by_contact is None else by_contact.of
    if by_contact is None and not problem.rows.neighbours:
        types[of_beads, problem.rows.numbers - 1] = 2
    return types


def _atom_lines(problem: Problem, line: int, masses: list[float], types: list[int], places: list[str]) -> Iterator[str]:
    """Line of text of each atom of a line of atoms, which is beside the line before.

    Args:
        problem: what is run.
        line: number of the line, from 0.
        masses: of each bead's atom, 0 where there is none.
        types: of each bead's atom.
        places: of each bead along the chain.
    """
    layout, first = problem.layout, line * problem.rows.existing + 1
    diameter = layout.diameter if line < problem.chains else layout.diameter_of_others
    size, unit, y = text(diameter), sphere_density(diameter), text(layout.apart((0, line)))
    measures: Iterable[str] = (f"{size} {text(unit * mass)}" for mass in masses)
    if masses.count(masses[0]) == len(masses):
        measures = itertools.repeat(f"{size} {text(unit * masses[0])}", len(masses))
    columns: list[Iterable[Any]] = [range(first, first + len(masses)), types, places, measures]
    if not all(masses):
        columns = [itertools.compress(column, masses) for column in columns]
    if _atom_style(problem) == "sphere":
        return (f"{atom} {kind} {measure} {x} {y} 0\n" for atom, kind, x, measure in zip(*columns, strict=True))
    columns.append(itertools.count(1) if problem.rows.follow else itertools.repeat(line + 1))
    return (
        f"{atom} {kind} {x} {y} 0 {measure} {molecule}\n"
        for atom, kind, x, measure, molecule in zip(*columns, strict=False)
    )


def _lines_of_start(problem: Problem) -> Iterator[str]:
    """Section of the velocity of every atom at the start, and its displacement as vy; none where all are at rest."""
    system = problem.system
    if system.start is None:
        return
    yield "\nVelocities\n\n"
    x, v = system.start.displacement.reshape(-1), system.start.velocity.reshape(-1)
    for atom in physics.atom_ids(system).tolist():
        yield f"{atom} {text(v[atom - 1])} {text(x[atom - 1])} 0 0 0 0\n"


def _number_lines(problem: Problem) -> Iterator[str]:
    """Section of the numbers of every bead; none where no law has them."""
    if (numbers := _numbers(problem)) is None:
        return
    yield "\nNumbers\n\n"
    rows = np.stack([*numbers.values()], axis=-1).reshape(-1, len(numbers))
    for atom, row in enumerate(rows.tolist(), 1):
        yield f"{atom} {' '.join(map(text, row))}\n"
