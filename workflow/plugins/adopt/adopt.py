"""From a user's deck to a scene: executed, measured, written down, and run beside the deck."""

import re
import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from granchain import InputError, RunError, Scene
from granchain.parts import BinaryDump, file_names, library, scene_files
from workflow.plugins.adopt import differences, evaluate
from workflow.plugins.adopt.chains import TIME, Measured, NotMeasuredError
from workflow.plugins.adopt.deck_text import FIXES_WITHOUT_EFFECT, WITHOUT_EFFECT, Command, Deck, damped_wall, words_of
from workflow.plugins.adopt.evaluate import Executed, Workplace
from workflow.plugins.adopt.measure import START
from workflow.plugins.adopt.motions import RECORDED, GivenMotion
from workflow.plugins.adopt.scene_of import SceneKeys
from workflow.plugins.adopt.walls_at_gap import with_other_walls

BEAD_STEPS = 10_000_000
"""Length of the run beside the deck: some seconds of each."""

FRAMES = 200
"""Frames that are compared."""

AGREE = 1e-4
"""Difference of velocities, in V, above which a scene is not that of the deck: half of the default accuracy."""

AFTER_RUN = ("compute", "group", "if", "jump", "label", "next", "quit", "run", "uncompute", "variable")
"""Commands after the first run that change nothing that moves the beads."""


UNIT_NAMES = {"cgs": ("cm", "s", "g"), "micro": ("um", "us", "pg"), "nano": ("nm", "ns", "ag")}
"""LAMMPS's other units in which forces are masses times lengths over times squared: length, time, mass."""


class RefusedDeckError(InputError):
    """Commands of a deck that no scene can have; `lines` has one message for each."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__(lines[0])
        self.lines = lines


@dataclass(frozen=True)
class Adopted:
    """A scene from a deck, and how far its deck is from the user's.

    Attributes:
        scene: the scene.
        axis: axis along which the chains lie in the deck, ``x``, ``y`` or ``z``.
        notes: what was left out or chosen.
        steps: steps that were compared.
        of: steps of the run.
        difference: largest difference of the beads' velocities, in V.
    """

    scene: Scene
    axis: str
    notes: list[str]
    steps: int
    of: int
    difference: float


def adopt(path: Path, data: Path | None, variables: list[tuple[str, str]], seconds: float) -> Adopted:
    """Read a deck into a scene.

    Args:
        path: the deck.
        data: data file that replaces the one of the same name beside the deck; None for that one.
        variables: names and values of LAMMPS variables, as by ``lmp -var``.
        seconds: wall time after which LAMMPS is ended.

    Raises:
        RefusedDeckError: commands that no scene can have.
        InputError: LAMMPS does not execute the deck, or it has no run.
        RunError: the scene's deck moves otherwise than the user's.
    """
    if data is not None and not data.is_file():
        raise InputError(f"{data}: no such file")
    deck = Deck(path)
    with Workplace(deck, data, variables, seconds).opened() as workplace:
        executed = workplace.execute("through", "run 0 post no\n")
        refuse(executed, path)
        first = _first_run(executed)
        steps = _steps(executed, path, first)
        try:
            measured = _measured(workplace, executed, path, first, steps)
            scene, keys, compared, difference = _nearest(workplace, measured, executed, path, first, steps)
        except NotMeasuredError as error:
            raise RefusedDeckError(_at_lines(error, executed, path)) from None
    if not difference <= AGREE + drag_error(scene):
        _refuse_other_motion(keys.measured, scene, executed, path, f"over {compared} steps by {difference:.2g} V")
    notes = [*keys.notes, *differences.unreached(keys.measured), *_of_run(executed, first), *_notes(executed)]
    return Adopted(scene, "xyz"[keys.measured.axis], notes, compared, steps, difference)


def _measured(workplace: Workplace, executed: Executed, path: Path, first: int, steps: int) -> Measured:
    """What LAMMPS says of the beads at the run with which the scene begins, and of their given motions.

    Raises:
        NotMeasuredError: no scene is like it.
        InputError: LAMMPS does not execute the deck.
    """
    moves = " ".join(
        " ".join(words_of(command.text)[1:3]) for command in executed.commands if command.style == "fix move"
    )
    relaxed = first > 0 or any(command.style == "minimize" for command in executed.commands[: executed.runs[first][0]])
    names = f'variable {START} string "{relaxed:d} {moves}"\n'
    evaluate.refuse_error(workplace.execute("measure", f"{names}{evaluate.STOP}\n", first), path)
    measured: Measured | NotMeasuredError = evaluate.measured(workplace, "measure")
    if isinstance(measured, NotMeasuredError):
        raise measured
    if not np.any(measured.driven):
        return measured
    return _with_motions(workplace, measured, executed, first, steps)


def _with_motions(workplace: Workplace, measured: Measured, executed: Executed, first: int, steps: int) -> Measured:
    """Record the motions of driven beads, in a run without the others; those that do not move are held.

    The record is longer than the run, as a bead with a table is at rest behind its last point.
    """
    driven = np.argwhere(measured.driven)
    ids = measured.ids[measured.driven]
    every = max(1, steps // RECORDED)
    frames = workplace.folder / "motions.bin"
    bonds = " bond yes" if any("bond" in words_of(c.text) for c in executed.commands if c.style == "atom_style") else ""
    run = (
        f"group granchain_driven id {' '.join(map(str, ids))}\n"
        "group granchain_others subtract all granchain_driven\n"
        f"delete_atoms group granchain_others{bonds}\nneighbor {np.min(measured.radius):.6g} nsq\n"
        f"{_dumped('granchain_driven', frames, 'id x y z', measured.first_step, every, steps + every)}quit 0\n"
    )
    recorded = workplace.execute("motions", run, first)
    if recorded.error:
        raise InputError(f"{recorded.commands[-1].place}: {evaluate.explained(recorded.error)}")
    places = BinaryDump(frames).read(columns=("x", "y", "z"))
    if np.any(np.ptp(np.delete(places, measured.axis, axis=1), axis=0)):
        raise NotMeasuredError("a bead is moved across its chain; supported: motions along it", "fix move")
    moved = places[:, measured.axis]
    time = measured.timestep * every * np.arange(len(moved))
    motions, held = {}, measured.held.copy()
    for (chain, bead), atom in zip(driven.tolist(), ids.tolist(), strict=True):
        path_of_bead = moved[:, int(np.searchsorted(np.sort(ids), atom))]
        motion = GivenMotion(
            np.asarray(time, dtype=np.float64), np.asarray(path_of_bead - path_of_bead[0], dtype=np.float64)
        )
        if motion.none:
            held[chain, bead] = True
        else:
            motions[chain, bead] = motion
    return replace(measured, held=held, driven=measured.driven & ~held, motions=motions)


def _nearest(
    workplace: Workplace, measured: Measured, executed: Executed, path: Path, first: int, steps: int
) -> tuple[Scene, SceneKeys, int, float]:
    """The scene, its keys, the steps of a run of both decks, and the largest difference of velocities in V.

    Walls that stand elsewhere than the next bead would are part of the scene only if a bead reaches them.
    """
    try:
        scene, keys = _scene_of(measured, executed, path, steps)
        compared, difference = _beside(workplace, scene, keys.measured, steps, first)
        if difference <= AGREE + drag_error(scene) or not measured.other_walls:
            return scene, keys, compared, difference
    except InputError:
        if not measured.other_walls:
            raise
    for name in ("scene", "beside"):
        shutil.rmtree(workplace.folder / name, ignore_errors=True)
    scene, keys = _scene_of(with_other_walls(measured), executed, path, steps)
    return scene, keys, *_beside(workplace, scene, keys.measured, steps, first)


def _refuse_other_motion(measured: Measured, scene: Scene, executed: Executed, path: Path, apart: str) -> NoReturn:
    """Refuse a deck whose motion is not that of the scene that was read; names the laws that differ.

    Raises:
        RefusedDeckError: walls are elsewhere, or have other laws.
        RunError: other forces differ, or none do at the displacements at which they were measured.
    """
    walls = differences.of_walls(measured, scene)
    if walls:
        errors = [NotMeasuredError(text, "fix wall/gran", "fix freeze") for text in walls]
        raise RefusedDeckError([line for error in errors for line in _at_lines(error, executed, path)])
    forces = differences.of_forces(measured, scene)
    where = "; ".join(forces) or (
        "forces agree where they were measured, at small overlaps; either a force differs elsewhere, or a contact with "
        "a dashpot closes within rounding of a time step (try a kick that is 3 % smaller)"
    )
    raise RunError(f"{path}: the scene that was read moves otherwise (velocities differ {apart}): {where}")


def refuse(executed: Executed, path: Path) -> None:
    """Refuse what LAMMPS did not execute, and motions that are changed after the first run.

    Raises:
        RefusedDeckError: some commands are none of a scene.
        InputError: LAMMPS ended with an error.
    """
    refused = [f"{command.place}: {command.refusal}" for command in executed.commands if command.refusal]
    if refused:
        # commands that were left out are often the reason why LAMMPS stopped
        unread = executed.unread if executed.error else []
        refused += [f"{command.place}: {command.refusal}" for command in unread if command.refusal]
        raise RefusedDeckError(list(dict.fromkeys(refused)))
    evaluate.refuse_error(executed, path)


def _first_run(executed: Executed) -> int:
    """Number, from 0, of the run with which the scene begins: the first one after which nothing changes motions."""
    places = [place for place, _ in executed.runs]
    return next(
        (
            number
            for number, place in enumerate(places)
            if not any(_moves(command) for command in executed.commands[place + 1 : places[-1]])
        ),
        0,
    )


def _moves(command: Command) -> bool:
    name = words_of(command.text)[0]
    return not (
        name in AFTER_RUN or name in WITHOUT_EFFECT or command.style.removeprefix("fix ") in FIXES_WITHOUT_EFFECT
    )


def _steps(executed: Executed, path: Path, first: int) -> int:
    steps = sum(count for _, count in executed.runs[first:])
    if steps < 1:
        raise InputError(f"{path}: has no `run` of at least one step")
    return steps


def _of_run(executed: Executed, first: int) -> list[str]:
    """Note on the run with which the scene begins, where it is not the first."""
    if not first:
        return []
    place, _ = executed.runs[first]
    return [
        f"{executed.commands[place].place}: the scene begins with run {first + 1}, from the state in which the runs "
        "before leave the beads (key `initial`); for two scenes, write one of those, and `initial: {run: DIRECTORY}` "
        "in that of these"
    ]


def _scene_of(measured: Measured, executed: Executed, path: Path, steps: int) -> tuple[Scene, SceneKeys]:
    """Scene in the deck's units, or in reduced ones if its beads are of no solid."""
    name = re.sub(r"[^A-Za-z0-9._-]", "-", path.name.removeprefix("in.")).strip(".-_")[:64] or "adopted"
    every = min(executed.every) if executed.every else None
    units = [words_of(command.text)[1] for command in executed.commands if command.style == "units"]
    others = UNIT_NAMES.get(units[-1] if units else "")
    source = f"{path}: the scene that was read"
    if units[-1:] == ["si"] and measured.exponent == 1.5:
        keys = SceneKeys(measured, si=True, poisson_ratio=_poisson_ratio(executed))
        try:
            return library.from_plain(keys.keys(name, path.name, every, steps), source), keys
        except InputError as error:
            reason = str(error).removeprefix(f"{source}: ")
        reduced = SceneKeys(measured, si=False)
        reduced.notes.append(
            f"in SI units the scene is refused ({reason}), so that it is in reduced units: lengths in m, times in s, "
            f"masses in units of {reduced.mass:.6g} kg"
        )
        return library.from_plain(reduced.keys(name, path.name, every, steps), source), reduced
    keys = SceneKeys(measured, si=False)
    if others is not None:
        keys.notes.append(
            f"the scene is in reduced units: lengths in {others[0]}, times in {others[1]}, masses in units of "
            f"{keys.mass:.6g} {others[2]}"
        )
    elif keys.mass != 1.0:
        keys.notes.append(f"the scene's unit of mass is {keys.mass:.6g} of the deck; lengths and times are the deck's")
    return library.from_plain(keys.keys(name, path.name, every, steps), source), keys


def _poisson_ratio(executed: Executed) -> float:
    """Poisson's ratio of `hertz/material`, if the deck states one number; 0 else."""
    ratios = set()
    for command in executed.commands:
        words = words_of(command.text)
        if command.style == "pair_coeff" and "hertz/material" in words:
            ratios.add(words[words.index("hertz/material") + 3 :][:1][0])
    try:
        ratio = float(ratios.pop()) if len(ratios) == 1 else 0.0
    except ValueError:  # a variable
        return 0.0
    return ratio if -1.0 < ratio <= 0.5 else 0.0


def _at_lines(error: NotMeasuredError, executed: Executed, path: Path) -> list[str]:
    """Message at the lines that determine what could not be read; at the deck if none does."""
    causes = [command for command in executed.commands if command.style in error.commands]
    if TIME in error.commands:
        variables = (command for command in executed.commands if command.style == "variable")
        causes = [command for command in variables if _OF_TIME.search(command.text)]
    places = list(dict.fromkeys(command.place for command in causes))
    return [f"{place}: {error.message}" for place in places[-MOST_LINES:]] or [f"{path}: {error.message}"]


_OF_TIME = re.compile(r"\b(step|time|elapsed|elaplong|ramp|vdisplace|swiggle|cwiggle)\b")
"""Words of LAMMPS's formulas that depend on the time."""


MOST_LINES = 3
"""Lines that are named as causes of one message."""


def drag_error(scene: Scene) -> float:
    """Difference of velocities, in V, that drag makes, whose force LAMMPS takes half a step late.

    The deck of a scene balances that by masses that are larger by gamma dt / 2. The times of a motion that decays with
    the rate gamma / (2 m) differ by at most dt / e, and velocities change by V in no less than T.
    """
    damping = scene.part("damping")
    if damping is None or not damping.beads or scene.timestep is None:
        return 0.0
    return scene.timestep / scene.scale.time


def _notes(executed: Executed) -> list[str]:
    skipped: dict[str, None] = {}
    for command in executed.commands:
        if command.style in ("dump", "shell", "write_data", "write_restart", "restart"):
            skipped.setdefault(command.place)
    walls = (command.place for command in executed.commands if damped_wall(words_of(command.text)))
    without = "executed with gamma_n = 1e-30, as LAMMPS divides by gamma_n"
    frames = "; frames are those of `output.every`"
    return [
        *(f"{place}: {without}" for place in walls),
        *(f"{place}: not executed" + frames * (" dump" in place) for place in skipped),
    ]


# --- the scene's deck beside the user's -------------------------------------------------------------------------------


def _dumped(group: str, frames: Path, columns: str, first: int, every: int, steps: int) -> str:
    """LAMMPS commands that run and write frames from the first step on, whatever its number."""
    return (
        f"variable granchain_frame equal stride({first},{first + steps + 2 * every},{every})\n"
        f"dump granchain_frames {group} custom 1 {frames} {columns}\n"
        f"dump_modify granchain_frames every v_granchain_frame first yes\nrun {steps} post no\n"
    )


def _beside(workplace: Workplace, scene: Scene, measured: Measured, steps: int, first: int) -> tuple[int, float]:
    """Steps of a run of both decks, and the largest difference of velocities in V."""
    problem = scene.problem()
    compared = int(min(steps, max(100, BEAD_STEPS // measured.mass.size)))
    every = max(1, compared // FRAMES)
    compared -= compared % every
    axis = "xyz"[measured.axis]
    frames = workplace.folder / "user.bin"
    run = _dumped("all", frames, f"id v{axis}", measured.first_step, every, compared)
    executed = workplace.execute("beside", f"{run}quit 0\n", first)
    if executed.error:
        raise InputError(f"{executed.commands[-1].place}: {evaluate.explained(executed.error)}")
    folder = workplace.folder / "scene"
    folder.mkdir()
    scene_files.write(scene, folder)
    options = [("steps", str(compared)), ("every", str(every)), ("thermo", str(compared))]
    error = workplace.lammps(folder / file_names.DECK, folder / file_names.LOG, folder, options)
    if error:
        raise RunError(f"the scene's deck: {error}")
    user, ours = _velocities(frames, f"v{axis}"), _velocities(folder / file_names.DUMP, "vx")
    index = np.searchsorted(_ids(frames), np.ravel(measured.ids))
    beads = ours[-(compared // every) - 1 :, : problem.chains * problem.beads]
    theirs = measured.direction * user[-(compared // every) - 1 :, index] / scene.scale.velocity
    apart = np.abs(beads - theirs)
    apart[0, np.ravel(measured.driven)] = 0.0  # `fix move` gives velocities from the first step on
    return compared, float(np.max(apart))


def _velocities(path: Path, column: str) -> NDArray[np.float64]:
    """Velocities of the atoms in ascending order of their numbers, [frame, atom]."""
    return BinaryDump(path).read(columns=(column,))[:, 0]


def _ids(path: Path) -> NDArray[np.int64]:
    return BinaryDump(path).ids
