"""Qt, from the binding that this machine has: `from roah_rsbb.rqt.qt import QLabel, Qt, Signal`.

rqt chooses its binding through python_qt_binding, and the panels must use the same one. Where python_qt_binding is
missing, as on Debian 13, rqt is missing too, and the panels use PyQt5 directly.
"""

import importlib
import importlib.util
from typing import Any

_BINDING = "python_qt_binding" if importlib.util.find_spec("python_qt_binding") else "PyQt5"
_MODULES = ("QtCore", "QtGui", "QtWidgets", "QtTest")
# python_qt_binding gives these names to all bindings.
_PYQT5_NAMES = {"Signal": "pyqtSignal", "Slot": "pyqtSlot", "Property": "pyqtProperty"}


def __getattr__(name: str) -> Any:
    """Find a name in the modules of Qt; each module is loaded only when it is needed."""
    if name.startswith("__"):
        raise AttributeError(name)
    wanted = _PYQT5_NAMES.get(name, name) if _BINDING == "PyQt5" else name
    for module in _MODULES:
        found = getattr(importlib.import_module(f"{_BINDING}.{module}"), wanted, None)
        if found is not None:
            globals()[name] = found
            return found
    raise AttributeError(f"Qt has no {name}")
