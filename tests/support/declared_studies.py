"""Studies that installed distributions declare."""

from lammps_inputs import plugins
from workflow.study_kit.directory import Study


def declared_studies() -> list[Study]:
    """Every declared study that has a directory, in whatever name of its module."""
    studies = {}
    for module in plugins.loaded("studies").values():
        named = [getattr(value, "study", value) for value in vars(module).values()]
        studies |= {value.command: value for value in named if isinstance(value, Study)}
    return list(studies.values())
