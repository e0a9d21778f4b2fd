"""From maxima between frames to pulses tracked through the beads, and how well each is found.

`peaks` finds passages at single beads, and `peak_bounds` their times between frames, with uncertainties. `pulses` links
passages, `leading_waves` has the first of each bead, and `succession` finds where another pulse becomes the first. How
chains share a pulse is in `analysis.sharing`.
"""
