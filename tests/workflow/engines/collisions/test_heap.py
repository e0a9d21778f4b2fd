import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from workflow.engines.collisions.engine import make_heap, reschedule


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 40), st.integers(0, 2**31))
def test_the_first_member_is_always_the_earliest(members, seed):
    random = np.random.default_rng(seed)
    heap = make_heap(members)
    times = np.full(members, np.inf)
    for _ in range(200):
        member = int(random.integers(members))
        times[member] = random.choice([np.inf, float(random.integers(5)), random.random()])
        reschedule(heap, member, times[member])
        assert heap.time[heap.member[0]] == times.min()
        assert np.array_equal(heap.member[heap.place], np.arange(members))
