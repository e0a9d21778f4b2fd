"""Run a scene with several engines and compare the results, such as rigid and Hertzian beads.

Each engine's run has a directory of its name; ``compare.json`` and a figure are beside them.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis import motion
from analysis.files import events
from analysis.sharing.impulses import ImpulseMeter, Impulses, from_events, relative_difference
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, Problem, Scene, file_names, library, physics, strict_yaml
from workflow.engines.reference import engine as reference
from workflow.errors import RunError
from workflow.formats import figure_files
from workflow.prepare.settings import refuse_unstable, settle
from workflow.runs.engines import ENGINES, LAMMPS, REFERENCE, RIGID, engine_called
from workflow.runs.files import EVENTS, as_json
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Answer, count_bar, one_line, print_table
from workflow.studies.options import add_output
from workflow.studies.study import Study, kept_run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# --- numbers ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Result:
    """What one engine found, dimensionless.

    Attributes:
        engine: its name.
        impulses: of the contacts of every row.
        peak: largest velocity of each shown row, [chain, shown row].
        time, velocity: of the shown rows, [frame] and [frame, chain, shown row].
        energy_share: share of each chain's motion and contacts at the end, then of the springs, [chain + 1].
        seconds: wall time of the computation alone.
    """

    engine: str
    impulses: Impulses
    peak: Floats
    time: Floats
    velocity: Floats
    energy_share: Floats
    seconds: float

    def plain(self) -> dict[str, Any]:
        """For ``compare.json``."""
        impulses = self.impulses
        return {
            "seconds": self.seconds,
            "energy_share": self.energy_share.tolist(),
            "peak": self.peak.tolist(),
            "first_impulse": impulses.first.tolist(),
            "impulse": impulses.whole.tolist(),
            "contacts": impulses.contacts.tolist(),
            "first_time": impulses.time.tolist(),
            "imbalance": impulses.imbalance,
        }


def measure(directory: RunDirectory, rows: Sequence[int]) -> Result:
    """What the finished run in a directory found, in one pass over its frames."""
    problem, job = directory.problem, directory.job
    meter, finder = ImpulseMeter(problem), PeakFinder()
    place = [int(np.flatnonzero(problem.recorded_beads == row)[0]) for row in rows]
    times, velocities, last = [], [], None
    for block in directory.blocks():
        times.append(block.time)
        velocities.append(block.velocity[:, :, place].copy())
        if ENGINES[directory.engine].deforms:
            meter.add(block)
            finder.add(block)
        last = block[-1:]
    if last is None:
        raise RunError(f"{directory.path}: holds no frames")
    time, velocity = np.concatenate(times), np.concatenate(velocities)
    if ENGINES[directory.engine].deforms:
        impulses, waves = meter.result(), finder.result()
        bead, chain, peaks = waves.bead, waves.chain, waves.velocity
    else:
        table = events.from_csv(directory.path / EVENTS, problem.scale)
        impulses = from_events(problem, table)
        bead, chain, peaks = table.row + 1, table.chain, table.striker
    peak = velocity.max(axis=0)
    for k, row in enumerate(rows):
        np.maximum.at(peak[:, k], chain[bead == row] - 1, peaks[bead == row])
    return Result(directory.engine, impulses, peak, time, velocity, energy_shares(last), job.engine_seconds)


def energy_shares(state: Trajectory) -> Floats:
    """Of a frame: of each chain's motion and contacts, and, last, of the springs."""
    system, x, v = state.system_at(-1), state.displacement[-1], state.velocity[-1]
    of_chain = np.sum(motion.kinetic_energy(system, v), axis=-1) + np.sum(motion.contact_energy(system, x), axis=-1)
    whole = float(motion.energy(system, x, v))
    return np.append(of_chain, whole - of_chain.sum()) / whole


def last_row(results: Sequence[Result]) -> int:
    """Last bead, before the last five, that got an impulse in every engine."""
    passed = np.all([np.any(result.impulses.whole > 0.0, axis=0) for result in results], axis=0)
    if len(passed) > 10:
        passed[-5:] = False  # the free end
    reached = len(passed) if passed.all() else int(np.argmin(passed))
    return int(results[0].impulses.bead[reached - 1]) if reached else 1


# --- words ------------------------------------------------------------------------------------------------------------

KEPT = 0.1
"""Relative difference up to which the cheap model is said to keep a quantity."""


def unevenness(impulses: Impulses, last: int) -> float:
    """How unequal the chains are on the last quarter of the way: median of (largest - smallest) / mean, or NaN."""
    rows = (impulses.bead <= last) & (impulses.bead > 0.75 * last)
    values = relative_difference(impulses.first[:, rows])
    return float(np.nanmedian(values)) if np.isfinite(values).any() else math.nan


def kept_to(one: Impulses, other: Impulses, last: int) -> int:
    """Last bead up to which every first impulse agrees within `KEPT` of the row's largest; 1 if not even bead 2."""
    rows = other.bead <= last
    scale = other.first[:, rows].max(axis=0)
    agree = np.all(np.abs(one.first[:, rows] - other.first[:, rows]) <= KEPT * scale, axis=0)
    return last if agree.all() else int(other.bead[int(np.argmin(agree))]) - 1


def arrival(impulses: Impulses, bead: int) -> float:
    """Time of the first impulse in a row, the earliest of its chains, in units of T; NaN without any."""
    times = impulses.time[:, impulses.row(bead)]
    return float(np.nanmin(times)) if np.isfinite(times).any() else math.nan


def answer(results: Sequence[Result], last: int) -> tuple[str, ...]:
    """What the numbers say, in sentences."""
    by_name = {result.engine: result for result in results}
    sentences = []
    if {"lammps", "reference"} <= set(by_name):
        one, other = by_name["lammps"], by_name["reference"]
        rows = one.impulses.bead <= last
        impulse = np.abs(one.impulses.first - other.impulses.first)[:, rows].max(initial=0.0)
        late = np.abs(one.impulses.time - other.impulses.time)[:, rows]
        moved = float(np.nanmax(late)) if np.isfinite(late).any() else 0.0
        sentences.append(
            f"LAMMPS and the reference agree on first impulses to {impulse:.1e} m V, on their times to {moved:.1e} T."
        )
    hertz = by_name.get("reference") or by_name.get("lammps")
    if RIGID.name in by_name and hertz is not None:
        sentences += _rigid_against(by_name[RIGID.name], hertz, last)
    return tuple(sentences)


def _rigid_against(rigid: Result, hertz: Result, last: int) -> list[str]:
    if last < 2:
        return ["No row received an impulse in both models, so nothing can be compared; give a longer duration."]
    kept, lost = [], []
    one, other = rigid.impulses, hertz.impulses
    until = kept_to(one, other, last)
    if until >= 2:
        kept.append(f"the first impulses of beads 2 to {until}")
    if until < last:
        lost.append(f"those from bead {until + 1} on" if until >= 2 else "the first impulses, from bead 2 on")
    row = other.row(last)
    for name, a, b in (
        (f"the arrival at bead {last}", arrival(one, last), arrival(other, last)),
        (f"the momentum passed to bead {last}", one.whole[:, row].sum(), other.whole[:, row].sum()),
    ):
        difference = (a - b) / b
        (kept if abs(difference) <= KEPT else lost).append(f"{name} ({100.0 * difference:+.3g} %)")
    farthest = int(other.bead[np.flatnonzero(other.whole.any(axis=0))[-1]])
    reached = int(one.bead[np.flatnonzero(one.whole.any(axis=0))[-1]])
    if reached < farthest - 5:
        lost.append(
            f"the pulse itself, which has not passed bead {reached} when it is at bead {farthest} in Hertz beads"
        )
    sentences = []
    if kept:
        sentences.append(f"Rigid beads reproduce, within {100.0 * KEPT:.0f} %: {'; '.join(kept)}.")
    if lost:
        sentences.append(f"{'They' if kept else 'Rigid beads'} do not reproduce: {'; '.join(lost)}.")
    if len(one.first) > 1:
        a, b = unevenness(one, last), unevenness(other, last)
        if math.isfinite(a) and math.isfinite(b):
            verdict = "the same" if abs(a - b) <= KEPT else "not the same"
            sentences.append(
                f"Energy exchange between chains is {verdict}: on the last quarter of the way to bead {last} the "
                f"chains' impulses differ by {_percent(a)} of their mean in rigid, by {_percent(b)} in Hertz beads."
            )
    ratio = hertz.seconds / rigid.seconds if rigid.seconds > 0.0 else math.inf
    sentences.append(
        f"Rigid beads took {rigid.seconds:.2g} s, {hertz.engine} {hertz.seconds:.2g} s: {ratio:.3g} times as long."
    )
    return sentences


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %" if share >= 1e-4 else "less than 0.01 %"


# --- report -----------------------------------------------------------------------------------------------------------

REPORT, FIGURE = "compare.json", "compare"
STUDY = Study(
    "compare",
    f"{REPORT} holds what was found, and each engine's run has a directory in it",
    tables=(file_names.SCENE, REPORT),
    figures=(FIGURE,),
)


@dataclass(frozen=True)
class Comparison:
    """Several engines' results of one scene.

    Attributes:
        rows: numbers of the beads that are shown.
        last: last bead up to which every engine passed an impulse on; 1 if none did.
        answer: sentences that say what was found.
    """

    problem: Problem
    results: tuple[Result, ...]
    rows: tuple[int, ...]
    last: int
    answer: tuple[str, ...]

    def plain(self) -> dict[str, Any]:
        """The contents of ``compare.json``, dimensionless (times in T, impulses in m V; ``scale`` has the units).

        | key       | what                                                                               |
        |-----------|------------------------------------------------------------------------------------|
        | answer    | sentences                                                                          |
        | last_bead | up to which every engine passed an impulse on                                      |
        | beads     | receiving bead of each row of the arrays below                                      |
        | engines   | per engine: first_impulse, impulse, contacts, first_time [chain][row]; imbalance;  |
        |           | peak [chain][shown]; energy_share (last: springs); seconds                         |
        """
        problem, scale = self.problem, self.problem.scale
        kappa, gap = physics.kappa(problem.system), physics.gap(problem.system)
        return {
            "scene": problem.name,
            "kappa": kappa,
            "gap": gap,
            "theta": math.sqrt(2.0 * kappa) * gap,
            "duration": problem.duration,
            "scale": {name: getattr(scale, name) for name in ("mass", "length", "time", "velocity")},
            "answer": list(self.answer),
            "last_bead": self.last,
            "shown": list(self.rows),
            "beads": self.results[0].impulses.bead.tolist(),
            "engines": {result.engine: result.plain() for result in self.results},
        }

    def tables(self) -> list[tuple[str, list[str], list[list[str]]]]:
        """Title, head and rows of the printed tables: of the shown rows by engine, and of the shares."""
        problem, scale = self.problem, self.problem.scale
        rows = []
        for k, bead in enumerate(self.rows):
            for result in self.results:
                of, place = result.impulses, result.impulses.row(bead)
                cells = ["no impulse", "", "", ""]
                if (of.whole[:, place] > 0.0).any():
                    time = f"{arrival(of, bead) * scale.time:.6g}"
                    cells = [time, *map(_list, (of.first[:, place], of.whole[:, place], result.peak[:, k]))]
                rows.append([str(bead) if result is self.results[0] else "", result.engine, *cells])
        time = scale.heading("first impulse at", "time")
        head = ["bead", "engine", time, "first impulse / mV", "all impulses / mV", "peak velocity / V"]
        shares = []
        for result in self.results:
            of, energy = result.impulses, result.energy_share
            passed = _list(of.whole[:, of.row(self.last)]) if self.last >= 2 else ""
            numbers = [_list(energy[:-1]), f"{energy[-1]:.4f}", f"{result.seconds:.2g}"]
            shares.append([result.engine, passed, *numbers])
        passed = f"passed to bead {self.last} by chain / mV"
        own = ["engine", passed, "final energy by chain", "in springs", "computing (s)"]
        until = scale.written(problem.duration, "time")
        return [(f"{problem.name}: rows, chains 1, 2, ...", head, rows), (f"shares until t = {until}", own, shares)]


def _list(values: Floats) -> str:
    shown = "  ".join(f"{value:.4f}" for value in values[:4])
    return f"{shown} ..." if len(values) > 4 else shown


def _figure(found: Comparison) -> "Figure":
    from analysis.figures.engines import Curve, engines_figure  # matplotlib takes half a second to import

    curves = [
        Curve(result.engine, result.time, result.velocity, result.impulses.bead, result.impulses.first)
        for result in found.results
    ]
    return engines_figure(found.problem, found.rows, curves)


# --- runs -------------------------------------------------------------------------------------------------------------

MOST_SHOWN = 7


def engines_for(scene: Scene, asked: Sequence[str] | None) -> tuple[str, ...]:
    """The engines to run: those asked for, or all that can do the scene.

    Raises:
        InputError: an engine that does not exist, is named twice, or cannot do what the scene names.
    """
    if asked is None:
        return tuple(engine.name for engine in (RIGID, REFERENCE, LAMMPS) if not engine.refusal(scene))
    for name in asked:
        if refusal := engine_called(name, "--engines").refusal(scene):
            raise InputError(f"--engines: {refusal}")
    if len(set(asked)) < len(asked):
        raise InputError("--engines: one is named twice")
    return tuple(asked)


def compare(scene: Scene, directory: Path, engines: Sequence[str] | None = None) -> Comparison:
    """Run a scene with each engine in a directory of its own, and write what they found beside.

    Args:
        scene: what to compute; every bead is recorded.
        directory: made if need be; runs of the same scene in it are kept.
        engines: of `workflow.runs.engines.ENGINES`; by default all that can do the scene.

    Raises:
        InputError: the directory or an engine cannot be used.
        RunError: a run failed.
    """
    if scene.window is not None:
        raise InputError("window: only lammps follows the pulse with one; leave it out to compare engines")
    names = engines_for(scene, engines)
    whole = {"beads": "all", "snapshots": None, "peaks": None}
    scene = scene.model_copy(update={"output": scene.output.model_copy(update=whole)})
    scene, settings = settle(scene, source=scene.name, own_step=LAMMPS.name in names)
    problem = scene.problem()
    rows, results = shown_rows(problem), []
    text = strict_yaml.dump(scene.resolved().plain())
    study = replace(STUDY, others=tuple(ENGINES))
    reference.load()  # compiled before any clock runs
    accurate = settings and replace(settings, asked=True)  # what LAMMPS is compared with has a smaller error
    with study.opened(directory), count_bar("compare") as progress:
        path = directory / file_names.SCENE
        if path.is_file() and path.read_text(encoding="utf-8") != text:
            raise InputError(f"{path}: is another scene than the one to compare; choose another -o")
        study.write(directory, {file_names.SCENE: text})
        for count, name in enumerate(names):  # one at a time, for each is timed
            progress(count, len(names))
            own = accurate if name == REFERENCE.name else settings
            results.append(measure(kept_run(scene, name, directory / name, own), rows))
        last = last_row(results)
        found = Comparison(problem, tuple(results), rows, last, answer(results, last))
        study.write(directory, {REPORT: as_json(found.plain()) + "\n"}, {FIGURE: _figure(found)})
    return found


def shown_rows(problem: Problem) -> tuple[int, ...]:
    """Beads whose numbers and velocities are shown: near the start, then ever farther apart."""
    last = max(2, problem.beads - 5)
    wanted = [row for row in (2, 5, 10, 25, 50, 100) if row < last]
    if last > 200:
        wanted += np.geomspace(100, last, 3).round().astype(int).tolist()[1:-1]
    return (*wanted, last)[-MOST_SHOWN:]


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "what compare.json holds"
DRAWS = True
EXAMPLES = (
    "compare two-chains-gapped -o compared",
    "compare my/gapped.yaml -o compared --engines collisions,reference",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, where to, and with what."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    add_output(parser)
    parser.add_argument(
        "--engines", metavar="NAME,NAME", help=f"of {', '.join(ENGINES)} (default all that can do the scene)"
    )


def execute(arguments: argparse.Namespace) -> Answer:
    """Print tables and an answer; write compare.json, a figure, and each engine's run directory."""
    scene = library.find(arguments.scene)
    engines = None if arguments.engines is None else tuple(arguments.engines.split(","))
    if "lammps" in engines_for(scene, engines):
        refuse_unstable(scene, arguments.scene)
    found = compare(scene, arguments.output, engines)
    system = found.problem.system
    if physics.gap(system) and physics.coupled(system):
        from workflow.engines.collisions import modes  # numba takes a third of a second to import

        print(f"theta = omega D / V = {modes.theta(found.problem):.5g} (eq. 5: {modes.THETA_OF_EQ_5:.5g})")
    for table in found.tables():
        print_table(*table)
    for sentence in found.answer:
        print(sentence)
    files = [REPORT, *figure_files(FIGURE), *(f"{result.engine}/" for result in found.results)]
    print(f"{one_line(arguments.output)}: {', '.join(files)}")
    return Answer(0, found.plain())
