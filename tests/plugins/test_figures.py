"""Figures of studies have the formats and the width that are asked for."""

from lammps_inputs import plugins


def test_studies_that_draw_take_the_width_of_figures():
    drawing = {name for name, module in plugins.loaded("studies").items() if getattr(module, "DRAWS", False)}
    assert {"fit", "threshold", "trade"} <= drawing
