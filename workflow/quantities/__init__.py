"""Quantities by name: which there are, with words and units, and their numbers for a scene that is run in memory."""
