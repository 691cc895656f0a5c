"""The dialog that pairs phones and tablets, and lists and ends their pairings (docs/web.md, "Pairing")."""

import time
from functools import partial
from typing import List, Optional

from roah_rsbb import qr_code
from roah_rsbb.model.web_calls import PAIR, PAIRED, REVOKE
from roah_rsbb.rqt.model.calls import CallOutcome, Calls
from roah_rsbb.rqt.qt import (
    QColor,
    QComboBox,
    QDialog,
    QHBoxLayout,
    QLabel,
    QPainter,
    QPushButton,
    Qt,
    QTimer,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.device import ROLES, encryption_text, role_text
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.times import Moments, countdown

ORGANISER = "organiser"
# How often the list of devices is asked for, and the countdown is shown.
LIST_MS, TICK_MS = 2000, 500
# In units of the desktop's font.
SQUARE_EMS, WIDE_EMS = 18, 44


class Square(QWidget):
    """A QR code: always dark on light, as readers need it."""

    def __init__(self) -> None:
        super().__init__()
        self._rows: Optional[List[List[bool]]] = None
        side = round(SQUARE_EMS * basic.em())
        self.setFixedSize(side, side)

    def show_text(self, text: str) -> None:
        """Show the code of a text; empty: none."""
        self._rows = qr_code.modules_of(text) if text else None
        self.setVisible(self._rows is not None)
        self.setAccessibleName(text)
        self.update()

    def paintEvent(self, event) -> None:
        if self._rows is None:
            return
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor("white"))
        size = self.width() // len(self._rows)
        margin = (self.width() - size * len(self._rows)) // 2
        for y, row in enumerate(self._rows):
            for x, is_dark in enumerate(row):
                if is_dark:
                    painter.fillRect(margin + x * size, margin + y * size, size, size, QColor("black"))
        painter.end()


class PairDialog(QDialog):
    """Shows a code for one device, and all paired devices."""

    def __init__(self, parent: QWidget, calls: Calls, moments: Moments, zone: str) -> None:
        super().__init__(parent, windowTitle=tr("Pair a phone or tablet"))
        self.setAttribute(Qt.WA_DeleteOnClose)
        self._calls = calls
        self._moments = moments
        self._zone = zone
        self._valid_until = 0.0  # monotonic time
        self.roles = QComboBox()
        for role in ROLES:
            self.roles.addItem(role_text(role, "" if role == ORGANISER else zone), role)
        self.make = QPushButton(tr("New code"))
        self.square = Square()
        self.code = basic.enlarged(QLabel(), 2.0, bold=True)
        self.how = QLabel(wordWrap=True)
        for label in (self.code, self.how):
            label.setTextFormat(Qt.PlainText)
            label.setTextInteractionFlags(Qt.TextSelectableByMouse)
        self.devices = QTreeWidget()
        self.devices.setRootIsDecorated(False)
        self.devices.setHeaderLabels([tr("Person"), tr("May act as"), tr("Device"), tr("Last seen"), ""])
        self.trouble = QLabel(wordWrap=True, textFormat=Qt.PlainText)
        self._lay_out()
        self.make.clicked.connect(self._ask_code)
        self.roles.activated.connect(self._ask_code)
        self._tick_timer = QTimer(self, timeout=self._tick)
        self._tick_timer.start(TICK_MS)
        self._list_timer = QTimer(self, timeout=self._ask_list)
        self._list_timer.start(LIST_MS)
        self.finished.connect(lambda: calls.forget(self))
        self._show_code("", "", 0.0)
        self._ask_code()
        self._ask_list()

    def _lay_out(self) -> None:
        box = QVBoxLayout(self)
        row = QHBoxLayout()
        row.addWidget(self.roles, 1)
        row.addWidget(self.make)
        box.addLayout(row)
        row = QHBoxLayout()
        row.addWidget(self.square)
        texts = QVBoxLayout()
        texts.addWidget(self.code)
        texts.addWidget(self.how)
        texts.addStretch(1)
        row.addLayout(texts, 1)
        box.addLayout(row)
        box.addWidget(self.trouble)
        box.addWidget(self.devices, 1)
        close = QPushButton(tr("Close"))
        close.clicked.connect(self.reject)
        box.addWidget(close, 0, Qt.AlignRight)
        self.resize(round(WIDE_EMS * basic.em()), round(0.9 * WIDE_EMS * basic.em()))

    # -- codes ----------------------------------------------------------------------------------------

    def _ask_code(self) -> None:
        role = self.roles.currentData()
        zone = "" if role == ORGANISER else self._zone
        self._show_code("", "", 0.0)
        self.make.setEnabled(False)
        self._calls.call(self, PAIR, self._on_code, role=role, zone=zone)

    def _on_code(self, outcome: CallOutcome) -> None:
        self.make.setEnabled(True)
        self.trouble.setText(outcome.error)
        if not outcome.error:
            answer = outcome.result
            self._show_code(answer["code"], answer["url"], answer["valid"])

    def _show_code(self, code: str, url: str, valid_s: float) -> None:
        self._valid_until = time.monotonic() + valid_s
        self.code.setText(code)
        self.square.show_text(url)
        how = ""
        if code:
            page = url.partition("#")[0]
            how = (tr("Scan the code with the device, or open {page} and type it. It is for one device.", page=page)
                   if self.square.isVisibleTo(self) else
                   tr("Open {page} on the device and type the code. It is for one device. For a QR code: {install}",
                      page=page, install=qr_code.INSTALL))
            how = "\n\n".join(filter(None, [how, encryption_text(url)]))
        self._how = how
        self._tick()

    def _tick(self) -> None:
        left_s = self._valid_until - time.monotonic()
        if not self.code.text():
            self.how.setText("")
        elif left_s > 0.0:
            self.how.setText(f"{self._how}\n\n{tr('Valid for {time}', time=countdown(left_s))}")
        else:
            self.square.show_text("")
            self.how.setText(tr("The code is too old: press New code"))

    # -- devices --------------------------------------------------------------------------------------

    def _ask_list(self) -> None:
        self._calls.call(self, PAIRED, self._on_list)

    def _on_list(self, outcome: CallOutcome) -> None:
        if outcome.error:
            self.trouble.setText(outcome.error)
            return
        shown = [self.devices.topLevelItem(i).data(0, Qt.UserRole) for i in range(self.devices.topLevelItemCount())]
        devices = outcome.result["devices"]
        if [one["id"] for one in devices] != shown:
            self._fill(devices)
        for i, one in enumerate(devices):
            self.devices.topLevelItem(i).setText(
                3, tr("connected") if one["connected"] else self._moments.stamp(one["seen"] or one["paired"]))

    def _fill(self, devices: list) -> None:
        self.devices.clear()
        for one in devices:
            item = QTreeWidgetItem([one["person"], role_text(one["role"], one["zone"]), one["device"], ""])
            item.setData(0, Qt.UserRole, one["id"])
            self.devices.addTopLevelItem(item)
            end = basic.CommandButton(tr("End pairing"), tr("End this pairing at once"), 1.0)
            end.allow(True)
            end.hold()  # a click may be meant for the one that was here
            end.setAccessibleName(tr("End the pairing of {person}", person=one["person"]))
            end.clicked.connect(partial(self._revoke, one["id"]))
            self.devices.setItemWidget(item, 4, end)
        for column in range(4):
            self.devices.resizeColumnToContents(column)

    def _revoke(self, device: str) -> None:
        def done(outcome: CallOutcome) -> None:
            self.trouble.setText(outcome.error)
            self._ask_list()

        self._calls.call(self, REVOKE, done, device=device)
