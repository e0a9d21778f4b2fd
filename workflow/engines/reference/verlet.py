"""Velocity Verlet: order 2, symplectic, time-reversible; step for step what LAMMPS's ``fix nve`` does."""

from workflow.engines.reference.scheme import Scheme

VERLET = Scheme(
    name="verlet",
    order=2,
    kicks=(0.5, 0.5),
    drifts=(1.0,),
    source="Swope, Andersen, Berens & Wilson, J. Chem. Phys. 76 (1982) 637",
)
