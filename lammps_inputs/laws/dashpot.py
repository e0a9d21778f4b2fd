"""Dashpots: forces against the rate at which a link's strain changes, which take energy away.

A law of damping is a `DashpotLaw`, which declares parameters as a law of force does, numbers or arrays over links,
and has functions of strain, rate of strain and the parameters:

- ``damping(s, rate, ...)``: what drives the link's first bead back and its second forward; ``damping * rate`` is the
  power that is dissipated, never less than 0;
- ``impulse(s, ...)``: integral from no strain to this one of the resistance, the largest ratio of that to the rate:
  where no tension is cut, that is the impulse of a dashpot over time, whatever the path of the strain; exactly 0 at
  rest;
- ``growth(s, ...)``: slope of the resistance, where that does not jump;
- ``granular(layout)``: of contacts, what LAMMPS's ``pair_style granular`` calls it: coefficient and model.

Dashpots of contacts act while the beads touch; under a static load ``rest`` is the overlap from which the strain
counts. Where a dashpot pulls harder than the contact pushes, so does their sum; with the contact's strength as
``tensile_limit`` the sum is never tensile, with `NO_LIMIT` it may be.

The dashpot of a wall is that of a contact.

Examples:
    >>> damper = granchain.load("damped-contacts").problem().system.dampers[0].law
    >>> float(dashpot.resistance(damper, 1.0)), dashpot.cut(damper)
    (0.01, False)
    >>> round(dashpot.alpha(0.9), 4)  # coefficient of the dashpot for a restitution of 0.9
    0.0749
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import engine_limits, laws
from lammps_inputs.deck_lines import AtomTypes, BeadLayout, DeckLines, LinksAcross, atoms_by_value
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension

NO_LIMIT = 1e300
"""A contact of this strength is never pulled open: its product with an overlap is finite, and 0 at none."""

_NEVER: Any = NO_LIMIT

LEAST = 1e-4
"""Overlap below which a resistance grows no faster than there."""


class DashpotLaw(Law):
    """Force of a dashpot, and what a law of damping is where it does not say otherwise.

    Attributes:
        tensile_limit: strength of the contact beside which tension is cut; `NO_LIMIT` where it is not.
        each_pair: whether every pair parts with a share of its own speed, which LAMMPS computes from its stiffness.
    """

    tensile_limit = _NEVER
    each_pair = False

    def at_walls(self, layout: BeadLayout) -> tuple[list[float], str]:
        """LAMMPS's coefficient for the wall of every chain, and the model, which is that of the contacts.

        Viscoelastic ones it multiplies by the bead's mass and the contact's radius, sqrt(diameter / 2 * overlap).
        Restitution it makes of strengths and masses itself, for walls of spheres.
        """
        assert layout.contact_loss is not None
        share, model = layout.contact_loss.granular(layout)
        of_chain: NDArray[np.float64] = np.broadcast_to(next(iter(self)), (layout.chains, 1))[:, 0]
        if layout.contact_loss.each_pair:
            model = "damping velocity"  # beside a stiffness of 0 there is no other
        elif "restitution" in model:
            of_chain = np.full(layout.chains, share)
        elif "viscoelastic" in model:
            of_chain = of_chain / (layout.heaviest * np.sqrt(layout.diameter / 2.0))
        return of_chain.tolist(), model


class Dashpot(DashpotLaw):
    """``gamma s'`` at any strain."""

    coefficient: Annotated[Parameter, Dimension("force", "velocity")]
    """gamma, in units of m / T."""

    @staticmethod
    def damping(s: Any, rate: Any, coefficient: Any) -> Any:  # noqa: ARG004
        """Force of the dashpot, proportional to the rate."""
        return coefficient * rate

    @staticmethod
    def growth(s: Any, coefficient: Any) -> Any:
        """Slope of the resistance, 0: it does not depend on the strain."""
        return 0.0 * coefficient * s

    @staticmethod
    def impulse(s: Any, coefficient: Any) -> Any:
        """``gamma s``."""
        return coefficient * s

    def ground(self, name: str, layout: BeadLayout) -> DeckLines:
        """A drag on every bead, of the velocity in the middle of the step before.

        With masses larger by half of what a step of the drag takes, LAMMPS's step is that of the drag of the mean of
        the velocities before and after, which is of order 2. The deck does that where nothing else spoils the order.
        """
        if np.ndim(self.coefficient):
            return self._of_some(name, layout)
        return DeckLines(
            variables=(f"variable {name} index {text(float(self.coefficient))}   # force per velocity",),
            motion=(f"fix {name} {layout.group} viscous ${{{name}}}",),
            heavier=f"v_{name}" if layout.velocity_at_full_steps else None,
        )

    def _of_some(self, name: str, layout: BeadLayout) -> DeckLines:
        """A drag on the beads that have one, in groups of one coefficient."""
        lines, heavier = [], []
        for number, ((coefficient,), atoms) in enumerate(atoms_by_value(name, self, (layout.chains, layout.beads)), 1):
            group, value = f"{name}{number}", text(coefficient)
            lines += [f"group {group} id {atoms}", f"fix {group} {group} viscous {value}"]
            for first, last in (ids.split(":") for ids in atoms.split()):
                heavier.append(f"{value}*(id>={first})*(id<={last})")
        return DeckLines(
            motion=tuple(lines), heavier=f"({'+'.join(heavier)})" if layout.velocity_at_full_steps else None
        )

    def across(self, link: LinksAcross, layout: BeadLayout) -> DeckLines:
        """LAMMPS's thermostat of DPD at no temperature, whose drag, if the same along and across, is this.

        Beads of neighbouring chains differ by their type; the cutoff is between that of a row and those beside it.

        Raises:
            EngineLimitError: beads that differ, or that not all have a dashpot to the next chain.
        """
        name = link.name
        if link.tie:
            return self._tie(link, layout)
        every = link.open_row and len(link.edges) == layout.chains - 1 and np.ndim(self.coefficient) == 0
        if not (every and layout.alike):
            raise engine_limits.COUPLING_DASHPOTS.error("damping.coupling")
        types = np.repeat(1 + np.arange(layout.chains)[:, np.newaxis] % 2, layout.beads, axis=1)
        pressed = float(np.max(layout.closer))
        apart = layout.diameter + layout.gap
        cutoff = text(4.25**0.5 * apart if pressed == 0.0 else math.hypot(2.0 * apart, 0.5 * (apart - pressed)))
        return DeckLines(
            types=AtomTypes(types, {}, 2),
            variables=(f"variable {name} index {text(float(np.max(self.coefficient)))}   # force per velocity",),
            beside=(
                f"dpd/ext/tstat 0 0 {cutoff} 1",
                "# dashpots between chains: DPD thermostat at temperature 0, isotropic, up to a cutoff distance",
                "special_bonds lj/coul 1 1 1      # also between bonded beads",
                f"pair_coeff 1 2 dpd/ext/tstat ${{{name}}} ${{{name}}} 0 0 {cutoff}",
            ),
        )

    def _tie(self, link: LinksAcross, layout: BeadLayout) -> DeckLines:
        """A force against the velocity of each tied atom and its bead relative to each other.

        LAMMPS has no dashpots in bonds. The two are a chunk of atoms, of which the sum of the velocities is known.
        """
        lines = [
            "# dashpots inside the beads: of a bead and its inner atom, a chunk, the sum of both velocities is known"
        ]
        kinds = itertools.count(1)
        for apart, table in self._by_distance(link, layout):
            first_tied, apart = table.size, apart * layout.beads
            for (coefficient,), atoms in atoms_by_value(link.name, (table,), table.shape):
                name = f"{link.name}{link.number}_{next(kinds)}"
                ranges = [list(map(int, ids.split(":"))) for ids in atoms.split()]
                tied = " ".join(f"{first + apart}:{last + apart}" for first, last in ranges)
                lines += [
                    f"group {name} id {atoms} {tied}",
                    f"variable {name}_pair atom id-{apart}*(id>{first_tied})",
                    f"compute {name}_pair {name} chunk/atom v_{name}_pair nchunk once ids once",
                    f"variable {name}_own atom vx",
                    f"compute {name}_sum {name} reduce/chunk {name}_pair sum v_{name}_own",
                    f"compute {name}_both {name} chunk/spread/atom {name}_pair c_{name}_sum",
                    f"variable {name} atom -{text(coefficient)}*(2*vx-c_{name}_both)",
                    f"fix {name} {name} addforce v_{name} 0.0 0.0",
                ]
        return DeckLines(motion=tuple(lines))

    def _by_distance(self, link: LinksAcross, layout: BeadLayout) -> Iterator[tuple[int, NDArray[np.float64]]]:
        """Distance of two tied lines, and coefficients [lower line, bead] of pairs so far apart; no atom is in two."""
        of_edge = np.broadcast_to(self.coefficient, (len(link.edges), layout.beads))
        groups: dict[tuple[int, int], list[int]] = {}
        for edge, (lower, higher) in enumerate(link.edges):
            groups.setdefault((higher - lower, max(lower, layout.chains - 1)), []).append(edge)
        for (apart, _), edges in groups.items():
            lines = [link.edges[edge][0] for edge in edges]
            table = np.zeros((max(lines) + 1, layout.beads))
            table[lines] = of_edge[edges]
            yield apart, table


class ContactDashpot(DashpotLaw):
    """``g s'`` while the beads touch (Rosas, Romero, Nesterenko & Lindenberg, Phys. Rev. Lett. 98, 2007)."""

    coefficient: Parameter
    """g, in units of m / T."""
    tensile_limit: Parameter = NO_LIMIT
    rest: Parameter = 0.0

    @staticmethod
    def damping(s: Any, rate: Any, coefficient: Any, tensile_limit: Any, rest: Any) -> Any:
        """Force of the dashpot, which jumps where the beads meet and part."""
        closed = np.maximum(s + rest, 0.0)
        return np.maximum((closed > 0.0) * (coefficient * rate), -tensile_limit * (closed * np.sqrt(closed)))

    @staticmethod
    def growth(s: Any, coefficient: Any, tensile_limit: Any, rest: Any) -> Any:  # noqa: ARG004
        """Slope of the resistance, 0: it does not depend on the strain."""
        return 0.0 * coefficient * s

    @staticmethod
    def impulse(s: Any, coefficient: Any, tensile_limit: Any, rest: Any) -> Any:  # noqa: ARG004
        """``g ((d0 + s)+ - d0)``."""
        return coefficient * np.maximum(s, -rest)

    def granular(self, layout: BeadLayout) -> tuple[float, str]:  # noqa: ARG002
        """Coefficient and model in LAMMPS, which has this dashpot."""
        return float(np.max(self.coefficient)), "damping velocity" + _limit(self.tensile_limit)


class Viscoelastic(DashpotLaw):
    """``b s**0.5 s'`` (Kuwabara & Kono 1987; Brilliantov, Spahn, Hertzsch & Poeschel 1996)."""

    coefficient: Parameter
    """b, in units of m / (T L**0.5)."""
    tensile_limit: Parameter = NO_LIMIT
    rest: Parameter = 0.0

    @staticmethod
    def damping(s: Any, rate: Any, coefficient: Any, tensile_limit: Any, rest: Any) -> Any:
        """Force of the dashpot, proportional to the contact's radius and to the rate."""
        root = np.sqrt(np.maximum(s + rest, 0.0))
        return np.maximum(coefficient * root * rate, -tensile_limit * (root * root * root))

    @staticmethod
    def growth(s: Any, coefficient: Any, tensile_limit: Any, rest: Any) -> Any:  # noqa: ARG004
        """Slope of the resistance, infinite where the beads meet, and so limited to that at an overlap of `LEAST`."""
        return 0.5 * coefficient * (s + rest > 0.0) / np.sqrt(np.maximum(s + rest, LEAST))

    @staticmethod
    def impulse(s: Any, coefficient: Any, tensile_limit: Any, rest: Any) -> Any:  # noqa: ARG004
        """``2/3 b ((d0 + s)+**1.5 - d0**1.5)``."""
        closed = np.maximum(s + rest, 0.0)
        return coefficient * (2.0 / 3.0 * closed * np.sqrt(closed) - 2.0 / 3.0 * rest * np.sqrt(rest))

    def granular(self, layout: BeadLayout) -> tuple[float, str]:
        """LAMMPS multiplies by the contact's radius, sqrt(diameter / 4 * overlap), and the reduced mass, 1/2.

        Raises:
            EngineLimitError: beads of different mass.
        """
        if layout.lightest < layout.heaviest:
            raise engine_limits.VISCOELASTIC.error("damping.law")
        unit = 2.0 / float(np.sqrt(layout.diameter / 4.0))
        return unit * float(np.max(self.coefficient)), "damping viscoelastic" + _limit(self.tensile_limit)


class Restitution(DashpotLaw):
    """``a s**0.25 s'``: two beads part with the same share of any speed (Tsuji 1992; Antypov & Elliott 2011)."""

    coefficient: Parameter
    """a = alpha * sqrt(reduced mass * strength), in units of m / (T L**0.25)."""
    share: float
    """e, which sets alpha = -sqrt(5) ln e / sqrt(pi**2 + ln(e)**2)."""
    rest: Parameter = 0.0

    @staticmethod
    def damping(s: Any, rate: Any, coefficient: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """Force of the dashpot, proportional to the root of the contact's stiffness and to the rate."""
        return coefficient * np.sqrt(np.sqrt(np.maximum(s + rest, 0.0))) * rate

    @staticmethod
    def growth(s: Any, coefficient: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """Slope of the resistance, infinite where the beads meet, and so limited to that at an overlap of `LEAST`."""
        return 0.25 * coefficient * (s + rest > 0.0) / np.maximum(s + rest, LEAST) ** 0.75

    @staticmethod
    def impulse(s: Any, coefficient: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """``4/5 a ((d0 + s)+**1.25 - d0**1.25)``."""
        closed = np.maximum(s + rest, 0.0)
        return coefficient * (0.8 * closed * np.sqrt(np.sqrt(closed)) - 0.8 * rest * np.sqrt(np.sqrt(rest)))

    def granular(self, layout: BeadLayout) -> tuple[float, str]:  # noqa: ARG002
        """Restitution and model in LAMMPS, which computes the coefficient from masses and strengths."""
        return self.share, "damping coeff_restitution"


class LinearRestitution(DashpotLaw):
    """``g s'`` while beads touch that repel linearly and differ: each pair parts with the same share of any speed."""

    coefficient: Parameter
    """g = alpha * sqrt(reduced mass * strength), in units of m / T."""
    share: float
    """e, which sets alpha = -2 ln e / sqrt(pi**2 + ln(e)**2)."""
    rest: Parameter = 0.0
    each_pair = True

    @staticmethod
    def damping(s: Any, rate: Any, coefficient: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """Force of the dashpot, which jumps where the beads meet and part."""
        return (s + rest > 0.0) * (coefficient * rate)

    @staticmethod
    def growth(s: Any, coefficient: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """Slope of the resistance, 0: it does not depend on the strain."""
        return 0.0 * coefficient * s

    @staticmethod
    def impulse(s: Any, coefficient: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """``g ((d0 + s)+ - d0)``."""
        return coefficient * np.maximum(s, -rest)

    def granular(self, layout: BeadLayout) -> tuple[float, str]:  # noqa: ARG002
        """Restitution and model in LAMMPS, which computes the coefficient from masses and strengths."""
        return self.share, "damping coeff_restitution"


class PowerRestitution(DashpotLaw):
    """``a s**((p - 1) / 2) s'`` beside contacts of exponent p: two beads part with the same share of any speed."""

    coefficient: Parameter
    """a = alpha * sqrt(reduced mass * strength), in units of m / (T L**((p - 1) / 2))."""
    exponent: float
    """p."""
    share: float
    """e, which sets alpha."""
    rest: Parameter = 0.0

    @staticmethod
    def damping(s: Any, rate: Any, coefficient: Any, exponent: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """Force of the dashpot, proportional to the root of the contact's stiffness and to the rate."""
        return coefficient * np.maximum(s + rest, 0.0) ** (0.5 * (exponent - 1.0)) * rate

    @staticmethod
    def growth(s: Any, coefficient: Any, exponent: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """Slope of the resistance, limited to that at an overlap of `LEAST`."""
        power = 0.5 * (exponent - 1.0)
        return power * coefficient * (s + rest > 0.0) * np.maximum(s + rest, LEAST) ** (power - 1.0)

    @staticmethod
    def impulse(s: Any, coefficient: Any, exponent: Any, share: Any, rest: Any) -> Any:  # noqa: ARG004
        """``a ((d0 + s)+**q - d0**q) / q`` with ``q = (p + 1) / 2``."""
        q = 0.5 * (exponent + 1.0)
        return coefficient / q * (np.maximum(s + rest, 0.0) ** q - rest**q)

    def granular(self, layout: BeadLayout) -> tuple[float, str]:  # noqa: ARG002
        """No model of LAMMPS.

        Raises:
            EngineLimitError: always.
        """
        raise engine_limits.RESTITUTIONS.error("damping.law", self.exponent)


ContactLoss = ContactDashpot | Viscoelastic | Restitution | LinearRestitution | PowerRestitution


def alpha(share: float, exponent: float = 1.5) -> float:
    """Coefficient alpha of the dashpot ``alpha sqrt(reduced mass * strength) s**((p - 1) / 2)`` of a restitution.

    Antypov & Elliott, EPL 94 (2011) 50004, eq. 13, for spheres; with ``s**((p + 1) / 2)`` as variable the contact is a
    damped oscillator for any exponent p, and ``sqrt(5)`` there is ``sqrt(2 (p + 1))``.
    """
    loss = -float(np.log(share))
    return float(np.sqrt(2.0 * (exponent + 1.0))) * loss / float(np.hypot(np.pi, loss))


def damping(law: Any, strain: Any, rate: Any) -> Any:
    """Force of a law of damping on links."""
    return law.damping(strain, rate, *law)


def resistance(law: Any, strain: Any) -> Any:
    """Largest ratio of force to rate of a law of damping on links at a strain: no tension is cut while they close."""
    return law.damping(strain, np.ones_like(strain, dtype=np.float64), *law)


def cut(law: Any) -> bool:
    """Whether a law of damping cuts tension, so that its force does not follow from the strain and its rate alone."""
    return bool(np.min(law.tensile_limit) < NO_LIMIT)


def lets_go(law: Any, strain: Any, rate: Any) -> Any:
    """Whether a law that cuts tension does so: the dashpot pulls as hard as the contact pushes."""
    closed = np.maximum(strain + law.rest, 0.0)
    return resistance(law, strain) * rate < -law.tensile_limit * (closed * np.sqrt(closed))


def change(law: Any, strain: Any, rate: Any, acceleration: Any) -> Any:
    """How fast the force of a law of damping changes, but for jumps; where tension is cut, against the contact's."""
    force_rate = resistance(law, strain) * acceleration + law.growth(strain, *law) * rate**2
    if not cut(law):
        return force_rate
    slope = 1.5 * law.tensile_limit * np.sqrt(np.maximum(strain + law.rest, 0.0))
    return np.where(lets_go(law, strain, rate), -slope * rate, force_rate)


def at_max_strain(law: Any, elastic: laws.Law, energy: float) -> Any:
    """Resistance of contacts where each alone holds an energy."""
    return resistance(law, elastic.max_strain(energy, *elastic))


def beside(elastic: DeckLines, layout: BeadLayout) -> DeckLines:
    """The lines of contacts whose pair style has no dashpots, with these added.

    Raises:
        EngineLimitError: contacts that are no single pair style.
    """
    assert layout.contact_loss is not None
    styles = [line.split() for line in elastic.interactions if line.startswith("pair_style ")]
    if len(styles) != 1 or styles[0][1].startswith("hybrid"):
        raise engine_limits.DASHPOTS.error("damping.contact")
    coefficient, model = layout.contact_loss.granular(layout)
    says, *lines = elastic.interactions
    return replace(
        elastic,
        variables=(*elastic.variables, f"variable contact_damping index {text(coefficient)}   # {model}"),
        interactions=(says.replace("no loss", "with a dashpot beside it"), *lines),
        beside=(
            "granular",
            "# dashpots of contacts: spheres with a contact stiffness of 0",
            f"pair_coeff * * granular hertz 0 ${{contact_damping}} tangential linear_nohistory 0 0 {model}",
        ),
    )


def overlaid(contacts: list[str], beside: list[tuple[str, ...]]) -> list[str]:
    """The lines of contacts, with other pair styles over theirs."""
    lines = []
    for line in contacts:
        word, *rest = line.split(" ")
        if word == "pair_style":
            style = rest[0]
            line = " ".join(["pair_style hybrid/overlay", *rest, *(other for other, *_ in beside)])
        elif word == "pair_coeff":
            line = " ".join([word, *rest[:2], style, *rest[2:]])
        lines.append(line)
    return [*lines, *(line for _, *more in beside for line in more)]


def _limit(tensile_limit: Parameter) -> str:
    return " limit_damping" if np.min(tensile_limit) < NO_LIMIT else ""
