"""A panel with a growing text: the base of Online Data and Log Display."""

from roah_rsbb.document.difference import added
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt.panels.collapsing import CollapsingPanel
from roah_rsbb.rqt.qt import QCheckBox, QFontDatabase, QPlainTextEdit, QTextCursor
from roah_rsbb.rqt.widgets.text_search import TextSearch
from roah_rsbb.wording.language import tr

# The core publishes only the end of the text; the panel keeps what it received since it was opened.
MAX_LINES = 5000


class TextPanel(CollapsingPanel):
    """Shows a text of the zone and follows its end, unless the referee scrolls."""

    NOTHING = ""
    WORKS_BEHIND = True

    def __init__(self, client) -> None:
        super().__init__(client)
        self._source: tuple = ()
        self._published = ""
        self.view = QPlainTextEdit(readOnly=True)
        self.view.setPlaceholderText(tr(self.NOTHING))
        self.view.setMaximumBlockCount(MAX_LINES)
        font = QFontDatabase.systemFont(QFontDatabase.FixedFont)
        self.view.setFont(font)
        self.follow = QCheckBox(tr("Follow the end"))
        self.follow.setChecked(True)
        self.follow.toggled.connect(self._to_end)
        self.search = TextSearch(self.view, self)
        # New lines must not scroll a match away.
        self.search.jumped.connect(lambda: self.follow.setChecked(False))
        self.body.addWidget(self.view, 1)
        self.body.addWidget(self.search)
        self.body.addWidget(self.follow)

    def text_of(self, zone: ZoneSeen) -> str:
        """Return the text that this panel shows."""
        raise NotImplementedError

    def where(self) -> str:
        last = self._published.rstrip("\n").rpartition("\n")[2]
        return f"{tr(self.TITLE)}: {last}" if self.is_collapsed and last else super().where()

    def parts(self) -> tuple:
        zone = self.model.zone
        return () if zone is None else (zone.event.id, self.text_of(zone))

    def show_model(self) -> None:
        zone = self.model.zone
        source = () if zone is None else (zone.zone, zone.event.id)
        published = "" if zone is None else self.client.moments.lines(self.text_of(zone), self.model.now().utc)
        more = added(self._published, published) if source == self._source else None
        self._source, self._published = source, published
        if more is None:
            self.view.setPlainText(published)
            self._to_end()
        elif more:
            self._append(more)

    def save_settings(self, settings) -> None:
        settings.set_value("follow", self.follow.isChecked())

    def restore_settings(self, settings) -> None:
        # Settings files contain text.
        self.follow.setChecked(str(settings.value("follow", True)).lower() == "true")

    def _append(self, text: str) -> None:
        """Append text without changing the scroll position or the selection."""
        bar = self.view.verticalScrollBar()
        at = bar.value()
        cursor = QTextCursor(self.view.document())
        cursor.movePosition(QTextCursor.End)
        cursor.insertText(text)
        bar.setValue(bar.maximum() if self.follow.isChecked() else at)

    def _to_end(self) -> None:
        if self.follow.isChecked():
            bar = self.view.verticalScrollBar()
            bar.setValue(bar.maximum())
