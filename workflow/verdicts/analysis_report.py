"""What an analysis writes of every scene: the keys of ``analysis.json``, and the table ``waves.csv``."""

from dataclasses import replace
from itertools import accumulate
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from analysis.conservation import Conservation
from analysis.quantity import QuantityColumn, data_frame, declare, declared, derived, result, structured, to_csv
from analysis.shape.exact_wave import wave_of
from analysis.sharing.equipartition import AGREEMENTS, Estimate, resolved, runs_exact_waves
from analysis.sharing.is_solitary import Character, Tolerances
from analysis.sharing.run_error import UNMEASURED, MeasuredError
from analysis.sharing.survey import Survey
from analysis.sharing.verdict import DecayFit
from analysis.tracking.leading_waves import Waves
from analysis.tracking.pulses import Pulse, Train, train_of
from analysis.tracking.succession import Change
from analysis.tracking.undisturbed import CLEAR, clear_of_others
from analysis.trajectory import Floats, along_the_way, mirrored_bead
from lammps_inputs import Problem, html, physics
from lammps_inputs.facts import Fact
from lammps_inputs.units import DIMENSIONLESS, Scale

WAVES = "waves.csv"

SHOWN = 8
"""Rows that a notebook shows."""

TOO_COARSE = "frames are so far apart that its uncertainty exceeds a twentieth of the energy input"


@result
class WavesTable(Waves):
    """Leading wave of each chain at each bead that it reached: ``waves.csv``, sorted by chain, then bead."""

    lag: Floats = declare("arrival behind the wave of the kicked chain", "time", "either arrival is undefined")
    width: Floats = declare(
        "full width of the velocity at half its maximum", "beads", "the passage is not recorded completely"
    )
    residual: Floats = declare(
        "largest difference from the velocity of the exact wave of this peak velocity, over that",
        undefined="the passage is not recorded completely, a larger pulse overlaps, or there is no exact wave",
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
    chain_energy, wave_energy, chain_error, wave_error = _energies(survey)
    shape = survey.shape
    made = WavesTable(
        **vars(survey.waves),
        lag=_lag(survey),
        width=shape.width,
        residual=shape.residual,
        chain_energy=chain_energy,
        wave_energy=wave_energy,
        chain_energy_error=chain_error,
        wave_energy_error=wave_error,
    )
    return made.measured(survey.problem.scale)


def _lag(survey: Survey) -> Floats:
    """[wave] arrival behind the wave of the chain that was kicked at the same bead; NaN where that was not seen."""
    waves = survey.waves
    of_kicked = waves.of_chain(survey.shared.kicked + 1)
    arrival = dict(zip(of_kicked.bead.tolist(), of_kicked.arrival.tolist(), strict=True))
    return waves.arrival - np.array([arrival.get(bead, np.nan) for bead in waves.bead.tolist()], dtype=np.float64)


def _energies(survey: Survey) -> tuple[Floats, Floats, Floats, Floats]:
    """Energies of chains and waves at each wave's passage, [wave], and the uncertainties of both; NaN if unknown."""
    waves, problem, energies = survey.waves, survey.problem, survey.energies
    bead = survey.shared.bead[energies.place]
    if survey.direction < 0:
        bead = mirrored_bead(problem, bead)
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
class ChainSummary:
    """The leading wave of a chain at the last bead that it passed clear of the end."""

    chain: int = declare("number of the chain")
    beads_reached: int = declare("number of recorded beads that the wave passed")
    ended: list[int] = declare(
        "beads at which a leading pulse ended, in the order in which it passed them: another one led from the next "
        "recorded bead on"
    )
    bead: int | None = declare(
        "last recorded bead, five before the end, that the wave passed", undefined=NOT_REACHED, column="last clear bead"
    )
    arrival: float | None = declare(
        "time at which the wave passes that bead",
        "time",
        f"{NOT_REACHED}, or the bead flies freely at its largest velocity",
        "t",
        column="arrival at the last clear bead",
    )
    peak_velocity: float | None = declare(
        "largest velocity of that bead in the direction of the wave as the wave passes",
        "velocity",
        NOT_REACHED,
        "v",
        column="peak velocity at the last clear bead",
    )
    speed: float | None = declare(
        "speed of the wave there, from the arrivals at the recorded beads on either side",
        "speed",
        f"{NOT_REACHED}, one of those arrivals is undefined, or the pulse begins or ends there within the chain",
        "c",
        column="speed at the last clear bead",
    )
    arrival_error: float | None = declare(
        "bound on the error of the arrival by the time between frames and by the run (``run_error``)",
        "time",
        NOT_REACHED,
    )
    peak_velocity_error: float | None = declare(
        "bound on the error of the peak velocity by the time between frames and by the run (``run_error``)",
        "velocity",
        NOT_REACHED,
    )
    arrival_reduced: float | None = declare("the arrival in units of T", "T", "as ``arrival``", "t / T")
    peak_velocity_reduced: float | None = declare(
        "the peak velocity in units of V",
        "V",
        NOT_REACHED,
        "v / V",
    )

    @classmethod
    def of(cls, waves: Waves, problem: Problem, chain: int, succession: tuple[Change, ...] = ()) -> "ChainSummary":
        """Summary of a chain's leading waves, with the changes from one pulse to another that were found."""
        chain_waves = waves.of_chain(chain)
        if len(chain_waves) == 0:
            return cls(chain, 0, [], *[None] * 8)
        last = last_clear_bead(chain_waves, problem)
        names = ("arrival", "peak_velocity", "speed", "arrival_error", "peak_velocity_error")
        at = {name: float(getattr(chain_waves, name)[last]) for name in names}
        reduced = {f"{name}_reduced": at[name] for name in ("arrival", "peak_velocity")}
        ended = [change.last for change in succession if change.chain == chain]
        return cls(chain, len(chain_waves), ended, int(chain_waves.bead[last]), **at, **reduced)


@result
class Final(Estimate):
    """The asymptotic amplitude."""

    uncertainty: float = declare(
        "its uncertainty: largest deviation over the last half beat, or the change still to come where that is larger; "
        "and the error of these amplitudes by the time between frames and by the run",
        "V",
    )

    @property
    @derived()
    def reduction(self) -> float:
        """Reduction of the amplitude against V, 1 - value."""
        return 1.0 - self.value


@result
class AmplitudeRange:
    """Range of amplitudes over some beads."""

    first: int = declare("first bead of the second half of the compared beads")
    last: int = declare("last bead")
    least: float = declare("least amplitude of any chain between them", "V")
    largest: float = declare("largest amplitude of any chain between them", "V")


@result
class EnergyShare:
    """Share of the energy input in the leading waves at the last clear bead."""

    exact: float | None = declare(
        "energy of exact waves of these amplitudes",
        "energy input",
        "there is no such wave (gaps, loads, unlike beads, dissipation), or the energy input is not known",
    )
    measured: float | None = declare(
        "energy within three beads of the peaks",
        "energy input",
        f"not all beads are recorded, another pulse is as near, no pulse keeps its shape, or {TOO_COARSE}",
        columns=(QuantityColumn("energy_share", "share of the energy in the leading waves"),),
    )
    measured_error: float | None = declare(
        "uncertainty of ``measured`` by the time between frames and by the run (``run_error``)",
        "energy input",
        "as ``measured``",
        columns=(
            QuantityColumn("energy_share_uncertainty", "uncertainty of the share of the energy in the leading waves"),
        ),
    )
    chains: Floats | None = declare(
        "energy of each chain, with half of its springs', when the waves (on average) pass the last compared bead at "
        "which all arrivals are defined",
        "energy input",
        f"there is one chain, not all beads are recorded, no pulse keeps its shape, or {TOO_COARSE}",
    )


@result
class Equipartition:
    """How the chains share the leading pulse. Beads count from the end that was kicked along the pulse's way.

    The amplitude at a bead is the peak velocity of the leading pulse; where coupled chains have gaps, the impulse of
    the bead's first contact over its mass.
    """

    verdict: str = declare("what the run shows of equipartition, in words", column="")
    state: str = declare("the same in few words", column="")
    since: int | None = declare("bead from which on amplitudes and arrivals agree to 1 %", undefined="they do not")
    expected: Estimate | None = declare(
        "bead from which on amplitudes are expected to agree to 1 %",
        "beads",
        "they agree already, or no rule is known for such a scene",
    )
    amplitudes: dict[str, int | None] = declare(
        "bead from which on the chains' amplitudes differ (largest - smallest) by under 0.1, 0.01 and 0.001 of their "
        f"mean, {COUNTED}",
        undefined=NO_AGREEMENT,
        columns=(
            QuantityColumn("agree_10", "bead from which amplitudes agree to 10 %", "0.1", "d_{10}"),
            QuantityColumn("agree_1", "bead from which amplitudes agree to 1 %", "0.01", "d_1"),
        ),
    )
    arrivals: dict[str, int | None] = declare(
        f"bead from which on the chains' arrivals differ by under 0.1, 0.01 and 0.001 of the passage time, {COUNTED}",
        undefined=NO_AGREEMENT,
        columns=(QuantityColumn("synchronised_1", "bead from which arrivals agree to 1 %", "0.01"),),
    )
    final: Final | None = declare(
        "asymptotic amplitude of the leading waves: mean over chains and the last half beat",
        "V",
        "no pulse keeps its shape, or amplitudes do not converge (*asymptotic amplitude* in the terms of verdicts)",
        "v",
        columns=(
            QuantityColumn("amplitude", "asymptotic amplitude", "value", "v"),
            QuantityColumn("amplitude_uncertainty", "uncertainty of the asymptotic amplitude", "uncertainty"),
        ),
    )
    range: AmplitudeRange | None = declare(
        "range of amplitudes over the second half of the compared beads", undefined="no pulse keeps its shape"
    )
    energy_share: EnergyShare = declare("energy in the leading waves at the last clear bead")
    beat_length: Estimate | None = declare(
        "beat length: twice the mean of the half beats seen, and twice their standard deviation, with what the errors "
        "of the amplitudes change, by the time between frames and by the run (``run_error``)",
        "beads",
        f"no half beat is seen, or they scatter by over half of their mean; {UNRESOLVED}",
        columns=(
            QuantityColumn("beat_length", "beat length", "value"),
            QuantityColumn("beat_length_uncertainty", "uncertainty of the beat length", "uncertainty"),
        ),
    )
    decay_law: DecayFit | None = declare(
        "law v = v_0 (1 - n / n*)^(5/2) fitted to the kicked chain",
        undefined="neighbours are nowhere weak over ten beads, springs are not linear and equal, beads are unlike, "
        "loaded or have gaps, energy is dissipated, or not just one bead was kicked",
    )


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
class ErrorOfRun:
    """Error of a run by its time step and integrator, with the uncertainty of the reference that measured it."""

    velocity: float = declare("bound on the error of any velocity of a bead or resonator", "V")
    amplitude: float = declare(
        "bound on the error of a peak velocity of a leading pulse; ``velocity`` where no pulse leads", "V"
    )
    arrival: float = declare(
        "bound on the error of an arrival of a leading pulse; ``velocity`` over V, in units of T, where none is sharp",
        "T",
    )


@result
class Report:
    """The contents of ``analysis.json`` of every run; what only some have is in `workflow.measures`."""

    complete: bool = declare("whether every frame of the scene is there")
    frames: tuple[int, int] = declare("number of frames found, and of those asked for")
    front: int | None = declare(
        "front: foremost bead (largest number) that moved faster than 1e-3 V",
        undefined="no recorded bead moved so fast",
        column="foremost bead that moved",
    )
    energy_drift: float = declare(
        "largest deviation of the energy, dissipated energy included, over the energy input",
        undefined="not all beads are recorded, or what was exchanged is not known",
        column="relative drift of the energy",
    )
    momentum_drift: float = declare(
        "largest deviation of the momentum over the momentum of kicks and forces from outside",
        undefined="not all beads are recorded, or momentum is not conserved (foundation, walls, weights)",
    )
    participation: float = declare(
        "participation number of the beads' energies in the last frame: (their sum)^2 / sum of their squares. A bead "
        "has its kinetic energy, half of that of each contact, and those of foundation and walls",
        undefined="not all beads are recorded, as in a window, or none has energy",
        column="participation number of the beads' energies at the end",
    )
    units: str = declare("the scene's units: ``SI`` or ``reduced``")
    scale: dict[str, float] = declare(
        "mass m, length L, time T and velocity V of the dimensionless problem, in the scene's units", "kg, m, s, m/s"
    )
    kappa: float = declare(
        "dimensionless stiffness of the coupling, k T^2 / m: the largest where springs differ; 0 without springs, and "
        "of purely cubic ones",
        symbol="\\kappa",
    )
    arrival: str = declare("definition of arrivals: ``maximum`` of the velocity, or centre of the ``impulse``")
    waves: list[ChainSummary] = declare("leading wave of each chain at its last clear bead")
    train: Train | None = declare(
        "pulses that follow each other in the kicked chain", undefined="none is steady anywhere"
    )
    equipartition: Equipartition = declare(
        "how the chains share the leading pulse, whose amplitude at a bead is its peak velocity or, where coupled "
        "chains have gaps, the impulse of the bead's first contact over its mass"
    )
    run_error: ErrorOfRun | None = declare(
        "error of the run, which all uncertainties in these files cover beside that by the time between frames",
        undefined="the run was not checked (rigid beads, runs that a cluster resumed): they cover the frames alone",
    )
    tolerances: Tolerances = declare("relative differences within which a pulse is called solitary")
    pulses: list[PulseEntry] = declare("every pulse, the strongest first")


def report(
    survey: Survey, conservation: Conservation, tolerances: Tolerances, error: MeasuredError = UNMEASURED
) -> Report:
    """What is known of every run, dimensionless."""
    problem, scale = survey.problem, survey.problem.scale
    entries = [pulse_entry(survey, *pair) for pair in zip(survey.pulses, survey.characters, strict=True)]
    return Report(
        complete=conservation.frames == problem.frames + 1,
        frames=(conservation.frames, problem.frames + 1),
        front=conservation.front,
        energy_drift=conservation.energy_drift,
        momentum_drift=conservation.momentum_drift,
        participation=conservation.participation,
        units="SI" if scale.si else "reduced",
        scale={"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity},
        kappa=physics.kappa(problem.system),
        arrival=survey.arrival,
        waves=[
            ChainSummary.of(survey.waves, problem, chain, survey.succession) for chain in range(1, problem.chains + 1)
        ],
        train=train(survey),
        equipartition=equipartition(survey),
        run_error=ErrorOfRun(error.velocity, error.amplitude, error.arrival) if error.measured else None,
        tolerances=tolerances,
        pulses=sorted(entries, key=lambda entry: -entry.peak_velocity),
    )


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
            unknown = np.isnan(varies) and survey.problem.recorded is not None
            constant = unknown or varies <= STEADY * pulse.peak_velocity[at]
            steady.setdefault(int(pulse.bead[at]), []).append((float(pulse.arrival[at]), bool(good) and constant))
    first = {bead: sum(accumulate((good for _, good in sorted(passages)), min)) for bead, passages in steady.items()}
    largest = max(first.values(), default=0)
    if largest == 0:
        return None
    best = [bead for bead, count in first.items() if count == largest]
    pulses = train_of(far, chain, ahead, max(best) if ahead > 0 else min(best), wave_of(survey.problem.system))
    return pulses.where(slice(largest))


def equipartition(survey: Survey) -> Equipartition:
    """How the chains share the leading pulse."""
    shared, decay, verdict, system = survey.shared.followed, survey.decay, survey.verdict, survey.problem.system
    pulse = system.holds(Fact.PULSE)
    is_resolved = pulse and resolved(shared, system)
    final, span = shared.final, shared.span if pulse else None
    measured, error = (np.sum(energy, axis=1) for energy in (survey.energies.wave, survey.energies.wave_error))
    return Equipartition(
        verdict=verdict.sentence,
        state=verdict.state.value,
        since=verdict.since,
        expected=verdict.expected,
        amplitudes={str(tolerance): shared.agrees_from(tolerance) if is_resolved else None for tolerance in AGREEMENTS},
        arrivals={str(tolerance): shared.in_step_from(tolerance) if is_resolved else None for tolerance in AGREEMENTS},
        final=None if final is None else Final(final.value, final.uncertainty),
        range=None if span is None else AmplitudeRange(span[0], int(shared.bead[-1]), *span[1:]),
        energy_share=EnergyShare(
            exact=float(np.sum(shared.wave_share[-1])) if len(shared) and runs_exact_waves(system) else None,
            measured=float(measured[-1]) if len(measured) and pulse else None,
            measured_error=float(error[-1]) if len(error) and pulse else None,
            chains=survey.energies.chain[-1] if len(measured) and pulse and survey.problem.chains > 1 else None,
        ),
        beat_length=shared.regular_beat if is_resolved else None,
        decay_law=decay,
    )


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


def last_clear_bead(waves: Waves, problem: Problem) -> int:
    """Position of the last bead that the pulse passed undisturbed by the end that it runs to, five beads before it.

    That of the first bead passed, where it passed none so far from that end.
    """
    passed = along_the_way(problem, waves.bead)
    clear = np.where(passed <= max(problem.beads - CLEAR, 1), passed, 0)
    return int(np.argmax(clear)) if clear.any() else int(np.argmin(passed))
