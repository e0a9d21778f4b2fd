"""Stability at the extremes: `cells` are run and compared by `measure`, gathered by `study`."""
