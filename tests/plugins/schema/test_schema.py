"""`granchain schema` prints the schemas that are declared."""

import json

import pytest

from lammps_inputs import plugins
from workflow.cli import main


@pytest.mark.slow
@pytest.mark.parametrize("kind", plugins.declared("schemas"))
def test_schema_prints_json(kind, capsys):
    assert main(["schema", kind]) == 0
    assert json.loads(capsys.readouterr().out) == plugins.load("schemas", kind)()
