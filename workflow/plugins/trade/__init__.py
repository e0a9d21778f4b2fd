"""Error against cost of what can be chosen for a scene: `settings` has and runs the choices and the reference that they
are compared with, `points` has what was measured and what follows, also in sentences.
"""
