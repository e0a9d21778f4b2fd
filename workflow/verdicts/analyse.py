"""Analyse a run directory: ``waves.csv``, ``analysis.json`` and the figures beside the frames, which are read twice."""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.conservation import Conservation
from analysis.files.binary_dump import CutDumpWarning
from analysis.files.recording import FARTHEST
from analysis.gauges.far_end import FarEnd
from analysis.gauges.forces import ForceMeter
from analysis.gauges.gauge import gauges
from analysis.gauges.readings import Readings, to_csv
from analysis.gauges.restitution import restitution
from analysis.gauges.spectra import Spectra, SpectrumMeter
from analysis.gauges.spectra import to_csv as spectra_csv
from analysis.largest_overlap import LargestOverlap, shown_by_frames
from analysis.mirror import direction_of
from analysis.sharing.cells import CellEnergy
from analysis.sharing.energy_flow import EnergyFlow, Flow
from analysis.sharing.is_solitary import Tolerances
from analysis.sharing.survey import Survey, survey
from analysis.sound.dispersion import Dispersion, Map, NoDispersionError
from analysis.sound.dispersion import to_csv as table_of
from analysis.sound.loaded_pulse import LoadedPulse, LoadedWave
from analysis.tracking.leading_waves import Arrival, Waves, usual_arrival
from analysis.tracking.left_behind import LeftBehind
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, Problem, Scene, html, laws
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.unequal import period
from workflow.engines.reference.accountant import Accountant
from workflow.formats import figure_files, in_any_format
from workflow.runs.accounts import accountant
from workflow.runs.contacts import Contacts, has_contacts, of_overlap
from workflow.runs.files import ANALYSIS_FIGURES, REPORT
from workflow.runs.own_files import claim, retire
from workflow.runs.peaks_table import found_on_the_way
from workflow.runs.results import Fingerprint, recorded_fingerprint
from workflow.runs.run_directory import RunDirectory
from workflow.runs.whole_files import write_figure, write_json, write_text
from workflow.verdicts.analysis_report import last_clear_bead, report
from workflow.verdicts.ingredient_reports import (
    ClosedBudget,
    budget_report,
    cells_report,
    dispersion_report,
    energy_report,
    far_end_report,
    forces_report,
    sound_report,
    spectra_report,
)
from workflow.verdicts.waves_table import waves_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Analysis", "analyse", "default_beads", "last_clear_bead"]

WAVES, FORCES, SPECTRA, DISPERSION = "waves.csv", "forces.csv", "spectra.csv", "dispersion.csv"

LARGEST = 1e100
"""Displacement or velocity that no run has, far from where squares overflow; dimensionless."""


@dataclass(frozen=True, repr=False)
class Analysis:
    """What was found in a run.

    Attributes:
        survey: the waves, pulses, energies and the verdict, dimensionless.
        conservation: energy, momentum, frames seen.
        complete: whether the dump holds every frame that the scene asks for.
        figures: files drawn.
        left: what a window has left behind; None without a window.
        failure: why the run failed; empty where it did not.
        altered: whether frames or snapshots are not those that the run wrote, by the fingerprint in ``run.json``.
        contacts: the hardest contact; None without a material, and of rigid beads.
        energy: where the energy was over time, where no pulse stays together and every bead was recorded; else None.
        cells: what the pulse left behind, where beads differ and every one was recorded; else None.
        forces: what the scene's gauges read; None where it names none.
        spectra: of the beads that the scene names; None where it names none, and of too few frames.
        given_back: of the walls among them, by side: velocity of the pulse thrown back over that which came, [chain].
        sound: the leading pulse above a static load; None without one, and where it did not come far enough.
        budget: where the energy was over time, and how well that is known; None where none is exchanged, and where not
            all beads are recorded.
        bead_length: distance of neighbouring beads at rest, in m; None where there is no one such distance.
        dispersion: of small waves; why there is none, in words, where there is none.
    """

    problem: Problem
    survey: Survey
    conservation: Conservation
    complete: bool
    figures: tuple[Path, ...]
    left: LeftBehind | None
    failure: str
    altered: bool
    contacts: Contacts | None
    energy: Flow | None
    cells: CellEnergy | None
    forces: Readings | None
    spectra: Spectra | None
    given_back: dict[str, Floats]
    sound: LoadedWave | None
    dispersion: Map | str
    budget: ClosedBudget | None
    bead_length: float | None

    @property
    def waves(self) -> Waves:
        """The leading pulse at every bead, dimensionless."""
        return self.survey.waves

    @property
    def si(self) -> Waves:
        """The leading pulse at every bead, in the scene's units."""
        return self.waves.measured(self.problem.scale)

    def __repr__(self) -> str:
        return f"<analysis of {self.problem.name}: {self.survey.verdict.sentence}>"

    def _repr_html_(self) -> str:
        drawn = ", ".join(path.name for path in self.figures)
        head = ["chain", "last bead", "arrival", "peak velocity", "beads a unit of time"]
        rows = []
        for chain in np.unique(self.waves.chain).tolist():
            last = self.si.of_chain(chain).array()[-1]
            numbers = (f"{float(last[name]):.6g}" for name in ("arrival", "peak_velocity", "speed"))
            rows.append((chain, last["bead"], *numbers))
        return html.table(repr(self)[1:-1], head, rows) + html.text(drawn)


def analyse(
    directory: RunDirectory,
    *,
    beads: tuple[int, ...] | None = None,
    figures: bool = True,
    tolerances: Tolerances | None = None,
    arrival: Arrival | None = None,
) -> Analysis:
    """Analyse what a directory holds, also of a run that was cut short.

    Args:
        directory: a run directory.
        beads: whose velocity over time is drawn; by default three, see `default_beads`.
        figures: whether to draw.
        tolerances: within which a pulse is called solitary; by default 1% each.
        arrival: what counts as the arrival of a wave; by default the maximum where it is sharp, see
            `analysis.tracking.leading_waves.usual_arrival`.

    Raises:
        InputError: no frames, frames that hold what is no number, or a bead that was not recorded.
    """
    problem, allowed = directory.problem, tolerances or Tolerances()
    shown = default_beads(problem) if beads is None else beads
    for bead in shown:
        if bead not in problem.recorded_beads:
            raise InputError(f"--beads: bead {bead} is not among the recorded ones")
    if problem.every > FARTHEST * (1.0 + 1e-9):
        limit = FARTHEST * problem.scale.time
        raise InputError(
            f"{directory.path}: its frames are {problem.every * problem.scale.time:.4g} apart, too far to find waves "
            f"between them; run it with output.every at most {limit:.4g}"
        )
    ledger = accountant(directory, problem)
    conservation = Conservation(ledger.of)
    left = LeftBehind() if problem.window is not None else None
    flow = EnergyFlow(problem) if problem.whole and not problem.holds(Fact.PULSE) else None
    cells = None
    if problem.whole and not problem.alike and problem.holds(Fact.PULSE) and problem.holds(Fact.SONIC_VACUUM):
        scene = directory.scene
        cells = CellEnergy(problem, period(scene), tuple((one.chain, one.bead) for one in scene.replace or ()))
    fingerprint = Fingerprint()
    watchers: list[Any] = [conservation, fingerprint]
    meter, spectrum = _meter(directory), _spectrum_meter(directory)
    pulse = LoadedPulse(problem) if problem.loaded and problem.whole and problem.holds(Fact.PULSE) else None
    sounds = _dispersion(problem)
    watchers += [watcher for watcher in (left, flow, cells, meter, spectrum, pulse) if watcher is not None]
    watchers += [sounds] if isinstance(sounds, Dispersion) else []
    end = FarEnd(problem) if problem.whole and directory.engine != "collisions" else None
    watchers += [] if end is None else [end]
    overlap = LargestOverlap() if has_contacts(directory) else None
    if overlap is not None and shown_by_frames(problem):
        watchers.append(overlap)
    spacetime = history = None
    if figures:
        from analysis.figures import BeadHistory, SpaceTime  # matplotlib takes half a second to import

        history = BeadHistory(problem, shown)
        spacetime = SpaceTime(problem if problem.frames_per_snapshot is None else problem.snapshots())
        watchers += [history] if problem.frames_per_snapshot is not None else [history, spacetime]

    found = survey(
        lambda: _sound(directory, directory.blocks()),
        problem,
        watchers=watchers,
        tolerances=allowed,
        arrival=arrival,
        leading=found_on_the_way(directory) if arrival in (None, usual_arrival(problem)) else None,
    )
    if problem.frames_per_snapshot is not None:
        ledger = accountant(directory, problem.snapshots())
        whole = Conservation(ledger.of)
        for block in _sound(directory, directory.snapshots()):
            whole.add(block)
            fingerprint.add(block)
            if spacetime is not None:
                spacetime.add(block)
        spacetime = spacetime if whole.frames > 1 else None
        conservation.energy_drift, conservation.momentum_drift = whole.energy_drift, whole.momentum_drift
        conservation.budget = whole.budget
    energy = None if flow is None else flow.result()
    forces = None if meter is None else meter.result()
    spectra = None if spectrum is None else spectrum.result()
    sound = None if pulse is None else pulse.result()
    dispersion = _mapped(sounds)
    budget = _budget(directory, conservation, ledger)
    figures_of = _makers(found, spacetime, history, energy, forces, dispersion) if figures else {}
    if figures and spectra is not None:
        from analysis.figures import spectra_figure

        figures_of["spectra"] = lambda: spectra_figure(problem, spectra)
    if figures and budget is not None and len(budget.account.time) > 1:
        from analysis.figures import budget_figure

        figures_of["budget"] = lambda: budget_figure(problem, budget.account)
    there = ((FORCES, forces is not None), (SPECTRA, spectra is not None), (DISPERSION, isinstance(dispersion, Map)))
    tables = [WAVES, *(name for name, is_there in there if is_there)]
    files = figure_files(*figures_of)
    claim(directory.path, (*tables, REPORT, *files))
    if figures:
        retire(directory.path, set(in_any_format(*ANALYSIS_FIGURES)).difference(files))
    drawn = tuple(path for name, make in figures_of.items() for path in write_figure(directory.path, name, make()))
    write_text(directory.path / WAVES, waves_csv(found))
    if forces is not None:
        write_text(directory.path / FORCES, to_csv(forces, problem.scale))
    if isinstance(dispersion, Map):
        write_text(directory.path / DISPERSION, table_of(dispersion, problem.scale))
    if spectra is not None:
        write_text(directory.path / SPECTRA, spectra_csv(spectra, problem.scale))
    hardest = None if overlap is None else of_overlap(directory.scene, overlap)
    found_contacts = {} if hardest is None else {"contacts": hardest.plain()}
    more: dict[str, Any] = {**found_contacts, **({} if energy is None else {"energy": energy_report(problem, energy)})}
    sides = {gauge.side for gauge in forces.gauges if gauge.kind == "wall"} if forces is not None else set()
    given_back = {
        side: restitution((*found.pulses, *found.crests), problem, right=side == "right") for side in sorted(sides)
    }
    if forces is not None:
        more["forces"] = forces_report(problem, forces, given_back)
    length = bead_length(directory.scene) if problem.loaded else None
    if problem.loaded:
        more["sound"] = sound_report(problem, sound, found.crests, length)
        more["dispersion"] = dispersion_report(problem, dispersion)
    if spectra is not None:
        more["spectra"] = spectra_report(problem, spectra)
    if end is not None:
        more["far_end"] = far_end_report(problem, end)
    if cells is not None:
        more["cells"] = cells_report(problem, cells)
    if budget is not None:
        more["budget"] = budget_report(problem, budget)
    write_json(directory.path / REPORT, {**report(found, conservation, allowed, left), **more})
    complete = conservation.frames == problem.frames + 1
    altered = recorded_fingerprint(directory) not in ("", fingerprint.sha256())
    return Analysis(
        problem=problem,
        survey=found,
        conservation=conservation,
        complete=complete,
        figures=drawn,
        left=left,
        failure=directory.failure,
        altered=altered,
        contacts=hardest,
        energy=energy,
        cells=cells,
        forces=forces,
        given_back=given_back,
        sound=sound,
        dispersion=dispersion,
        budget=budget,
        bead_length=length,
        spectra=spectra,
    )


def _budget(directory: RunDirectory, seen: Conservation, ledger: Accountant) -> ClosedBudget | None:
    if seen.budget is None:
        return None
    account = seen.budget.result()
    try:
        record = directory.record
    except InputError:
        record = {}
    stated = (record.get("check") or record.get("certificate") or {}).get("velocity")
    return ClosedBudget(account, seen.energy_drift, ledger.unsure / account.most, stated)


def _dispersion(problem: Problem) -> Dispersion | str:
    """What collects the dispersion of a run, or why nothing does."""
    try:
        return Dispersion(problem)
    except NoDispersionError as why:
        return str(why)


def _mapped(sounds: Dispersion | str) -> Map | str:
    if isinstance(sounds, str):
        return sounds
    try:
        return sounds.result()
    except NoDispersionError as why:
        return str(why)


def bead_length(scene: Scene) -> float | None:
    """Distance of neighbouring beads at rest, in m; None without a material, and where it is not one."""
    system = scene.system
    if scene.material is None or not (system.one_kind and system.even):
        return None
    return 2.0 * scene.material.radius - float(laws.rest(system.along[0].law)) * scene.scale.length


def _meter(directory: RunDirectory) -> ForceMeter | None:
    """What reads the forces that the scene names; None where it names none, and for rigid beads."""
    wanted, problem = directory.scene.output.forces, directory.problem
    if wanted is None or directory.engine == "collisions":
        return None
    places = gauges(problem, wall=wanted.wall is True, contacts=wanted.contacts or (), sensors=wanted.sensors or ())
    return ForceMeter(problem, places)


def _spectrum_meter(directory: RunDirectory) -> SpectrumMeter | None:
    """What collects the spectra that the scene names; None where it names none."""
    wanted, problem = directory.scene.output.spectra, directory.problem
    if wanted is None:
        return None
    return SpectrumMeter(problem, wanted.beads, None if wanted.after is None else wanted.after / problem.scale.time)


def _sound(directory: RunDirectory, blocks: Iterator[Trajectory]) -> Iterator[Trajectory]:
    """Blocks of numbers that can be computed with.

    Without a warning of a cut frame at their end: that the run is incomplete is said in words.

    Raises:
        InputError: one is not finite, or so large that its square is not.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)
        for block in blocks:
            for name, values in (("displacement", block.displacement), ("velocity", block.velocity)):
                size = max(float(values.max()), -float(values.min()))  # NaN comes through
                if not size < LARGEST:
                    frame, chain, bead = (int(k[0]) for k in np.nonzero(~(np.abs(values) < LARGEST)))
                    raise InputError(
                        f"{directory.path}: the {name} of bead {block.beads[bead]} of chain {chain + 1} is "
                        f"{values[frame, chain, bead]:.3g} at t = {block.time[frame] * block.problem.scale.time:.6g}; "
                        f"{directory.failure or 'the frames are damaged, or the run went wrong: run it again'}"
                    )
            yield block


def default_beads(problem: Problem) -> tuple[int, ...]:
    """Three recorded beads: near a sixth, a half and nine tenths of the way, or near that hit, where no pulse runs."""
    recorded = problem.recorded_beads
    if not problem.holds(Fact.PULSE):
        hit = problem.hardest_blow[1]
        way = 1 if direction_of(problem) > 0 else -1
        return tuple(sorted({int(recorded[np.argmin(np.abs(recorded - hit - way * far))]) for far in (0, 2, 5)}))
    places = np.unique(np.round(np.array([0.17, 0.5, 0.9]) * (len(recorded) - 1)).astype(int))
    return tuple(int(recorded[place]) for place in places)


def _makers(
    found: Survey, spacetime: Any, history: Any, energy: Flow | None, forces: Readings | None, dispersion: Map | str
) -> "dict[str, Callable[[], Figure]]":
    """Name -> what draws the figure; those that there is something to show in."""
    from analysis.figures import (
        dispersion_figure,
        distance_figure,
        energy_figure,
        force_figure,
        response_figure,
        shape_figure,
        spacetime_figure,
    )

    problem = found.problem
    makers: dict[str, Callable[[], Figure]] = {"response": lambda: response_figure(history)}
    if spacetime is not None and len(spacetime.beads) > 1:
        makers["spacetime"] = lambda: spacetime_figure(spacetime)
    if energy is not None:
        makers["energy"] = lambda: energy_figure(problem, energy)
    if forces is not None:
        makers["forces"] = lambda: force_figure(problem, forces)
    if isinstance(dispersion, Map):
        makers["dispersion"] = lambda: dispersion_figure(problem, dispersion)
    if len(found.shared) > 1 and problem.holds(Fact.PULSE):
        makers["distance"] = lambda: distance_figure(problem, found.shared, found.energies, found.direction)
    whole = np.unique(found.waves.bead[np.isfinite(found.shape.residual)])
    whole = whole[whole <= problem.beads - 5]
    if len(whole) and problem.holds(Fact.PULSE) and problem.holds(Fact.SONIC_VACUUM) and not problem.gap:
        early, late = whole[min(len(whole) - 1, int(np.searchsorted(whole, 10)))], whole[-1]
        makers["shape"] = lambda: shape_figure(problem, found.waveforms, sorted({int(early), int(late)}))
    return makers
