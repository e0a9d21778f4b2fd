import pickle
import struct
import subprocess
import sys
import tracemalloc
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stock_lammps import lammps, scene
from stock_lammps import run as run_lammps

from analysis import trajectory
from analysis.files.binary_dump import BinaryDump, CutDumpWarning, NoFrameError
from analysis.files.recording import Writer, atom_ids, blocks, rest_positions
from lammps_inputs import InputError, Output, Problem, Scene, file_names, physics

TWO = scene(chains=2, beads=12, kappa=0.1, every=0.1)
SOME = TWO.model_copy(update={"output": Output(every=0.1, beads=(2, 5, 12))})
TINY = scene(duration=0.3, every=0.1)


def dump_of(scene: Scene, directory: Path, ranks: int = 1) -> Path:
    """The dump of a scene that LAMMPS ran."""
    return run_lammps(scene, directory, ranks=ranks).directory / file_names.DUMP


@pytest.fixture(scope="module")
def serial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dump_of(TWO, tmp_path_factory.getbasetemp() / "serial")


@pytest.fixture(scope="module")
def parallel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dump_of(TWO, tmp_path_factory.getbasetemp() / "parallel", ranks=2)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dump_of(TINY, tmp_path_factory.getbasetemp() / "tiny")


def frame(
    step: int,
    chunks: list[np.ndarray],
    *,
    names: str = "id x vx",
    time: float | None = None,
    units: str = "",
    sheared: bool = False,
) -> bytes:
    """A frame by the book, independent of the package; chunks are [atom, column]."""
    atoms = sum(len(chunk) for chunk in chunks)
    out = struct.pack("<q", -10) + b"DUMPCUSTOM" + struct.pack("<iiqqi6i", 1, 2, step, atoms, sheared, *[1] * 6)
    out += struct.pack(f"<{9 if sheared else 6}d", 0, 1, 0, 2, 0, 3, *[0] * (3 * sheared)) + struct.pack(
        "<i", len(names.split())
    )
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


def test_a_lammps_dump_has_the_frames_atoms_and_columns_of_the_deck(serial: Path) -> None:
    dump = BinaryDump(serial)
    assert dump.steps.tolist() == list(range(0, 401, 10))
    assert dump.columns == ("id", "x", "vx")
    assert dump.ids.tolist() == list(range(1, 25))
    assert not dump.cut
    np.testing.assert_allclose(dump.times, dump.steps * TWO.problem().timestep, rtol=1e-12)
    np.testing.assert_array_equal(dump.box[0, 1:], [[-8.0, 16.0], [-8.0, 8.0]])


def test_displacements_are_exactly_zero_and_velocities_the_kicks_at_the_start(serial: Path) -> None:
    first = whole(TWO.problem(), serial)[:1]
    assert not first.displacement.any()
    np.testing.assert_array_equal(first.velocity[0], physics.initial_velocity(TWO.problem().system))


def test_two_ranks_write_two_chunks_and_read_like_one(serial: Path, parallel: Path) -> None:
    raw = parallel.read_bytes()
    chunks = struct.unpack_from("<i", raw, raw.index(b"id x vx") + 7)
    assert chunks == (2,)
    np.testing.assert_array_equal(BinaryDump(parallel).read(), BinaryDump(serial).read())


def test_recorded_beads_only_are_the_same_beads_of_the_whole_run(serial: Path, tmp_path: Path) -> None:
    some = whole(SOME.problem(), dump_of(SOME, tmp_path / "some"))
    everything = whole(TWO.problem(), serial)
    np.testing.assert_array_equal(some.velocity, everything.velocity[:, :, [1, 4, 11]])
    np.testing.assert_array_equal(some.displacement, everything.displacement[:, :, [1, 4, 11]])


def test_time_units_and_the_box_of_lammps_are_read(tmp_path: Path) -> None:
    (tmp_path / "in").write_text(
        "region b block 0 8 0 5 0 6\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\ncreate_atoms 1 single 3 3 3\n"
        "mass 1 1\npair_style zero 1.0\npair_coeff * *\nfix 1 all nve\nvelocity all set 1 0 0\ntimestep 0.25\n"
        f"dump d all custom 2 {file_names.DUMP} id x vx\ndump_modify d time yes units yes\nrun 6\n"
    )
    lammps(tmp_path, "in")
    dump = BinaryDump(tmp_path / file_names.DUMP)
    assert dump.times is not None
    assert dump.times.tolist() == [0.0, 0.5, 1.0, 1.5]
    assert dump.box[0].tolist() == [[0.0, 8.0], [0.0, 5.0], [0.0, 6.0]]
    assert dump.read(columns=("x",))[:, 0].tolist() == [[1.0, 3.0], [1.5, 3.5], [2.0, 4.0], [2.5, 4.5]]


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


# slices


@pytest.mark.parametrize(
    "cut", [slice(None), slice(3, 17), slice(None, None, 7), slice(-4, None), slice(None, None, -1), slice(50, 60)]
)
def test_slices_are_those_of_the_array_of_all_frames(serial: Path, cut: slice) -> None:
    dump = BinaryDump(serial)
    np.testing.assert_array_equal(dump.read(cut.start, cut.stop, cut.step), dump.read()[cut])


def test_columns_are_picked_by_name_in_the_order_asked_for(serial: Path) -> None:
    dump = BinaryDump(serial)
    np.testing.assert_array_equal(dump.read(columns=("vx", "x")), dump.read()[:, [2, 1]])
    with pytest.raises(InputError, match="has no column 'y'; it has id x vx"):
        dump.read(columns=("x", "y"))


def test_a_dump_survives_pickling(serial: Path) -> None:
    dump = BinaryDump(serial)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(dump)).read(3, 5), dump.read(3, 5))


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
@settings(max_examples=150, deadline=None)
@given(files())
def test_any_order_of_ids_and_any_chunks_give_the_atoms_in_order(
    tmp_path_factory: pytest.TempPathFactory, file: tuple[bytes, list[int], np.ndarray]
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.bin"
    path.write_bytes(file[0])
    dump = BinaryDump(path)
    assert dump.steps.tolist() == file[1]
    np.testing.assert_array_equal(dump.read(), file[2])


@settings(max_examples=50, deadline=None)
@given(
    chains=st.integers(1, 3),
    recorded=st.none() | st.sets(st.integers(1, 6), min_size=1),
    frames=st.integers(1, 5),
    seed=st.integers(0, 2**32),
)
def test_what_is_written_is_read_again(
    tmp_path_factory: pytest.TempPathFactory, chains: int, recorded: set[int] | None, frames: int, seed: int
) -> None:
    beads: tuple[int, ...] | str = "all" if recorded is None else tuple(sorted(recorded))
    problem = TWO.model_copy(update={"chains": chains, "beads": 6, "output": Output(every=0.1, beads=beads)}).problem()
    rng = np.random.default_rng(seed)
    displacement, velocity = rng.normal(size=(2, frames, *atom_ids(problem).shape))
    path = tmp_path_factory.getbasetemp() / "written.bin"
    with Writer(path, problem) as writer:
        for number in range(frames):
            writer.append(number * problem.steps_per_frame, displacement[number], velocity[number])
    run = whole(problem, path)
    rest = rest_positions(problem)
    np.testing.assert_array_equal(run.velocity, velocity)
    np.testing.assert_array_equal(run.displacement, (rest + displacement) - rest)
    np.testing.assert_array_equal(run.time, np.arange(frames) * problem.every)


def test_names_longer_than_a_disk_block_are_read(tmp_path: Path) -> None:
    names = " ".join(["id", *(f"c_compute[{i}]" for i in range(500))])
    table = np.arange(1, 1003.0).reshape(2, 501)
    (tmp_path / "wide.bin").write_bytes(frame(0, [table], names=names) + frame(1, [table], names=names))
    np.testing.assert_array_equal(BinaryDump(tmp_path / "wide.bin").read(1, 2)[0], table.T)


def test_frames_of_other_ranks_after_a_while_are_all_found(tmp_path: Path) -> None:
    table = rows(1, 2, 3)
    one, three = ([table], np.split(table, 3))
    (tmp_path / "a.bin").write_bytes(b"".join(frame(i, one if 100 <= i < 200 else three) for i in range(300)))
    dump = BinaryDump(tmp_path / "a.bin")
    assert dump.steps.tolist() == list(range(300))
    assert (dump.read() == table.T).all()


# several files


def test_a_continued_run_reads_like_one_without_frames_twice(serial: Path, tmp_path: Path) -> None:
    raw = serial.read_bytes()
    size = len(raw) // 41
    first, second = tmp_path / "1.bin", tmp_path / "2.bin"
    first.write_bytes(raw[: 25 * size + 100])
    second.write_bytes(raw[20 * size :])
    run = whole(TWO.problem(), first, second)  # without a warning: the second file has the frame that the first lacks
    once = whole(TWO.problem(), serial)
    for name in ("time", "displacement", "velocity"):
        np.testing.assert_array_equal(getattr(run, name), getattr(once, name))


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
    with pytest.raises(NoFrameError, match=r"2\.bin: is an empty file"):
        whole(TWO.problem(), tmp_path / "2.bin")


def test_a_continuation_after_the_last_frame_has_none_to_miss(serial: Path, tmp_path: Path) -> None:
    (tmp_path / "2.bin").write_bytes(b"")
    assert whole(TWO.problem(), serial, tmp_path / "2.bin").frames == 41  # without a warning


def test_blocks_are_of_bounded_size_and_miss_nothing(serial: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trajectory, "BLOCK_BYTES", 24 * 16 * 7)
    monkeypatch.setattr(trajectory, "LEAST_FRAMES", 1)
    parts = list(blocks([serial], TWO.problem()))
    assert [part.frames for part in parts] == [7, 7, 7, 7, 7, 6]
    np.testing.assert_array_equal(np.concatenate([part.time for part in parts]), whole(TWO.problem(), serial).time)


@pytest.mark.parametrize("change", [{"beads": 13}, {"chains": 1}, {"output": Output(every=0.1, beads=(1, 2))}])
def test_atoms_of_another_problem_are_refused(serial: Path, change: dict[str, object]) -> None:
    with pytest.raises(InputError, match="its 24 atoms are not the "):
        whole(TWO.model_copy(update=change).problem(), serial)


def test_steps_that_go_back_within_a_file_are_refused(serial: Path, tmp_path: Path) -> None:
    (tmp_path / "twice.bin").write_bytes(serial.read_bytes() * 2)
    with pytest.raises(InputError, match=r"twice\.bin: its steps go back"):
        whole(TWO.problem(), tmp_path / "twice.bin")


def test_the_writer_refuses_arrays_of_another_shape(tmp_path: Path) -> None:
    with Writer(tmp_path / "a.bin", SOME.problem()) as writer, pytest.raises(ValueError, match="is \\(2, 3\\)"):
        writer.append(0, np.zeros((2, 12)), np.zeros((2, 12)))


# cuts


@pytest.mark.parametrize("chunks", [1, 2])
def test_a_cut_at_any_byte_of_the_last_frame_leaves_the_whole_ones(tmp_path: Path, tiny: Path, chunks: int) -> None:
    raw = tiny.read_bytes()
    start = len(raw) // 4 * 3
    before, last = raw[:start], raw[start:]
    if chunks == 2:
        *first, last = (frame(i, np.split(rows(2, 1), 2), units="" if i else "lj", time=0.1) for i in range(4))
        before = b"".join(first)
    path = tmp_path / "cut.bin"
    for cut in range(1, len(last)):
        path.write_bytes(before + last[:cut])
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


def test_a_dump_that_grows_can_be_read_meanwhile(tmp_path: Path) -> None:
    problem = TINY.problem()
    with Writer(tmp_path / "a.bin", problem) as writer:
        for number in range(3):
            writer.append(number, np.zeros((1, 2)), np.zeros((1, 2)))
            assert BinaryDump(tmp_path / "a.bin").n_frames == number + 1


# what is no dump


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"hello", "is not a LAMMPS binary dump of style custom"),
        (bytes(5000), "is not a LAMMPS binary dump of style custom"),
        (bytes(range(256)) * 10, "is not a LAMMPS binary dump of style custom"),
        (b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n", "text dump"),
        (struct.pack("<q8s", -8, b"DUMPATOM") + bytes(100), "style atom"),
        (struct.pack(">q10s", -10, b"DUMPCUSTOM") + bytes(100), "big-endian"),
        (struct.pack("<q10s2i", -10, b"DUMPCUSTOM", 1, 1) + bytes(100), "revision 1"),
        (struct.pack("<2q7i6d2i", 0, 2, 0, *[1] * 6, *[0.0, 1.0] * 3, 3, 1) + bytes(52), "before 2021"),
        (frame(0, [rows(1, 2)], names="type x vx"), "`id` must be among them"),
        (frame(0, [rows(1, 2)], names="id x"), None),
        (frame(0, [rows(1, 1)]), "not different whole numbers"),
        (frame(0, [rows(0, 1)]), "not different whole numbers"),
        (frame(0, [rows(1, 2) * 1.5]), "not different whole numbers"),
        (frame(0, [rows(1, 2) * np.nan]), "not different whole numbers"),
    ],
)
def test_files_that_are_no_dump_are_refused_by_name(tmp_path: Path, content: bytes, reason: str | None) -> None:
    path = tmp_path / "alien.bin"
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"alien\.bin: .*{reason or ''}"):
        BinaryDump(path)


def test_a_missing_file_and_a_directory_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.bin: no such file"):
        BinaryDump(tmp_path / "no.bin")
    with pytest.raises(InputError, match="is a directory, not a file"):
        BinaryDump(tmp_path)


@pytest.mark.parametrize(
    ("second", "reason"),
    [
        (bytes(400), "begins differently"),
        (frame(1, [rows(1, 2)]), "another number of atoms"),
        (frame(1, [rows(1, 2, 3)], names="id y vx"), "other columns"),
        (frame(1, [rows(1, 2, 3)], sheared=True), "its box is sheared"),
    ],
)
def test_damage_at_opening_tells_how_to_save_the_frames_before_it(tmp_path: Path, second: bytes, reason: str) -> None:
    path = tmp_path / "bad.bin"
    good = frame(0, [rows(1, 2, 3)])
    path.write_bytes(good + second)
    with pytest.raises(InputError, match=rf"bad\.bin: frame 1 .*{reason}.*`head -c {len(good)}` saves"):
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
        for value in (0x00, 0x7F, 0xFF):
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
    assert refused > 500
    assert peak < 10 << 20


def test_a_file_that_shrinks_after_opening_is_refused(serial: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(serial.read_bytes())
    dump = BinaryDump(path)
    path.write_bytes(serial.read_bytes()[:-500])
    with pytest.raises(InputError, match=r"a\.bin: changed while it was read"):
        dump.read()
    path.unlink()
    with pytest.raises(InputError, match=r"a\.bin: no such file"):
        dump.read()


# size

READ_THROUGH = """
import sys
from pathlib import Path
from analysis.files.recording import blocks
from lammps_inputs import Kick, Scene
scene = Scene(name="long", chains=2, beads=120, kick=(Kick(velocity=1.0),), duration=1.0, timestep=0.01)
print(sum(block.frames for block in blocks([Path(sys.argv[1])], scene.problem())))
status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
print(status["VmHWM"].split()[0])
"""


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is measured through /proc")
def test_three_hundred_megabytes_are_read_through_in_two_hundred(tmp_path: Path) -> None:
    problem = TWO.model_copy(update={"beads": 120}).problem()
    path = tmp_path / "long.bin"
    with Writer(path, problem) as writer:
        writer.append(0, np.zeros((2, 120)), np.zeros((2, 120)))
    raw = np.tile(np.frombuffer(path.read_bytes(), np.uint8), (1000, 1))
    with path.open("wb") as file:
        for start in range(0, 51_000, 1000):
            steps = problem.steps_per_frame * np.arange(start, start + 1000, dtype="<i8")[:, np.newaxis]
            raw[:, 26:34] = steps.view(np.uint8)
            raw[:, 127:135] = (steps * problem.timestep).view(np.uint8)  # the time, after units and flag
            file.write(raw.data)
    assert path.stat().st_size > 300e6
    out = subprocess.run([sys.executable, "-c", READ_THROUGH, path], capture_output=True, text=True, check=True)
    path.unlink()
    frames, kilobytes = map(int, out.stdout.split())
    assert frames == 51_000
    assert kilobytes < 200_000
