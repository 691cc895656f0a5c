"""Python's garbage collector, in Qt's thread only.

By itself it runs in whichever thread creates an object, such as one of rospy's. If it destroys a widget there while Qt
handles an event of that widget, the program crashes.
"""

import gc
from typing import Optional

from roah_rsbb.rqt.qt import QApplication, QTimer

PERIOD_MS = 1000
_timer: Optional[QTimer] = None


def collect_here() -> None:
    """Collect garbage in this thread only, which must be Qt's. Further calls have no effect."""
    global _timer
    if _timer is not None:
        return
    gc.disable()
    _timer = QTimer(QApplication.instance())
    _timer.timeout.connect(_collect)
    _timer.start(PERIOD_MS)


def _collect() -> None:
    """Collect the oldest generation that is due by Python's own thresholds."""
    for generation in (2, 1, 0):
        if gc.get_count()[generation] > gc.get_threshold()[generation]:
            gc.collect(generation)
            return
