"""The leading pulse at every bead as LAMMPS's run has left it in ``peaks.csv``, beside frames of only some beads."""

import numpy as np

from analysis.mirror import direction_of
from analysis.tracking.leading_waves import Waves, from_csv
from lammps_inputs import InputError, file_names
from workflow.runs.run_directory import RunDirectory


def found_on_the_way(directory: RunDirectory) -> Waves | None:
    """The table's waves; None where there is none, or where the frames hold every bead anyway.

    Raises:
        InputError: the file cannot be read.
    """
    path, problem = directory.path / file_names.PEAKS, directory.problem
    if not problem.peaks or problem.recorded is None or not path.is_file():
        return None
    try:
        waves = from_csv(path.read_text(encoding="utf-8"), problem.scale, direction=direction_of(problem))
    except (ValueError, OSError):
        raise InputError(f"{path}: cannot be read as a table of peaks; delete it to analyse the frames alone") from None
    chain, bead = waves.chain, waves.bead
    there = (chain >= 1) & (chain <= problem.chains) & (bead >= 1) & (bead <= problem.beads)
    in_order = np.array_equal(np.lexsort((bead, chain)), np.arange(len(waves)))
    if not (in_order and np.all(there & np.isfinite(waves.peak_velocity))):
        raise InputError(f"{path}: holds what is not this scene's; delete it to analyse the frames alone")
    return waves
