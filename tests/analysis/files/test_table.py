"""A user's table comes back number for number, and whatever is none ends in one line."""

import contextlib
import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from analysis.files import table
from lammps_inputs import InputError

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


@st.composite
def grids(draw):
    """(time, chains, beads, displacement or None, velocity or None) with every place filled."""
    time = np.array(sorted(draw(st.lists(NUMBERS, min_size=1, max_size=5, unique=True))))
    time = np.unique(time + 0.0)  # -0 and 0 are one time
    chains = np.array(sorted(draw(st.sets(st.integers(1, 9), min_size=1, max_size=3))))
    beads = np.array(sorted(draw(st.sets(st.integers(1, 10**6), min_size=1, max_size=4))))
    shape = (len(time), len(chains), len(beads))
    present = draw(st.sampled_from([(True, True), (True, False), (False, True)]))
    return (
        time,
        chains,
        beads,
        *(draw(arrays(np.float64, shape, elements=NUMBERS)) if is_in else None for is_in in present),
    )


def long_columns(grid):
    """The columns of a table of a grid."""
    time, chains, beads, displacement, velocity = grid
    places = [axis.ravel() for axis in np.meshgrid(time, chains, beads, indexing="ij")]
    columns = dict(zip(("time", "chain", "bead"), places, strict=True))
    for name, values in (("displacement", displacement), ("velocity", velocity)):
        if values is not None:
            columns[name] = values.ravel()
    return columns


def as_text(columns, between, order, head=""):
    names = list(columns)
    rows = [between.join(repr(columns[name][k].item()) for name in names) for k in order]
    return "\n".join([head + between.join(names), *rows]) + "\n"


def same(found, grid):
    for own, given_ in zip(
        (found.time, found.chains, found.beads, found.displacement, found.velocity), grid, strict=True
    ):
        if given_ is None:
            assert own is None
        else:
            np.testing.assert_array_equal(own, given_)


def read_or_refused(path):
    """Load whatever is there; `InputError` makes its text one line."""
    with contextlib.suppress(InputError):
        table.load(path)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return tmp_path_factory.mktemp("table") / "table.dat"


@pytest.mark.slow
@given(grids(), st.sampled_from([",", " ", "\t", ", "]), st.sampled_from(["", "# ", "#", "\ufeff"]), st.randoms())
def test_text_comes_back_number_for_number_in_any_order_of_rows(path, grid, between, head, random):
    columns = long_columns(grid)
    order = list(range(len(columns["time"])))
    random.shuffle(order)
    path.write_text(as_text(columns, between, order, head), encoding="utf-8")
    same(table.load(path), grid)


@pytest.mark.slow
@given(grids(), st.randoms())
def test_an_npz_of_a_grid_comes_back_with_chains_and_beads_in_order(path, grid, random):
    time, chains, beads, *values = grid
    by_chain, by_bead = random.sample(range(len(chains)), len(chains)), random.sample(range(len(beads)), len(beads))
    shuffled = {
        name: value[:, by_chain][:, :, by_bead]
        for name, value in zip(("displacement", "velocity"), values, strict=True)
        if value is not None
    }
    with path.open("wb") as file:
        np.savez(file, time=time, chain=chains[by_chain], bead=beads[by_bead], **shuffled)
    same(table.load(path), grid)


HEAD = "time,chain,bead,velocity\n"


def grid_of(**changes):
    return {"time": np.arange(3.0), "velocity": np.ones((3, 2, 4)), **changes}


def columns_of(**changes):
    return {"time": np.arange(3.0), "chain": np.ones(3), "bead": np.ones(3), "velocity": np.ones(3), **changes}


WRONG_ARRAYS = {
    "pickled": (columns_of(velocity=np.array([None, {}, 1])), "not an npz of plain numbers"),
    "other lengths": (columns_of(velocity=np.ones(4)), "different lengths"),
    "empty": (columns_of(velocity=np.ones(0)), "'velocity' is empty"),
    "too few chains": (grid_of(chain=np.array([1])), "do not number"),
    "grids of two shapes": (grid_of(displacement=np.ones((3, 2, 5))), "do not fit together"),
    "times that go back": (grid_of(time=np.array([0.0, 2.0, 1.0])), "not ascending"),
    "a chain twice": (grid_of(chain=np.array([1, 1])), "named twice"),
    "NaN": (grid_of(velocity=np.full((3, 2, 4), np.nan)), "'velocity' holds nan in entry 1, 1, 1"),
    "every row of its own": (
        {name: np.arange(2000.0) for name in ("time", "chain", "bead", "velocity")},
        "2000 times of 2000 chains and 2000 beads are too many",
    ),
}


@pytest.mark.parametrize("case", WRONG_ARRAYS)
def test_what_is_wrong_with_an_npz_is_said_in_one_line(case, path):
    content, words = WRONG_ARRAYS[case]
    with path.open("wb") as file:
        np.savez(file, **content)
    with pytest.raises(InputError) as error:
        table.load(path)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.slow
@given(st.data())
def test_a_damaged_npz_is_read_or_refused(path, data):
    out = io.BytesIO()
    np.savez(out, **columns_of())
    content = bytearray(out.getvalue())
    for place in data.draw(st.lists(st.integers(2, len(content) - 1), max_size=4)):
        content[place] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(4, len(content)))])
    read_or_refused(path)


@pytest.mark.slow
@given(st.sampled_from([b"", HEAD.encode()]), st.binary(max_size=80) | st.text(max_size=80))
def test_any_bytes_and_any_text_after_a_header_are_read_or_refused(path, head, content):
    path.write_bytes(head + (content if isinstance(content, bytes) else content.encode(errors="surrogatepass")))
    read_or_refused(path)


def test_an_npz_that_unpacks_to_more_than_is_read_here_is_refused_before_it_does(tmp_path, monkeypatch):
    path = tmp_path / "bomb.npz"
    np.savez_compressed(path, time=np.zeros(10**6))
    monkeypatch.setattr(table, "MAX_BYTES", 10**6)
    with pytest.raises(InputError, match=r"bomb.npz: unpacks to 0.008 GB; at most 0.001 GB are read here"):
        table.load(path)
