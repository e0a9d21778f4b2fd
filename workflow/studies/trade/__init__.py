"""Error against cost of what can be chosen for a scene: `settings` has and runs the choices, `work_precision` measures
them in rounds against a `certified` reference, `advice` says in sentences what follows, `study` carries out and writes.
"""
