"""Stability at the extremes: `cells` are run by `measure`, each judged by `true_error`; `report` gathers them."""
