"""The dialog with what a reload of the configuration found: errors, or the changes to be applied."""

from typing import Callable, List, Optional

from roah_rsbb.rqt.qt import QDialog, QDialogButtonBox, QLabel, QPlainTextEdit, Qt, QVBoxLayout, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr

# Size, in units of the desktop's font.
WIDE_EMS, HIGH_EMS = 52, 26


class ReloadDialog(QDialog):
    """Shows the lines, and calls `apply()` if the organiser confirms. Without `apply`, it can only be closed."""

    def __init__(self, parent: QWidget, heading: str, lines: List[str], apply: Optional[Callable[[], None]]) -> None:
        super().__init__(parent, windowTitle=tr("Reload configuration"))
        self.setAttribute(Qt.WA_DeleteOnClose)
        box = QVBoxLayout(self)
        label = basic.enlarged(QLabel(heading, wordWrap=True, textFormat=Qt.PlainText), 1.2, bold=True)
        box.addWidget(label)
        self.lines = QPlainTextEdit("\n".join(lines), readOnly=True)
        box.addWidget(self.lines, 1)
        buttons = QDialogButtonBox()
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        if apply is None:
            buttons.addButton(tr("Close"), QDialogButtonBox.RejectRole)
        else:
            self.apply = buttons.addButton(tr("Apply"), QDialogButtonBox.AcceptRole)
            self.apply.setAutoDefault(False)
            cancel = buttons.addButton(tr("Cancel"), QDialogButtonBox.RejectRole)
            cancel.setDefault(True)
            self.accepted.connect(apply)
        box.addWidget(buttons)
        self.resize(round(WIDE_EMS * basic.em()), round(HIGH_EMS * basic.em()))
