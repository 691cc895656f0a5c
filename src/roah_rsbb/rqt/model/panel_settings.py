"""Settings of one panel, where rqt does not keep them."""

from python_qt_binding.QtCore import QSettings


class PanelSettings:
    """QSettings with rqt's names, for one panel."""

    def __init__(self, settings: QSettings, name: str) -> None:
        self._settings = settings
        self._name = name

    def set_value(self, key: str, value) -> None:
        """Keep a value."""
        self._settings.setValue(f"{self._name}/{key}", value)

    def value(self, key: str, default=None):
        """The value kept, or `default`."""
        return self._settings.value(f"{self._name}/{key}", default)
