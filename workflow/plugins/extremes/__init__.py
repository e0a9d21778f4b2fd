"""Stability at the extremes: `cells` are run, compared and gathered by `study`."""
