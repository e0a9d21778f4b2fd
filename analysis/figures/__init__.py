"""Figures of a run: data in, matplotlib Figure out. Readable in print and by colour-blind eyes; nothing is saved."""
