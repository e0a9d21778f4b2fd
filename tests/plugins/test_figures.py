"""Figures of studies have the formats and the width that are asked for."""

from declared_studies import declared_studies

from lammps_inputs import plugins


def test_studies_that_draw_take_the_width_of_figures():
    draw = {study.command for study in declared_studies() if study.figures}
    assert draw == {name for name, module in plugins.loaded("studies").items() if getattr(module, "DRAWS", False)}
