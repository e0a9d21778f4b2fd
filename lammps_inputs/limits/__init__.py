"""What a scene's numbers cannot do, known at once: a step too long, beads pressed too hard, a gap that stays open.

Bounds in closed form, from the problem alone. What a run has to be tried for is found by `workflow.prepare`.
"""
