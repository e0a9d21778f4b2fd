"""How near together recorded beads must lie for beats to be seen."""

import numpy as np
from synthetic_waves import of_keys

from analysis.sharing.equipartition import Sharing, resolved


def farthest(chains: int, stiffness: float, topology: str = "open", strength: float = 1.0) -> int:
    """Largest distance of recorded beads at which beats are seen."""
    keys = {"coupling": {"stiffness": stiffness, "topology": topology}, "contact": {"strength": strength}}
    system = of_keys(chains=chains, beads=200, kick={"velocity": 1.0}, duration=1.0, **keys).system
    seen = []
    for apart in range(1, 100):
        bead = np.arange(1, 200, apart)
        numbers = np.ones((len(bead), chains))
        seen.append(resolved(Sharing(0, bead, numbers, numbers, 0.5), system))
    assert seen == sorted(seen, reverse=True)
    return sum(seen)


def test_beats_of_a_ring_of_three_chains_are_seen_as_those_of_two_chains_of_its_modal_frequency():
    """Its square is 3 k; that of two chains is 2 k, whose beats need a bead in ``2 / sqrt(k)``."""
    assert farthest(2, 0.0015) == 51
    assert farthest(3, 0.001, "ring") == 51
    assert farthest(3, 0.001, "open") == 63


def test_beats_of_contacts_of_strength_32_are_four_times_as_long_as_those_of_strength_1():
    """Pulses are 32**0.4 = 4 times as fast, and the springs swing as before."""
    assert farthest(2, 0.016) == 15
    assert farthest(2, 0.016, strength=32.0) == 63
