"""Derivatives of quantities of a scene by its fields, from the tangent flow of the reference, with uncertainties.

`tangent` is the flow of vectors along a run, `linearised` the problem of a scene that has one, `motion` the derivatives
of a run by numbers of its scene, `varied_scene` a scene with fields that vary, `gradient` the derivatives of quantities
with their uncertainties, and `of_analyze` the options of ``granchain analyze``.
"""
