"""Error against cost of what can be chosen for a scene: `settings` has and runs the choices, `work_precision` measures
them in rounds against the reference of `truth`, `advice` states in sentences what follows, `study` runs and writes.
"""
