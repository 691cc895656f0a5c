"""A panel in which the referee's name is typed, because what is written down there carries it."""

from typing import Optional

from python_qt_binding.QtWidgets import QWidget

from roah_rsbb.rqt.model.client import Client
from roah_rsbb.rqt.model.referee_name import RefereeLine
from roah_rsbb.rqt.panels.panel import Panel


class RefereePanel(Panel):
    """Base of such panels. A subclass puts `self.referee` where it belongs."""

    def __init__(self, client: Client, parent: Optional[QWidget] = None) -> None:
        super().__init__(client, parent)
        self.referee = RefereeLine(client.referee)

    def shutdown(self) -> None:
        self.referee.end()
        super().shutdown()

    def save_settings(self, settings) -> None:
        self.referee.save(settings)

    def restore_settings(self, settings) -> None:
        self.referee.restore(settings)
