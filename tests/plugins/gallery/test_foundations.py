"""What the gallery says of foundations that vary in time."""

import pytest

from workflow.cli import main


@pytest.mark.slow
def test_growth_and_tunnelling_have_the_numbers_that_were_found_independently(tmp_path):
    """Floquet's exponent, the chain of 60 beads, and the share of the action, by LAMMPS and the reference."""
    assert main(["gallery", "parametric", "landau-zener", "-o", str(tmp_path), "--quiet"]) == 0
    page = (tmp_path / "index.html").read_text()
    assert "reference 0.02499268" in page
    assert "LAMMPS 0.668106, reference 0.668106" in page
    assert "reference 0.536736" in page
    assert "reference 0.555905" in page
