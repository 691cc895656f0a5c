"""Commands of Benchmark Control that most runs do not need: phases and pauses, runs without a robot, the choice of a
robot (docs/referee.md, "Setup time, phases, pauses" and "Without a robot").
"""

from typing import Callable, NamedTuple, Optional, Sequence

from roah_rsbb.msg import ZoneDetails
from roah_rsbb.rqt.qt import QAction, QHBoxLayout, QMenu, Qt, QToolButton, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.sent import tr_sent


class Command(NamedTuple):
    """A command of the zone: its names in services, messages and labels. `<service>_off` of ZoneDetails has the reasons
    why it is refused."""

    service: str
    what: str
    label: str
    explanation: str
    question: str = ""  # asked before it is given; empty: it is given at once


RULE_COMMANDS = (
    Command("previous_phase", tr_later("Previous phase in {zone}"), tr_later("◀ Phase"),
            tr_later("Go back to the phase before; its time continues")),
    Command("next_phase", tr_later("Next phase in {zone}"), tr_later("Next phase ▶"),
            tr_later("Go to the next phase")),
    Command("pause", tr_later("Pause in {zone}"), tr_later("‖ Pause"),
            tr_later("Stop the clock of the run. The robot does not notice")),
    Command("resume", tr_later("Resume in {zone}"), tr_later("▶ Resume clock"),
            tr_later("Let the clock of the run continue")),
)
SHEET_COMMANDS = (
    Command("open_sheet", tr_later("Score sheet in {zone}"), tr_later("Score without a robot"),
            tr_later("Start and stop the clock yourself. Nothing is sent to a robot")),
    Command("no_show", tr_later("No-show in {zone}"), tr_later("No-show …"),
            tr_later("The team did not appear. Leave this event"),
            tr_later("Did team {team} not appear? The zone leaves this event.")),
    Command("withdrawn", tr_later("Withdrawal in {zone}"), tr_later("Team withdrew …"),
            tr_later("The team withdrew. Leave this event"),
            tr_later("Did team {team} withdraw? The zone leaves this event.")),
)
WHATS = {command.service: command.what for command in (*RULE_COMMANDS, *SHEET_COMMANDS)}


def why_off(details: Optional[ZoneDetails], service: str, silent: str) -> Sequence[str]:
    """Return why a command is refused now; empty: it is allowed. `silent`: the core is not heard."""
    if details is None or silent:
        return [silent or tr("Waiting for the core")]
    return [tr_sent(reason) for reason in getattr(details, f"{service}_off")]


class RuleButtons(QWidget):
    """Phases and pause, in a row that is only visible where the benchmark has such rules."""

    def __init__(self, press: Callable[[str], None]) -> None:
        super().__init__()
        self.buttons = {}
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        for command in RULE_COMMANDS:
            button = basic.CommandButton(tr(command.label), tr(command.explanation), 1.1)
            button.clicked.connect(lambda _checked=False, service=command.service: press(service))
            row.addWidget(button, 1)
            self.buttons[command.service] = button
        self.hide()

    def show_details(self, details: Optional[ZoneDetails], has_phases: bool, silent: str) -> None:
        """Show what is possible now. `silent`: why nothing is; empty: the core is heard."""
        has_pause = details is not None and details.pause_allowed
        is_paused = has_pause and not details.resume_off
        visible = {"previous_phase": has_phases, "next_phase": has_phases, "pause": has_pause and not is_paused,
                   "resume": is_paused}
        for service, button in self.buttons.items():
            reasons = why_off(details, service, silent)
            button.allow(not reasons, reasons, basic.READY if service == "resume" else None)
            button.setVisible(visible[service])
        self.setVisible(has_phases or has_pause)


class MoreMenu(QToolButton):
    """The team's robots to choose from, the commands for runs without a robot, and pairing."""

    def __init__(
        self, connect_robot: Callable[[str], None], press: Callable[[Command], None], pair: Callable[[], None],
    ) -> None:
        super().__init__()
        self.setText("⋯")
        self.setToolTip(tr("Choose a robot, score without a robot, no-show, pair a phone"))
        self.setFocusPolicy(Qt.TabFocus)
        self.setPopupMode(QToolButton.InstantPopup)
        basic.enlarged(self, 1.3, bold=True)
        basic.set_style(self, "QToolButton::menu-indicator { image: none; }")
        self._connect_robot = connect_robot
        self._menu = QMenu(self)
        self._menu.setToolTipsVisible(True)
        self._robots: Sequence[str] = ()
        self.robots: Sequence[QAction] = ()  # one for each of the team's robots
        self.actions_of = {}
        for command in SHEET_COMMANDS:
            action = self._menu.addAction(tr(command.label))
            action.triggered.connect(lambda _checked=False, command=command: press(command))
            self.actions_of[command.service] = action
        self._menu.addSeparator()
        self.pair = self._menu.addAction(tr("Pair a phone …"))
        self.pair.setToolTip(basic.tip(tr("Let a phone or tablet act as a referee; list and end pairings")))
        self.pair.triggered.connect(lambda: pair())
        self._line = self._menu.insertSeparator(self.actions_of["open_sheet"])
        self._line.setVisible(False)
        self.setMenu(self._menu)

    def show_details(self, details: Optional[ZoneDetails], silent: str) -> None:
        """Show what is possible now. An open menu does not change its entries, only what is possible."""
        robots = () if details is None or silent else tuple(details.robots_to_choose)
        if robots != self._robots and not self._menu.isVisible():
            self._show_robots(robots)
        for action in self.robots:
            action.setEnabled(bool(robots))
        for command in SHEET_COMMANDS:
            reasons = why_off(details, command.service, silent)
            action = self.actions_of[command.service]
            action.setEnabled(not reasons)
            action.setToolTip(basic.tip("\n".join(reasons) or tr(command.explanation)))

    def _show_robots(self, robots: Sequence[str]) -> None:
        for action in self.robots:
            self._menu.removeAction(action)
        self._robots, self.robots = robots, []
        for robot in robots:
            action = QAction(tr("Connect {robot}", robot=robot), self._menu)
            action.triggered.connect(lambda _checked=False, robot=robot: self._connect_robot(robot))
            self._menu.insertAction(self._line, action)
            self.robots.append(action)
        self._line.setVisible(bool(robots))
