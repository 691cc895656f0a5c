"""The times of a run, side by side: of the run and of its goal, each with its label."""

from typing import Optional

from roah_rsbb.rqt.qt import QGridLayout, QLabel, Qt, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.clock import Clock, Figure, Hurry

UNKNOWN = Clock(Figure("Time", "–:––"))
# How the last seconds look. Those of the last 10 s have marks, so that they stand out without colour.
_TONES = {Hurry.NO: None, Hurry.SOON: basic.OLD, Hurry.LAST: basic.ALARM}
_LAST = "‼ {} ‼"
_LAST_LABEL = "LAST SECONDS · {}"


def marked(figure: Figure) -> str:
    """Returns the time, with marks in its last seconds."""
    return _LAST.format(figure.text) if figure.hurry is Hurry.LAST else figure.text


def tone_of(figure: Figure) -> Optional[basic.Tone]:
    """Returns the colours of a time; None: the usual ones."""
    return _TONES[figure.hurry]


class _Time(QWidget):
    """A time and its label."""

    def __init__(self) -> None:
        super().__init__()
        self.label = QLabel(alignment=Qt.AlignCenter)
        self.label.setMinimumWidth(1)
        self.figure = basic.FittedText(lines_high=2.6)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setSpacing(0)
        grid.addWidget(self.label, 0, 0)
        grid.addWidget(self.figure, 1, 0)
        grid.setRowStretch(1, 1)

    def show_figure(self, figure: Figure, is_old: bool) -> None:
        """Show a time. Brackets and grey show that it is old."""
        is_last = figure.hurry is Hurry.LAST
        self.label.setText(_LAST_LABEL.format(figure.label) if is_last else figure.label)
        self.figure.setText(f"({figure.text})" if is_old else marked(figure))
        self.figure.set_tone(None if is_old else tone_of(figure))
        self.figure.setEnabled(not is_old)


class RunTimes(QWidget):
    """All times of a run. Its size does not depend on them."""

    def __init__(self) -> None:
        super().__init__()
        self.main, self.goal = _Time(), _Time()
        self.aside = QLabel(" ", alignment=Qt.AlignCenter)
        self.aside.setMinimumWidth(1)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setVerticalSpacing(0)
        grid.addWidget(self.main, 0, 0)
        grid.addWidget(self.goal, 0, 1)
        grid.addWidget(self.aside, 1, 0, 1, 2)
        grid.setRowStretch(0, 1)
        for column in range(2):
            grid.setColumnStretch(column, 1)

    def show_clock(self, clock: Optional[Clock], is_old: bool) -> None:
        """Show the times of a run; None: they are not known."""
        clock = clock or UNKNOWN
        self.main.show_figure(clock.main, is_old)
        self.goal.setVisible(clock.goal is not None)
        if clock.goal is not None:
            self.goal.show_figure(clock.goal, is_old)
        self.aside.setText(clock.aside or " ")
        self.aside.setEnabled(not is_old)
