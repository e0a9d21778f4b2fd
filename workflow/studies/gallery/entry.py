"""What an entry of the gallery is: scenes, what was published of them, and what is found in their runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from lammps_inputs import library
from workflow.studies.gallery.ran import Ran
from workflow.studies.kept_runs import Say, kept_run
from workflow.studies.page import Section, Statement, drawn

ENGINES = ("lammps", "reference")

Runs = Mapping[str, Ran]
"""One scene's run by engine."""

Results = Mapping[str, Runs]
"""All of an entry, by the names of its scenes."""


@dataclass(frozen=True)
class Entry:
    """One canonical result.

    Attributes:
        title, introduction: what it is about.
        sources: where it was published, and what of it could be read.
        scenes: name -> scene without its name, run by LAMMPS and by the reference.
        statements: the published ones beside what the runs say.
        picture: one figure of the runs.
        caption: of it.
        swept: likewise name -> scene, run by the reference only.
    """

    title: str
    introduction: str
    sources: Sequence[str]
    scenes: Mapping[str, Mapping[str, Any]]
    statements: Callable[[Results], Sequence[Statement]]
    picture: Callable[[Results], Figure]
    caption: str
    swept: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def build(self, folder: Path, say: Say) -> Section:
        """Run what an earlier start has not run, and measure it.

        Args:
            folder: where run directories are kept.
            say: told what is going on.

        Raises:
            RunError: a run failed.
        """
        wanted = {
            **{name: (scene, ENGINES) for name, scene in self.scenes.items()},
            **{name: (scene, ("reference",)) for name, scene in self.swept.items()},
        }
        results: dict[str, Runs] = {}
        for name, (plain, engines) in wanted.items():
            scene = library.from_plain({"name": name, **plain}, name)
            results[name] = {engine: Ran(kept_run(scene, engine, folder, say)) for engine in engines}
        return Section(
            self.title,
            self.introduction,
            list(self.statements(results)),
            [drawn("figure", self.picture(results), self.caption)],
            [*self.sources, _own_errors(results)],
        )


def _own_errors(results: Results) -> str:
    """The measured error of the runs that both engines made, in words."""
    both = [runs for runs in results.values() if set(runs) == set(ENGINES)]
    worst = {engine: [max(runs[engine].errors[place] for runs in both) for place in (0, 1)] for engine in ENGINES}
    return (
        "Measured error of these runs: the peaks of LAMMPS's leading pulse are off by at most "
        f"{worst['lammps'][0]:.1e} V at any bead, its arrivals by {worst['lammps'][1]:.1e} T; any velocity of the "
        f"reference, also of beads left behind, is sure to {worst['reference'][0]:.1e} V, its arrivals to "
        f"{worst['reference'][1]:.1e} T."
    )
