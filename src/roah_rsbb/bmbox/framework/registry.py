"""All benchmarking modules by code: each file of this room that has a `Module` with a code."""

import importlib
import inspect
import pkgutil
import traceback
from typing import Callable, Dict, Optional, Type

from roah_rsbb import bmbox
from roah_rsbb.bmbox.framework.module import Module


def modules(tell: Optional[Callable[[str], None]] = None) -> Dict[str, Type[Module]]:
    """The modules by code.

    A file that cannot be imported, or drives what another one drives already, raises; but where `tell` takes the
    reason, only that file is left out.
    """
    found: Dict[str, Type[Module]] = {}
    for info in pkgutil.iter_modules(bmbox.__path__):
        try:
            for kind in _of_file(info.name).values():
                if kind.CODE in found:
                    raise ValueError(f"{kind.__module__} and {found[kind.CODE].__module__} both drive {kind.CODE}")
                found[kind.CODE] = kind
        except Exception as error:  # whatever its author did
            if tell is None:
                raise
            trace = "".join(traceback.format_exception(type(error), error, error.__traceback__))
            tell(f"{info.name}.py cannot be used, mend it and start again: {error}\n{trace}")
    return found


def _of_file(name: str) -> Dict[str, Type[Module]]:
    file = importlib.import_module(f"{bmbox.__name__}.{name}")
    return {
        name: kind for name, kind in inspect.getmembers(file, inspect.isclass)
        if issubclass(kind, Module) and kind.CODE and kind.__module__ == file.__name__
    }
