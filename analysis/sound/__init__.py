"""Chains under a static load, which pass on sound: the pulse above the load, and dispersion."""
