"""What the plots of a run's page share."""

import pytest
from matplotlib.colors import to_rgb

from workflow.plugins.pages.plots import CHAIN_COLOURS

DARK = "#1b1d21"


def luminance(colour: str) -> float:
    """Relative luminance by WCAG 2.1."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in to_rgb(colour)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("colour", CHAIN_COLOURS)
def test_colours_of_chains_have_the_contrast_of_graphics_in_dark_mode(colour):
    assert (luminance(colour) + 0.05) / (luminance(DARK) + 0.05) >= 3.0  # WCAG 2.1, 1.4.11
