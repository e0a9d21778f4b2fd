"""Error of a run in the uncertainties of what is measured in it, beside what the time between its frames leaves.

A run has an error by its time step and integrator, which a reference measures: of velocities, and of peak velocities
and arrivals of the leading pulse. Uncertainties of a survey are those by the time between frames; here the error of the
run is added to each. Both are bounds, so they add up.

- A leading pulse has the errors that were measured for leading pulses, others that of all velocities: as a velocity,
  and as the time in which the exact wave of their peak velocity v rises by it, over ``v**1.2`` in spheres of equal
  mass and contacts of strength 1 (`rises`).
- A time step delays a pulse in proportion to the time t that it has run, by the error e of its arrival at most, and
  each passage by what the error a of its peak velocity v makes of it. The time d between two arrivals, on which speeds
  and lags depend, is then off by ``2 e d / t + 2 a / v**1.2``, and by 2 e at most. Measured, that of a passage and its
  neighbours holds in 99 of 100 passages of installed scenes, and is 4 to 50 times the error.
- Energies of beads of masses m at a frame are off by up to ``2 e sqrt(m E)``, kinetic ones as ``m v e``, with the error
  e of velocities; sums of them and their shares then follow from the inequality of Cauchy and Schwarz.
- Widths are off by as much as speeds, and their ends by ``a / v**1.2``. Residuals are differences of velocities.
- An energy is a square of velocities: its relative error is twice that of the peak velocity.
- A force changes by ``m omega`` times a velocity, with the largest angular frequency omega, half of it for two beads
  that move against each other; an impulse changes the velocities of two beads whenever a contact closes
  (`with_error` of the readings of forces).
"""

import math
from dataclasses import replace

import numpy as np

from analysis.quantity import declare, result
from analysis.shape.exact_wave import HERTZ
from analysis.shape.waveforms import REACH, Shape
from analysis.sharing.energies import EnergyShares, Flow
from analysis.sharing.equipartition import Sharing
from analysis.sharing.is_solitary import Character
from analysis.sharing.survey import Survey, numbered
from analysis.sharing.verdict import fit_decay, verdict_on
from analysis.tracking.leading_waves import Lags, Waves
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats
from lammps_inputs import Problem, System, laws, physics
from lammps_inputs.limits import rates


@result
class MeasuredError:
    """Error of a run by its time step and integrator, with the uncertainty of the reference that measured it.

    All errors are 0 where none was measured.
    """

    velocity: float = declare("bound on the error of any velocity of a bead or resonator", "V", default=0.0)
    amplitude: float = declare(
        "bound on the error of a peak velocity of a leading pulse; ``velocity`` where no pulse leads", "V", default=0.0
    )
    arrival: float = declare(
        "bound on the error of an arrival of a leading pulse; ``velocity`` over V, in units of T, where none is sharp",
        "T",
        default=0.0,
    )
    measured: bool = False
    """Whether they were measured, by a check or the reference's step halving."""

    @classmethod
    def of(
        cls, velocity: float, amplitude: float, arrival: float, of_reference: float, arrival_of_reference: float
    ) -> "MeasuredError":
        """Errors against a reference, with those of the reference itself.

        Args:
            velocity, amplitude, arrival: largest differences from the reference; NaN where undefined, and then taken
                from the velocity.
            of_reference, arrival_of_reference: uncertainty of the reference in velocities and in arrivals. That in peak
                velocities is taken for as much smaller as the run's error is.
        """
        total = velocity + of_reference
        if not math.isfinite(total):
            return cls()
        peaks = amplitude * (1.0 + of_reference / velocity) if amplitude <= velocity > 0.0 else amplitude + of_reference
        times = arrival + (arrival_of_reference if math.isfinite(arrival_of_reference) else 0.0)
        peaks, times = (total if math.isnan(value) else value for value in (peaks, times))
        return cls(total, peaks, times, measured=True)

    def of_passages(self, peak_velocity: Floats, system: System) -> Floats:
        """Errors of the arrivals, [passage], of pulses that do not lead, of these peak velocities."""
        return np.maximum(self.arrival, rises(self.velocity, peak_velocity, system))

    def of_force(self, problem: Problem) -> float:
        """Error of any force of a contact, in units of m V / T."""
        return 0.5 * float(np.max(problem.system.mass)) * rates.fastest(problem.system) * self.velocity

    def of_energy(self, energy: Floats, mass: float) -> Floats:
        """Errors of energies, [...], that bodies of a mass in all have with their springs, in units of m V**2."""
        moved = self.velocity * math.sqrt(mass)
        return np.asarray(moved * (2.0 * np.sqrt(energy) + moved))


def _of_speed(speed: Floats, time: Floats, late: Floats, moved: Floats) -> Floats:
    """Errors of speeds, [passage], from the arrivals one bead before and one after.

    Args:
        speed, time: of the passage, in beads / T and in T.
        late: error of the arrival, in T.
        moved: time in which the velocity rises by the error of the peak velocity, in T.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.minimum(2.0 * late * speed / time + moved * speed**2, 2.0 * late * speed**2))


def rises(error: Floats | float, peak_velocity: Floats, system: System) -> Floats:
    """Time, [passage] in T, in which the velocity of an exact wave of this peak velocity rises by an error.

    The largest slope is the largest force over the mass m: ``(A / m)**(1 / (n + 1)) v**(2 n / (n + 1))`` in contacts of
    strength A and exponent n; of contacts and beads that differ, the least strength and the largest mass count.
    """
    exponent = physics.exponent(system) or HERTZ
    weakest = float(np.min(laws.strength(system.along[0].law)) / np.max(system.mass))
    slope = np.maximum(peak_velocity, 1e-12) ** (2.0 * exponent / (exponent + 1.0))
    return np.asarray(error / (weakest ** (1.0 / (exponent + 1.0)) * slope))


UNMEASURED = MeasuredError()
"""That of a run without a check: uncertainties then cover the time between frames alone."""


def with_run_error(of_frames: Survey, error: MeasuredError) -> Survey:
    """A survey whose uncertainties, and the verdict that depends on them, cover the error of the run."""
    if not error.measured:
        return of_frames
    survey = of_frames.completed()
    shared, pulses = _of_shared(survey.shared, error), tuple(_of_pulse(pulse, survey, error) for pulse in survey.pulses)
    decay = fit_decay(shared.followed, survey.problem)
    waves = _of_waves(survey, error)
    return survey.replaced(
        passages=waves,
        waves=waves,
        lags=_of_lags(survey, error),
        shape=_of_shape(survey, waves, error),
        pulses=pulses,
        characters=tuple(
            _of_character(*each, error, survey.problem.system) for each in zip(survey.characters, pulses, strict=True)
        ),
        shared=shared,
        energies=_of_energies(survey.energies, shared, error),
        decay=decay,
        verdict=numbered(verdict_on(shared.followed, survey.problem, decay), survey.direction),
    )


def flow_with_error(flow: Flow, error: MeasuredError, problem: Problem) -> Flow:
    """Shares of energy over time with the error of the run."""
    if not error.measured or flow.energy is None:
        return flow
    mass = np.sum(np.broadcast_to(problem.system.mass, (problem.chains, problem.beads)), axis=1)
    assert flow.supplied is not None
    of_chain = flow.share * flow.energy[:, np.newaxis]
    of_springs = error.of_energy(flow.between * flow.supplied, float(np.sum(mass))) / flow.supplied
    of_shares, of_centres = (
        2.0 * error.velocity * np.sqrt(heavy / np.where(energy > 0.0, energy, np.nan))
        for heavy, energy in ((np.sum(mass), flow.energy), (mass, of_chain))
    )
    at_end = None if flow.fastest_mode_action is None else float(of_shares[-1])
    return replace(
        flow,
        share_error=of_shares,
        between_error=of_springs,
        centre_error=of_centres * flow.spread,
        spread_error=of_centres * flow.spread_scatter,
        fastest_mode_action_error=at_end,
    )


def _of_waves(survey: Survey, error: MeasuredError) -> Waves:
    """Leading waves; a maximum at the start is exact, and last beads, which fly off, have errors of other pulses."""
    waves = survey.waves
    exact, last = waves.peak_velocity_error == 0.0, waves.bead == (survey.problem.beads if survey.direction > 0 else 1)
    arrival = np.where(last, error.of_passages(waves.peak_velocity, survey.problem.system), error.arrival)
    peak = np.where(last, error.velocity, error.amplitude)
    speed = _of_speed(waves.speed, waves.time, arrival, rises(peak, waves.peak_velocity, survey.problem.system))
    return replace(
        waves,
        arrival_error=waves.arrival_error + np.where(exact, 0.0, arrival),
        peak_velocity_error=waves.peak_velocity_error + np.where(exact, 0.0, peak),
        speed_error=waves.speed_error + speed,
    )


def _of_lags(survey: Survey, error: MeasuredError) -> Lags:
    """Lags behind the kicked chain; centres of impulses depend on displacements, with errors of all velocities."""
    waves, lags = survey.waves, survey.lags
    least = np.full(survey.problem.beads + 1, np.inf)
    np.minimum.at(least, waves.bead, waves.peak_velocity)
    moved = rises(
        error.velocity if survey.arrival == "impulse" else error.amplitude, least[waves.bead], survey.problem.system
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        late = np.minimum(2.0 * error.arrival * np.abs(lags.value) / waves.time + 2.0 * moved, 2.0 * error.arrival)
    return lags._replace(error=lags.error + np.where(waves.chain == survey.shared.kicked + 1, 0.0, late))


def _of_shape(survey: Survey, waves: Waves, error: MeasuredError) -> Shape:
    """Shapes of the leading waves, with the errors that their speeds have now."""
    shape, before = survey.shape, survey.waves
    of_speed = shape.width * (waves.speed_error - before.speed_error) / waves.speed
    of_ends = 2.0 * waves.speed * rises(error.amplitude, waves.peak_velocity, survey.problem.system)
    of_velocities = (error.amplitude + error.velocity) / waves.peak_velocity
    return replace(
        shape,
        width_error=shape.width_error + of_speed + of_ends,
        energy_error=shape.energy_error + 2.0 * error.amplitude / waves.peak_velocity * shape.energy,
        residual_error=shape.residual_error + of_velocities,
    )


def _of_pulse(pulse: Pulse, survey: Survey, error: MeasuredError) -> Pulse:
    """A pulse with errors of leading ones where it leads, and of all others elsewhere."""
    waves = survey.waves.of_chain(pulse.chain)
    leads = np.isin(pulse.arrival, waves.time) & (pulse.direction == survey.direction)
    exact = pulse.peak_velocity_error == 0.0
    peak = np.where(leads, error.amplitude, error.velocity)
    arrival = np.where(leads, error.arrival, error.of_passages(pulse.peak_velocity, survey.problem.system))
    speed = _of_speed(pulse.speed, pulse.arrival, arrival, rises(peak, pulse.peak_velocity, survey.problem.system))
    return replace(
        pulse,
        arrival_error=pulse.arrival_error + np.where(exact, 0.0, arrival),
        peak_velocity_error=pulse.peak_velocity_error + np.where(exact, 0.0, peak),
        speed_error=pulse.speed_error + speed,
    )


def _of_character(character: Character, pulse: Pulse, error: MeasuredError, system: System) -> Character:
    """A character with the errors of its pulse at its bead.

    A momentum is the velocity of a bead over the time of travel past `REACH` beads on either side, times the speed.
    """
    at = int(np.flatnonzero(pulse.bead == character.bead)[0])
    peak, arrival = float(pulse.peak_velocity_error[at]), float(pulse.arrival_error[at])
    speed = float(pulse.speed_error[at])
    added = (peak - character.peak_velocity_error) / character.peak_velocity
    highest = np.array(character.peak_velocity)
    ends = 2.0 * character.speed * float(rises(added * highest, highest, system))
    delayed = character.momentum * character.speed * (arrival - character.arrival_error)
    return replace(
        character,
        arrival_error=arrival,
        peak_velocity_error=peak,
        speed_error=speed,
        width_error=character.width_error + character.width * (speed - character.speed_error) / character.speed + ends,
        residual_error=character.residual_error + added + error.velocity / character.peak_velocity,
        speed_excess_error=character.speed_excess_error
        + (1.0 + character.speed_excess) * ((speed - character.speed_error) / character.speed + added),
        variation_error=character.variation_error + (2.0 + character.variation) * added,
        momentum_error=character.momentum_error + 2.0 * REACH * error.velocity + delayed,
        energy_error=character.energy_error + 2.0 * added * character.energy,
    )


def _of_shared(shared: Sharing, error: MeasuredError) -> Sharing:
    """Leading waves side by side; arrivals are compared at one bead, and a time step delays those of all chains alike.

    An impulse is the velocity that it gives a bead, over the mass.
    """
    if shared.amplitude_error is None:
        return shared
    added = error.velocity if shared.of_impulses else error.amplitude
    return replace(shared, amplitude_error=np.nan_to_num(shared.amplitude_error) + added)


def _of_energies(energies: EnergyShares, shared: Sharing, error: MeasuredError) -> EnergyShares:
    """Energies of chains and of their waves with the uncertainties of squares of velocities."""
    peak = shared.amplitude[energies.place]
    relative = 2.0 * np.divide(error.amplitude, peak, out=np.zeros_like(peak), where=peak > 0.0)
    return replace(
        energies,
        chain_error=energies.chain_error + relative * energies.chain,
        wave_error=energies.wave_error + relative * energies.wave,
    )
