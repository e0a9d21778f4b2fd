"""MDAnalysis's own tests of readers and writers, on ours; where its package of tests is installed."""

import numpy as np
import pytest

pytest.importorskip("MDAnalysisTests", reason="MDAnalysisTests is not installed")

import MDAnalysis as mda
from MDAnalysis.coordinates.memory import MemoryReader
from MDAnalysisTests.coordinates import base

import analysis.mda.formats as formats

pytestmark = pytest.mark.filterwarnings("ignore")  # theirs


class Reference(base.BaseReference):
    """The frames that their tests expect, as a dump of ours."""

    reader = formats.BinaryDumpReader
    writer = formats.BinaryDumpWriter
    ext = "bin"

    def __init__(self, directory):
        super().__init__()
        self.changing_dimensions = True
        frames = np.array([2**i * self.first_frame.positions for i in range(self.n_frames)])
        boxes = np.array([self.dimensions, self.dimensions_second_frame, *[self.dimensions] * 3])
        self.topology = mda.Universe.empty(self.n_atoms, n_residues=self.n_atoms, atom_resindex=range(5))
        self.topology.add_TopologyAttr("resids", range(1, 6))
        self.topology.trajectory = MemoryReader(frames, dimensions=boxes)
        self.trajectory = directory / "test.bin"
        self.topology.atoms.write(self.trajectory, frames="all")


@pytest.fixture(scope="module")
def ref(tmp_path_factory):
    return Reference(tmp_path_factory.mktemp("battery"))


class TestReader(base.MultiframeReaderTest):
    pass


class TestWriter(base.BaseWriterTest):
    @staticmethod
    @pytest.fixture
    def universe(ref):
        copy = ref.topology.copy()
        copy.load_new(str(ref.trajectory))
        return copy
