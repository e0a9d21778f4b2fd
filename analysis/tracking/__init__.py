"""From maxima between frames to pulses tracked through the beads, and how well each is found.

The bottom is `peaks`, which finds passages at single beads, and `peak_bounds`, which says where between frames;
`pulses` links them, `leading_waves` keeps the first, and `succession` finds where another one becomes the first. What
the chains make of the pulse is in `analysis.sharing`.
"""
