"""The imports in Python files, read once for all tests."""

import ast
import functools
import pathlib
from typing import NamedTuple, Tuple


class Import(NamedTuple):
    """An import: `import module`, or `from module import name`."""

    module: str
    name: str = ""


@functools.lru_cache(maxsize=None)
def imports_of(path: pathlib.Path) -> Tuple[Import, ...]:
    """Return all imports anywhere in a file."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [Import(alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            found += [Import(node.module, alias.name) for alias in node.names]
    return tuple(found)
