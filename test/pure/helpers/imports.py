"""The imports in Python files, read once for all tests."""

import ast
import functools
import pathlib
from typing import Iterator, List, NamedTuple, Tuple


class Import(NamedTuple):
    """An import: `import module`, or `from module import name`."""

    module: str
    name: str = ""


def _statements(tree: ast.Module) -> Iterator[ast.AST]:
    """All statements. Most nodes are expressions, which hold none."""
    waiting: List[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            waiting += getattr(node, part, None) or ()


@functools.lru_cache(maxsize=None)
def imports_of(path: pathlib.Path) -> Tuple[Import, ...]:
    """Return all imports anywhere in a file."""
    found = []
    for node in _statements(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [Import(alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            found += [Import(node.module, alias.name) for alias in node.names]
    return tuple(found)
