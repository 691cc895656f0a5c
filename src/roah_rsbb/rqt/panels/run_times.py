"""The phase and the times of a run, as panels show them: with words and a mark, never with colour alone."""

from typing import NamedTuple, Optional

from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.qt import QHBoxLayout, QLabel, Qt, QVBoxLayout, QWidget
from roah_rsbb.wording import sheets
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import Clock, Figure, Hurry


class PhaseLook(NamedTuple):
    """How a phase looks."""

    text: str
    tone: basic.Tone


def phase_look(zone: ZoneSeen, clock: Optional[Clock] = None) -> PhaseLook:
    """Return the phase of a zone, with the reason if the run has ended or its `clock` is paused."""
    if clock is not None and clock.pause and zone.phase in sheets.PHASES:
        return PhaseLook(f"‖ {clock.pause}", basic.OLD)
    return PhaseLook(sheets.marked_phase(zone.phase, zone.end_reason),
                     basic.PHASES[sheets.look(zone.phase, zone.end_reason)])


# How the last seconds look. Those of the last 10 s have marks, words and a frame: they stand out without colour.
_TONES = {Hurry.NO: None, Hurry.SOON: basic.OLD, Hurry.LAST: basic.ALARM}
_LAST = tr_later("‼ LAST SECONDS ‼ {label}")
# Between the two times. Without a gap, they read as one long number.
BETWEEN_EMS = 2.5


def marked(figure: Figure) -> str:
    """Return the time, with a mark in its last seconds."""
    return f"‼ {figure.text}" if figure.hurry is Hurry.LAST else figure.text


def known(clock: Optional[Clock]) -> Clock:
    """Return the times of a run, or one that says that they are not known."""
    return clock or Clock(Figure(tr("Time"), "–:––"))


def tone_of(figure: Figure) -> Optional[basic.Tone]:
    """Return the colours of a time; None: the usual ones."""
    return _TONES[figure.hurry]


class _Time(QWidget):
    """A time and its label."""

    def __init__(self) -> None:
        super().__init__()
        self.label = QLabel(alignment=Qt.AlignCenter, textFormat=Qt.PlainText)
        self.label.setMinimumWidth(1)
        self.figure = basic.FittedText()
        column = basic.flat(QVBoxLayout(self))
        column.setSpacing(0)
        column.addWidget(self.label)
        column.addWidget(self.figure, 1)

    def show_figure(self, figure: Figure, is_old: bool) -> None:
        """Show a time. Brackets and grey show that it is old."""
        is_last = figure.hurry is Hurry.LAST
        self.label.setText(tr(_LAST, label=figure.label) if is_last else figure.label)
        basic.enlarged(self.label, basic.TEXT, bold=is_last)
        self.figure.setText(f"({figure.text})" if is_old else figure.text)
        self.figure.set_tone(None if is_old else tone_of(figure), framed=is_last)
        self.figure.setEnabled(not is_old)


class TimesWidget(QWidget):
    """All times of a run. Its size does not depend on them."""

    def __init__(self) -> None:
        super().__init__()
        self.main, self.goal = _Time(), _Time()
        self.aside = QLabel(" ", alignment=Qt.AlignCenter, textFormat=Qt.PlainText)
        self.aside.setMinimumWidth(1)
        figures = QHBoxLayout()
        figures.setSpacing(round(BETWEEN_EMS * basic.em()))
        figures.addWidget(self.main, 1)
        figures.addWidget(self.goal, 1)
        column = basic.flat(QVBoxLayout(self))
        column.setSpacing(0)
        column.addLayout(figures, 1)
        column.addWidget(self.aside)

    def show_clock(self, clock: Optional[Clock], is_old: bool) -> None:
        """Show the times of a run; None: they are not known."""
        clock = known(clock)
        self.main.show_figure(clock.main, is_old)
        self.goal.setVisible(clock.goal is not None)
        if clock.goal is not None:
            self.goal.show_figure(clock.goal, is_old)
        self.aside.setText(clock.aside or " ")
        self.aside.setEnabled(not is_old)
