"""All benchmarking modules by code: each file of this room that has a `Module` with a code."""

import importlib
import inspect
import pkgutil
from typing import Dict, Type

from roah_rsbb import bmbox
from roah_rsbb.bmbox.module import Module


def modules() -> Dict[str, Type[Module]]:
    """The modules by code. ValueError when two have the same."""
    found: Dict[str, Type[Module]] = {}
    for info in pkgutil.iter_modules(bmbox.__path__):
        file = importlib.import_module(f"{bmbox.__name__}.{info.name}")
        for _, kind in inspect.getmembers(file, inspect.isclass):
            if not (issubclass(kind, Module) and kind.CODE and kind.__module__ == file.__name__):
                continue
            if kind.CODE in found:
                raise ValueError(f"{kind.__module__} and {found[kind.CODE].__module__} both drive {kind.CODE}")
            found[kind.CODE] = kind
    return found
