"""Lyapunov exponents: how fast small deviations grow along a run, and for how long a run can be predicted.

`growth` follows tangent vectors along a run and averages their growth; `study` plans the runs, judges and writes.
"""
