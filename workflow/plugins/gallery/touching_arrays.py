"""Pulses in arrays of touching chains: the leading pulse of every chain, and relative modes of synchronised waves.

Solitary waves of equal peak velocity V_s run in chains tied by springs kappa. A relative mode is an eigenvector of the
graph of springs with eigenvalue mu; omega^2 = mu kappa / m. Waves that are ahead by a time t and faster by q in such a
mode change slowly from row to row. Momentum and energy that springs take from a wave, with the virial theorem of
Hertz's force (5/9 of the energy is kinetic) and the speed c ~ V_s^(1/5), give

    dq/dn = -5/9 omega^2 (V_s / c) t,    dt/dn = 1/5 q / (c V_s),

beats of wavenumber ``omega / (3 c)``. What a row keeps behind is a displacement 4/5 (S / V_s) q, for the shift S of the
wave, and a velocity -4/9 omega^2 S t. The product of the two is the loss of the area of the mode: it decays by

    4/45 omega^2 S^2 / e

from row to row, e the energy of the wave. S^2 / e falls as V_s^-0.4.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, engine, exact_wave, library

WINDOW = 120
"""Rows that are integrated near the front."""

MOST_BEADS = 12_000
CLEAR = 10
"""Rows at the free end that are left out."""

THRESHOLD = 1e-6
"""Smallest peak of a leading pulse, in units of V."""


def beat(omega: float, speed_of_beads: float) -> float:
    """Wavenumber in rad a bead of the beats of a relative mode.

    Args:
        omega: frequency of the mode, in units of 1 / T.
        speed_of_beads: peak velocity V_s of the waves, in units of V.
    """
    return omega / (3.0 * float(exact_wave.solitary_wave().speed_at(speed_of_beads)))


def decay(stiffness: float, speed_of_beads: float) -> float:
    """Decay of a relative mode from row to row, as a logarithm: 4/45 omega^2 S^2 / e.

    Args:
        stiffness: omega^2 = mu kappa.
        speed_of_beads: peak velocity V_s of the waves, in units of V.
    """
    wave = exact_wave.solitary_wave()
    shift, energy = wave.shift_at(speed_of_beads), wave.energy_at(speed_of_beads)
    return 4.0 / 45.0 * stiffness * float(shift**2 / energy)


@dataclass(frozen=True)
class GraphOfChains:
    """Chains and the springs between them.

    Attributes:
        kind: ``row``, ``ring`` or ``square``.
        chains: number of chains.
        edges: pairs of chains that springs tie, from 0.
    """

    kind: str
    chains: int
    edges: tuple[tuple[int, int], ...]

    @property
    def topology(self) -> Any:
        """Key of a scene."""
        side = math.isqrt(self.chains)
        return {"row": "open", "ring": "ring", "square": {"lattice": [side, side]}}[self.kind]

    def __str__(self) -> str:
        side = math.isqrt(self.chains)
        return {"row": "{n} chains", "ring": "ring of {n} chains", "square": "{side} x {side} chains"}[
            self.kind
        ].format(n=self.chains, side=side)

    def modes(self) -> tuple[Floats, Floats]:
        """Eigenvalues, [mode] ascending, and eigenvectors of the Laplacian, [chain, mode]."""
        laplacian = np.zeros((self.chains, self.chains))
        for first, second in self.edges:
            laplacian[[first, second], [first, second]] += 1.0
            laplacian[[first, second], [second, first]] -= 1.0
        values, vectors = np.linalg.eigh(laplacian)
        return values, vectors

    def slowest(self, kicked: Sequence[int]) -> tuple[float, float]:
        """Least eigenvalue above 0 of a mode that equal kicks of some chains (from 0) excite, and its spread.

        The spread is that of the velocities which the kicks give to these modes, (largest - smallest) / mean of all.
        """
        values, vectors = self.modes()
        start = np.zeros(self.chains)
        start[list(kicked)] = 1.0
        for value in np.unique(values.round(9)):
            part = vectors[:, np.abs(values - value) < 1e-8]
            velocity = part @ (part.T @ start)
            if value > 1e-8 and np.linalg.norm(velocity) > 1e-6:
                return float(value), float(np.ptp(velocity) / start.mean())
        raise ValueError("equal kicks of all chains excite no relative mode")


def row_of(chains: int) -> GraphOfChains:
    """Chains side by side, each tied to the next."""
    return GraphOfChains("row", chains, tuple((chain, chain + 1) for chain in range(chains - 1)))


def ring_of(chains: int) -> GraphOfChains:
    """Chains side by side, the last one also tied to the first."""
    return GraphOfChains("ring", chains, tuple((chain, (chain + 1) % chains) for chain in range(chains)))


def square_of(side: int) -> GraphOfChains:
    """A square lattice of chains."""
    across = [(row * side + column, row * side + column + 1) for row in range(side) for column in range(side - 1)]
    along = [(row * side + column, (row + 1) * side + column) for row in range(side - 1) for column in range(side)]
    return GraphOfChains("square", side * side, tuple(across + along))


def plain_array(graph: GraphOfChains, kappa: float, kicks: Sequence[float], beads: int, **keys: Any) -> dict[str, Any]:
    """Plain data of a scene of touching chains, without its name, whose first beads are kicked, [chain]."""
    kick = [{"chain": chain, "bead": 1, "velocity": float(v)} for chain, v in enumerate(kicks, 1) if v]
    springs = {"stiffness": kappa, "topology": graph.topology}
    return {"chains": graph.chains, "beads": beads, "coupling": springs, "kick": kick, "duration": 10.0 * beads, **keys}


def problem_of(plain: Mapping[str, Any]) -> Problem:
    """The problem of a scene without its name."""
    return library.from_plain({"name": "array", **plain}, "array").problem()


def peaks(problem: Problem, window: int = WINDOW) -> Floats:
    """Peak velocities of the leading pulses, [chain, bead] in units of V; NaN where a chain has none yet."""
    rows = min(window, problem.beads + 30)
    passed = engine.passages(problem, rows=rows, until_bead=problem.beads - CLEAR // 2, threshold=THRESHOLD)
    values = np.full((problem.chains, problem.beads), np.nan)
    values[passed.chain - 1, passed.bead - 1] = passed.peak_velocity
    return values[:, :-CLEAR]


@dataclass(frozen=True)
class Levelled:
    """Where the pulses of an array become equal.

    Attributes:
        graph, kappa, kicked: chains, coupling, and chains (from 0) that are kicked with V.
        slowest, spread: of the slowest modes that the kicks excite (`GraphOfChains.slowest`).
        difference: of the peaks, (largest - smallest) / mean, [bead]; NaN where a chain was not reached.
        amplitude: mean peak in the last beads, in units of V; NaN if the peaks do not agree to 1 %.
    """

    graph: GraphOfChains
    kappa: float
    kicked: tuple[int, ...]
    slowest: float
    spread: float
    difference: Floats
    amplitude: float

    def within(self, tolerance: float) -> int | None:
        """Bead from which on peaks agree to a tolerance; None if not for a tenth of the chain at its end."""
        apart = np.flatnonzero(~(self.difference <= tolerance))
        first = int(apart[-1]) + 1 if len(apart) else 0
        return first + 1 if first <= 0.9 * len(self.difference) else None

    @property
    def decay(self) -> float:
        """Decay of the slowest mode from row to row, at the last amplitude."""
        return decay(self.slowest * self.kappa, self.amplitude)

    def delayed(self, tolerance: float) -> float:
        """Distance to a tolerance in lengths of decay, less those in which the spread falls to it; NaN if never."""
        first = self.within(tolerance)
        return math.nan if first is None else first * self.decay - math.log(self.spread / tolerance)

    @property
    def energy(self) -> float:
        """Share of the energy input that the last waves have."""
        wave = exact_wave.solitary_wave()
        return self.graph.chains * float(wave.energy_at(self.amplitude)) / (0.5 * len(self.kicked))


@cache
def levelled(graph: GraphOfChains, kappa: float, kicked: tuple[int, ...] = (0,)) -> Levelled:
    """Compute an array until its pulses agree to 1 %, in chains as long as that takes, or of `MOST_BEADS`."""
    slowest, spread = graph.slowest(kicked)
    beads = min(MOST_BEADS, math.ceil(60.0 + 16.0 / (kappa * slowest)))
    kicks = [float(chain in kicked) for chain in range(graph.chains)]
    while True:
        values = peaks(problem_of(plain_array(graph, kappa, kicks, beads)))
        with np.errstate(invalid="ignore"):
            difference = (values.max(axis=0) - values.min(axis=0)) / values.mean(axis=0)
        result = Levelled(graph, kappa, kicked, slowest, spread, difference, float(values[:, -CLEAR:].mean()))
        if result.within(0.01) is not None:
            return result
        if beads >= MOST_BEADS:
            return Levelled(graph, kappa, kicked, slowest, spread, difference, math.nan)
        beads = min(MOST_BEADS, 2 * beads)


@dataclass(frozen=True)
class Mode:
    """Decay and beat of a relative mode of nearly equal waves, measured in a run.

    Attributes:
        stiffness: omega^2 = mu kappa of the mode.
        amplitude: peak velocity V_s of the waves, in units of V.
        decay, wavenumber: from row to row; the latter in rad.
    """

    stiffness: float
    amplitude: float
    decay: float
    wavenumber: float


def mode_of(values: Floats, vector: Floats, stiffness: float, first: int = 30) -> Mode | None:
    """Decay and beat of a mode in the rows of a run in which it is small.

    Every n-th row counts, a tenth of a beat apart: the recurrence of rows side by side would lose digits.

    Args:
        values: peaks, [chain, bead] in units of V.
        vector: of the mode, [chain].
        stiffness: omega^2 of the mode.
        first: bead with which rows begin.

    Returns:
        None where too few rows have a mode that can be told from rounding.
    """
    amplitude = float(values[:, -CLEAR:].mean())
    every = max(1, round(0.2 * math.pi / beat(math.sqrt(stiffness), amplitude)))
    mode = (vector @ values / values.sum(axis=0))[first::every]
    used = mode[: np.flatnonzero(np.abs(mode) > 1e-7)[-1] + 1]
    if len(used) < 8:
        return None
    size = np.max(np.abs([used[:-2], used[1:-1], used[2:]]), axis=0)
    earlier, middle, later = (part / size for part in (used[:-2], used[1:-1], used[2:]))
    (trace, determinant), *_ = np.linalg.lstsq(np.stack([middle, -earlier], axis=1), later, rcond=None)
    root = np.roots([1.0, -trace, determinant])[0]
    return Mode(stiffness, amplitude, -math.log(abs(root)) / every, abs(math.atan2(root.imag, root.real)) / every)
