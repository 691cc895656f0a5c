"""Log Display: the log of the zone's run, as it is written (docs/referee.md, "Log Display")."""

import re

from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt.panels.text_panel import TextPanel
from roah_rsbb.rqt.qt import QColor, QSyntaxHighlighter, QTextCharFormat, QTextDocument
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr_later

# The core writes the level of warnings and errors after the time.
LINE = re.compile(r"^\S+ (WARNING|ERROR): ")
TONES = {"WARNING": basic.OLD, "ERROR": basic.ALARM}


class LevelColours(QSyntaxHighlighter):
    """Highlights warnings and errors in a document, also in lines that are added later."""

    def __init__(self, document: QTextDocument) -> None:
        super().__init__(document)
        self._looks = {level: _look(tone) for level, tone in TONES.items()}

    def highlightBlock(self, text: str) -> None:
        match = LINE.match(text)
        if match:
            self.setFormat(0, len(text), self._looks[match.group(1)])


def _look(tone: basic.Tone) -> QTextCharFormat:
    look = QTextCharFormat()
    look.setBackground(QColor(tone.background))
    look.setForeground(QColor(tone.text))
    look.setFontWeight(75)
    return look


class LogDisplayPanel(TextPanel):
    """The run's log, with warnings and errors highlighted."""

    TITLE = tr_later("Log Display")
    TAB = tr_later("Log")
    NOTHING = tr_later("Nothing has been logged yet")

    def __init__(self, client) -> None:
        super().__init__(client)
        self._colours = LevelColours(self.view.document())

    def text_of(self, zone: ZoneSeen) -> str:
        return zone.log
