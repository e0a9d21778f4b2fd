"""MDAnalysis reads and writes our files once this module is imported: ``mda.Universe("DIR/data.chains", DUMP)``.

- `BinaryDumpReader`, `BinaryDumpWriter`: LAMMPS binary dumps (``.bin``), their float64 columns in ``ts.data``;
- `ChainsParser`: ``data.chains``, with chains as segments, beads as residues, springs as bonds; recorded beads only.

MDAnalysis has positions and velocities in float32, which is good for viewing; compute with ``ts.data``::

    import MDAnalysis as mda
    import analysis.mda.formats  # registers the formats

    universe = mda.Universe("DIR/data.chains", "DIR/chains.dump.bin")
    for ts in universe.trajectory[::10]:
        print(ts.time, ts.data["velocity"].max())

A run that was continued has several dumps; see `analysis.mda.universe` for all of a run at once.
"""

from analysis.mda.reader import BinaryDumpReader
from analysis.mda.topology import ChainsParser
from analysis.mda.writer import BinaryDumpWriter

__all__ = ["BinaryDumpReader", "BinaryDumpWriter", "ChainsParser"]
