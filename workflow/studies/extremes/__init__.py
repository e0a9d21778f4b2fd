"""Stability at the extremes: `cells` are run and judged by `measure`, gathered by `study`."""
