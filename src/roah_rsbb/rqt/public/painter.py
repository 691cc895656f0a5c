"""Writes texts on the public display so that they are whole: smaller, then shortened, where they do not fit."""

from typing import List, NamedTuple

from python_qt_binding.QtCore import QRectF, Qt
from python_qt_binding.QtGui import QColor, QFont, QFontMetricsF, QPainter

from roah_rsbb.rqt.public.layout import Rect

# A text is made smaller down to this share before it is shortened: it must stay legible.
SMALLEST = 0.7


class Written(NamedTuple):
    """A text on the screen."""

    text: str
    shown: str  # the same, or shortened
    place: Rect  # that it was given
    ink: Rect  # that it takes


class Writer:
    """Writes with a painter, and remembers what was written where."""

    def __init__(self, painter: QPainter) -> None:
        self._painter = painter
        self.written: List[Written] = []

    def write(
        self, place: Rect, text: str, colour: QColor, fill: float = 0.7, side=Qt.AlignLeft, bold: bool = False
    ) -> None:
        """Write one line, whose letters fill that share of the height of `place`."""
        if not text or place.w <= 0:
            return
        pixels = int(fill * place.h)
        smallest = max(1, int(SMALLEST * pixels))
        # Letters come in whole pixels: their width does not follow their size exactly.
        while pixels > smallest and width(text, pixels, bold) > place.w:
            pixels -= 1
        font = _font(pixels, bold)
        metrics = QFontMetricsF(font)
        shown = text
        if metrics.horizontalAdvance(text) > place.w:
            # What it leaves may be a little wider than it says: letters come closer in other company.
            shown = metrics.elidedText(text, Qt.ElideRight, place.w - 0.2 * pixels)
        area = QRectF(*place)
        self._painter.setFont(font)
        self._painter.setPen(colour)
        flags = int(side | Qt.AlignVCenter | Qt.TextSingleLine)
        self._painter.drawText(area, flags, shown)
        ink = metrics.boundingRect(area, flags, shown)
        self.written.append(Written(text, shown, place, Rect(ink.x(), ink.y(), ink.width(), ink.height())))


def width(text: str, pixels: float, bold: bool = False) -> float:
    """How wide a text is in letters of that size."""
    return QFontMetricsF(_font(pixels, bold)).horizontalAdvance(text)


def _font(pixels: float, bold: bool) -> QFont:
    font = QFont()
    font.setPixelSize(max(1, int(pixels)))
    font.setBold(bold)
    return font
