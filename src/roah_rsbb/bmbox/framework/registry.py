"""Finds all benchmarking modules: classes derived from `Module`, with a code, in the files of `bmbox/`."""

import importlib
import inspect
import pkgutil
import traceback
from typing import Callable, Dict, Optional, Type

from roah_rsbb import bmbox
from roah_rsbb.bmbox.framework.module import Module


def modules(report: Optional[Callable[[str], None]] = None) -> Dict[str, Type[Module]]:
    """Return the modules by code.

    An invalid file, or a second file for the same code, raises an exception. If `report` is given, it is called with
    the reason instead, and only that file is omitted.
    """
    found: Dict[str, Type[Module]] = {}
    for info in pkgutil.iter_modules(bmbox.__path__):
        try:
            for kind in _of_file(info.name).values():
                if kind.CODE in found:
                    raise ValueError(f"{kind.__module__} and {found[kind.CODE].__module__} both define {kind.CODE}")
                found[kind.CODE] = kind
        except Exception as error:  # the file may contain any error
            if report is None:
                raise
            trace = "".join(traceback.format_exception(type(error), error, error.__traceback__))
            report(f"{info.name}.py cannot be used. Repair it and restart: {error}\n{trace}")
    return found


def _of_file(name: str) -> Dict[str, Type[Module]]:
    file = importlib.import_module(f"{bmbox.__name__}.{name}")
    return {
        name: kind for name, kind in inspect.getmembers(file, inspect.isclass)
        if issubclass(kind, Module) and kind.CODE and kind.__module__ == file.__name__
    }
