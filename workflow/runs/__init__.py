"""Runs and their directories: started, checked at the end, gone on with, repeated, and the state that one is in.

`run` is the way in from Python. What is made of finished frames is in `workflow.verdicts`.
"""
