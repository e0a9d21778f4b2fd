"""Names that a module imports for type checkers, and has when they are first used.

Such a module is quick to import, and says once where each of its names is from.
"""

import ast
import importlib
from pathlib import Path
from typing import Any


def sources(path: str) -> dict[str, tuple[str, str]]:
    """Name -> module, and name in it, by the statements under ``if TYPE_CHECKING`` of a file."""
    statements = ast.parse(Path(path).read_text(encoding="utf-8")).body
    [checked] = [node for node in statements if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]
    return {
        alias.asname or alias.name: (str(node.module), alias.name)
        for node in checked.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def imported(module: str, name: str) -> Any:
    """Attribute of a module, or a module in a package."""
    package = importlib.import_module(module)
    return getattr(package, name) if hasattr(package, name) else importlib.import_module(f"{module}.{name}")
