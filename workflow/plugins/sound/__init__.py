"""Sound under a static load: its speed, its dispersion as a run shows it, and the leading pulse on it."""
