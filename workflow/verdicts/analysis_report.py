"""What an analysis writes of every scene: the keys of ``analysis.json``, and the table ``waves.csv``."""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import accumulate
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from analysis.conservation import Conservation
from analysis.quantity import QuantityColumn, computed, data_frame, declare, declared, result, structured, to_csv
from analysis.shape.exact_wave import wave_of
from analysis.sharing.equipartition import (
    AGREEMENTS,
    AmplitudeRange,
    Estimate,
    Final,
    Sharing,
    resolved,
    runs_exact_waves,
)
from analysis.sharing.is_solitary import Character, Tolerances
from analysis.sharing.run_error import UNMEASURED, MeasuredError
from analysis.sharing.survey import Survey
from analysis.sharing.verdict import DecayFit
from analysis.tracking.leading_waves import Waves
from analysis.tracking.pulses import Pulse, Train, train_of
from analysis.tracking.undisturbed import clear_of_others
from analysis.trajectory import Flags, Floats, along_the_way
from lammps_inputs import html, physics
from lammps_inputs.facts import Fact
from lammps_inputs.units import DIMENSIONLESS, Scale

WAVES = "waves.csv"

SHOWN = 8
"""Rows that a notebook shows."""

TOO_COARSE = "frames are so far apart that its uncertainty exceeds a twentieth of the energy input"


@result
class WavesTable(Waves):
    """Leading wave of each chain at each bead that it reached: ``waves.csv``, sorted by chain, then bead.

    >>> waves = granchain.analyze("out").waves
    >>> waves.at(20).peak_velocity.round(3), waves.at(20).lag.round(3)  # of both chains, in the scene's units
    (array([0.335, 0.399]), array([ 0.   , -0.437]))
    """

    lag: Floats = declare("arrival behind the wave of the kicked chain", "time", "either arrival is undefined")
    lag_error: Floats = declare(
        "bound on the error of the lag by those of both arrivals by the time between frames, and by the run "
        "(``run_error``), which delays all chains nearly alike",
        "time",
        "as ``lag``, or an error of an arrival is",
    )
    width: Floats = declare(
        "full width of the velocity at half its maximum", "beads", "the passage is not recorded completely"
    )
    residual: Floats = declare(
        "largest difference from the velocity of the exact wave of this peak velocity, over that",
        undefined="the passage is not recorded completely, a larger pulse overlaps, or there is no exact wave",
    )
    width_error: Floats = declare(
        "uncertainty of ``width`` by the time between frames, by that of the speed and by the run (``run_error``)",
        "beads",
        "as ``width`` or ``speed_error``, or the passage is recorded in fewer than six frames",
    )
    residual_error: Floats = declare(
        "uncertainty of ``residual`` by the time between frames and by the run (``run_error``)",
        undefined="as ``residual``, or the error of the arrival is",
    )
    chain_energy: Floats = declare(
        "energy of the chain, with half of its springs', when the waves (on average) pass this bead",
        "energy",
        f"not all beads are recorded, not all waves passed, or {TOO_COARSE}",
    )
    wave_energy: Floats = declare(
        "kinetic energy at that time of the beads within 3 beads of the wave's peak (more where pulses are longer), "
        "and energy of the contacts between them",
        "energy",
        f"not all beads are recorded, not all waves passed, another pulse is as near, or {TOO_COARSE}",
    )
    chain_energy_error: Floats = declare(
        "uncertainty of ``chain_energy`` by the time between frames and by the run (``run_error``)",
        "energy",
        "as ``chain_energy``",
    )
    wave_energy_error: Floats = declare(
        "uncertainty of ``wave_energy`` by the time between frames and by the run (``run_error``)",
        "energy",
        "as ``wave_energy``",
    )
    scale: Scale = DIMENSIONLESS  # of the numbers

    @property
    def columns(self) -> list[str]:
        """Names of the columns in the order of ``waves.csv``; each is an attribute, an array [wave].

        Returns:
            The names; errors stand last.

        Examples:
            >>> waves = granchain.analyze("out").waves
            >>> waves.columns[:5]
            ['chain', 'bead', 'pulse', 'arrival', 'peak_velocity']
            >>> waves.of_chain(2).at(60).peak_velocity.round(2)
            array([0.36])
        """
        return sorted(declared(WavesTable), key=lambda name: name.endswith("_error"))

    def __repr__(self) -> str:
        chains, beads = (len(np.unique(numbers)) for numbers in (self.chain, self.bead))
        units = "SI units" if self.scale.si else "reduced units"
        several = "s" if chains > 1 else ""
        return f"<leading waves of {chains} chain{several} at {beads} beads: {len(self)} rows, {units}>"

    def _repr_html_(self) -> str:
        rows = zip(*(getattr(self, name)[:SHOWN].tolist() for name in self.columns), strict=True)
        title = repr(self)[1:-1] + (f"; the first {SHOWN} rows" if len(self) > SHOWN else "")
        return html.table(title, [html.with_unit(name, self.unit(name)) for name in self.columns], rows)

    def measured(self, scale: Scale) -> Self:
        """Table of dimensionless waves in the units of a scene.

        Args:
            scale: units of the scene, of a `Problem`.

        Returns:
            The table, whose ``scale`` is that of the scene.

        Examples:
            >>> analysis = granchain.analyze("steel")
            >>> f"{analysis.survey.waves.arrival[1]:.2f} T = {analysis.waves.arrival[1]:.2e} s"
            '1.88 T = 2.77e-05 s'
        """
        return replace(super().measured(scale), scale=scale)

    def heading(self, name: str) -> str:
        """Heading of a column in ``waves.csv``: its name, with the unit where the scene is in SI units.

        Args:
            name: name of a column.

        Returns:
            The heading, such as ``arrival (s)``.

        Examples:
            >>> granchain.analyze("steel").waves.heading("arrival")
            'arrival (s)'
        """
        return self.scale.heading(name, declared(WavesTable)[name][0].unit)

    def unit(self, name: str) -> str:
        """Unit of a column: symbol of the SI unit, ``reduced``, or that of counts; empty of a pure number.

        Args:
            name: name of a column.

        Returns:
            The unit.

        Examples:
            >>> granchain.analyze("out").waves.unit("arrival"), granchain.analyze("steel").waves.unit("arrival")
            ('reduced', 's')
        """
        return declared(WavesTable)[name][0].symbol_of_unit(si=self.scale.si)

    def array(self) -> NDArray[np.void]:
        """Structured array, [wave], with a field for each column, in the units of this table.

        Returns:
            The array; integers are int64, other columns float64 with NaN where undefined.

        Examples:
            >>> granchain.analyze("out").waves.array().dtype.names[:3]
            ('chain', 'bead', 'pulse')
        """
        return structured({name: getattr(self, name) for name in self.columns})

    def pandas(self) -> Any:
        """Data frame of the table, with the headings of ``waves.csv``.

        Returns:
            A ``pandas.DataFrame``, a row for each wave.

        Raises:
            ImportError: pandas is not installed; `array` needs nothing.
        """
        return data_frame(self.array(), self.heading)

    def to_csv(self) -> str:
        """Text of ``waves.csv``; numbers read back exactly, and an undefined number is empty.

        Returns:
            The text.

        Examples:
            >>> granchain.analyze("out").waves.to_csv().splitlines()[0][:16]
            'chain,bead,pulse'
        """
        return to_csv({self.heading(name): getattr(self, name) for name in self.columns})


def waves_table(survey: Survey) -> WavesTable:
    """Leading waves of a run with all their columns, in the scene's units."""
    return table_of(survey).measured(survey.problem.scale)


def table_of(survey: Survey) -> WavesTable:
    """Leading waves of a run with all their columns, dimensionless."""
    chain_energy, wave_energy, chain_error, wave_error = _energies(survey)
    shape = survey.shape
    return WavesTable(
        **vars(survey.waves),
        lag=survey.lags.value,
        lag_error=survey.lags.error,
        width=shape.width,
        residual=shape.residual,
        width_error=shape.width_error,
        residual_error=shape.residual_error,
        chain_energy=chain_energy,
        wave_energy=wave_energy,
        chain_energy_error=chain_error,
        wave_energy_error=wave_error,
    )


def _energies(survey: Survey) -> tuple[Floats, Floats, Floats, Floats]:
    """Energies of chains and waves at each wave's passage, [wave], and the uncertainties of both; NaN if unknown."""
    waves, problem, energies = survey.waves, survey.problem, survey.energies
    bead = along_the_way(problem, survey.shared.bead[energies.place])
    shares = [energies.chain, energies.wave, energies.chain_error, energies.wave_error]
    tables = np.full((len(shares), problem.chains, problem.beads + 1), np.nan)
    for of_beads, share in zip(tables, shares, strict=True):
        of_beads[:, bead] = share.T
    chain, wave, chain_error, wave_error = tables[:, waves.chain - 1, waves.bead] * survey.shared.energy
    return chain, wave, chain_error, wave_error


REPORT = "analysis.json"

STEADY = 0.01
"""Relative change of its amplitude over ten beads up to which a pulse of a train is steady."""


NOT_REACHED = "no recorded bead was reached"

UNRESOLVED = (
    "no pulse keeps its shape, recorded beads are too far apart to show beats, or, with gaps, not all are recorded"
)
NO_AGREEMENT = f"it does not, or not for a half beat; a single chain; {UNRESOLVED}"
COUNTED = "to the last compared bead; beads count from the end that the pulses come from"


@result
class LeadingWave:
    """The leading wave of a chain at the last bead that it passed clear of the end, or at another bead."""

    survey: Survey
    chain: int = declare("number of the chain")
    at_bead: int | None = None
    """Number of the other bead."""
    beads_reached: int = computed(
        "number of recorded beads that the wave passed", of=lambda wave: int(np.sum(wave._in_chain))
    )
    ended: list[int] = computed(
        "beads at which a leading pulse ended, in the order in which it passed them: another one led from the next "
        "recorded bead on",
        of=lambda wave: [change.last for change in wave.survey.succession if change.chain == wave.chain],
    )
    bead: int | None = computed(
        "last recorded bead, five before the end, that the wave passed",
        undefined=NOT_REACHED,
        column="last clear bead",
        of=lambda wave: wave.column("bead"),
    )
    arrival: float | None = computed(
        "time at which the wave passes that bead",
        "time",
        f"{NOT_REACHED}, or the bead flies freely at its largest velocity",
        "t",
        column="arrival at the last clear bead",
        of=lambda wave: wave.column("arrival"),
    )
    peak_velocity: float | None = computed(
        "largest velocity of that bead in the direction of the wave as the wave passes",
        "velocity",
        NOT_REACHED,
        "v",
        column="peak velocity at the last clear bead",
        of=lambda wave: wave.column("peak_velocity"),
    )
    speed: float | None = computed(
        "speed of the wave there, from the arrivals at the recorded beads on either side",
        "speed",
        f"{NOT_REACHED}, one of those arrivals is undefined, or the pulse begins or ends there within the chain",
        "c",
        column="speed at the last clear bead",
        of=lambda wave: wave.column("speed"),
    )
    arrival_error: float | None = computed(
        "bound on the error of the arrival by the time between frames and by the run (``run_error``)",
        "time",
        NOT_REACHED,
        of=lambda wave: wave.column("arrival_error"),
    )
    peak_velocity_error: float | None = computed(
        "bound on the error of the peak velocity by the time between frames and by the run (``run_error``)",
        "velocity",
        NOT_REACHED,
        of=lambda wave: wave.column("peak_velocity_error"),
    )
    speed_error: float | None = computed(
        "bound on the error of the speed by those of the arrivals and by the run (``run_error``)",
        "speed",
        f"{NOT_REACHED}, so is the speed, or the errors exceed the time between the arrivals",
        of=lambda wave: wave.column("speed_error"),
    )
    arrival_reduced: float | None = computed(
        "the arrival in units of T", "T", "as ``arrival``", "t / T", of=lambda wave: wave.arrival
    )
    peak_velocity_reduced: float | None = computed(
        "the peak velocity in units of V", "V", NOT_REACHED, "v / V", of=lambda wave: wave.peak_velocity
    )

    @cached_property
    def _in_chain(self) -> Flags:
        """Mask of the waves of the chain, [wave]."""
        return np.asarray(self.survey.passages.chain == self.chain)

    @cached_property
    def _place(self) -> int | None:
        """Position of the wave in `waves_table`; None where no bead, or not that bead, was reached."""
        waves, places = self.survey.passages, np.flatnonzero(self._in_chain)
        if self.at_bead is not None:
            places = places[waves.bead[places] == self.at_bead]
        if len(places) == 0:
            return None
        return int(places[self.survey.last_clear_bead(waves.where(places))])

    def column(self, name: str) -> Any:
        """Number of a column of ``waves.csv``, dimensionless; None where the bead was not reached."""
        if self._place is None:
            return None
        if name in declared(Waves):
            of_each_pulse = name in ("speed", "speed_error")
            waves = self.survey.waves if of_each_pulse else self.survey.passages
        else:
            waves = table_of(self.survey)
        return getattr(waves, name)[self._place].item()


@result
class EnergyShare:
    """Share of the energy input in the leading waves at the last clear bead."""

    survey: Survey
    exact: float | None = computed(
        "energy of exact waves of these amplitudes",
        "energy input",
        "there is no such wave (gaps, loads, unlike beads, dissipation), or the energy input is not known",
        of=lambda share: share._of_exact_waves(),
    )
    exact_error: float | None = computed(
        "bound on the error of ``exact`` by those of the amplitudes, by the time between frames and by the run "
        "(``run_error``)",
        "energy input",
        "as ``exact``",
        of=lambda share: share._error_of_exact_waves(),
    )
    measured: float | None = computed(
        "energy within three beads of the peaks",
        "energy input",
        f"not all beads are recorded, another pulse is as near, no pulse keeps its shape, or {TOO_COARSE}",
        columns=(QuantityColumn("energy_share", "share of the energy in the leading waves"),),
        of=lambda share: share._sum(share.survey.energies.wave),
    )
    measured_error: float | None = computed(
        "uncertainty of ``measured`` by the time between frames and by the run (``run_error``)",
        "energy input",
        "as ``measured``",
        columns=(
            QuantityColumn("energy_share_uncertainty", "uncertainty of the share of the energy in the leading waves"),
        ),
        of=lambda share: share._sum(share.survey.energies.wave_error),
    )
    chains: Floats | None = computed(
        "energy of each chain, with half of its springs', when the waves (on average) pass the last compared bead at "
        "which all arrivals are defined",
        "energy input",
        f"there is one chain, not all beads are recorded, no pulse keeps its shape, or {TOO_COARSE}",
        of=lambda share: share._of_chains(share.survey.energies.chain),
    )
    chains_error: Floats | None = computed(
        "uncertainties of ``chains`` by the time between frames and by the run (``run_error``)",
        "energy input",
        "as ``chains``",
        of=lambda share: share._of_chains(share.survey.energies.chain_error),
    )

    def _of_exact_waves(self) -> float | None:
        shared = self.survey.shared.followed
        defined = len(shared) and runs_exact_waves(self.survey.problem.system)
        return float(np.sum(shared.wave_share[-1])) if defined else None

    def _error_of_exact_waves(self) -> float | None:
        """Energies of exact waves are squares of amplitudes v with errors a: each is off by up to (1 + a / v)^2 - 1."""
        shared = self.survey.shared.followed
        if self._of_exact_waves() is None or shared.amplitude_error is None:
            return None
        amplitude, error = shared.amplitude[-1], shared.amplitude_error[-1]
        relative = np.divide(error, amplitude, out=np.zeros_like(amplitude), where=amplitude > 0.0)
        return float(np.nansum(shared.wave_share[-1] * ((1.0 + relative) ** 2 - 1.0)))

    def _sum(self, energy: Floats) -> float | None:
        """Energies [place, chain] of all chains at the last place."""
        pulse = self.survey.problem.system.holds(Fact.PULSE)
        return float(np.sum(energy, axis=1)[-1]) if len(energy) and pulse else None

    def _of_chains(self, energy: Floats) -> Floats | None:
        """Energies [place, chain] of each chain at the last place."""
        problem = self.survey.problem
        defined = len(energy) and problem.system.holds(Fact.PULSE) and problem.chains > 1
        return energy[-1] if defined else None


@result
class Equipartition:
    """How the chains share the leading pulse. Beads count from the end that was kicked along the pulse's way.

    The amplitude at a bead is the peak velocity of the leading pulse; where coupled chains have gaps, the impulse of
    the bead's first contact over its mass.
    """

    survey: Survey
    verdict: str = computed(
        "what the run shows of equipartition, in words", column="", of=lambda shares: shares.survey.verdict.sentence
    )
    state: str = computed("the same in few words", column="", of=lambda shares: shares.survey.verdict.state.value)
    since: int | None = computed(
        "bead from which on amplitudes and arrivals agree to 1 %",
        undefined="they do not",
        of=lambda shares: shares.survey.verdict.since,
    )
    expected: Estimate | None = computed(
        "bead from which on amplitudes are expected to agree to 1 %",
        "beads",
        "they agree already, or no rule is known for such a scene",
        of=lambda shares: shares.survey.verdict.expected,
    )
    amplitudes: dict[str, int | None] = computed(
        "bead from which on the chains' amplitudes differ (largest - smallest) by under 0.1, 0.01 and 0.001 of their "
        f"mean, {COUNTED}",
        undefined=NO_AGREEMENT,
        columns=(
            QuantityColumn("agree_10", "bead from which amplitudes agree to 10 %", "0.1", "d_{10}"),
            QuantityColumn("agree_1", "bead from which amplitudes agree to 1 %", "0.01", "d_1"),
        ),
        of=lambda shares: shares._each(shares._shared.agrees_from),
    )
    arrivals: dict[str, int | None] = computed(
        f"bead from which on the chains' arrivals differ by under 0.1, 0.01 and 0.001 of the passage time, {COUNTED}",
        undefined=NO_AGREEMENT,
        columns=(QuantityColumn("synchronised_1", "bead from which arrivals agree to 1 %", "0.01"),),
        of=lambda shares: shares._each(shares._shared.in_step_from),
    )
    mismatch: Estimate | None = computed(
        "(largest - smallest) / mean of the chains' amplitudes at the last compared bead; its uncertainty is what those"
        " of the amplitudes change",
        undefined=f"a single chain; {UNRESOLVED}",
        of=lambda shares: shares._at_last[0],
    )
    spread: Estimate | None = computed(
        "time between the first and the last chain's arrival at the last compared bead over the passage time; its "
        "uncertainty is what those of arrivals and amplitudes change",
        undefined=f"a single chain; an arrival is undefined; {UNRESOLVED}",
        of=lambda shares: shares._at_last[1],
    )
    final: Final | None = computed(
        "asymptotic amplitude of the leading waves: mean over chains and the last half beat",
        "V",
        "no pulse keeps its shape, or amplitudes do not converge (*asymptotic amplitude* in the terms of verdicts)",
        "v",
        columns=(
            QuantityColumn("amplitude", "asymptotic amplitude", "value", "v"),
            QuantityColumn("amplitude_uncertainty", "uncertainty of the asymptotic amplitude", "uncertainty"),
        ),
        of=lambda shares: shares._shared.final,
    )
    range: AmplitudeRange | None = computed(
        "range of amplitudes over the second half of the compared beads",
        undefined="no pulse keeps its shape",
        of=lambda shares: shares._shared.span if shares._pulse else None,
    )
    energy_share: EnergyShare = computed(
        "energy in the leading waves at the last clear bead", of=lambda shares: EnergyShare(shares.survey)
    )
    beat_length: Estimate | None = computed(
        "beat length: twice the mean of the half beats seen, and twice their standard deviation, with what the errors "
        "of the amplitudes change, by the time between frames and by the run (``run_error``)",
        "beads",
        f"no half beat is seen, or they scatter by over half of their mean; {UNRESOLVED}",
        columns=(
            QuantityColumn("beat_length", "beat length", "value"),
            QuantityColumn("beat_length_uncertainty", "uncertainty of the beat length", "uncertainty"),
        ),
        of=lambda shares: shares._shared.regular_beat if shares._resolved else None,
    )
    decay_law: DecayFit | None = computed(
        "law v = v_0 (1 - n / n*)^(5/2) fitted to the kicked chain",
        undefined="neighbours are nowhere weak over ten beads, springs are not linear and equal, beads are unlike, "
        "loaded or have gaps, energy is dissipated, or not just one bead was kicked",
        of=lambda shares: shares.survey.decay,
    )

    @cached_property
    def _shared(self) -> Sharing:
        """Waves of the pulse that leads at the last bead, side by side."""
        return self.survey.shared.followed

    @cached_property
    def _at_last(self) -> tuple[Estimate | None, Estimate | None]:
        """Mismatch and spread at the last compared bead."""
        return (self._shared.at_last() if self._resolved else None) or (None, None)

    @cached_property
    def _pulse(self) -> bool:
        """Whether a pulse keeps its shape."""
        return self.survey.problem.system.holds(Fact.PULSE)

    @cached_property
    def _resolved(self) -> bool:
        """Whether the places show beats of a pulse."""
        return self._pulse and resolved(self._shared, self.survey.problem.system)

    def _each(self, begins: Callable[[float], int | None]) -> dict[str, int | None]:
        """Tolerance -> bead from which on chains agree within it."""
        return {str(tolerance): begins(tolerance) if self._resolved else None for tolerance in AGREEMENTS}


@result
class PulseEntry(Character):
    """A pulse: its direction, and what it is at the last bead where it was seen whole."""

    chain: int = declare("number of the chain")
    direction: int = declare("1 towards higher bead numbers, -1 towards lower")
    leading: bool = declare("whether it is the leading wave of its chain where it was last seen")
    beads: int = declare("number of recorded beads at which it was seen")
    first: int = declare("first of these beads")
    last: int = declare("last of these beads")


@result
class Report:
    """The contents of ``analysis.json`` of every run; what only some have is in `workflow.measures`."""

    survey: Survey
    conserved: Callable[[], Conservation]
    """Energy and momentum of all frames."""
    allowed: Tolerances
    error: MeasuredError = UNMEASURED
    complete: bool = computed(
        "whether every frame of the scene is there",
        of=lambda run: run.conservation.frames == run.survey.problem.frames + 1,
    )
    frames: tuple[int, int] = computed(
        "number of frames found, and of those asked for",
        of=lambda run: (run.conservation.frames, run.survey.problem.frames + 1),
    )
    front: int | None = computed(
        "front: foremost bead (largest number) that moved faster than 1e-3 V",
        undefined="no recorded bead moved so fast",
        column="foremost bead that moved",
        of=lambda run: run.conservation.front,
    )
    energy_drift: float = computed(
        "largest deviation of the energy, dissipated energy included, over the energy input",
        undefined="not all beads are recorded, or what was exchanged is not known",
        column="relative drift of the energy",
        of=lambda run: run.conservation.energy_drift,
    )
    momentum_drift: float = computed(
        "largest deviation of the momentum over the momentum of kicks and forces from outside",
        undefined="not all beads are recorded, or momentum is not conserved (foundation, walls, weights)",
        of=lambda run: run.conservation.momentum_drift,
    )
    participation: float = computed(
        "participation number of the beads' energies in the last frame: (their sum)^2 / sum of their squares. A bead "
        "has its kinetic energy, half of that of each contact, and those of foundation and walls",
        undefined="not all beads are recorded, as in a window, or none has energy",
        column="participation number of the beads' energies at the end",
        of=lambda run: run.conservation.participation,
    )
    units: str = computed(
        "the scene's units: ``SI`` or ``reduced``", of=lambda run: "SI" if run.survey.problem.scale.si else "reduced"
    )
    scale: dict[str, float] = computed(
        "mass m, length L, time T and velocity V of the dimensionless problem, in the scene's units",
        "kg, m, s, m/s",
        of=lambda run: scale_of(run.survey.problem.scale),
    )
    kappa: float = computed(
        "dimensionless stiffness of the coupling, k T^2 / m: the largest where springs differ; 0 without springs, and "
        "of purely cubic ones",
        symbol="\\kappa",
        of=lambda run: physics.kappa(run.survey.problem.system),
    )
    arrival: str = computed(
        "definition of arrivals: ``maximum`` of the velocity, or centre of the ``impulse``",
        of=lambda run: run.survey.arrival,
    )
    waves: list[LeadingWave] = computed(
        "leading wave of each chain at its last clear bead",
        of=lambda run: [LeadingWave(run.survey, chain) for chain in range(1, run.survey.problem.chains + 1)],
    )
    train: Train | None = computed(
        "pulses that follow each other in the kicked chain",
        undefined="none is steady anywhere",
        of=lambda run: train(run.survey),
    )
    equipartition: Equipartition = computed(
        "how the chains share the leading pulse, whose amplitude at a bead is its peak velocity or, where coupled "
        "chains have gaps, the impulse of the bead's first contact over its mass",
        of=lambda run: Equipartition(run.survey),
    )
    run_error: MeasuredError | None = computed(
        "error of the run, which all uncertainties in these files cover beside that by the time between frames",
        undefined="the run was not checked (rigid beads, runs that a cluster resumed): they cover the frames alone",
        of=lambda run: run.error if run.error.measured else None,
    )
    tolerances: Tolerances = computed(
        "relative differences within which a pulse is called solitary", of=lambda run: run.allowed
    )
    pulses: list[PulseEntry] = computed("every pulse, the strongest first", of=lambda run: pulse_entries(run.survey))

    @cached_property
    def conservation(self) -> Conservation:
        """Energy and momentum of all frames."""
        return self.conserved()


def scale_of(scale: Scale) -> dict[str, float]:
    """Mass, length, time and velocity of the dimensionless problem, in the scene's units."""
    return {"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity}


def train(survey: Survey) -> Train | None:
    """The first pulses of the kicked chain, as many as are steady somewhere; there, at the last such bead.

    Each is clear of the ends of the chain and of all other pulses, and its amplitude is constant to `STEADY` over the
    ten beads before. Only pulses count that ran over a quarter of the chain. None where not even the first is steady,
    and where no pulse keeps its shape.
    """
    if not survey.problem.system.holds(Fact.PULSE):
        return None
    chain, ahead = survey.shared.kicked + 1, survey.direction
    steady: dict[int, list[tuple[float, bool]]] = {}
    far: list[Pulse] = []
    for pulse, clear in zip(survey.pulses, survey.clear, strict=True):
        if (pulse.chain, pulse.direction) != (chain, ahead) or 4 * np.ptp(pulse.bead) < survey.problem.beads:
            continue
        far.append(pulse)
        alone = clear_of_others(chain, pulse.bead, pulse.arrival, survey.pulses, survey.problem.every)
        for at, good in enumerate(clear & alone):
            varies = pulse.variation(at)  # not known where few beads are recorded
            unknown = np.isnan(varies) and not survey.problem.rows.neighbours
            constant = unknown or varies <= STEADY * pulse.peak_velocity[at]
            steady.setdefault(int(pulse.bead[at]), []).append((float(pulse.arrival[at]), bool(good) and constant))
    first = {bead: sum(accumulate((good for _, good in sorted(passages)), min)) for bead, passages in steady.items()}
    largest = max(first.values(), default=0)
    if largest == 0:
        return None
    best = [bead for bead, count in first.items() if count == largest]
    pulses = train_of(far, chain, ahead, max(best) if ahead > 0 else min(best), wave_of(survey.problem.system))
    return pulses.where(slice(largest))


def pulse_entries(survey: Survey) -> list[PulseEntry]:
    """All pulses, the strongest first."""
    entries = [pulse_entry(survey, *pair) for pair in zip(survey.pulses, survey.characters, strict=True)]
    return sorted(entries, key=lambda entry: -entry.peak_velocity)


def pulse_entry(survey: Survey, pulse: Pulse, character: Character) -> PulseEntry:
    """A pulse, and what it is at the last bead where it was seen whole."""
    return PulseEntry(
        **vars(character),
        chain=pulse.chain,
        direction=pulse.direction,
        leading=survey.leads(pulse),
        beads=len(pulse),
        first=int(pulse.bead[0]),
        last=int(pulse.bead[-1]),
    )
