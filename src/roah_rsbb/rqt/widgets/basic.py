"""Small widgets that the panels share. Sizes are in units of the desktop's font."""

import html
import re
from typing import Iterable, NamedTuple, Optional, Sequence, Tuple

from python_qt_binding.QtCore import QSize, Qt, QTimer, Signal
from python_qt_binding.QtGui import QFont, QFontMetricsF, QPainter, QPalette
from python_qt_binding.QtWidgets import QApplication, QLabel, QPushButton, QSizePolicy, QTextEdit, QWidget

from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import texts


class Tone(NamedTuple):
    """Colours of a piece of information, legible on light and dark desktops. Never the only sign of it."""

    background: str
    text: str


RUNNING = Tone("#12702b", "#ffffff")
READY = Tone("#14508c", "#ffffff")
ENDED = Tone("#5b3a86", "#ffffff")
IDLE = Tone("#565b61", "#ffffff")
OLD = Tone("#ffb300", "#000000")
ALARM = Tone("#b3001b", "#ffffff")
OFF = Tone("transparent", "palette(text)")
# Text of what is off: legible on light and dark buttons alike.
FADED = "#8c8c8c"

# A button that was pressed takes no second press for this long: a double click is one command.
HOLD_MS = 1000


def em() -> float:
    """Height of the desktop's font in pixels: the unit of all sizes."""
    return QFontMetricsF(QApplication.font()).height()


def enlarged(widget: QWidget, factor: float, bold: bool = False) -> QWidget:
    """Give `widget` the desktop's font, `factor` times as large; returns the widget."""
    font = QFont(QApplication.font())
    if font.pointSizeF() > 0:
        font.setPointSizeF(font.pointSizeF() * factor)
    else:
        font.setPixelSize(round(font.pixelSize() * factor))
    font.setBold(bold)
    widget.setFont(font)
    return widget


def set_style(widget: QWidget, style: str) -> None:
    """Set a style sheet if it changed; setting one anew costs a whole layout."""
    if widget.styleSheet() != style:
        widget.setStyleSheet(style)


def tip(text: str) -> str:
    """A tooltip that shows `text` as it is; Qt breaks long lines only of what it takes for HTML."""
    return f"<p>{_escaped(text)}</p>" if text else ""


def _escaped(text: str) -> str:
    return html.escape(text).replace("\n", "<br>")


class Badge(QLabel):
    """A short text on a colour."""

    def __init__(self, factor: float = 1.0, parent: Optional[QWidget] = None) -> None:
        super().__init__(parent)
        enlarged(self, factor, bold=True)
        self.setAlignment(Qt.AlignCenter)
        self.setMinimumWidth(1)  # a long text must not move what is beside it

    def show_text(self, text: str, tone: Tone) -> None:
        """Show `text`, on the tone's colour."""
        self.setText(text)
        set_style(self, f"background: {tone.background}; color: {tone.text}; padding: 0.1em 0.5em;")


class Notices(QTextEdit):
    """Lines to read; those that call for attention are marked. A long list scrolls, and moves nothing."""

    def __init__(self, factor: float = 1.2, parent: Optional[QWidget] = None) -> None:
        super().__init__(parent)
        enlarged(self, factor)
        self.setReadOnly(True)
        self.setFocusPolicy(Qt.ClickFocus)
        self._lines: Tuple[Tuple[str, bool], ...] = ()

    def show_lines(self, lines: Iterable[Tuple[str, bool]]) -> None:
        """Show lines: text, and whether it calls for attention."""
        shown = tuple(lines)
        if shown != self._lines:
            self._lines = shown
            self.setHtml("".join(_notice_html(text, alarm) for text, alarm in shown))


def _notice_html(text: str, alarm: bool) -> str:
    if not alarm:
        return f'<p style="margin: 0">{_escaped(text)}</p>'
    return f'<p style="margin: 0; background-color: {OLD.background}; color: {OLD.text}"><b>⚠ {_escaped(text)}</b></p>'


class FittedText(QWidget):
    """A text as large as its rectangle allows. Digits do not make it jump."""

    def __init__(self, lines_high: float = 2.0, parent: Optional[QWidget] = None) -> None:
        """`lines_high`: least height, in lines of the desktop's font."""
        super().__init__(parent)
        self._text = ""
        self._lines_high = lines_high
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    def text(self) -> str:
        """The text shown."""
        return self._text

    def setText(self, text: str) -> None:
        """Show another text."""
        if text != self._text:
            self._text = text
            self.update()

    def sizeHint(self) -> QSize:
        return QSize(round(10 * em()), round(2 * self._lines_high * em()))

    def minimumSizeHint(self) -> QSize:
        return QSize(round(5 * em()), round(self._lines_high * em()))

    def paintEvent(self, event) -> None:
        painter = QPainter(self)
        painter.setFont(self.fitted_font())
        painter.setPen(self.palette().color(QPalette.WindowText))
        painter.drawText(self.rect(), Qt.AlignCenter, self._text)

    def fitted_font(self) -> QFont:
        """The largest font in which the text fits; figures count as equally wide."""
        font = QFont(self.font())
        font.setPixelSize(100)
        metrics = QFontMetricsF(font)
        width = metrics.horizontalAdvance(re.sub(r"\d", "0", self._text) or "0")
        room = min(self.width() / width, self.height() / metrics.height())
        font.setPixelSize(max(1, int(100 * room)))
        return font


class CommandButton(QPushButton):
    """A command to the core. While it is off its tooltip says why, each reason."""

    def __init__(self, text: str, explanation: str, factor: float = 1.3, parent: Optional[QWidget] = None) -> None:
        super().__init__(text, parent)
        enlarged(self, factor, bold=True)
        # Tab reaches it, a click does not leave the focus on it: a stray press of the space bar does nothing.
        self.setFocusPolicy(Qt.TabFocus)
        self._explanation = explanation
        self._allowed = False
        self.why_off = ""  # every reason, a line each; empty: it is on
        self._held = QTimer(self, singleShot=True)
        self._held.timeout.connect(self._apply)
        self.setEnabled(False)

    def sizeHint(self) -> QSize:
        """Room around the text also where a style sheet takes the platform's away."""
        room = round(2.4 * self.fontMetrics().height())
        return QSize(self.fontMetrics().horizontalAdvance(self.text()) + round(1.5 * em()), room)

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def allow(
        self, allowed: bool, reasons: Sequence[str] = (), tone: Optional[Tone] = None, explanation: str = ""
    ) -> None:
        """Switch it on or off; `tone`: colour while it is on; `explanation`: instead of the usual one."""
        self._allowed = allowed
        self.why_off = "" if allowed else texts.bullets(reasons or ("Not possible now",))
        self.setToolTip(tip(self.why_off or explanation or self._explanation))
        on = allowed and tone is not None
        set_style(self, _button_style(tone) if on else "")
        self._apply()

    def hold(self) -> None:
        """It was pressed."""
        self._held.start(HOLD_MS)
        self._apply()

    def let_go(self) -> None:
        """The command failed: it may be given again at once."""
        self._held.stop()
        self._apply()

    def is_on(self) -> bool:
        """Whether the command may be given now."""
        return self._allowed and not self._held.isActive()

    def _apply(self) -> None:
        self.setEnabled(self.is_on())


def _button_style(tone: Tone) -> str:
    return (
        f"QPushButton {{ background: {tone.background}; color: {tone.text}; border: 0.15em solid {tone.background};"
        " border-radius: 0.3em; }"
        f"QPushButton:hover, QPushButton:focus {{ border-color: {tone.text}; }}"
        f"QPushButton:disabled {{ background: palette(button); color: {FADED}; border-color: {FADED}; }}"
    )


KEEP_MS = 800
KEEP_HOLDING = "… keep holding"


class HoldButton(basic.CommandButton):
    """`kept` comes when it was held for KEEP_MS, `too_short` when it was let go before."""

    kept = Signal()
    too_short = Signal()

    def __init__(self, text: str, explanation: str, factor: float = 1.3, parent: Optional[QWidget] = None) -> None:
        super().__init__(text, explanation, factor, parent)
        self._text = text
        # Its text changes, its size must not.
        self.setText(KEEP_HOLDING)
        self.setMinimumWidth(self.sizeHint().width())
        self.setText(text)
        self._keeping = QTimer(self, singleShot=True)
        self._keeping.timeout.connect(self._on_kept)
        self.pressed.connect(self._on_pressed)
        self.released.connect(self._on_released)

    def _on_pressed(self) -> None:
        self.setText(KEEP_HOLDING)
        self._keeping.start(KEEP_MS)

    def _on_released(self) -> None:
        early = self._keeping.isActive()
        self._keeping.stop()
        self.setText(self._text)
        if early and self.is_on():  # where there is nothing to do any more, Qt lets it go by itself
            self.too_short.emit()

    def _on_kept(self) -> None:
        self.setText(self._text)
        if self.is_on():
            self.kept.emit()
