"""Ensembles: one scene with many seeds of its random ingredients, and the statistics of its quantities.

`statistics` has the numbers, as pure functions; `study` computes the scenes and writes.
"""
