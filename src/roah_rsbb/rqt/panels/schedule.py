"""Schedule: all events of all zones, with results, sign-offs and estimated times (docs/referee.md, "Schedule")."""

from typing import Callable, List, Optional, Sequence

from roah_rsbb.model.schedule import EventSeen
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel, ask
from roah_rsbb.rqt.qt import QAbstractItemView, QComboBox, QHBoxLayout, QSignalBlocker, Qt, QTimer
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.rows import Rows, TableRow
from roah_rsbb.wording import schedule, sheets, stop
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.schedule import EventFilter, Show
from roah_rsbb.wording.times import Moments

WAITING = tr_later("Waiting for the core")
NO_EVENTS = tr_later("No event fits these filters.")
CHOOSE = tr_later("Choose this event")
CHOOSE_FIRST = tr_later("Select an event above first.")
OLD = tr_later("The core is silent: no event can be chosen now")
COLUMNS = (
    tr_later("Time"), tr_later("Begins"), tr_later("Late"), tr_later("State"), tr_later("Zone"), tr_later("Team"),
    tr_later("Event"), tr_later("Score"), tr_later("Sheet"),
)
# The widest column of names, in units of the desktop's font.
WIDEST_EMS = 11.0


class FilterBox(QComboBox):
    """Chooses one of several texts; the first entry stands for all."""

    def __init__(self, everything: str) -> None:
        super().__init__()
        self._everything = everything
        self._names: List[str] = []
        self.addItem(everything, "")
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(9)

    @property
    def chosen(self) -> str:
        """The chosen text; empty: all."""
        return self.currentData() or ""

    def offer(self, names: List[str], show: Callable[[str], str] = str) -> None:
        """Offer these texts, as `show` shows them. The choice stays, as long as it is offered."""
        if names == self._names:
            return
        chosen, self._names = self.chosen, names
        with QSignalBlocker(self):
            self.clear()
            for name in ["", *names]:
                self.addItem(show(name) if name else self._everything, name)
            self.setCurrentIndex(max(0, self.findData(chosen)))


class SchedulePanel(Panel):
    """A list of the events, filters above it, and a button that chooses the selected event."""

    TITLE = tr_later("Schedule")
    TAB = tr_later("Plan")
    PARTS = ("schedule",)

    def __init__(self, client) -> None:
        super().__init__(client)
        self._events: Sequence[EventSeen] = ()
        self._shown: Optional[EventFilter] = None
        self._scroll = QTimer(self, singleShot=True, interval=0, timeout=self._scroll_to_current)
        self.zones, self.teams = FilterBox(tr("All zones")), FilterBox(tr("All teams"))
        self.days, self.shows = FilterBox(tr("All days")), FilterBox(tr("All events"))
        self.shows.offer([show.value for show in Show if show is not Show.ALL], tr)
        self.rows = Rows([tr(column) for column in COLUMNS], stretched=(7,), wrapped=False)
        self.rows.horizontalHeader().setMaximumSectionSize(round(WIDEST_EMS * basic.em()))
        self.choose = basic.button(tr(CHOOSE), self._choose, 1.1, bold=True)
        self._answer = AnswerLine()
        self._lay_out()
        for box in (self.zones, self.teams, self.days, self.shows):
            box.currentIndexChanged.connect(self.redraw)
        self.rows.itemSelectionChanged.connect(self.redraw)
        self.rows.itemDoubleClicked.connect(lambda *_: self.choose.click())

    def _lay_out(self) -> None:
        filters = QHBoxLayout()
        for box in (self.zones, self.teams, self.days, self.shows):
            filters.addWidget(box, 1)
        self.body.addLayout(filters)
        self.body.addWidget(self.rows, 1)
        last = QHBoxLayout()
        last.addWidget(self._answer, 1)
        last.addWidget(self.choose)
        self.body.addLayout(last)

    # -- showing ------------------------------------------------------------------------------------

    def where(self) -> str:
        return schedule.summary(self._events) if self._events else tr(WAITING)

    def show_model(self) -> None:
        self._events = () if self.model.document is None else self.model.document.events()
        self._where.setText(self.where())
        in_utc = self.client.moments.in_utc
        self.zones.offer(list(dict.fromkeys(event.zone for event in self._events)))
        self.teams.offer(sorted({event.team for event in self._events}))
        self.days.offer(sorted({schedule.day_of(event, in_utc) for event in self._events}))
        show = Show(self.shows.chosen or Show.ALL.value)
        shown = EventFilter(self.zones.chosen, self.teams.chosen, self.days.chosen, show)
        events = [event for event in self._events if shown.shows(event, in_utc)]
        several_days = len({schedule.day_of(event, in_utc) for event in events}) > 1
        rows = [_row(event, several_days, self.client.moments) for event in events]
        nothing = tr(NO_EVENTS) if self._events else ""
        self.rows.show_rows(rows or [TableRow(None, ("", "", "", nothing, "", "", "", "", ""))])
        if rows and shown != self._shown:
            self._shown = shown
            self._scroll.start()  # once the rows have their heights
        self._show_button()

    def _scroll_to_current(self) -> None:
        keys = {event.id for event in self._events if event.current}
        current = next((index for index, key in enumerate(self.rows.keys()) if key in keys), 0)
        self.rows.scrollToItem(self.rows.item(current, 0), QAbstractItemView.PositionAtCenter)

    def _show_button(self) -> None:
        event = self._chosen()
        why = self.model.why_read_only(tr(OLD)) or (
            tr(CHOOSE_FIRST) if event is None else schedule.why_not(self._events, event))
        self.choose.setEnabled(not why)
        self.choose.setToolTip(basic.tip(why or tr("Make it the current event of {zone}", zone=event.zone)))

    def _chosen(self) -> Optional[EventSeen]:
        return next((event for event in self._events if event.id == self.rows.chosen), None)

    # -- choosing -----------------------------------------------------------------------------------

    def _choose(self) -> None:
        event = self._chosen()
        if event is None:
            return
        left = schedule.left_unsigned(self._events, event.zone)
        if left is None or left.id == event.id:
            self._send(event, left)
            return
        ask(
            self, tr("Leave {run} in {zone} without a sign-off?", run=_name(left), zone=event.zone),
            self._leaving(event.zone)
            + tr("{score}\n\nThe score sheet stays in Results and can be signed off later. {zone} goes to {run}.",
                 score=left.score or tr("No score"), zone=event.zone, run=_name(event)),
            tr(CHOOSE), lambda: self._send(event, left),
        )

    def _leaving(self, zone: str) -> str:
        """Return what the referee must know before they leave the run in a zone, as a paragraph."""
        found = self.model.zone_of(zone)
        why = "" if found is None else stop.leaving(found)
        return f"{why}\n\n" if why else ""

    def _send(self, event: EventSeen, left: Optional[EventSeen]) -> None:
        """Choose an event. `left`: the run that the referee leaves without a sign-off."""
        what = f"{event.zone}: {_name(event)}"
        document = self.model.document
        now_left = schedule.left_unsigned(document.schedule.values(), event.zone)
        now = document.schedule.get(event.id)
        # A question may have been open for long.
        if now is None or _subject(now) != _subject(event) or (
                now_left is not None and (left is None or now_left.id != left.id)):
            self._answer.warn(tr("Not done: the schedule or the runs in {zone} have changed", zone=event.zone))
            return
        given = {"event": event.id, "team": event.team, "unsigned": left is not None}
        self.client.calls.act(self, "choose_event", event.zone, "", given,
                              self._answer.begin(what))


def _subject(event: EventSeen) -> tuple:
    """Return what the referee chooses with an event."""
    return event.zone, event.code, event.team, event.round, event.run, event.scheduled_utc_s


def _name(event: EventSeen) -> str:
    return sheets.run_name(event.code, event.team, event.round, event.run)


def _row(event: EventSeen, several_days: bool, moments: Moments) -> TableRow:
    """Return the row of an event. Estimated times have a mark that distinguishes them from facts."""
    has_begun = event.state in ("done", "running", "ended")
    begins = "" if event.state == "skipped" else schedule.moment_text(event.begins_utc_s, several_days, moments.in_utc)
    is_signed = bool(event.identity) and not event.unsigned
    return TableRow(event.id, (
        schedule.moment_text(event.scheduled_utc_s, several_days, moments.in_utc),
        begins if has_begun or not begins else f"~ {begins}",
        schedule.delay_text(event.late_s), schedule.state_text(event), event.zone, event.team,
        f"{event.code}, {sheets.turn(event.round, event.run)}", event.score,
        f"✔ {schedule.sheet_text(event)}" if is_signed else schedule.sheet_text(event),
    ), bold=event.current, tips=(
        moments.tip(event.scheduled_utc_s), moments.tip(event.begins_utc_s) if begins else ""
    ))
