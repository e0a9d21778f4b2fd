"""What became of the kick: how the chains share it, in beads, energy and impulse, and the verdict in words.

`survey` reads a run twice and finds all of it. Nothing here looks for a wave (`analysis.tracking`) or draws one
(`analysis.figures`).
"""
