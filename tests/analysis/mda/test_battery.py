"""MDAnalysis's own tests of readers, on ours; where its package of tests is installed."""

import numpy as np
import pytest

pytest.importorskip("MDAnalysisTests", reason="MDAnalysisTests is not installed")

import MDAnalysis as mda
from MDAnalysisTests.coordinates import base

import analysis.mda.formats as formats
from analysis.files.dump_layout import header

pytestmark = pytest.mark.filterwarnings("ignore")  # theirs


class Reference(base.BaseReference):
    """The frames that their tests expect, as a dump of ours."""

    reader = formats.BinaryDumpReader
    ext = "bin"

    def __init__(self, directory):
        super().__init__()
        self.changing_dimensions = True
        self.dimensions = np.array([81.1, 82.2, 83.3, 90.0, 90.0, 90.0], dtype=np.float32)  # orthogonal boxes only
        self.dimensions_second_frame = np.array([84.4, 85.5, 86.6, 90.0, 90.0, 90.0], dtype=np.float32)
        self.volume = float(np.prod(self.dimensions[:3]))
        lengths = [self.dimensions[:3], self.dimensions_second_frame[:3], *[self.dimensions[:3]] * 3]
        frames = []
        for i, box in enumerate(lengths):
            atoms = np.column_stack([np.arange(1.0, self.n_atoms + 1), 2.0**i * self.first_frame.positions])
            bounds = [end for length in box for end in (0.0, float(length))]
            frames.append(header(i, float(i), self.n_atoms, bounds, "id x y z") + atoms.tobytes())
        self.topology = mda.Universe.empty(self.n_atoms, n_residues=self.n_atoms, atom_resindex=range(5))
        self.topology.add_TopologyAttr("resids", range(1, 6))
        self.trajectory = directory / "test.bin"
        self.trajectory.write_bytes(b"".join(frames))


@pytest.fixture(scope="module")
def ref(tmp_path_factory):
    return Reference(tmp_path_factory.mktemp("battery"))


class TestReader(base.MultiframeReaderTest):
    test_get_writer_1 = test_get_writer_2 = None  # there is no writer: MDAnalysis writes other formats
