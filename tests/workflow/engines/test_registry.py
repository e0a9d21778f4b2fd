"""Engines by their entry points: names, records, and what no distribution declares."""

import subprocess
import sys

import pytest
from processes import HANGS

from lammps_inputs import file_names
from workflow.engines.registry import engine_names
from workflow.runs.engines import Engine, engine_called
from workflow.runs.files import RECORD
from workflow.runs.job import Job


@pytest.mark.parametrize("name", engine_names())
def test_an_engine_has_the_name_under_which_it_is_declared_and_leaves_its_scene_and_record(name):
    engine = engine_called(name)
    assert isinstance(engine, Engine)
    assert engine.name == name
    assert {file_names.SCENE, RECORD, file_names.DUMP, *engine.inputs} <= set(engine.files)
    assert issubclass(engine.record, Job)
    assert engine.table is None or engine.table[0] in engine.files


def test_listing_the_engines_loads_none_of_them():
    code = "import sys; from workflow.engines.registry import engine_names; assert len(engine_names()) > 1"
    code += "; print(*(name for name in sys.modules if name.startswith('workflow.runs')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=HANGS, check=True)
    assert done.stdout.split() == []
