"""Measurements that only some runs have, one kind a class: those that installed distributions declare.

Each class says for a run what to measure in its frames, and declares its quantities, table and figures. The rest of an
analysis (`workflow.verdicts.analyse`) and of what `analyze` prints does not know which there are.
"""
