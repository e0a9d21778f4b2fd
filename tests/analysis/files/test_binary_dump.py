"""Frames of LAMMPS and of our writer: read exactly, in pieces of any kind, and refused where they are no frames."""

import struct
import tracemalloc
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stock_lammps import run as run_lammps
from stock_lammps import scene

from analysis import trajectory
from analysis.files.binary_dump import BinaryDump, CutDumpWarning, NoFrameError
from analysis.files.recording import Writer, blocks
from lammps_inputs import InputError, Problem, Scene, file_names, physics

TWO = scene(chains=2, beads=12, kappa=0.1, every=0.1)
TINY = scene(duration=0.3, every=0.1)


def dump_of(scene: Scene, directory: Path) -> Path:
    """The dump of a scene that LAMMPS ran."""
    return run_lammps(scene, directory).directory / file_names.DUMP


@pytest.fixture(scope="module")
def serial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dump_of(TWO, tmp_path_factory.getbasetemp() / "serial")


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dump_of(TINY, tmp_path_factory.getbasetemp() / "tiny")


def frame(
    step: int, chunks: list[np.ndarray], *, names: str = "id x vx", time: float | None = None, units: str = ""
) -> bytes:
    """A frame by the book, independent of the package; chunks are [atom, column]."""
    atoms = sum(len(chunk) for chunk in chunks)
    out = struct.pack("<q", -10) + b"DUMPCUSTOM" + struct.pack("<iiqqi6i", 1, 2, step, atoms, 0, *[1] * 6)
    out += struct.pack("<6d", 0, 1, 0, 2, 0, 3) + struct.pack("<i", len(names.split()))
    out += struct.pack("<i", len(units)) + units.encode()
    out += struct.pack("<b", time is not None) + (b"" if time is None else struct.pack("<d", time))
    out += struct.pack("<i", len(names)) + names.encode() + struct.pack("<i", len(chunks))
    for chunk in chunks:
        out += struct.pack("<i", chunk.size) + np.ascontiguousarray(chunk, dtype="<f8").tobytes()
    return out


def rows(*ids: int) -> np.ndarray:
    return np.array([(number, 10.0 * number, 100.0 * number) for number in ids])


def whole(problem: Problem, *paths: Path) -> trajectory.Trajectory:
    return trajectory.joined(blocks(paths, problem))


# what LAMMPS writes


@pytest.mark.slow
def test_a_lammps_dump_has_the_frames_atoms_and_columns_of_the_deck_and_its_start(serial: Path) -> None:
    dump = BinaryDump(serial)
    assert dump.steps.tolist() == list(range(0, 401, 10))
    assert dump.columns == ("id", "x", "vx")
    assert dump.ids.tolist() == list(range(1, 25))
    assert not dump.cut
    np.testing.assert_allclose(dump.times, dump.steps * TWO.problem().timestep, rtol=1e-12)
    np.testing.assert_array_equal(dump.box[0, 1:], [[-8.0, 16.0], [-8.0, 8.0]])
    for cut in (slice(3, 17), slice(None, None, 7), slice(-4, None), slice(None, None, -1), slice(50, 60)):
        np.testing.assert_array_equal(dump.read(cut.start, cut.stop, cut.step), dump.read()[cut])
    first = whole(TWO.problem(), serial)[:1]
    assert not first.displacement.any()
    np.testing.assert_array_equal(first.velocity[0], physics.initial_velocity(TWO.problem().system))


def test_the_writer_writes_what_lammps_writes_but_for_the_box(serial: Path, tmp_path: Path) -> None:
    run = whole(TWO.problem(), serial)
    with Writer(tmp_path / "ours.bin", TWO.problem()) as writer:
        for number in range(run.frames):
            writer.append(10 * number, run.displacement[number], run.velocity[number])
    ours = (tmp_path / "ours.bin").read_bytes()
    size = len(ours) // run.frames
    box = set(range(70, 70 + 48))
    assert len(ours) == serial.stat().st_size
    assert {i % size for i, (a, b) in enumerate(zip(ours, serial.read_bytes(), strict=True)) if a != b} <= box


# files in any order of atoms, ranks and layouts


@st.composite
def files(draw: st.DrawFn) -> tuple[bytes, list[int], np.ndarray]:
    """A file in pieces of any kind, its steps, and [frame, column, atom] that it holds."""
    ids = np.array(sorted(draw(st.sets(st.integers(1, 2**40), min_size=1, max_size=9))))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    fixed_order = draw(st.booleans())
    order = rng.permutation(len(ids))
    out, steps, values = b"", [], []
    for step in range(draw(st.integers(1, 12))):
        if not fixed_order:
            order = rng.permutation(len(ids))
        table = np.column_stack([ids, *rng.choice([0.0, -0.0, 1e-300, 1e300, np.inf, np.nan, 0.1], (2, len(ids)))])
        cuts = sorted(draw(st.lists(st.integers(0, len(ids)), max_size=3)))
        units = draw(st.sampled_from(["", "", "lj"]))
        out += frame(step, np.split(table[order], cuts), units=units, time=draw(st.sampled_from([None, 0.5])))
        steps.append(step)
        values.append(table.T)
    return out, steps, np.array(values)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(files())
def test_any_order_of_ids_and_any_chunks_give_the_atoms_in_order(
    tmp_path_factory: pytest.TempPathFactory, file: tuple[bytes, list[int], np.ndarray]
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.bin"
    path.write_bytes(file[0])
    dump = BinaryDump(path)
    assert dump.steps.tolist() == file[1]
    np.testing.assert_array_equal(dump.read(), file[2])


# several files


def test_a_continuation_that_leaves_frames_out_is_refused(serial: Path, tmp_path: Path) -> None:
    raw = serial.read_bytes()
    size = len(raw) // 41
    (tmp_path / "1.bin").write_bytes(raw[: 25 * size + 100])
    (tmp_path / "2.bin").write_bytes(raw[26 * size :])
    with pytest.raises(InputError, match=r"2\.bin: continues at step 260, but the file before ends at step 240"):
        whole(TWO.problem(), tmp_path / "1.bin", tmp_path / "2.bin")


def test_a_continuation_killed_before_its_first_frame_is_passed_over(serial: Path, tmp_path: Path) -> None:
    raw = serial.read_bytes()
    (tmp_path / "1.bin").write_bytes(raw[: len(raw) // 41 * 40])
    (tmp_path / "2.bin").write_bytes(b"")
    with pytest.warns(CutDumpWarning, match=r"2\.bin: is an empty file; it is passed over"):
        assert whole(TWO.problem(), tmp_path / "1.bin", tmp_path / "2.bin").frames == 40
    assert whole(TWO.problem(), serial, tmp_path / "2.bin").frames == 41  # without a warning: none is missing
    with pytest.raises(NoFrameError, match=r"2\.bin: is an empty file"):
        whole(TWO.problem(), tmp_path / "2.bin")


def test_a_column_that_is_not_there_a_missing_file_and_a_directory_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "own.bin"
    path.write_bytes(frame(0, [rows(1, 2)]))
    with pytest.raises(InputError, match=r"own\.bin: has no column 'y'; it has id x vx"):
        BinaryDump(path).read(columns=("x", "y"))
    with pytest.raises(InputError, match=r"no\.bin: no such file"):
        BinaryDump(tmp_path / "no.bin")
    with pytest.raises(InputError, match="is a directory, not a file"):
        BinaryDump(tmp_path)


@pytest.mark.parametrize("change", [{"beads": 13}, {"chains": 1}])
def test_atoms_of_another_problem_are_refused(serial: Path, change: dict[str, object]) -> None:
    with pytest.raises(InputError, match="its 24 atoms are not the "):
        whole(TWO.model_copy(update=change).problem(), serial)


# cuts


@pytest.mark.slow
def test_a_cut_at_any_byte_of_the_last_frame_leaves_the_whole_ones(tmp_path: Path) -> None:
    *before, last = (frame(i, np.split(rows(2, 1), 2), units="" if i else "lj", time=0.1) for i in range(4))
    path = tmp_path / "cut.bin"
    for cut in range(1, len(last)):
        path.write_bytes(b"".join(before) + last[:cut])
        with pytest.warns(CutDumpWarning, match=r"cut\.bin: ends within a frame; the 3 complete frames"):
            dump = BinaryDump(path)
        assert dump.cut
        assert dump.n_frames == 3


def test_a_cut_at_any_byte_of_the_only_frame_leaves_nothing_to_read(tmp_path: Path, tiny: Path) -> None:
    raw = tiny.read_bytes()
    size = len(raw) // 4
    path = tmp_path / "cut.bin"
    for cut in range(size):
        path.write_bytes(raw[:cut])
        with pytest.raises(NoFrameError, match=r"cut\.bin: (ends within its first frame|is an empty file)"):
            BinaryDump(path)


# what is no dump


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"hello", "is not a LAMMPS binary dump of style custom"),
        (b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n", "text dump"),
        (struct.pack("<q8s", -8, b"DUMPATOM") + bytes(100), "style atom"),
        (struct.pack(">q10s", -10, b"DUMPCUSTOM") + bytes(100), "big-endian"),
        (struct.pack("<q10s2i", -10, b"DUMPCUSTOM", 1, 1) + bytes(100), "revision 1"),
        (struct.pack("<2q7i6d2i", 0, 2, 0, *[1] * 6, *[0.0, 1.0] * 3, 3, 1) + bytes(52), "before 2021"),
        (frame(0, [rows(1, 2)], names="type x vx"), "`id` must be among them"),
        (frame(0, [rows(1, 2)], names="id x"), None),
        (frame(0, [rows(1, 1)]), "not different whole numbers"),
        (frame(0, [rows(1, 2) * np.nan]), "not different whole numbers"),
    ],
)
def test_files_that_are_no_dump_are_refused_by_name(tmp_path: Path, content: bytes, reason: str | None) -> None:
    path = tmp_path / "alien.bin"
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"alien\.bin: .*{reason or ''}"):
        BinaryDump(path)


def test_other_atoms_and_wrong_chunks_in_a_later_frame_are_refused_when_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "bad.bin"
    good, alien = frame(0, [rows(1, 2, 3)]), frame(1, [rows(1, 2, 4)])
    path.write_bytes(good + alien)
    with pytest.raises(InputError, match=r"frame 1 .*its atoms are not those of the first frame"):
        BinaryDump(path).read()
    wrong = bytearray(frame(1, [rows(1), rows(2, 3)]))
    wrong[wrong.index(b"id x vx") + 11] = 6
    path.write_bytes(good + wrong)
    with pytest.raises(InputError, match=r"frame 1 .*its chunks do not add up to its atoms"):
        BinaryDump(path).read()


@pytest.mark.slow
def test_no_wrong_byte_of_a_header_does_worse_than_a_refusal_or_takes_memory(tmp_path: Path) -> None:
    path = tmp_path / "bad.bin"
    frames = [frame(step, [rows(2, 1), rows(3)], time=0.1, units="lj") for step in range(3)]
    good = b"".join(frames)
    tracemalloc.start()
    refused = 0
    for at in range(2 * len(frames[0])):
        for value in (0x7F, 0xFF):
            raw = bytearray(good)
            raw[at] = value
            path.write_bytes(raw)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", CutDumpWarning)
                try:
                    BinaryDump(path).read()
                except InputError:
                    refused += 1
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert refused > 300
    assert peak < 10 << 20
