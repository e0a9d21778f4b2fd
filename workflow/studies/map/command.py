"""Map equipartition over coupling and number of chains, with the reference integrator."""

import argparse
from pathlib import Path

from lammps_inputs import InputError
from workflow.screen import count_bar, one_line, print_table
from workflow.studies.map import study as mapping

DRAWS = True
EXAMPLES = (
    "map -o map                # some four minutes; the same command resumes",
    "map -o map --quiet",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to map, and where to."""
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, required=True, help="new directory, or one to resume"
    )
    parser.add_argument("--couplings", metavar="K,K,...", help="dimensionless couplings (default 1e-3 to 2)")
    parser.add_argument("--chains", metavar="N,N,...", help="numbers of chains (default 2 to 8)")
    parser.add_argument("--most-beads", metavar="N", type=int, default=mapping.MOST_BEADS, help="longest chains")


def execute(arguments: argparse.Namespace) -> int:
    """Run what is missing, print a table."""
    try:
        couplings = _numbers(arguments.couplings, float) or mapping.COUPLINGS
        chains = _numbers(arguments.chains, int) or mapping.CHAINS
    except ValueError:
        raise InputError("map: --couplings and --chains take numbers with commas between") from None
    if arguments.most_beads < 60:
        raise InputError(f"--most-beads: {arguments.most_beads} given; at least 60")
    with count_bar("map") as progress:
        cases = mapping.make_map(
            arguments.output, couplings, chains, most_beads=arguments.most_beads, progress=progress
        )
    rows = [
        [
            str(case.chains),
            f"{case.kappa:.4g}",
            "-" if case.ten is None else str(case.ten),
            "-" if case.one is None else str(case.one),
            f"{case.amplitude:.4f}",
            f"{case.mismatch:.1e}",
            str(case.beads),
            f"{case.window_error:.0e}",
        ]
        for case in cases
    ]
    print_table(
        "leading pulses: bead from which all chains agree, and what is left at the end (V = 1)",
        ["N", "kappa", "10% from", "1% from", "amplitude", "mismatch", "beads", "window error"],
        rows,
    )
    print(f"{one_line(arguments.output)}: {', '.join(mapping.STUDY.files)}")
    return 0


def _numbers(text: str | None, kind: type) -> list:  # type: ignore[type-arg]
    return [] if text is None else [kind(part) for part in text.split(",")]
