"""What the edits of the day need of the box: which events may still be changed, and teams that withdraw."""

from typing import Collection, List, NamedTuple, Sequence, Set

from roah_rsbb.core.connections import Connections
from roah_rsbb.core.desks import CommandRecord
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.timers import Timers
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Reason, Refused, RunName, checked_who, cut_note, say
from roah_rsbb.model.records import By, Phase
from roah_rsbb.rulebook.day import NO_EVENT
from roah_rsbb.rulebook.event_ids import key_of
from roah_rsbb.scoring.book import FinishedRuns
from roah_rsbb.scoring.counting import RunChoice
from roah_rsbb.scoring.stages import ADVANCE, ASK
from roah_rsbb.scoring.standings import stage_standings
from roah_rsbb.wording.texts import did_you_mean

NO_STAGE = say("No stage '{stage}' from which teams advance: standings.yaml has {stages}{hint}")
NOBODY = say("Nobody has a signed result in stage '{stage}' yet")
NO_TEST = say("Stage '{stage}' leads to no test that only those run who advance: name one in a stage whose 'teams' it "
              "is")


class OpenEvents(NamedTuple):
    """The ids of events."""

    open: Set[str]  # not over, and no run of them is in progress
    to_come: Set[str]  # of these, the ones that their zone has not passed


class WithdrawnRun(NamedTuple):
    """The run that says that a team withdrew from an event."""

    zone: str
    identity: str
    event: str  # id


class Advancing(NamedTuple):
    """Who advances from a stage."""

    stage: str
    teams: Sequence[str]  # the best one first
    tests: Sequence[str]  # codes of the benchmarks that only they run
    of_all: Collection[str]  # codes of the benchmarks of the stage
    said: List[Reason]  # in words
    remarks: List[Reason]  # what the public reads beside the standing


class DayDesk:
    """See above."""

    def __init__(
        self, timers: Timers, zones: Zones, finished: FinishedRuns, connections: Connections, record: CommandRecord,
        outbox: Outbox,
    ) -> None:
        self._timers, self._zones, self._finished = timers, zones, finished
        self._connections, self._record, self._outbox = connections, record, outbox

    def events(self) -> OpenEvents:
        """Return the events that may be changed."""
        over, found = self._zones.over(self._finished.records()), OpenEvents(set(), set())
        for zone in self._zones.values():
            for place, event in enumerate(zone.events):
                has_begun = place == zone.index and zone.run is not None and zone.run.phase is not Phase.CONNECTED
                if (zone.name, place) not in over and not has_begun:
                    found.open.add(event.id)
                    if place >= zone.index:
                        found.to_come.add(event.id)
        return found

    def advancing(self, name: str) -> Advancing:
        """Return who advances from a stage by the runs that are signed off; empty: from the only one. Raises
        `Refused`."""
        rules, finished = self._finished.ranking, self._finished
        choice = RunChoice(signed_off=True, events=finished.event_rules())
        able = {stage.name: (stage, standing) for stage, standing in zip(
            rules.stages, stage_standings(rules, finished.records(), choice)) if stage.advance}
        name = next(iter(able)) if not name and len(able) == 1 else name
        if name not in able:
            raise Refused([NO_STAGE(stage=name, hint=did_you_mean(name, able), stages=", ".join(able) or "-")])
        stage, standing = able[name]
        remarks = [remark for remark in standing.remarks if isinstance(remark, Reason)]
        if standing.undecided:
            raise Refused([remark for remark in remarks if remark.template == ASK])
        if not standing.advance:
            raise Refused([NOBODY(stage=name)])
        of_all = {column.test for column in stage.of}
        tests = dict.fromkeys(column.test for later in rules.stages if later.teams == name for column in later.of
                              if column.test and column.test not in of_all)
        if not tests:
            raise Refused([NO_TEST(stage=name)])
        return Advancing(name, standing.advance, list(tests), of_all, [
            remark for remark in remarks if remark.template == ADVANCE], [
            remark for remark in remarks if remark.template != ADVANCE])

    def withdraw(self, now: Now, events: Sequence[str], team: str, who: str, reason: str) -> List[WithdrawnRun]:
        """Record that a team withdrew from events. Zones go past them. Raises `Refused`."""
        self._timers.tick(now)
        zones = {event.id: zone for zone in self._zones.values() for event in zone.events}
        found: List[WithdrawnRun] = []
        with self._record.of(RunName(""), who, "withdraw_team", team=team, events=" ".join(events), reason=reason):
            if not zones.keys() >= set(events):
                raise Refused([NO_EVENT])
            reasons = self._connections.off([])
            if reasons:
                raise Refused(reasons)
            for event in sorted(events, key=lambda event: event == zones[event].event.id):  # zones go past the others
                place = zones[event].place_of_id(event)
                assert place is not None, "it is in this zone"
                identity = self._connections.withdraw(now, zones[event], place, By(checked_who(who), cut_note(reason)))
                found.append(WithdrawnRun(zones[event].name, identity, event))
        return found

    def go_back(self, now: Now, events: Collection[str]) -> None:
        """Let zones go back to the first of these events that they have passed and that is not over."""
        passed = {zone.name: [key_of(event) for event in zone.events if event.id in events]
                  for zone in self._zones.values()}
        for zone in self._zones.go_back(passed, self._finished.records()):
            self._outbox.mark_changed(zone.name)
