"""Thresholds: where a quantity of a scene crosses a value as a field varies, also as a curve over a second field.

`crossings` decides which values of the field to compute next and what follows from them; `study` computes and writes.
"""
