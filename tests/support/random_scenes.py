"""Random accepted scenes through LAMMPS, every number and sentence against a computation that shares no code.

As a script, from the root of the repository: ``python tests/support/random_scenes.py COUNT [SEED] [FROM]``, some
seconds of one core a scene; ``SEED-NUMBER`` in place of COUNT is that scene alone, ``installed`` are the installed
ones, and names of them are those. Compared are: the frames with the integrator here, every key of ``analysis.json``,
every column of every table, and what `run` and `analyze` print. What differs by more than the run itself states is
wrong, and what nobody computes is not checked: exit code 1.

| file            | what                                                                        |
|-----------------|-----------------------------------------------------------------------------|
| scene_draws     | the random scenes                                                           |
| scene_keys, scenes_nature | forces and energies straight from a scene's keys                  |
| truth           | the motion, by scipy's DOP853                                               |
| own_frames      | a run directory as an outsider reads it                                     |
| comparing       | trees of expectations, leaf by leaf                                         |
| check_*         | the expectations, a topic a file                                            |
"""

import contextlib
import io
import os
import random
import re
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import check_cells
import check_ends
import check_energy
import check_forces
import check_printed
import check_pulses
import check_sharing
import check_sound
import check_waves
import lammps_here
import numpy as np
from case import FLOOR, Case
from comparing import Tally
from own_frames import Directory
from scene_draws import draw, draw_any

from lammps_inputs import InputError, Scene, library
from workflow import cli
from workflow.commands.run import _tell
from workflow.engines.lammps import mpi
from workflow.errors import RunError
from workflow.prepare.settings import settle
from workflow.runs.check import LITTLE
from workflow.runs.resume import resume
from workflow.runs.run import Run, run

__all__ = ["draw", "judge"]

TOPICS = (check_energy, check_forces, check_sound, check_ends, check_waves, check_pulses, check_cells, check_sharing)


@dataclass(frozen=True)
class Judgement:
    """What came of a scene.

    Attributes:
        verdict: ``right``, ``stated`` (off by no more than the run itself states), ``unknown`` (the integrator here does
            not know it itself), ``stopped`` (the run ended with an error), ``refused`` or ``WRONG``.
        reason: why.
        tally: what was compared.
    """  # noqa: E501

    verdict: str
    reason: str
    tally: Tally = field(default_factory=Tally)


def judge(scene: Scene, directory: Path, *, ranks: int = 1, cut: bool = False) -> Judgement:
    """Run a scene and compare everything."""
    try:
        result = _run(scene, directory, ranks, cut=cut)
    except RunError as error:
        return Judgement("stopped", str(error))
    if isinstance(result, str):
        return Judgement("WRONG", result)
    printed = {"run": _printed(lambda: _tell(result, None)), "analyze": _analysed(directory)}
    found = compared(directory, printed, 1e-9)
    if found.verdict == "WRONG":
        found = compared(directory, printed, 1e-12)
    if found.verdict == "WRONG" and (apart := _apart(directory)) > FLOOR:
        return Judgement("unknown", f"two integrations here are {apart:.1e} V apart; {found.reason}", found.tally)
    return found


def compared(directory: Path, printed: dict[str, str], rtol: float) -> Judgement:
    """A run directory that was analysed against the true motion."""
    case, tally = Case(Directory(directory), rtol, printed), Tally()
    _velocities(case, tally)
    if not tally.wrong:
        tally.compare("analysis.json", case.report, {k: v for topic in TOPICS for k, v in topic.expected(case).items()})
        for name, expected in tables(case).items():
            tally.compare(name, case.directory.table(name), expected)
        check_waves.claims(case, tally)
        check_printed.check(case, tally)
        for path in directory.glob("*.csv"):
            if path.name not in tables(case):
                tally.unchecked[path.name] += 1
    off, stated = case.off[1], case.stated.velocity
    if tally.wrong:
        return Judgement("WRONG", "\n  ".join([f"off by {off:.1e} V", *tally.wrong[:12]]), tally)
    return Judgement("right" if off <= FLOOR else "stated", f"off by {off:.1e} V, stated {stated:.1e}", tally)


def tables(case: Case) -> dict[str, object]:
    """Of all CSV tables that there are to be."""
    names = ["waves.csv", *(["peaks.csv"] if case.scene.output.peaks else [])]
    waves = {name: check_waves.table(case, name) for name in names}
    return {**waves, **check_forces.tables(case), **check_sound.tables(case)}


def _velocities(case: Case, tally: Tally) -> None:
    """All frames are there, and as right as the run says."""
    values = len(case.frames) * case.scene.chains * len(case.directory.recorded)
    between = 1.1 if values > LITTLE else 1.0  # the run compares only some of its frames
    off, stated = case.off[1], max(FLOOR, between * case.stated.velocity)
    wanted = set(range(0, case.directory.record["steps"] + 1, case.directory.steps_per_frame))
    tally.claim("every frame is there", holds=set(case.frames.steps.tolist()) == wanted)
    tally.numbers["velocities of frames"] += int(np.isfinite(case.frames.v).sum())
    tally.claim("velocities are as right as stated", holds=off <= stated, what=f"{off:.1e} V, stated {stated:.1e}")


def _run(scene: Scene, directory: Path, ranks: int, *, cut: bool) -> Run | str:
    """The run, done; or what is wrong with how it was resumed. One rank in this process; what is cut is begun on one."""  # noqa: E501
    if not cut:
        return run(scene, directory, ranks=ranks, lammps=lammps_here.run)
    result = run(scene, directory, lammps=lammps_here.interrupted_after(0))
    if result.outcome == "done":
        # the first report comes after 200 steps, and the run is cut at the next, after 600
        return result if result.directory.problem.steps < 700 else "a run that was to be cut was not"
    again = resume(directory, ranks=ranks, lammps=lammps_here.run)
    if again is None or not result.directory.job.resumed[-1].from_step > 0:
        return "a run that was cut was not resumed from where it was"
    return again


def _printed(what: object) -> str:
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        what()  # type: ignore[operator]
    return text.getvalue()


def _analysed(directory: Path) -> str:
    where = Path.cwd()
    try:
        return _printed(lambda: cli.main(["analyze", str(directory), "--no-figures"]))
    finally:
        os.chdir(where)


def _apart(directory: Path) -> float:
    """How far two integrations of this module's own are apart: where chaos reigns, neither is the truth."""
    one, other = (Case(Directory(directory), rtol).truth for rtol in (1e-12, 2e-12))
    return float(np.max(np.abs(one.fine[1] - other.fine[1])))


# --- many -------------------------------------------------------------------------------------------------------------


def drawn(name: str) -> tuple[Scene, int, bool]:
    """The scene of a name, SEED-NUMBER; on how many ranks it is run, and whether it is cut and resumed."""
    chance, scene = random.Random(name), None
    while scene is None:
        with contextlib.suppress(ValueError):
            scene = draw_any(chance, name)
    ranks = chance.choice([1, 1, 1, 1, 1, min(2, mpi.cores(), scene.beads)])
    return scene, ranks, chance.random() < 0.2


def one(name: str) -> tuple[Judgement, str]:
    """What came of a scene by its name, and how it was run."""
    if re.fullmatch(r"\d+-\d+", name):
        scene, ranks, cut = drawn(name)
    else:
        scene, ranks, cut = settle(library.find(name), source=name, force=False)[0], 1, False
    with tempfile.TemporaryDirectory() as place:
        try:
            found = judge(scene, Path(place) / "run", ranks=ranks, cut=cut)
        except InputError as error:
            found = Judgement("refused", str(error))
    return found, f"{scene.name} on {ranks}{', cut' * cut}: {kinds_of(scene)}"


def kinds_of(scene: Scene) -> str:
    """What a scene has of what not every one has."""
    keys = scene.plain().keys() - {"name", "description", "chains", "beads", "kick", "duration", "output", "timestep"}
    output = scene.plain().get("output", {}).keys() - {"every", "beads"}
    return " ".join(sorted({*keys, *output, *(["both ways"] if len({k.velocity > 0 for k in scene.kick}) > 1 else [])}))


def main(arguments: list[str]) -> int:
    """Judge scenes one after the other; print what is not right, and what was compared."""
    count, seed, begin, *_ = [*arguments, *["1", "1"][len(arguments) - 1 :]]
    names = arguments
    if count.isdigit():
        names = [f"{seed}-{k}" for k in range(int(begin), int(begin) + int(count))]
    elif count == "installed":
        names = list(library.installed())
    verdicts: dict[str, int] = {}
    kinds: dict[str, int] = {}
    whole = Tally()
    for number, name in enumerate(names, 1):
        try:
            found, how = one(name)
        except Exception as error:
            found, how = Judgement("WRONG", f"{type(error).__name__}: {error}"), name
            if len(names) == 1:
                raise
        verdicts[found.verdict] = verdicts.get(found.verdict, 0) + 1
        for kind in how.partition(": ")[2].split():
            kinds[kind] = kinds.get(kind, 0) + 1
        whole.add(found.tally)
        if found.verdict not in ("right", "stated") or found.tally.unchecked:
            missing = f"; not checked: {', '.join(sorted(found.tally.unchecked))}" if found.tally.unchecked else ""
            print(f"{found.verdict}: {how}: {found.reason}{missing}", flush=True)
        if number % 10 == 0 or number == len(names):
            print(f"{number}: {verdicts}, {sum(whole.numbers.values())} numbers", flush=True)
    for title, counts in (("numbers", whole.numbers), ("sentences", whole.sentences), ("unknown", whole.unknown)):
        print(f"{title}: {sum(counts.values())}", *(f"  {n} {kind}" for kind, n in counts.most_common()), sep="\n")
    print(f"scenes: {verdicts}", f"of: {kinds}", f"not checked: {dict(whole.unchecked)}", sep="\n")
    return 1 if verdicts.get("WRONG") or verdicts.get("stopped") or whole.unchecked else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
