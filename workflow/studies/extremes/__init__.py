"""Stability at the extremes: cells of a `grid` are run by `measure`, judged by `true_error`, gathered by `report`."""
