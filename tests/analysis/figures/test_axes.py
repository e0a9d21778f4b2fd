"""Axes of figures need no factor beside them: units have prefixes, or powers of ten."""

import pytest
from matplotlib.figure import Figure

from analysis.figures import style
from lammps_inputs.units import Label


@pytest.mark.parametrize(
    ("unit", "largest", "label", "half"),
    [
        ("m", 2.9e-7, "displacement $x$ (nm)", "145"),
        ("s", 250.0, "displacement $x$ (s)", "125"),
        ("rad/s", 22190.0, "displacement $x$ (krad/s)", "11.095"),
        ("reduced", 3e-9, "displacement $x$ ($10^{-9}$ reduced)", "1.5"),
        ("reduced", 0.02, "displacement $x$ (reduced)", "0.01"),
    ],
)
def test_numbers_on_an_axis_are_those_of_the_unit_that_its_label_has(unit, largest, label, half):
    axis = Figure().subplots()
    axis.set_ylim(-largest, largest)
    style.label_axis(axis.yaxis, Label("displacement", "x", unit))
    formatter = axis.yaxis.get_major_formatter()
    axis.set_yticks([-largest / 2.0, largest / 2.0])
    assert axis.get_ylabel() == label
    assert [text.get_text() for text in axis.get_yticklabels()] == ["\N{MINUS SIGN}" + half, half]
    assert formatter.get_offset() == ""


def test_a_title_is_not_broken_between_a_number_and_its_unit():
    figure = style.new_figure(2.0, 4.0)
    style.head(figure, "three chains of steel: static load 20 N and 30 N, V = 0.1 m/s, and half as much")
    lines = figure.get_suptitle().splitlines()
    assert len(lines) > 1
    assert any("V = 0.1 m/s" in line for line in lines)
    assert any("20 N" in line for line in lines)
