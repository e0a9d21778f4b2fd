"""Runs and their directories: started, checked at the end, resumed, repeated, and their state.

`run` is the way in from Python. What is made of finished frames is in `workflow.verdicts`.
"""
