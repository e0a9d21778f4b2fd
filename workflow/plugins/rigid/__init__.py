"""Rigid beads: rows that move by their exact modes, and beads of one chain that exchange velocities when they meet.

The binary collision model of section 3 of the paper (Figs 7-9), event-driven: nothing is stepped, and no collision is
missed. Contacts that last, and beads that touch at the start, are outside it.
"""
