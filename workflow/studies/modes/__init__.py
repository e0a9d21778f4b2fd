"""Linear modes of a conservative scene about its static state, and the periodic states that continue them.

`linear` solves the eigenvalue problem, `shooting` finds periodic states and follows branches of them, `floquet` tests
their stability, `branches` computes one branch with its bifurcations, `lammps_check` starts LAMMPS on a state; `study`
plans, writes tables and figures, and is the command.
"""
