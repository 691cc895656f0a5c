"""The public display: the clock, what is running, and what comes next.

Meant to be read from ten metres: sizes are shares of the screen's height, not of the desktop's font. A
capital of 1/25 of the height of a 55 inch screen is 27 mm high; that is legible from ten metres.
"""

import time
from typing import List, NamedTuple, Optional

from python_qt_binding.QtCore import QRectF, Qt
from python_qt_binding.QtGui import QColor, QFont, QFontMetricsF, QPainter
from python_qt_binding.QtWidgets import QWidget

from roah_rsbb.msg import CoreToPublic, ScheduleInfo
from roah_rsbb.rqt import texts

# The core publishes twice a second; its clock, in seconds, is in every message. A message that is the same
# again may come from a core that hangs (latched, to a new subscription): it is no sign of life.
SILENT_S = 2.0

BACKGROUND = QColor("#0b1220")
TEXT = QColor("#f4f6fa")
FAINT = QColor("#9fb0c8")
RUNNING_BACKGROUND = QColor("#f7cc06")
RUNNING_TEXT = QColor("#101010")
OLD_BACKGROUND = QColor("#7a1020")

# Shares of the height of the screen.
HEAD = 0.15
TITLE = 0.07
RUNNING_ROW = 0.155
NEXT_ROW = 0.105
EDGE = 0.03
# A font fills this share of its row's height.
FILL = 0.68
MAX_RUNNING = 3
ALL_TEAMS = "ALL"


class Line(NamedTuple):
    """An event as it is shown."""

    time: str
    team: str
    benchmark: str
    turn: str


def line_of(event: ScheduleInfo, clock: str) -> Line:
    """What is shown of an event when the box's clock shows `clock`."""
    team = "All teams" if event.team == ALL_TEAMS else event.team
    return Line(texts.short_time(event.time, clock), team, event.benchmark, f"Round {event.round}, run {event.run}")


class PublicDisplay(QWidget):
    """A full screen without controls. `feed` is a `roah_rsbb.client.feed.Feed` of `topic`."""

    def __init__(self, feed, topic: str, parent: Optional[QWidget] = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("RoAH RSBB – public display")
        self.setCursor(Qt.BlankCursor)
        self._feed = feed
        self._topic = topic
        self._message: Optional[CoreToPublic] = None
        self._heard: Optional[float] = None
        self._was_old = True

    def look(self) -> None:
        """Take what the core published; call it several times a second."""
        received = self._feed.take(self._topic)
        news = received is not None and received.message != self._message
        if news:
            self._message, self._heard = received.message, received.mono
        if news or self.is_old != self._was_old:
            self._was_old = self.is_old
            self.update()

    @property
    def is_old(self) -> bool:
        """Whether the core has been silent for too long."""
        return self._heard is None or time.monotonic() - self._heard > SILENT_S

    # -- painting -----------------------------------------------------------------------------------

    def paintEvent(self, event) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.TextAntialiasing)
        painter.fillRect(self.rect(), BACKGROUND)
        high, edge = self.height(), EDGE * self.height()
        self._paint_head(painter, QRectF(edge, 0, self.width() - 2 * edge, HEAD * high))
        if self._message is None:
            area = QRectF(edge, 0.4 * high, self.width() - 2 * edge, 0.2 * high)
            _write(painter, area, "Waiting for the referee box", 0.08 * high, FAINT, Qt.AlignCenter)
            return
        clock = self._message.clock
        running = [line_of(e, clock) for e in self._message.schedule if e.running]
        following = [line_of(e, clock) for e in self._message.schedule if not e.running]
        top = self._paint_running(painter, running, HEAD * high)
        self._paint_next(painter, following, top)

    def _paint_head(self, painter: QPainter, area: QRectF) -> None:
        clock = self._message.clock if self._message else ""
        size = 0.75 * area.height()
        if self.is_old and self._message is not None:
            painter.fillRect(QRectF(0, 0, self.width(), area.height()), OLD_BACKGROUND)
            text = f"No signal since {clock.rpartition(' ')[2]}: what is shown is old"
            _write(painter, area, text, 0.5 * size, TEXT, Qt.AlignCenter)
            return
        date, _, hours = clock.rpartition(" ")
        _write(painter, area, hours, size, TEXT, Qt.AlignRight)
        _write(painter, area, date, 0.5 * size, FAINT, Qt.AlignLeft)

    def _paint_running(self, painter: QPainter, lines: List[Line], top: float) -> float:
        """Returns where what follows may begin."""
        high, edge = self.height(), EDGE * self.height()
        wide = self.width() - 2 * edge
        title = f"Running now (+{len(lines) - MAX_RUNNING} more)" if len(lines) > MAX_RUNNING else "Running now"
        _write(painter, QRectF(edge, top, wide, TITLE * high), title, FILL * TITLE * high, FAINT, Qt.AlignLeft)
        top += TITLE * high
        if not lines:
            area = QRectF(edge, top, wide, NEXT_ROW * high)
            _write(painter, area, "Nothing at the moment", FILL * NEXT_ROW * high, TEXT, Qt.AlignLeft)
            return top + NEXT_ROW * high
        for line in lines[:MAX_RUNNING]:
            area = QRectF(edge / 2, top, self.width() - edge, 0.94 * RUNNING_ROW * high)
            painter.setRenderHint(QPainter.Antialiasing)
            painter.setPen(Qt.NoPen)
            painter.setBrush(RUNNING_BACKGROUND)
            painter.drawRoundedRect(area, edge / 2, edge / 2)
            inside = area.adjusted(edge / 2, 0, -edge / 2, 0)
            upper = QRectF(inside.left(), inside.top(), inside.width(), 0.6 * inside.height())
            lower = QRectF(inside.left(), upper.bottom(), inside.width(), 0.36 * inside.height())
            turn = _write(painter, upper, line.turn, 0.5 * upper.height(), RUNNING_TEXT, Qt.AlignRight)
            upper.setRight(upper.right() - turn - edge)
            _write(painter, upper, f"▶ {line.team}", 0.88 * upper.height(), RUNNING_TEXT, Qt.AlignLeft, bold=True)
            _write(painter, lower, line.benchmark, 0.88 * lower.height(), RUNNING_TEXT, Qt.AlignLeft)
            top += RUNNING_ROW * high
        return top

    def _paint_next(self, painter: QPainter, lines: List[Line], top: float) -> None:
        high, edge = self.height(), EDGE * self.height()
        left, wide = edge, self.width() - 2 * edge
        _write(painter, QRectF(left, top, wide, TITLE * high), "Next", FILL * TITLE * high, FAINT, Qt.AlignLeft)
        top += TITLE * high
        size = FILL * NEXT_ROW * high
        shown = lines[:max(0, int((high - top) / (NEXT_ROW * high)))]
        if not shown:
            _write(painter, QRectF(left, top, wide, NEXT_ROW * high), "The schedule is done", size, TEXT, Qt.AlignLeft)
        times = min(max((_width(line.time, 0.8 * size) for line in shown), default=0.0), 0.3 * wide)
        teams = min(max((_width(line.team, size, bold=True) for line in shown), default=0.0), 0.35 * wide)
        for line in shown:
            row = QRectF(left, top, wide, NEXT_ROW * high)
            _write(painter, QRectF(left, top, times, row.height()), line.time, 0.8 * size, FAINT, Qt.AlignLeft)
            x = left + times + edge
            _write(painter, QRectF(x, top, teams, row.height()), line.team, size, TEXT, Qt.AlignLeft, bold=True)
            x += teams + edge
            area = QRectF(x, top, left + wide - x, row.height())
            _write(painter, area, line.benchmark, 0.8 * size, TEXT, Qt.AlignLeft)
            top += row.height()


def _font(size: float, bold: bool) -> QFont:
    font = QFont()
    font.setPixelSize(max(1, round(size)))
    font.setBold(bold)
    return font


def _width(text: str, size: float, bold: bool = False) -> float:
    return QFontMetricsF(_font(size, bold)).horizontalAdvance(text)


def _write(painter: QPainter, area: QRectF, text: str, size: float, color: QColor, side, bold: bool = False) -> float:
    """Write one line of `size` pixels in `area`, shortened where it does not fit; returns its width."""
    font = _font(size, bold)
    metrics = QFontMetricsF(font)
    shown = metrics.elidedText(text, Qt.ElideRight, area.width())
    painter.setFont(font)
    painter.setPen(color)
    painter.drawText(area, side | Qt.AlignVCenter | Qt.TextSingleLine, shown)
    return metrics.horizontalAdvance(shown)
