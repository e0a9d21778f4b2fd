"""Stability at the extremes: `cells` are run by `measure`, each judged by `judge`; `report` gathers them."""
