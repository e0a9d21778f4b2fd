"""The notebook, executed as a kernel does it: ``python tests/support/notebook.py`` writes its outputs into it."""

import ast
import base64
import contextlib
import io
import json
import os
import tempfile
from pathlib import Path

import workflow

NOTEBOOK = Path(workflow.__file__).parent / "first-steps.ipynb"

REPRESENTATIONS = {"text/html": "_repr_html_", "image/png": "_repr_png_"}


def executed(names):
    """The notebook with the outputs of its cells, which run here one after the other in a namespace."""
    book = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    for number, cell in enumerate((cell for cell in book["cells"] if cell["cell_type"] == "code"), 1):
        cell["execution_count"], cell["outputs"] = number, list(_outputs("".join(cell["source"]), number, names))
    return book


def _outputs(source, number, names):
    *body, last = ast.parse(source).body
    printed, shows = io.StringIO(), isinstance(last, ast.Expr)
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
        exec(compile(ast.Module(body if shows else [*body, last], []), NOTEBOOK.name, "exec"), names)
        shown = eval(compile(ast.Expression(last.value), NOTEBOOK.name, "eval"), names) if shows else None
    if printed.getvalue():
        yield {"name": "stdout", "output_type": "stream", "text": printed.getvalue().splitlines(keepends=True)}
    if shown is not None:
        data = {"text/plain": repr(shown).splitlines(keepends=True)}
        for kind, name in REPRESENTATIONS.items():
            if hasattr(shown, name):
                found = getattr(shown, name)()
                data[kind] = [found] if isinstance(found, str) else base64.b64encode(found).decode()
        yield {"data": data, "execution_count": number, "metadata": {}, "output_type": "execute_result"}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        os.chdir(made)
        book = executed({})
        NOTEBOOK.write_text(json.dumps(book, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
