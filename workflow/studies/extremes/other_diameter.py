"""A cell whose beads have another diameter in LAMMPS: the motion does not depend on it, the digits of positions do.

A scene cannot ask for that, so the cell is measured in a process of its own, in which all problems have the diameter.
"""

import json
import subprocess
import sys
from dataclasses import asdict

from lammps_inputs import Problem
from workflow.studies.extremes.cells import Cell
from workflow.studies.extremes.outcome import Outcome


def measure_apart(cell: Cell) -> Outcome:
    """As `measure.measure`, in another process; it ends when this one does, for it watches its standard input."""
    command = [sys.executable, "-P", "-m", "workflow.studies.extremes.other_diameter", json.dumps(asdict(cell))]
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,  # Ctrl-C reaches it through its standard input
    ) as process:
        assert process.stdout is not None
        said = process.stdout.read()
    return Outcome(**json.loads(said))


def main() -> None:
    """Measure the cell given, here."""
    from workflow.studies.extremes.measure import measure_here

    cell = Cell(**json.loads(sys.argv[1]))
    Problem.diameter = property(lambda _: cell.diameter)  # type: ignore[assignment, method-assign]
    print(json.dumps(asdict(measure_here(cell))))


if __name__ == "__main__":
    main()
