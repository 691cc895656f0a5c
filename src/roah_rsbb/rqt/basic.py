"""Small widgets that the panels share. Sizes are multiples of the desktop's font."""

import html
import math
import re
from typing import Callable, Iterable, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.fields import typed_number
from roah_rsbb.rqt.qt import (
    QApplication,
    QColor,
    QDialog,
    QEvent,
    QFont,
    QFontMetricsF,
    QLabel,
    QLayout,
    QMenu,
    QPainter,
    QPalette,
    QPushButton,
    QSize,
    QSizePolicy,
    QSpinBox,
    Qt,
    QTextEdit,
    QTimer,
    QToolButton,
    QWidget,
)
from roah_rsbb.wording import texts
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.whole_box import REPLAY


class Tone(NamedTuple):
    """Colours that are legible on light and dark desktops. Colour is never the only sign."""

    background: str
    text: str

    @property
    def css(self) -> str:
        """The colours, for a style sheet."""
        return f"background: {self.background}; color: {self.text};"


# As in tokens.css of the pages: a test compares them.
# By `sheets.look` of a phase.
PHASES = {look: Tone(band, "#ffffff") for look, band in (
    ("waiting", "#515c68"), ("ready", "#0a6475"), ("executing", "#1b4fc4"), ("stopped", "#2b3138"),
    ("completed", "#3d587c"), ("timeout", "#76502c"))}
IDLE, DONE = PHASES["waiting"], PHASES["completed"]
YES = Tone("#0c6838", "#ffffff")  # --achievement
OLD = Tone("#ffefcc", "#734600")  # --warning-wash, --warning
STOP = Tone("#b3001b", "#ffffff")  # of STOP and of nothing else
ALARM = Tone("#734600", "#ffefcc")
OFF = Tone("transparent", "palette(text)")
ON = Tone("palette(text)", "palette(base)")  # what is on, and the next action: ink, as --action
# Text of a disabled button, legible on light and dark desktops.
FADED = "#8c8c8c"
# Surfaces, edges and texts, by the tokens of the pages, whose names have dashes: in light and in dark windows.
SURFACES = {
    "surface_page": ("#eceff2", "#0c1015", [QPalette.Window]),
    "surface_sheet": ("#ffffff", "#141a21", [QPalette.Base, QPalette.ToolTipBase]),
    "surface_raised": ("#ffffff", "#1c242d", [QPalette.Button, QPalette.Light]),
    "surface_well": ("#f3f5f7", "#0f141a", [QPalette.AlternateBase]),
    "line": ("#d6dbe1", "#2a343f", [QPalette.Midlight]),
    "line_control": ("#78838f", "#6f7d8b", [QPalette.Mid, QPalette.Dark]),
    "text": ("#14191f", "#eef2f6", [QPalette.WindowText, QPalette.Text, QPalette.ButtonText, QPalette.ToolTipText,
                                    QPalette.Highlight]),
    "action_text": ("#ffffff", "#0c1015", [QPalette.HighlightedText]),
}
# The type scale of the pages: relative to the desktop's font, steps of 1.2.
TEXT, LEAD, TITLE, FIGURE = 1.0, 1.2, 1.44, 1.728
# What all parts share. Lengths are in units of the font of each part.
LOOK = f"""
QPushButton, QToolButton {{ background: palette(button); border: 1px solid palette(mid); border-radius: 0.4em;
    padding: 0.15em 0.5em; }}
QPushButton:hover, QPushButton:focus, QToolButton:hover {{ border-color: palette(text); }}
QPushButton:pressed, QToolButton:pressed {{ background: palette(midlight); }}
QPushButton:disabled, QToolButton:disabled {{ background: transparent; color: {FADED};
    border-color: palette(midlight); }}
QToolButton::menu-indicator {{ image: none; }}
QGroupBox {{ background: palette(base); border: 1px solid palette(midlight); border-radius: 0.5em;
    margin-top: 1.4em; }}
QGroupBox::title {{ subcontrol-origin: margin; left: 0; }}
QPlainTextEdit, QTextEdit, QTableView {{ border: 1px solid palette(midlight); background: palette(base); }}
QHeaderView::section {{ background: palette(alternate-base); border: none; border-bottom: 1px solid palette(mid);
    padding: 0.15em 0.4em; font-weight: bold; }}
QTabBar::tab {{ padding: 0.3em 0.7em; border: none; border-top: 0.2em solid transparent; }}
QTabBar::tab:selected {{ border-top-color: palette(text); background: palette(base); }}
QTabBar::tab:hover:!selected {{ background: palette(midlight); }}
QMainWindow::separator {{ background: palette(midlight); width: 5px; height: 5px; margin: 2px; }}
QToolBar {{ border: none; }}
"""


def dress(app: QApplication) -> QApplication:
    """Give a program the surfaces and the parts of the pages; returns it. Colours that the desktop chose decide between
    light and dark."""
    is_dark = app.palette().color(QPalette.Window).lightness() < 128
    palette = app.palette()
    for light, dark, roles in SURFACES.values():
        for role in roles:
            palette.setColor(role, QColor(dark if is_dark else light))
    for role in (QPalette.WindowText, QPalette.Text, QPalette.ButtonText):
        palette.setColor(QPalette.Disabled, role, QColor(FADED))
    app.setStyle("Fusion")
    app.setPalette(palette)
    app.setStyleSheet(LOOK)
    return app


# No text of a referee is smaller, in points, or in pixels where the desktop's font is given in pixels.
LEAST_PT, LEAST_PX = 9.0, 12

# After a press a button ignores further presses for this long: a double click is one command.
HOLD_MS = 1000


def em() -> float:
    """Return the height of the desktop's font in pixels, the unit of all sizes."""
    return QFontMetricsF(QApplication.font()).height()


def enlarged(widget: QWidget, factor: float, bold: bool = False) -> QWidget:
    """Give `widget` the desktop's font, scaled by `factor`. Returns the widget."""
    font = scaled(QApplication.font(), factor)
    font.setBold(bold)
    widget.setFont(font)
    return widget


def scaled(font: QFont, factor: float) -> QFont:
    """Return a copy of the font, scaled by `factor`, and never smaller than can be read."""
    font = QFont(font)
    if font.pointSizeF() > 0:
        font.setPointSizeF(max(LEAST_PT, font.pointSizeF() * factor))
    else:
        font.setPixelSize(max(LEAST_PX, round(font.pixelSize() * factor)))
    return font


def show_dialog(dialog: QDialog) -> None:
    """Show a dialog that blocks no other window, so that STOP stays available.

    A question that the same widget asked before is cancelled.
    """
    for other in dialog.parent().findChildren(QDialog):
        if other.property("is_question"):
            other.reject()
    dialog.setProperty("is_question", True)
    show_alone(dialog)


def show_alone(dialog: QDialog) -> None:
    """Show a dialog that asks nothing. It blocks no other window."""
    dialog.setWindowModality(Qt.NonModal)
    dialog.show()
    dialog.raise_()
    dialog.activateWindow()


def set_style(widget: QWidget, style: str) -> None:
    """Set a style sheet if it changed: setting it again would redo the layout. The font stays, which Qt would reset
    where the application has a style sheet, too."""
    if widget.styleSheet() != style:
        font = QFont(widget.font())
        widget.setStyleSheet(style)
        widget.ensurePolished()
        widget.setFont(font)


def tip(text: str) -> str:
    """Return a tooltip that shows `text` unchanged, as HTML: Qt wraps long lines in HTML only."""
    return f"<p>{_escaped(text)}</p>" if text else ""


def button(text: str, pressed: Callable[[], None], factor: float = 1.0, bold: bool = False) -> QPushButton:
    """Return a button that Tab reaches. A click does not focus it: a stray space bar does nothing."""
    made = enlarged(QPushButton(text, focusPolicy=Qt.TabFocus), factor, bold)
    made.clicked.connect(lambda _checked: pressed())
    return made


def flat(layout: QLayout) -> QLayout:
    """Remove the margins of a layout. Returns the layout."""
    layout.setContentsMargins(0, 0, 0, 0)
    return layout


def around(widget: QWidget, kind: type) -> Optional[QWidget]:
    """Return the nearest widget of this kind that a widget is in; None: it is in none."""
    parent = widget.parentWidget()
    while parent is not None and not isinstance(parent, kind):
        parent = parent.parentWidget()
    return parent


class NoWheel:
    """The first base of a field that ignores the mouse wheel: scrolling must not change a value."""

    def wheelEvent(self, event) -> None:
        event.ignore()


class AnyRegion:
    """The first base of a field for a number: it takes the decimal comma and the typographic minus, in any language."""

    def validate(self, text: str, place: int):
        """See QAbstractSpinBox."""
        is_empty = text == self.specialValueText()
        return super().validate(text if is_empty else typed_number(text, self.minimum(), self.maximum()), place)


class WholeField(AnyRegion, QSpinBox):
    """A whole number."""


def _escaped(text: str) -> str:
    return html.escape(text).replace("\n", "<br>")


class ShortenedLabel(QLabel):
    """A text in one line, which ends with "…" where space is short. Its size does not depend on that."""

    PADDING_EMS = 0.0
    _text = ""

    def __init__(self) -> None:
        super().__init__()
        self.setTextFormat(Qt.PlainText)

    def text(self) -> str:
        """Return the whole text."""
        return self._text

    def setText(self, text: str) -> None:
        if text != self._text:
            self._text = text
            self._shorten()
            self.updateGeometry()

    def sizeHint(self) -> QSize:
        metrics = self.fontMetrics()
        return QSize(metrics.horizontalAdvance(self._text) + self._padding() + 1, super().sizeHint().height())

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self._shorten()

    def changeEvent(self, event) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.FontChange, QEvent.StyleChange):
            self._shorten()

    def shown(self) -> str:
        """Return the text as it is on the screen."""
        return QLabel.text(self)

    def _padding(self) -> int:
        return math.ceil(self.PADDING_EMS * self.fontMetrics().height())

    def _shorten(self) -> None:
        width = self.width() - self._padding()
        super().setText(self.fontMetrics().elidedText(self._text, Qt.ElideRight, width))


# A text that is too long is written smaller, by these factors, before it is cut off.
SHRINK = (1.0, 0.85, 0.7)


class FilledLabel(QLabel):
    """A text as large as its place allows, which it never enlarges. Where it does not fit, a brief one takes its place
    if there is one. A text that does not fit ends with "…"."""

    def __init__(self) -> None:
        super().__init__(wordWrap=True)
        self.factor = 1.0
        self._whole = self._brief = ""
        self.setTextFormat(Qt.PlainText)
        self.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Expanding)

    def hasHeightForWidth(self) -> bool:
        return False

    def sizeHint(self) -> QSize:
        return QSize(1, round(1.3 * self.factor * em()))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def settle(self) -> None:
        """Write the text as large as the space allows."""
        shortest = self._brief or self._whole
        for text in (self._whole, shortest):
            self.setText(text)
            for shrink in SHRINK:
                enlarged(self, shrink * self.factor, bold=True)
                if self._fits():
                    return
        words = shortest.split(" ")
        while len(words) > 1 and not self._fits():
            words.pop()
            self.setText(f"{' '.join(words)} …")

    def _fits(self) -> bool:
        return self.heightForWidth(self.width()) <= self.height()

    @property
    def whole(self) -> str:
        """The text, also where it is cut off on the screen."""
        return self._whole

    def show_text(self, text: str, brief: str = "") -> None:
        """Show another text. `brief`: the same in fewer words."""
        if (text, brief) != (self._whole, self._brief):
            self._whole, self._brief = text, brief
            self.settle()

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self.settle()


class Badge(ShortenedLabel):
    """A short text on a colour."""

    PADDING_EMS = 1.0

    def __init__(self, factor: float = 1.0) -> None:
        super().__init__()
        enlarged(self, factor, bold=True)
        self.setAlignment(Qt.AlignCenter)
        self.setMinimumWidth(1)  # a long text must not push its neighbours away

    def show_text(self, text: str, tone: Tone) -> None:
        """Show `text`, on the tone's colour."""
        self.setText(text)
        set_style(self, f"{tone.css} padding: 0.1em 0.5em;")


class Notices(QTextEdit):
    """Lines of text, with warnings marked. A long list scrolls instead of growing."""

    def __init__(self, factor: float = LEAD) -> None:
        super().__init__()
        enlarged(self, factor)
        self.setReadOnly(True)
        self.setFocusPolicy(Qt.ClickFocus)
        self._lines: Tuple[Tuple[str, bool], ...] = ()

    def show_lines(self, lines: Iterable[Tuple[str, bool]]) -> None:
        """Show lines: the text, and whether it is a warning."""
        shown = tuple(lines)
        if shown != self._lines:
            self._lines = shown
            self.setHtml("".join(_notice_html(text, alarm) for text, alarm in shown))


def _notice_html(text: str, alarm: bool) -> str:
    if not alarm:
        return f'<p style="margin: 0">{_escaped(text)}</p>'
    return f'<p style="margin: 0; background-color: {OLD.background}; color: {OLD.text}"><b>⚠ {_escaped(text)}</b></p>'


class FittedText(QWidget):
    """A text as large as its rectangle allows. Changing digits do not change its size."""

    LINES_HIGH = 2.6  # minimum height, in lines of the desktop's font

    def __init__(self) -> None:
        super().__init__()
        self._text = ""
        self.tone: Optional[Tone] = None
        self.framed = False
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    def text(self) -> str:
        """The text shown."""
        return self._text

    def setText(self, text: str) -> None:
        """Show another text."""
        if text != self._text:
            self._text = text
            self.update()

    def set_tone(self, tone: Optional[Tone], framed: bool = False) -> None:
        """Show the text in these colours, perhaps in a frame; None: in the usual ones."""
        if (tone, framed) != (self.tone, self.framed):
            self.tone, self.framed = tone, framed
            self.update()

    def sizeHint(self) -> QSize:
        return QSize(round(10 * em()), round(2 * self.LINES_HIGH * em()))

    def minimumSizeHint(self) -> QSize:
        return QSize(round(5 * em()), round(self.LINES_HIGH * em()))

    def paintEvent(self, event) -> None:
        painter = QPainter(self)
        painter.setFont(self.fitted_font())
        painter.setPen(self.palette().color(QPalette.WindowText))
        if self.tone is not None:
            edge = round(0.4 * em()) if self.framed else 0
            painter.fillRect(self.rect(), Qt.black)
            painter.fillRect(self.rect().adjusted(edge, edge, -edge, -edge), QColor(self.tone.background))
            painter.setPen(QColor(self.tone.text))
        painter.drawText(self.rect(), Qt.AlignCenter, self._text)

    def fitted_font(self) -> QFont:
        """Return the largest font in which the text fits; all digits count as equally wide."""
        font = QFont(self.font())
        font.setPixelSize(100)
        metrics = QFontMetricsF(font)
        width = metrics.horizontalAdvance(re.sub(r"\d", "0", self._text) or "0")
        room = min(self.width() / width, self.height() / metrics.height())
        font.setPixelSize(max(1, int(100 * room)))
        return font


class MenuButton(QToolButton):
    """A button that opens its menu, `entries`."""

    def __init__(self, text: str, factor: float = 1.0) -> None:
        super().__init__()
        enlarged(self, factor, bold=True)
        self.setText(text)
        self.setFocusPolicy(Qt.TabFocus)
        self.setPopupMode(QToolButton.InstantPopup)
        self.entries = QMenu(self)
        self.setMenu(self.entries)


MOST_LEAST_EMS = 8.0


class CommandButton(QPushButton):
    """A button that gives a command, by `pressed()`. While it is disabled its tooltip lists the reasons."""

    def __init__(
        self, text: str, explanation: str, factor: float = LEAD, pressed: Optional[Callable[[], object]] = None,
    ) -> None:
        super().__init__(text)
        if pressed is not None:
            self.clicked.connect(lambda _checked: pressed())
        enlarged(self, factor, bold=True)
        # Tab reaches it, but a click does not focus it: a stray space bar does nothing.
        self.setFocusPolicy(Qt.TabFocus)
        self.explanation = explanation
        self._allowed = False
        self.why_off = ""  # one reason per line; empty: it is enabled
        self._held = QTimer(self, singleShot=True, timeout=self._apply)
        self.setEnabled(False)

    def sizeHint(self) -> QSize:
        """Keep space around the text, also where a style sheet removes the platform's."""
        room = round(2.2 * self.fontMetrics().height())
        return QSize(self.fontMetrics().horizontalAdvance(self.text()) + round(1.5 * em()), room)

    def minimumSizeHint(self) -> QSize:
        """Return the size for the text, unless it is so long that a small window would have no place for its panels."""
        return self.sizeHint().boundedTo(QSize(round(MOST_LEAST_EMS * em()), round(MOST_LEAST_EMS * em())))

    def allow(self, allowed: bool, reasons: Sequence[str] = (), tone: Optional[Tone] = None) -> None:
        """Enable or disable it. `tone`: colour while enabled."""
        self._allowed = allowed
        self.why_off = "" if allowed else texts.bullets(reasons or (tr("Not possible now"),))
        self.setToolTip(tip(self.why_off or self.explanation))
        on = allowed and tone is not None
        set_style(self, _button_style(tone) if on else "")
        self._apply()

    def hold(self) -> None:
        """Ignore presses for a moment: it was pressed."""
        self._held.start(HOLD_MS)
        self._apply()

    def let_go(self) -> None:
        """Accept presses at once: the command failed."""
        self._held.stop()
        self._apply()

    def is_on(self) -> bool:
        """Whether the command may be given now."""
        return self._allowed and not self._held.isActive()

    def _apply(self) -> None:
        self.setEnabled(self.is_on())


def _button_style(tone: Tone) -> str:
    return f"QPushButton:enabled {{ {tone.css} border-color: {tone.background}; }}"


class MarkedTitle:
    """Puts a mark in front of the title of a window, such as that of a replay, and removes it again."""

    def __init__(self, window: QWidget, mark: str = REPLAY) -> None:
        self._window = window
        self._mark = f"{tr(mark)} – "
        self._is_marked = False

    def show(self, is_marked: bool) -> None:
        """Mark the title, or remove the mark."""
        if is_marked != self._is_marked:
            self._is_marked = is_marked
            title = self._window.windowTitle()
            self._window.setWindowTitle(self._mark + title if is_marked else title.replace(self._mark, "", 1))
