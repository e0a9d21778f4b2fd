"""Error against cost of what can be chosen for a scene: `harness` measures, `grid` has the choices, `advice` speaks."""
