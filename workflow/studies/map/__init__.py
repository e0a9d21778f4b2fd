"""Equipartition over coupling and number of chains: a sweep over two fields, with a figure of its own."""
