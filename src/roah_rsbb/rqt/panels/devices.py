"""Devices: the last known state of each home device, and controls to operate it (docs/referee.md, "Devices").

It follows the topics below /devices, which another program than the box may have, too.
"""

import time
from functools import partial
from typing import Callable, Dict, List, Sequence

from roah_rsbb.document.calls import RING
from roah_rsbb.protocol import wire_seconds
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.calls import CallOutcome, Edits
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel
from roah_rsbb.rqt.qt import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QScrollArea,
    QSignalBlocker,
    QSlider,
    QSpinBox,
    Qt,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.wording import whole_box
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.whole_box import PERCENT, UNCONFIRMED

PAGE = 10
# Width of a name in units of the desktop's font, the same in all rows.
NAME_EMS = 6
COMMAND_EMS = 5


class DeviceRow(QWidget):
    """A device: its name, its state, and its controls.

    It calls `change(value)` when the referee sets another value.
    """

    def __init__(self, device: str, change: Callable[[int], None]) -> None:
        super().__init__()
        self.device, self.name = device, whole_box.device_name(device)
        self.change = change
        self.commands: List[basic.CommandButton] = []
        self.line = basic.flat(QHBoxLayout(self))
        title = basic.enlarged(QLabel(self.name, textFormat=Qt.PlainText), basic.LEAD, bold=True)
        title.setMinimumWidth(round(NAME_EMS * basic.em()))
        self.line.addWidget(title)

    def add_command(self, text: str, value: int) -> basic.CommandButton:
        """Add a button that asks for `value`."""
        button = basic.CommandButton(text, f"{text}: {self.name}", basic.TEXT, lambda: self.change(value))
        button.setMinimumWidth(round(COMMAND_EMS * basic.em()))
        self.commands.append(button)
        self.line.addWidget(button)
        return button

    def show_value(self, value: int, waiting: bool, off: Sequence[str]) -> None:
        """Show `value`. `waiting`: not confirmed yet; `off`: the reasons why the device cannot be operated."""
        raise NotImplementedError

    def _allow(self, off: Sequence[str]) -> None:
        for button in self.commands:
            button.allow(not off, off)


class TwoStateRow(DeviceRow):
    """A device with two states, such as a switch, and a button for each: a second press changes nothing."""

    def __init__(self, device: str, change: Callable[[int], None]) -> None:
        super().__init__(device, change)
        self.state = basic.Badge(basic.LEAD)
        self.state.setMinimumWidth(round(6 * basic.em()))
        self.line.addWidget(self.state, 1)
        for text, value in whole_box.device_commands(device):
            self.add_command(text, value)

    def show_value(self, value: int, waiting: bool, off: Sequence[str]) -> None:
        tone = basic.OFF if off else basic.ON if value else basic.IDLE
        state = whole_box.device_states(self.device)[bool(value)]
        self.state.show_text(f"{state}{UNCONFIRMED if waiting else ''}", tone)
        self.state.setEnabled(not off)
        self._allow(off)


class _Slider(basic.NoWheel, QSlider):
    pass


class _Number(basic.NoWheel, QSpinBox):
    pass


class PercentageRow(DeviceRow):
    """A percentage: a slider, the exact number, and buttons for both ends.

    The slider sets its value when it is released, the number when Enter is pressed or another widget gets the focus.
    Until then published values do not overwrite it.
    """

    def __init__(self, device: str, change: Callable[[int], None]) -> None:
        super().__init__(device, change)
        self.slider = _Slider(Qt.Horizontal)
        self.slider.setRange(0, PERCENT)
        self.slider.setPageStep(PAGE)
        self.slider.setTracking(False)
        self.slider.setMinimumWidth(round(8 * basic.em()))
        self.slider.setFocusPolicy(Qt.TabFocus)
        self.number = basic.enlarged(_Number(), basic.LEAD, bold=True)
        self.number.setRange(0, PERCENT)
        self.number.setSuffix(" %")
        self.number.setAlignment(Qt.AlignRight)
        self.number.setKeyboardTracking(False)
        self.number.setFocusPolicy(Qt.StrongFocus)
        self.state = QLabel()
        self.state.setMinimumWidth(round(1.2 * basic.em()))
        lowest, highest = whole_box.device_commands(device)
        self.add_command(*lowest)
        self.line.addWidget(self.slider, 1)
        self.add_command(*highest)
        self.line.addWidget(self.number)
        self.line.addWidget(self.state)
        self.slider.sliderMoved.connect(self._on_dragged)
        self.slider.valueChanged.connect(self._on_chosen)
        self.number.valueChanged.connect(self._on_chosen)
        self.number.editingFinished.connect(lambda: self.number.lineEdit().setModified(False))

    def is_edited(self) -> bool:
        """Whether the referee is editing it."""
        return self.slider.isSliderDown() or (self.number.hasFocus() and self.number.lineEdit().isModified())

    def show_value(self, value: int, waiting: bool, off: Sequence[str]) -> None:
        self.state.setText(UNCONFIRMED.strip() if waiting else "")
        if not self.is_edited():
            self._put(value)
        for widget in (self.slider, self.number):
            widget.setEnabled(not off)
            widget.setToolTip(basic.tip("\n".join(off)))
        self._allow(off)

    def _put(self, value: int) -> None:
        """Show the value without setting it."""
        for widget in (self.slider, self.number):
            if widget.value() != value:
                with QSignalBlocker(widget):
                    widget.setValue(value)

    def _on_dragged(self, value: int) -> None:
        """Show the slider's position as a number."""
        with QSignalBlocker(self.number):
            self.number.setValue(value)

    def _on_chosen(self, value: int) -> None:
        self.number.lineEdit().setModified(False)
        self.change(value)


# States carry no time: an older one may still arrive for this long after the answer to a change.
LATE_S = 1.0


class DevicesPanel(Panel):
    """A row for each device; above them, whether they can be reached."""

    TITLE = tr_later("Devices")
    WHERE = tr_later("Home devices")

    def __init__(self, client) -> None:
        super().__init__(client)
        self._edits: Edits[float] = Edits(lambda until_mono: time.monotonic() > until_mono)
        self.connection = basic.Badge(basic.LEAD)
        self.reason = basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), basic.TEXT)
        self.body.addWidget(self.connection)
        self.body.addWidget(self.reason)
        self.rows: Dict[str, DeviceRow] = {}
        inside = QWidget()
        self._lines = QVBoxLayout(inside)
        edge = round(0.3 * basic.em())  # for the frame of the focus
        self._lines.setContentsMargins(edge, edge, edge, edge)
        for device, states in whole_box.DEVICES.items():
            row = (PercentageRow if states is None else TwoStateRow)(device, partial(self._change, device))
            self.rows[device] = row
            self._lines.addWidget(row)
        self._lines.addLayout(self._bell_line())
        self._lines.addStretch(1)
        area = QScrollArea(widgetResizable=True)
        area.setFrameShape(QFrame.NoFrame)
        area.setWidget(inside)
        self.body.addWidget(area, 1)
        self.answer = AnswerLine()
        self.body.addWidget(self.answer)

    def _bell_line(self) -> QHBoxLayout:
        line = QHBoxLayout()
        title = basic.enlarged(QLabel(tr(whole_box.BELL)), basic.LEAD, bold=True)
        title.setMinimumWidth(round(NAME_EMS * basic.em()))
        self.bell = basic.Badge(basic.LEAD)
        self.ring = basic.CommandButton(tr(whole_box.RING), tr("Ring the bell"), basic.TEXT, self._ring)
        line.addWidget(title)
        line.addWidget(self.bell, 1)
        line.addWidget(self.ring)
        return line

    # -- showing ------------------------------------------------------------------------------------

    def parts(self) -> tuple:
        return (self.model.devices, self.model.devices_status, self.model.why_no_devices)

    def show_model(self) -> None:
        self._show_connection()
        self.ring.allow(not self._off(), self._off())

    def show_times(self) -> None:
        state = self.model.devices
        for device, row in self.rows.items():
            published = 0 if state is None else int(getattr(state, device))
            row.show_value(self._edits.value(device, published), self._edits.is_waiting(device), self._off())
        self._show_bell(0.0 if state is None else wire_seconds(state.bell))

    def _off(self) -> List[str]:
        return [self.model.why_no_devices] if self.model.why_no_devices else []

    def _show_connection(self) -> None:
        status = self.model.devices_status
        if self._off():
            self.connection.show_text(tr("✘ NO DEVICES"), basic.ALARM)
            self.reason.setText(self.model.why_no_devices)
        else:
            is_connected = status is not None and status.connected
            text, reason = whole_box.controller_text(is_connected, "" if status is None else status.text)
            text, tone = (text, basic.DONE) if is_connected else (f"⚠ {text}", basic.OLD)
            self.connection.show_text(text, tone)
            self.reason.setText(reason)

    def _show_bell(self, rang_s: float) -> None:
        now = self.model.box_time() or time.time()
        text, rings = whole_box.bell_text(rang_s, now, self.client.moments)
        self.bell.setToolTip(self.client.moments.tip(rang_s) if rang_s else "")
        self.bell.show_text(text, basic.OLD if rings else basic.OFF)

    # -- operating ----------------------------------------------------------------------------------

    def _change(self, device: str, value: int) -> None:
        """Handle another value that the referee set."""
        send = self._edits.wish(device, value)
        if send is not None:
            self._send(device, send)
        self.show_times()

    def _send(self, device: str, value: int) -> None:
        self.client.node.devices.set(self.client.calls, self, device, value, partial(self._answered, device, value))

    def _answered(self, device: str, value: int, outcome: CallOutcome) -> None:
        what = f"{self.rows[device].name}: {value}{'' if whole_box.DEVICES[device] else ' %'}"
        self.answer.show_outcome(what, outcome)
        if outcome.error:
            self._edits.failed(device)
        else:
            following = self._edits.carried_out(device, time.monotonic() + LATE_S)
            if following is not None:
                self._send(device, following)
        self.show_times()

    def _ring(self) -> None:
        self.ring.hold()
        self.client.node.devices.set(
            self.client.calls, self, RING, 1, lambda outcome: self.answer.show_outcome(tr(whole_box.BELL), outcome))
