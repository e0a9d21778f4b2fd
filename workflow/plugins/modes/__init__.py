"""Linear modes and periodic states of conservative scenes, and periodic responses of driven, damped ones.

`linear` solves the eigenvalue problem, `continuation` has Newton's method and follows branches, `shooting` finds
periodic states of conservative scenes, `floquet` tests their stability, `branches` computes one branch with its
bifurcations, `lammps_check` starts LAMMPS on a state; `tables` and `drawing` have the results. `driven` says which
scenes have responses to a drive, `response` computes their curve, `lammps_sweep` sweeps the frequency in LAMMPS;
`response_tables` and `response_study` have the results. `study` plans, writes tables and figures, and is the command.
"""
