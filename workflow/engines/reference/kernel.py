"""The compiled step of the reference integrator: the template's places filled with the laws of a system.

The text depends on which laws there are, not on their numbers, so that one program does for many systems. It is kept as
a module beside its machine code (`workflow.compiled`), where it can be read, printed and profiled.

A dashpot's force is the rate of a function of the strain (`lammps_inputs.laws.dashpot`, ``impulse``). So where no
tension is cut, velocities are replaced by ``w = v - impulses / masses`` (as Lienard did): w changes by the forces of
positions alone, by kicks that are exact, and ``x' = w + impulses(x) / masses`` is the drift at fixed w. Forces that
jump where contacts open become mere kinks that way. Where tension is cut, a kick is the solution of
``masses * v' = forces(x) + drag(x, v)`` at fixed x. Either is one step of the classical Runge-Kutta method: of order 4,
as the scheme, and its error is far below that (a part of a step times the drag, to the fifth power, over 120).
LAMMPS instead takes the drag of the velocities that it has when forces are computed, those of half a step before.

Energy that dashpots dissipate is counted along the way. A kick at fixed positions takes no energy from the motion but
by their power, which is integrated as the velocities are. A drift at fixed w takes kinetic energy alone, and exactly
that.

Examples:
    >>> system = granchain.load("one-chain").problem().system
    >>> forces_of, parameters = kernel_inputs.make_terms(system, as_lammps=False, step=0.0)
    >>> program = kernel.make_tangent_program(forces_of)
    >>> callable(program.advance_tangent)  # compiled when it is called
    True
"""

import functools
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import System, physics
from workflow.engines.reference import template
from workflow.engines.reference.kernel_inputs import STATES, Term, Terms

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class KernelState(NamedTuple):
    """What the compiled step advances in place."""

    x: Floats
    """Displacements, [bead + 2, chain] flat, as all that follows."""
    v: Floats
    """Velocities; with dashpots whose tension is not cut, less what these have given."""
    push: Floats
    """Contact force on each bead from the bead behind it."""
    span: Integers
    """First and last row that may move; rows that are integrated at most; 1 if ``push`` is not that of ``x``, else 0.

    Beyond the rows of the span nothing has moved: a row at rest feels no force until the row beside it is displaced,
    and the span always holds one such row at each end, so the result is bit for bit that of all rows. Rows that are
    too far behind the last are let go and keep their last state.
    """
    chains: int
    room: tuple[Floats, ...]
    """Scratch arrays for the solution with dashpots, [place] each."""
    lost: Floats
    """[4, place]: energy that dashpots along, across, to the ground and of walls have taken from every bead; below 0
    of one that is dragged along."""
    work: Floats
    """[1]: work of loads, of springs that vary, and of beads whose motion is given against forces."""
    past: tuple[Floats, Floats, Floats]
    """[place] each: state of the contact behind each bead, and of the wall behind the last; strain and closing
    velocity at the start of a step. Without places where no force depends on a state.
    """

    @property
    def contacts(self) -> Floats:
        """States of contacts, [line, bead + 1], see `analysis.trajectory.Trajectory`; empty where there is none."""
        states = self.past[0]
        return states.reshape(-1, self.chains)[1:].T if states.size else np.zeros((0, 0))

    def set_contacts(self, system: System) -> None:
        """Set the states of contacts to those that the laws of a system have."""
        if self.contacts.size:
            self.contacts[: system.chains] = physics.contact_state(system)


class Steps(NamedTuple):
    """A scheme and its step."""

    kicks: Floats
    drifts: Floats
    h: float


class FrameArrays(NamedTuple):
    """Frames to fill: [frame, chain, bead], and [frame, entry] (`analysis.trajectory.Trajectory`)."""

    x: Floats
    v: Floats
    exchange: Floats
    contact_state: Floats = np.zeros((0, 0, 0))
    """[frame, chain, bead + 1]; without chains where no force depends on a state."""


class TangentArrays(NamedTuple):
    """Tangent vectors, [vector, place], that are advanced in place, and scratch arrays.

    As ``v`` of a state, ``dv`` lacks what dashpots whose tension is not cut have given.
    """

    dx: Floats
    dv: Floats
    slopes: Floats
    """Stiffness of the contact behind each bead, [place]."""
    pulls: Floats
    """Change of its force along a vector, [place]."""
    stiffness: Floats
    """Stiffness of other links, [term, place]."""
    nearby: Floats
    gains: Floats
    """Displacements within a drift and their summed rates, [vector, place]; empty without dashpots."""
    rates: Floats
    """Rates of the displacements of a vector, [place]; empty without dashpots."""


class ShiftArrays(NamedTuple):
    """Parameters beside those of a run; their differences drive the derivatives by what differs."""

    parameters: tuple[Any, ...]
    """Each parameter with a first axis [side]."""
    weights: Floats
    """[side]: the weighted sum over the sides of a vector is the derivative."""
    differs: NDArray[np.bool_]
    """[vector, 4]: whether sides differ in forces of contacts, other forces, dashpots, and loads."""
    first_side: Integers
    """[vector + 1]: number of the first side of each vector, and of all sides."""


class DerivativeFrames(NamedTuple):
    """Frames to fill: [frame, line, bead] of a state, and [vector, frame, line, bead] of the vectors.

    As in a state, velocities lack what dashpots whose tension is not cut have given.
    """

    x: Floats
    v: Floats
    dx: Floats
    dv: Floats


class Passing(NamedTuple):
    """First maxima of the velocity, NaN where none was, and scratch arrays; flat as the state."""

    arrival: Floats
    peak: Floats
    a: Floats
    a_before: Floats
    v_before: Floats


def make_state(x: Floats, v: Floats, span: Integers, terms: Terms, system: System) -> KernelState:
    """A state with displacements and velocities [bead + 2, chain], which are advanced in place.

    Args:
        x, v, span: see `KernelState`.
        terms: of the system.
        system: what is integrated; its laws have the states of contacts at the start.
    """
    scratch = len(_ROOM[terms.dashpots].split(", ")) if terms.dampers else 0
    room = tuple(np.zeros(x.size) for _ in range(scratch))
    push, lost, work = np.zeros(x.size), np.zeros((4, x.size)), np.zeros(1)
    states, was, closing = np.zeros((3, x.size if terms.with_state else 0))
    past = states, was, closing
    state = KernelState(x.reshape(-1), v.reshape(-1), push, span, x.shape[1], room, lost, work, past)
    state.set_contacts(system)
    return state


_ROOM = {
    "none": "",
    "half step": "squeeze, drag",
    "kick": "squeeze, drag, steady, total, trial",
    "drift": "squeeze, drag, actual, total, trial, place, early, start, after",
}
"""Arrays that a step needs for dashpots."""


@functools.cache
def make_program(terms: Terms) -> Any:
    """The module of some terms, compiled when it is called.

    It has ``advance(state, parameters, scheme, first_step, steps, recorded, frames)``, which fills frames of the
    recorded beads (counted from 1), so many steps each, after ``first_step`` earlier ones, and
    ``follow(state, parameters, scheme, first_step, steps, threshold, passing)``.
    """
    from workflow import compiled  # numba takes a third of a second to import

    return compiled.module(_Writer(terms).text(compiled.digest))


@functools.cache
def make_tangent_program(terms: Terms) -> Any:
    """The module of some terms with the tangent flow, compiled when it is called.

    It has ``advance_tangent(state, tangent, parameters, scheme, first_step, steps)``, which takes some steps after
    ``first_step`` earlier ones. Each step of the vectors is the derivative of the step of the state.
    """
    from workflow import compiled  # numba takes a third of a second to import

    return compiled.module(_Writer(terms, tangent=True).text(compiled.digest))


@functools.cache
def make_derivative_program(terms: Terms) -> Any:
    """The module of some terms with derivatives by parameters, compiled when it is called.

    It has ``advance_derivatives(state, tangent, parameters, scheme, first_step, steps, shift, recorded, frames)``,
    which fills frames of the recorded beads (counted from 1), so many steps each, after ``first_step`` earlier ones.
    """
    from workflow import compiled  # numba takes a third of a second to import

    return compiled.module(_Writer(terms, tangent=True, shifted=True).text(compiled.digest))


_OF_RUN, _OF_SIDE = "p[{}]", "q[{}][s]"
"""Source of a parameter by its number, of the run and of a side."""


class _Writer:
    """Writes the program of some terms, or that of their tangent flow, or that of derivatives by their parameters."""

    def __init__(self, terms: Terms, *, tangent: bool = False, shifted: bool = False) -> None:
        self._terms = terms
        self._tangent = tangent
        self._shifted = shifted
        self._laws: dict[Any, str] = {}
        self._functions: dict[str, str] = {}
        self._used: list[Any] = []

    def _call(self, term: Term, function: str, *arguments: str) -> str:
        """Source of a call of a law's function, which goes to the head of the program."""
        law = term.law
        if law not in self._laws:
            name, used = law.__name__, [other.__name__ for other in self._laws].count(law.__name__)
            self._laws[law] = name + str(used + 1) * (used > 0)
        called = f"{self._laws[law].lower()}_{function}"
        if law.source is not None:  # a formula's, which is in no module
            self._functions[called] = f"\n\n@inlined\n{law.source(called, function)}"
        else:
            if called not in self._functions:
                self._used.append(getattr(law, function))
            self._functions[called] = f"{called} = inlined({self._laws[law]}.{function})"
        call = f"{called}({', '.join([*arguments, *term.parameters])})"
        return f"{term.sign} * {call}" if term.sign else call

    def _sum(
        self,
        terms: Sequence[Term],
        function: str,
        *,
        rate: bool = False,
        times_rate: bool = False,
        number: int = 0,
    ) -> tuple[list[str], str]:
        """Loops to run before, and the sum of a function of laws at k, the last two added first; empty for none.

        Args:
            terms: the laws.
            function: name of the function.
            rate: whether it takes the rate of the strain.
            times_rate: whether its values are multiplied by that.
            number: of the sum among those that the scratch array has room for.
        """
        loops: list[str] = []
        calls = []
        for term in terms:
            call = self._call(term, function, term.strain, *filter(None, [term.time]), *([term.rate] * rate))
            call += f" * ({term.rate})" * times_rate
            if term.over:
                total = f"{term.sums}[{number}, k]"
                loops += self._lines(template.SUM, total=total, over=term.over, call=call)
                call = total
            calls.append(call)
        return loops, " + (".join(calls) + ")" * (len(calls) - 1)

    # --- the text -----------------------------------------------------------------------------------------------------

    def text(self, digest: Callable[[Iterable[Any]], str]) -> str:
        """The whole program, with the digest of its laws' functions."""
        places = self._parts_of_a_step()
        sections = [*self._functions_of_loads(), *self._functions_of_dashpots()]
        functions = (template.TANGENT,) if self._tangent else (template.ADVANCE, template.FOLLOW)
        if self._shifted:
            sections += self._shifted_functions()
            functions = (template.DERIVATIVES,)
        sections += [self._filled(section, **places) for section in functions]
        for law in self._laws:
            if "<locals>" in law.__qualname__:
                raise TypeError(f"law {law.__qualname__}: must be a class of a module, not of a function")
        written = [law for law in self._laws if law.source is not None]
        named = {law: name for law, name in self._laws.items() if law not in written}
        names = {law: law.__name__ + f" as {name}" * (law.__name__ != name) for law, name in named.items()}
        imports = sorted(f"from {law.__module__} import {name}" for law, name in names.items())
        if written:
            imports.append("import numpy as np")
        head = _filled(
            template.HEAD,
            digest=digest(self._used),
            imports=imports,
            laws=list(self._functions.values()),
        )
        return "\n\n".join([head, *sections]).lstrip("\n")

    def _filled(self, section: str, values: str = _OF_RUN, /, **places: str | list[str]) -> str:
        """A section with its places filled, and the parameters that each of its functions uses unpacked in it.

        Args:
            section: the text.
            values: source of a parameter by its number.
            **places: see `_filled`.
        """
        functions = []
        for function in "\n".join(self._lines(section, **places)).split("\n\n\n"):
            used = [n for n, name in enumerate(self._terms.names) if re.search(rf"\b{name}\b", function)]
            unpacked = ", ".join(self._terms.names[n] for n in used), ", ".join(values.format(n) for n in used)
            functions.append(_filled(function, parameters=[" = ".join(unpacked)] if used else []))
        return "\n\n\n".join(functions) + "\n"

    def _lines(self, section: str, **places: str | list[str]) -> list[str]:
        """Lines of a section with its places filled."""
        terms = self._terms
        switches: dict[str, bool] = {
            "pushed": terms.pushed_in_drifts,
            "damped": terms.dashpots != "none",
            "half_step": terms.dashpots == "half step",
            "drifting": terms.dashpots == "drift",
            "reset": terms.dashpots == "drift" and bool(terms.motions or terms.with_state),
            "counts_lost": terms.counts_lost,
            "counts_work": terms.counts_work,
            "moved_with_loss": terms.moved_with_loss,
            "has_state": bool(terms.with_state),
            "shifted": self._shifted,
            "shifted_loads": self._shifted and terms.pushed_in_drifts,
        }
        names = {"per_mass": terms.per_mass, "row": terms.row, "rooms": _ROOM[terms.dashpots]}
        return _filled(section, **switches, **names, **places).strip("\n").split("\n")

    def _parts_of_a_step(self) -> dict[str, str | list[str]]:
        """Texts for the places of the functions that take steps."""
        kind, as_lammps = self._terms.dashpots, self._terms.as_lammps
        press = self._lines(
            template.PRESS, contact=self._contact_force(), walls=self._of_walls(self._terms.at_ends, "push", "force")
        )
        kick = self._kick("v", "factor")
        if kind == "half step":
            kick += self._lines(template.DRAG_AS_LAMMPS)
        elif kind == "kick":
            steady = self._kick("steady", "1.0")
            kick = self._lines(template.KICK_WITH_DRAG, kick=steady, taken=self._taken_in_kicks())
        if kind == "drift":
            drift = self._lines(template.DRIFT_WITH_IMPULSES, **self._counts_in_drifts())
        else:
            drift = self._lines(template.DRIFT, loads=self._loads_in_drifts())
        step = self._lines(
            template.STEP,
            press=press,
            kick=kick,
            kick_by_means=self._kicks_by_means() if as_lammps else [],
            hold=[*self._held_motions(), *self._work_of_springs()] if self._terms.counts_work else [],
            tangent_kick=self._tangent_kick() if self._tangent else [],
            tangent_drift=self._tangent_drift() if self._tangent else [],
            drift=drift,
            updated=self._of_states(template.UPDATE_AS_LAMMPS if as_lammps else template.UPDATE),
        )
        return {
            "unpacked": self._lines(template.UNPACKED),
            "press": press,
            "step": step,
            "before": [] if as_lammps else self._of_states(template.NOTE),
            "split_step": self._lines(template.SPLIT, step=step, bends=self._terms.bends)
            if self._terms.bends
            else step,
            "velocities": self._lines(template.VELOCITIES) if kind == "drift" else [],
            "actual": "actual" if kind == "drift" else "v",
            "held_by_dashpots": self._held_by_dashpots() if self._terms.moved_with_loss else [],
            "kick": self._kick("a", "1.0"),
        }

    def _contact_force(self) -> str:
        """Source of the force of all contacts at k."""
        calls = [self._call(term, "force", term.strain) for term in self._terms.contacts]
        return " + (".join(calls) + ")" * (len(calls) - 1)

    def _at_end(self, term: Term, *lines: str) -> list[str]:
        """A loop over the beads at an end, those in the rows that can move."""
        begin, end = self._beads_of(term)
        return [f"for k in range({begin}, {end}):", *(f"    {line}" for line in lines)]

    def _beads_of(self, term: Term) -> tuple[str, str]:
        """First place of the loop over the beads of contacts or at an end, and the place behind the last."""
        row = self._terms.row
        if not term.row:
            return f"low + {row}", "high"
        return f"max(low, {term.row} * {row})", f"min(high, ({term.row} + uint64(1)) * {row})"

    def _of_walls(self, terms: Sequence[Term], array: str, function: str, *, rate: bool = False) -> list[str]:
        """Loops that put a function of walls into an array beside those of the contacts, as a contact with a place."""
        lines = []
        for term in terms:
            call = self._call(replace(term, sign=""), function, term.strain, *([term.rate] * rate))
            lines += self._at_end(term, f"{_places(array, term)} = {call}")
        return lines

    def _of_states(self, section: str) -> list[str]:
        """A section for each law of contacts or walls with a state, with the velocities that it reads."""
        terms, lines = self._terms, []
        moving = "actual" if terms.dashpots == "drift" else "v"
        for term in (replace(term, v=moving) for term in terms.with_state):
            behind = terms.per_mass_at(term.behind)
            begin, end = self._beads_of(term)
            lines += self._lines(
                section,
                begin=begin,
                end=end,
                strain=term.strain,
                rate=term.rate,
                contact_state=term.at_contact(STATES),
                was=term.at_contact("was"),
                closing=term.at_contact("closing"),
                after=self._call(replace(term, sign=""), "next_state", "late"),
                top=self._call(replace(term, sign=""), "next_state", "top"),
                more=self._force_with(term, "largest"),
                less=self._force_with(term, "before"),
                sign=f"-{term.sign} * " if term.sign else "",
                behind=[f"v[{term.behind}] -= given{behind}", f"x[{term.behind}] -= gone{behind}"]
                if term.behind
                else [],
            )
        if terms.with_state and moving == "actual":
            return self._lines(template.VELOCITIES) + lines
        return self._lines(template.SPAN) + lines if lines else []

    def _force_with(self, term: Term, state: str) -> str:
        """Source of the force of a law at a strain s in another state."""
        parameters = tuple(state if name == term.at_contact(STATES) else name for name in term.parameters)
        return self._call(replace(term, parameters=parameters, sign=""), "force", "s")

    def _kick(self, target: str, factor: str) -> list[str]:
        loops, others = self._other_forces()
        return self._lines(template.KICK, loops=loops, others=others, target=target, factor=factor)

    def _other_forces(self) -> tuple[list[str], str]:
        """Forces that drive beads back, across and to the ground."""
        lines, across = self._sum(self._terms.across, "force")
        more, ground = self._sum(self._terms.ground, "force")
        return lines + more, "".join(f" - ({total})" for total in (across, ground) if total)

    # --- tangent flow -------------------------------------------------------------------------------------------------

    def _tangent_kick(self) -> list[str]:
        contacts = " + ".join(self._call(term, "stiffness", term.strain) for term in self._terms.contacts)
        stiffness: list[str] = []
        loops: list[str] = []
        others = ""
        for terms in (self._terms.across, self._terms.ground):
            along = [replace(term, v="dx_n") for term in terms]
            more, total = self._sum([term for term in along if term.over], "stiffness", times_rate=True)
            loops += more
            others += f" - ({total})" if total else ""
            for term in along:
                if not term.over:  # the slope is the same for all vectors
                    slope = f"stiffness[{len(stiffness)}, k]"
                    call = self._call(term, "stiffness", term.strain, *filter(None, [term.time]))
                    stiffness.append(f"    {slope} = {call}")
                    others += f" - {slope} * ({term.rate})"
        before = ["for k in range(low, high):", *stiffness] if stiffness else []
        pulls = [line for term in self._terms.at_ends for line in self._at_end(term, self._pull(term))]
        return self._lines(
            template.TANGENT_KICK,
            contact_slope=contacts,
            wall_slopes=self._of_walls(self._terms.at_ends, "slopes", "stiffness"),
            wall_pulls=pulls,
            stiffness=before,
            loops=loops,
            others=others,
        )

    @staticmethod
    def _pull(term: Term) -> str:
        """Source of the change of a force at an end along a vector."""
        return f"{_places('pulls', term)} = slopes{term.place[0]} * ({replace(term, v='dx_n').rate})"

    def _tangent_drift(self) -> list[str]:
        damped = self._terms.dashpots == "drift"
        section = template.TANGENT_DRIFT_WITH_IMPULSES if damped else template.TANGENT_DRIFT
        loads = self._lines(template.SHIFTED_LOADS) if self._shifted and self._terms.pushed_in_drifts else []
        return self._lines(section, loads_of_sides=loads)

    def _shifted_functions(self) -> list[str]:
        """Functions that add effects of shifted parameters, which are entries of arrays."""
        loops, others = self._other_forces()
        walls = self._of_walls(self._terms.at_ends, "pulls", "force")
        forces: dict[str, str | list[str]] = {
            "contact": self._contact_force(),
            "walls": walls,
            "loops": loops,
            "others": others,
        }
        kick = self._filled(template.SHIFTED_KICK, _OF_SIDE, **forces)
        sections = [kick]
        if self._terms.dashpots == "drift":
            sections += [
                self._drag("shifted_impulses", "x", "Impulse", "impulse", shifted=True),
                self._filled(template.SHIFTED_RATE, _OF_SIDE),
            ]
        if self._terms.pushed_in_drifts:
            travels, gifts, _ = self._effects_of_loads("factor * ")
            names = {"name": "shifted_", "arguments": "q, s, factor"}
            sections.append(self._filled(template.TRAVEL, _OF_SIDE, travels=travels, gifts=gifts, **names))
        return sections

    # --- loads and motions --------------------------------------------------------------------------------------------

    def _acting_in_drifts(self) -> list[tuple[Term, str, bool]]:
        """Loads and motions, what makes each an acceleration, and whether it is a load whose work is counted."""
        terms = self._terms
        loads = [] if terms.as_lammps else [(load, terms.per_mass, terms.counts_work) for load in terms.loads]
        return [*loads, *((motion, "", False) for motion in terms.motions)]

    def _impulse_and_way(self, term: Term) -> tuple[str, str]:
        """Source of what a load gives a free bead in a duration, and of how much farther it gets."""
        now, later = (
            [self._call(term, name, time) for name in ("impulse", "travel")] for time in ("time", "time + duration")
        )
        return f"{later[0]} - {now[0]}", f"{later[1]} - {now[1]} - {now[0]} * duration"

    def _loads_in_drifts(self) -> list[str]:
        """Loops over the effects of loads on beads in a drift; the compiler merges what a loop computes twice."""
        loops = []
        for term, by_mass, counts in self._acting_in_drifts():
            impulse, gone = self._impulse_and_way(term)
            lines = [
                f"gone, given, early = {gone}, {impulse}, v[k]",
                f"x[k] += gone{by_mass}",
                f"v[k] += given{by_mass}",
            ]
            loops += _over(term.over, *lines, *["work[0] += given * 0.5 * (early + v[k])"] * counts)
        return loops

    def _effects_of_loads(self, factor: str = "") -> tuple[list[str], list[str], list[str]]:
        """Loops over effects on displacements and velocities in a drift, times a factor, and on accelerations."""
        travels, gifts, at = [], [], []
        for term, by_mass, _ in self._acting_in_drifts():
            impulse, gone = self._impulse_and_way(term)
            travels += _over(term.over, f"gone = {gone}", f"x[k] += {factor}gone{by_mass}")
            gifts += _over(term.over, f"given = {impulse}", f"v[k] += {factor}given{by_mass}")
            at += _over(term.over, f"a[k] += {self._call(term, 'force', 'time')}{by_mass}")
        return travels, gifts, at

    def _functions_of_loads(self) -> list[str]:
        travels, gifts, at = self._effects_of_loads()
        travel = self._filled(template.TRAVEL, travels=travels, gifts=gifts, name="", arguments="p")
        sections = [travel] * (self._terms.dashpots == "drift")
        return [*sections, self._filled(template.LOAD, loads=at)] if at else []

    def _kicks_by_means(self) -> list[str]:
        """Loops that add the means of loads over a step around a time to velocities; at the start over half a step."""
        loops = []
        for term in self._terms.loads:
            after, before = (self._call(term, "impulse", f"time {sign} 0.5 * h") for sign in "+-")
            change = f"v[k] += given / h * factor * (2.0 if time == 0.0 else 1.0){self._terms.per_mass}"
            loops += _over(term.over, f"given = {after} - {before}", change)
        return loops

    def _held_motions(self) -> list[str]:
        """Loops over the work of beads whose motion is given against forces of positions in a kick."""
        _, others = self._other_forces()
        work = f"work[0] -= factor * (push[k] - push[k + {self._terms.row}]{others}) * v[k]"
        return _over(self._terms.moved, work, everywhere=True) if self._terms.motions else []

    def _work_of_springs(self) -> list[str]:
        """Loops over the work of varying springs to the ground in a kick: time advances in drifts, as positions do."""
        lines = []
        for term in self._terms.ground:
            if term.time:
                power = self._call(term, "power", term.strain, term.time)
                lines += ["for k in range(low, high):", f"    work[0] += factor * {power}"]
        return lines

    def _held_by_dashpots(self) -> list[str]:
        """Loops over what dashpots take from beads whose motion is given, and so from what moves them."""
        held = "held = lost[0, k] + lost[1, k] + lost[2, k] + lost[3, k] + held"
        return ["held = 0.0", *_over(self._terms.moved, held, everywhere=True, backwards=True)]

    # --- dashpots -----------------------------------------------------------------------------------------------------

    def _functions_of_dashpots(self) -> list[str]:
        if self._terms.dashpots == "none":
            return []
        brake = self._drag("brake", "x, v", "Force", "damping", rate=True)
        if self._terms.dashpots != "drift":
            return [brake]
        return [brake, self._drag("impulses", "x", "Impulse", "impulse")]

    def _drag(
        self, name: str, arguments: str, quantity: str, function: str, *, rate: bool = False, shifted: bool = False
    ) -> str:
        _, contact = self._sum(self._terms.dampers[0], function, rate=rate)
        loops, held = [], []
        for terms in self._terms.dampers[1:]:
            more, total = self._sum(terms, function, rate=rate)
            loops += more
            held += [f"({total})"] if total else []
        walls = self._of_walls(self._terms.dampers_at_ends, "squeeze", function, rate=rate)
        drag = f"squeeze[k] - squeeze[k + {self._terms.row}]" if contact else "0.0"
        return self._filled(
            template.DRAG,
            _OF_SIDE if shifted else _OF_RUN,
            name=name,
            arguments=f"{arguments}, {'q, s' if shifted else 'p'}",
            what=quantity,
            contacts=self._lines(template.CONTACT_DRAG, contact=contact, walls=walls) if contact else [],
            loops=loops,
            drag=f"{drag} - ({' + '.join(held)})" if held else drag,
        )

    def _taken_in_kicks(self) -> list[str]:
        lines = []
        for kind, terms in list(enumerate(self._terms.dampers))[1:]:
            loops, held = self._sum([replace(term, v="trial") for term in terms], "damping", rate=True)
            if held:
                lines += loops + _counted(kind, f"taken = count * trial[k] * ({held})")
        for term in (replace(term, v="trial") for term in self._terms.wall_dampers):
            held = self._call(term, "damping", term.strain, term.rate)
            lines += self._at_end(term, *_taken(OF_WALLS, f"taken = count * trial[k] * {held}"))
        return lines

    def _counts_in_drifts(self) -> dict[str, list[str]]:
        """Loops over work of loads and dissipation by dashpots, from impulses at start, middle and end of a drift."""
        counted, taken = [], []
        for term in self._terms.loads:
            at = [self._call(term, "impulse", f"time{later}") for later in ("", " + 0.5 * duration", " + duration")]
            counted += _over(term.over, f"since, half, until = {', '.join(at)}", f"work[0] += {_OVER_THE_WAY}")
        for kind, terms in list(enumerate(self._terms.dampers))[1:]:
            lines = []
            for number, (name, x) in enumerate((("since", "place"), ("half", "trial"), ("until", "x"))):
                loops, impulse = self._sum([replace(term, x=x) for term in terms], "impulse", number=number)
                taken += loops
                lines.append(f"{name} = {impulse}")
            if terms:
                taken += _counted(kind, *lines, f"taken = {_OVER_THE_WAY}")
        for term in self._terms.wall_dampers:
            moments = [replace(term, x=x) for x in ("place", "trial", "x")]
            calls = ", ".join(self._call(each, "impulse", each.strain) for each in moments)
            taken += self._at_end(term, *_taken(OF_WALLS, f"since, half, until = {calls}", f"taken = {_OVER_THE_WAY}"))
        return {"counted": counted, "taken": taken}


OF_WALLS = 3
"""Number of the dashpots of walls among the kinds of dashpots whose losses are counted."""

_OVER_THE_WAY = "over_the_way(early[k], total[k], actual[k], half - since, until - half)"


def _places(array: str, term: Term) -> str:
    """Entries of an array that are the force at an end, as targets of an assignment."""
    return " = ".join(f"{array}{place}" for place in term.place)


def _filled(text: str, **places: str | list[str] | bool) -> str:
    """A text with some of its places filled; one alone in its line becomes lines as far in as it.

    A line that begins with ``?name`` is there only if the place of that name is true.
    """
    done = []
    for line in text.split("\n"):
        condition = re.fullmatch(r"( *)\?(\w+) (.*)", line)
        if condition and condition[2] in places:
            if not places[condition[2]]:
                continue
            line = condition[1] + condition[3]
        alone = re.fullmatch(r"( *)\{(\w+)\}", line)
        lines = places.get(alone[2]) if alone else None
        if alone and isinstance(lines, list):
            done += [alone[1] + more for more in lines]
            continue
        done.append(re.sub(r"\{(\w+)\}", lambda match: str(places.get(match[1], match[0])), line))
    return "\n".join(done)


def _over(places: str, *lines: str, everywhere: bool = False, backwards: bool = False) -> list[str]:
    """A loop that runs lines at the places in an array, by default at those in the rows that can move."""
    count = f"{places}.shape[0]"
    order = f"{count} - 1, -1, -1" if backwards else count
    begin = [f"for n in range({order}):", f"    k = {places}[n]"]
    if everywhere:
        return [*begin, *(f"    {line}" for line in lines)]
    return [*begin, "    if low <= k < high:", *(f"        {line}" for line in lines)]


def _counted(kind: int, *lines: str) -> list[str]:
    """A loop that counts what dashpots of a kind have taken."""
    return ["for k in range(low, high):", *(f"    {line}" for line in _taken(kind, *lines))]


def _taken(kind: int, *lines: str) -> list[str]:
    """Lines that count what dashpots of a kind have taken at k, and take it from the first kind, which has the rest."""
    return [*lines, f"lost[{kind}, k] += taken", "lost[0, k] -= taken"]
