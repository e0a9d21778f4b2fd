"""Analyse a run directory: one pass over the frames, then ``waves.csv``, ``analysis.json`` and the figures beside them."""

import io
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.binary_dump import CutDumpWarning
from analysis.conservation import Conservation
from analysis.peaks import PeakFinder
from analysis.waves import Waves, leading_waves, to_csv
from lammps_inputs import InputError, Problem
from workflow.run_directory import RunDirectory, write_bytes, write_json, write_text

WAVES, REPORT = "waves.csv", "analysis.json"


@dataclass(frozen=True)
class Analysis:
    """What was found in a run.

    Attributes:
        waves: the leading pulse at every bead, dimensionless.
        conservation: energy, momentum, frames seen.
        complete: whether the dump holds every frame that the scene asks for.
        figures: files drawn.
    """

    problem: Problem
    waves: Waves
    conservation: Conservation
    complete: bool
    figures: tuple[Path, ...]


def analyse(directory: RunDirectory, *, beads: tuple[int, ...] | None = None, figures: bool = True) -> Analysis:
    """Analyse what a directory holds, also of a run that was cut short.

    Args:
        directory: a run directory.
        beads: whose velocity over time is drawn; by default three beads along the way of the pulse.
        figures: whether to draw.

    Raises:
        InputError: no frames, or a bead that was not recorded.
    """
    problem = directory.problem
    shown = default_beads(problem) if beads is None else beads
    for bead in shown:
        if bead not in problem.recorded_beads:
            raise InputError(f"--beads: bead {bead} is not among the recorded ones")
    finder, conservation = PeakFinder(), Conservation()
    watchers: list[Any] = [finder, conservation]
    if figures:
        from analysis.figures import BeadHistory, SpaceTime  # matplotlib takes half a second to import

        watchers += [SpaceTime(problem), BeadHistory(problem, shown)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)  # said in words below: the run is incomplete
        for block in directory.blocks():
            for watcher in watchers:
                watcher.add(block)
    waves = leading_waves(finder.result())
    complete = conservation.frames == problem.frames + 1
    drawn = _draw(directory.path, watchers[2], watchers[3]) if figures else ()
    write_text(directory.path / WAVES, to_csv(waves, problem.scale))
    result = Analysis(problem, waves, conservation, complete, drawn)
    write_json(directory.path / REPORT, report(result))
    return result


def default_beads(problem: Problem) -> tuple[int, ...]:
    """Three recorded beads, near a sixth, a half and nine tenths of the way."""
    recorded = problem.recorded_beads
    places = np.unique(np.round(np.array([0.17, 0.5, 0.9]) * (len(recorded) - 1)).astype(int))
    return tuple(int(recorded[place]) for place in places)


def _draw(path: Path, spacetime: Any, history: Any) -> tuple[Path, ...]:
    from analysis.figures import response_figure, spacetime_figure

    files = []
    for name, figure in (("spacetime", spacetime_figure(spacetime)), ("response", response_figure(history))):
        for suffix in ("png", "pdf"):
            out = io.BytesIO()
            figure.savefig(out, format=suffix)
            files.append(path / f"{name}.{suffix}")
            write_bytes(files[-1], out.getvalue())
    return tuple(files)


def report(found: Analysis) -> dict[str, Any]:
    """The contents of ``analysis.json``.

    | key             | what                                                                             |
    |-----------------|----------------------------------------------------------------------------------|
    | complete        | whether every frame of the scene is there                                        |
    | frames          | found, and asked for                                                             |
    | front           | foremost bead that moved                                                         |
    | energy_drift    | largest relative deviation of the energy; null if not all beads were recorded    |
    | momentum_drift  | the same of the momentum                                                         |
    | scale           | worth of the dimensionless units of mass, length, time, velocity in the scene's  |
    | kappa           | dimensionless coupling at V = 1                                                  |
    | units           | the scene's units: ``SI`` or ``reduced``; those of the waves below and in waves.csv |
    | waves           | per chain: beads reached, and at the last whole one its arrival, peak velocity, speed |
    """
    problem, seen = found.problem, found.conservation
    scale = problem.scale
    return {
        "complete": found.complete,
        "frames": [seen.frames, problem.frames + 1],
        "front": seen.front,
        "energy_drift": _number(seen.energy_drift),
        "momentum_drift": _number(seen.momentum_drift),
        "units": "SI" if scale.si else "reduced",
        "scale": {"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity},
        "kappa": problem.kappa,
        "waves": [_chain_summary(found, chain) for chain in range(1, problem.chains + 1)],
    }


def _chain_summary(found: Analysis, chain: int) -> dict[str, Any]:
    waves, scale = found.waves.of_chain(chain), found.problem.scale
    if len(waves) == 0:
        return {"chain": chain, "beads_reached": 0}
    last = last_clear_bead(waves, found.problem)
    return {
        "chain": chain,
        "beads_reached": len(waves),
        "bead": int(waves.bead[last]),
        "arrival": float(waves.arrival[last] * scale.time),
        "peak_velocity": float(waves.peak_velocity[last] * scale.velocity),
        "speed": _number(float(waves.speed[last] / scale.time)),
        "peak_velocity_reduced": float(waves.peak_velocity[last]),
        "arrival_reduced": float(waves.arrival[last]),
    }


def last_clear_bead(waves: Waves, problem: Problem) -> int:
    """Position of the last bead that the pulse passed undisturbed by the free end, five beads before it."""
    clear = np.flatnonzero(waves.bead <= max(problem.beads - 5, 1))
    return int(clear[-1]) if len(clear) else 0


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None
