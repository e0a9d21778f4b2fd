"""Measure on this machine what the deck, the reader and the reference gain over the ways they replace."""

import argparse

from workflow.screen import print_table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments."""


def execute(arguments: argparse.Namespace) -> int:  # noqa: ARG001
    """Print a table of ratios; exit code 1 if one misses its goal."""
    from workflow.bench import all_ratios  # scipy takes a while to import

    rows, missed = [], 0
    for ratio in all_ratios():
        print(f"{ratio.name}: {ratio.value:.3g}", flush=True)
        missed += not ratio.reached
        rows.append([ratio.name, f"{ratio.value:.3g}", ratio.goal, "" if ratio.reached else "MISSED", ratio.detail])
    print()
    print_table("measured side by side, medians", ["what", "found", "goal", "", "first, second, spread"], rows)
    return 1 if missed else 0
