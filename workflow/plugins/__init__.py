"""Parts that may be deleted, one folder each, declared as entry points in ``pyproject.toml``."""
