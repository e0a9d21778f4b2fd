"""JSON, CSV and printed cells follow from what the fields of a result declare."""

import numpy as np
import pytest

from analysis.quantity import (
    declare,
    derived,
    plain,
    result,
    table,
    to_csv,
)
from lammps_inputs.units import make_scale


@result
class Passage:
    bead: int = declare("number of the bead")
    time: float = declare("when", "time", "never")
    undeclared: float = 1.0

    @property
    @derived("time")
    def double(self) -> float:
        """Twice that."""
        return 2.0 * self.time


@result
class Result:
    passages: list[Passage | None] = declare("of each chain")
    speed: np.ndarray = declare("speed", "speed", "unknown")
    size: float = declare("amplitude", "V")


SCALE = make_scale(2.0, 3.0, 0.1, si=True)
RESULT = Result([Passage(3, 5.0), None, Passage(4, np.nan)], np.array([[2.0, np.inf]]), 0.5)


def test_json_holds_declared_fields_and_properties_in_the_scenes_units_and_null_where_undefined():
    time = SCALE.time
    assert plain(RESULT, SCALE) == {
        "passages": [
            {"bead": 3, "time": 5.0 * time, "double": 10.0 * time},
            None,
            {"bead": 4, "time": None, "double": None},
        ],
        "speed": [[2.0 / time, None]],
        "size": 0.5,
    }


@pytest.mark.parametrize(("si", "head"), [(True, "bead,time (s),double (s)"), (False, "bead,time,double")])
def test_a_csv_table_has_a_column_for_each_quantity_headed_by_its_unit_and_nothing_where_undefined(si, head):
    scale = make_scale(2.0, 3.0, 0.1, si=si)
    column = Passage(np.array([3, 4]), np.array([5.0, np.nan]))
    time = 5.0 * scale.time
    assert to_csv(table(column, scale)).splitlines() == [head, f"3,{time!r},{2.0 * time!r}", "4,,"]
