"""The advice on ranks and cost, held against real runs."""

import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_problems import problem
from stock_lammps import WHEEL, scene

from lammps_inputs import file_names
from lammps_inputs.decks import continuation, scene_files
from lammps_inputs.numbers import time_text
from workflow.cost_model import MESSAGES, bead_seconds, cost
from workflow.plugins.jobs import ranks

PEAK_MEMORY = f"""
import resource, subprocess
subprocess.run([{str(WHEEL)!r}, "-in", "in.both", "-screen", "none"], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)
"""


def many(beads, coupled=True, chains=100):
    return problem(chains=chains, beads=beads // chains, kappa=0.1 if coupled else 0.0)


@pytest.mark.slow
@given(st.integers(2, 10**6), st.integers(1, 10**4), st.integers(1, 4096), st.booleans())
def test_no_rank_has_fewer_beads_than_its_messages_are_worth_or_fewer_than_twenty_rows(beads, chains, most, coupled):
    what = problem(chains=chains, beads=beads, kappa=0.1 if coupled else 0.0)
    advised = ranks.advised(what, most)
    assert 1 <= advised <= most
    if advised > 1:
        assert chains * beads / advised >= ranks.least_beads(what)
        assert beads / advised >= ranks.LEAST_ROWS


@pytest.mark.parametrize("coupled", [True, False])
def test_a_rank_with_the_least_beads_spends_a_tenth_of_its_time_on_messages(coupled):
    what = many(10**6, coupled)
    work = ranks.least_beads(what) * bead_seconds(what)
    assert work / (work + MESSAGES) == pytest.approx(ranks.EFFICIENCY, rel=1e-3)


def test_what_is_said_of_ranks_holds_their_number_beads_seconds_and_memory():
    few = many(240, chains=2)
    assert cost(few, 2).seconds > cost(few, 1).seconds
    alone = time_text(cost(few, 1).seconds)
    assert ranks.too_many(few, 2) == f"one rank would be faster: about {alone} with --nodes 1 --ranks-per-node 1"
    assert ranks.too_many(few, 1) == ranks.too_many(many(10**4), 2) == ""
    sentence = ranks.sentence(many(10**8, chains=1000), 1000)
    for words in ("on 1000 ranks of 100000 beads", "2 ms a step", "140 GB of memory", "(2.4 GB each)"):
        assert words in sentence


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [scene(chains=10, beads=2000, kappa=0.1), scene(beads=20_000)], ids=["coupled", "lone"]
)
def test_bytes_of_a_frame_of_a_restart_and_of_memory_are_those_of_a_real_run(case, tmp_path):
    case = case.model_copy(update={"duration": 1.0})
    scene_files.write(case, tmp_path)
    lines = [f"include {file_names.DECK}", *continuation.restart_lines(case.problem())]
    (tmp_path / "in.both").write_text("\n".join(lines) + "\n")
    done = subprocess.run([sys.executable, "-c", PEAK_MEMORY], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert cost(case.problem(), 1).frames == pytest.approx((tmp_path / file_names.DUMP).stat().st_size, rel=0.01)
    assert ranks.restart(case.problem()) == pytest.approx((tmp_path / file_names.UNFINISHED).stat().st_size, rel=0.25)
    memory = ranks.memory(case.problem(), 1)
    assert 0.5 * memory < int(done.stdout) < 1.2 * memory
