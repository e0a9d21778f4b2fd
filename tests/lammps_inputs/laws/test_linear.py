import numpy as np
from small_problems import system

from lammps_inputs import laws
from lammps_inputs.laws.spring import Linear
from lammps_inputs.layout import Layout
from lammps_inputs.links import Across

PAIR = Across("coupling", Linear(0.1), edges=((0, 1),))


def test_a_spring_holds_half_its_stiffness_times_the_square():
    assert laws.energy(Linear(0.1), np.array([0.0, 2.0, -2.0])).tolist() == [0.0, 0.2, 0.2]


def test_the_bond_has_no_rest_length():
    bonds = Linear(0.1).across(PAIR, Layout(system(0.5, 0.1, 2)))
    assert bonds.style == "harmonic"
    assert bonds.coefficients[0].split()[-1] == "0"


def test_the_bond_has_half_the_stiffness_with_17_digits():
    assert Linear(0.1).across(PAIR, Layout(system(0.5, 0.1, 2))).coefficients == ("$(v_kappa/2:%.17g) 0",)
