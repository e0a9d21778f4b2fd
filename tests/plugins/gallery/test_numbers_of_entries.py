"""Numbers that entries compute from runs, of runs made by hand whose answers are known exactly."""

from dataclasses import dataclass

from workflow.plugins.gallery.entries import alternating, loaded


class Column:
    """A pulse whose velocity goes as depth^(-1/4), and its speed as depth^(1/6)."""

    def peaks(self, depths):
        return 2.0 * depths**-0.25

    def speed(self, above, below):
        return 3.0 * (0.5 * (above + below)) ** (1.0 / 6.0)


@dataclass
class Dimer:
    """A pulse whose velocity is a parabola over the mass ratio, least at 0.60 in cell 10 and at 0.585 in cell 60."""

    ratio: float

    def peak(self, bead):
        return (self.ratio - {21: 0.60, 121: 0.585}[bead]) ** 2 + 0.01


def test_the_exponents_of_a_column_are_those_of_the_power_laws_of_its_pulse():
    peak, speed = loaded.GRAVITY.statements({"column": {"lammps": Column()}})
    assert "-0.2500" in peak.found[0]
    assert "0.1667" in speed.found[0]


def test_the_weakest_pulse_of_dimers_is_at_the_minimum_of_the_parabola():
    ratios = (*alternating.SWEPT, alternating.RESONANCE)
    results = {f"ratio-{ratio:g}": {"reference": Dimer(ratio)} for ratio in ratios}
    least, drift, weaker = alternating._resonance(results)
    assert "0.585" in least.found[0]
    assert "0.015" in drift.found[0]
    assert "after 10 cells it is 0.60" in drift.correction
    assert f"{(0.005**2 + 0.01) / ((0.3428 - 0.585) ** 2 + 0.01):.4f}" in weaker.found[0]
