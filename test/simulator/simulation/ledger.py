"""What referees may rely on: what they did and were answered, and so what each run must be.

It follows docs/referee.md, benchmarks.md, organiser.md ("Time and attempts"), journal.md and standby.md, and knows
nothing of how the box does it. A run changes because of a referee, its robot or its time, and because of nothing else.
"""

import contextlib
import re
from decimal import Decimal
from fractions import Fraction
from types import SimpleNamespace
from typing import NamedTuple, Optional

from roah_rsbb.core.runs.run import Run
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.rulebook.benchmarks import Restarts
from roah_rsbb.scoring.counting import Why

from .scheduler import Ended
from .sheets import Counts, Plain, plain_values

# Within this time, the box counts a run's time as a watch does. More, where one computer's clock stands for another's.
CLOCK_S, OTHER_CLOCK_S = 0.1, 0.4
# Commands with which a zone goes to another run or event, and with which a run begins, or may be asked to continue.
LEAVE = {"disconnect", "next", "previous", "no_show", "withdrawn", "connect", "open_sheet"}
GO = {"start", "continue"}
PHASES = {"next_phase": 1, "previous_phase": -1}
# Entries whose answer waits for the disk, or for both.
DURABLE = {"mark", "withdraw", "take_back", "in_time", "stop_reason", "sign_off", "submit", "hand_back", "waive",
           "annul", "move", "reopen", "undo"}
# What decides for what a run counts, and whether its sheet is final.
DECISIONS = {"sign_off", "annul", "move", "reopen", "undo"}
# What judges and the head referee do with a judge's sheet, as the record has it.
JUDGED = {"submit": "submitted", "hand_back": "handed back", "waive": "waived missing judges"}
ENDED_BY = {
    EndReason.STOPPED: {"stop", *LEAVE}, EndReason.NO_SHOW: {"no_show"}, EndReason.WITHDRAWN: {"withdrawn"},
}
TO_THE_NEXT = (EndReason.COMPLETED, EndReason.NO_SHOW, EndReason.WITHDRAWN)


class Act:
    """Something that a referee does in a zone, or with a run."""

    def __init__(self, at, zone, identity, name, given, who):
        self.at, self.zone, self.identity, self.name, self.given, self.who = at, zone, identity, name, given, who
        self.has_run, self.event = False, None  # whether its zone had one, and at which event it was
        self.is_confirmed = False  # the answer was that it is saved


class Kept:
    """An entry of a sheet: what it is, and who did it."""

    def __init__(self, act, row, made):
        self.act = act
        self.withdrawn = None  # the act that did
        self.said = []  # acts that said whether it was in time
        self.clock_s = None  # the counted time at which it was made, as the box has it
        self.made = made  # ... and as it must be: at the earliest and the latest; None: not known
        self.is_after_limit = False  # the run had timed out
        given = act.given
        self.key, self.added = row.key, given.get("added")
        self.value = given.get("value")
        if "text" in given:
            self.value = 1 + [choice.name for choice in row.choices].index(given["text"])

    @property
    def is_withdrawn(self):
        """Whether a referee withdrew it."""
        return self.withdrawn is not None

    @property
    def is_in_time(self):
        """Whether a referee said so."""
        return bool(self.said) and not self.said[-1].given["late"]


class Watch:
    """Counts the true time while it runs. How much it may be wrong: `unsure_s`."""

    def __init__(self):
        self.counted, self.since, self.unsure_s = 0.0, None, 0.0

    def turn(self, now, runs):
        """It runs from now on, or does not."""
        self.counted = self.read(now)
        self.since = now if runs else None

    def read(self, now):
        return self.counted + (0.0 if self.since is None else now - self.since)


class Standing(NamedTuple):
    """For what a finished run counts."""

    sign_off: Optional[Act]
    is_annulled: bool
    event: str  # id; empty: those of the schedule have none
    can_undo: bool


class Believed:
    """A run, as its referees believe it to be."""

    def __init__(self, run, zone, now):
        self.identity, self.zone, self.event, self.now = run.identity, zone, run.event, now
        self.phase, self.reason, self.is_paused = Phase.CONNECTED, None, False
        self.changed = self.stopped = float("-inf")  # when: the last change, the last end by a referee
        self.went = float("-inf")  # when a referee let the robot go, for the last time
        self.started_utc, self.ends = 0.0, 0  # as the box has them: when it began, and how often it has ended
        self.watch, self.setup = Watch(), Watch()
        self.phases, self.place = [], 0  # the watches of its phases, and the number of the present one
        self.entries, self.decisions, self.reasons = [], [], {}
        self.ever = []  # all entries, also those that were lost: a copy may still have them
        self.judged = []  # what was done with the sheets of judges
        self.taken = {}  # marks by their ids, also those that changed nothing
        self.final = None  # its time at its last end, at the earliest and the latest; None: not known any more
        self.is_left = self.is_doubted = False
        self.record = None  # as it was seen last
        self._counted = ()  # the entries that were counted last, and what they give

    @property
    def counts(self):
        """Whether its time passes."""
        if self.phase is Phase.ENDED:  # it was started
            return self.went > 0.0 and self.event.benchmark.rules.restarts is Restarts.CLOCK_RUNS
        return self.phase is Phase.RUNNING and not self.is_paused

    @property
    def is_stopped(self):
        """Whether a referee ended it, and that is not lost."""
        return self.phase is Phase.ENDED and self.stopped == self.changed and self.final is not None

    def standing(self):
        """What the decisions of a finished run give: `Standing` (docs/organiser.md, "A run is wrong")."""
        sign, changes = None, []
        for act in self.decisions:
            if act.name == "sign_off":
                sign = sign or act
            elif act.name == "undo":
                last = next(each for each in reversed(changes) if each[0].name != "reopen" or sign is None)
                changes.remove(last)
                sign = last[1] if last[0].name == "reopen" else sign and act
            else:
                changes.append((act, sign))
                sign = None if act.name == "reopen" else sign and act
        moved = [act.given["event"] for act, _ in changes if act.name == "move"]
        can_undo = any(act.name != "reopen" or sign is None for act, _ in changes)
        return Standing(sign, any(act.name == "annul" for act, _ in changes), (moved or [self.event.id])[-1], can_undo)

    @property
    def sign_off(self):
        """The act that made its sheet final; None: it is open."""
        return self.standing().sign_off

    def is_attempt_at(self, event):
        """Whether it counts as an attempt at an event."""
        standing = self.standing()
        is_there = self.event is event if standing.event == self.event.id else standing.event == event.id
        return is_there and self.went > 0.0 and self.is_left and not standing.is_annulled

    @property
    def is_something(self):
        """Whether it began, or was scored. Otherwise it may be forgotten when it is left."""
        return not self.is_left or self.went > 0.0 or bool(self.taken) or self.phase is not Phase.CONNECTED

    def judging(self):
        """The judges who have submitted, and whether the head referee waits for those who are missing."""
        submitted, waits = set(), True
        for act in self.judged:
            if act.name == "submit":
                submitted.add(act.given["judge"])
            elif act.name == "hand_back":
                submitted.discard(act.given["judge"])
            waits = act.name != "waive" and (waits or act.name == "hand_back")
        return submitted, waits

    def turn(self, now):
        """The time passes, or does not any more."""
        is_open, rules = self.phase is Phase.CONNECTED and not self.is_left, self.event.benchmark.rules
        self.watch.turn(now, self.counts)
        self.setup.turn(now, is_open and bool(rules.setup_time))
        for number, watch in enumerate(self.phases, 1):
            watch.turn(now, number == self.place and self.phase is Phase.RUNNING and not self.is_paused)

    def go_to_phase(self, now, number):
        """A referee moves it to a phase."""
        self.phases += [Watch()] if number > len(self.phases) else []
        self.place, self.changed = number, now
        self.turn(now)

    def values(self):
        """Those of all items that were marked."""
        return self.counted().values

    def counted(self):
        """What its entries give."""
        known = [(kept, kept.is_withdrawn, kept.is_in_time, kept.clock_s) for kept in self.entries]
        if not self._counted or self._counted[0] != known:
            self._counted = known, self._count()
        return self._counted[1]

    def _count(self):
        benchmark = self.event.benchmark
        if benchmark.sheet.items:
            return Plain(benchmark.sheet, benchmark.scoring, self.entries).counts()
        values = plain_values(kept for kept in self.entries if not kept.is_withdrawn)
        points = {row.key: row.points for row in benchmark.scoring}
        return Counts(values, set(), set(), sum((points[key] * value for key, value in values.items()), Decimal(0)))

    def row(self, given):
        """The row of its sheet that is marked."""
        return next(row for row in self.event.benchmark.scoring if row.key == (given["group"], given["desc"]))

    def after(self, given):
        """The value of a row after a mark."""
        kept = Kept(SimpleNamespace(given=given), self.row(given), None)
        return self.values().get(kept.key, 0) + int(kept.added) if kept.added else kept.value

    def made(self, now):
        """The counted time of an entry that is made now, at the earliest and the latest; None: not known."""
        limit = self.event.benchmark.total_timeout
        if self.phase is Phase.RUNNING:
            return (min(self.watch.read(now), limit),) * 2
        if self.phase is Phase.CONNECTED or self.final is None:
            return (0.0, 0.0) if self.phase is Phase.CONNECTED else None
        # After the time limit, the time of day counts.
        first, last = (min(at, limit) for at in self.final)
        return first, last if last < limit - CLOCK_S - self.watch.unsure_s else float("inf")


class Ledger:
    """The book of all referees of a world."""

    def __init__(self, world):
        self._world = world
        self._fail = world.oracles.fail
        self.runs = {}  # all by identity
        self.current = {}  # by zone
        self.absent = []  # what was done when a team without a run did not appear
        self.has_lost = False
        self._acting = None
        self._interrupted = []  # what was carried out when the core was killed
        self._sure = None  # after a loss: until when everything must be there, and whether that was confirmed must
        self.entered_at = 0.0  # when something that must be on the disk was entered last
        self.resumed = 0.0  # when the present box began
        self._away_s = 0.0  # for how long there was none before
        self._keeps_stop = []  # after losses: whether a STOP of a moment must be known

    # -- what referees do ---------------------------------------------------------------------------

    @contextlib.contextmanager
    def acting(self, act, box):
        """A box carries something out. The block gives the answer to `done`."""
        event = box.core.box.zones[act.zone].event
        self._acting, act.has_run, act.event = act, act.zone in self.current, event
        try:
            yield
        except Ended:
            if box is self._world.box:  # otherwise another one took over meanwhile
                self.interrupted(act)
            raise
        finally:
            self._acting = None

    def interrupted(self, act):
        """The core was killed while it carried something out, and may have recorded it."""
        self._interrupted.append(act)
        self.lost(act.at)

    @property
    def is_acting(self):
        """Whether something is carried out, perhaps for long."""
        return self._acting is not None

    def lets_go(self, believed):
        """Whether a referee lets the robot of a run go just now."""
        acting = self._acting
        return acting is not None and acting.name in GO and acting.zone == believed.zone

    def done(self, core, act, reasons):
        """What was carried out, and why it was refused; none: it was not."""
        run = self.runs.get(act.identity) if act.identity else self.current.get(act.zone)
        if act.name in ("no_show", "withdrawn") and not act.has_run and not reasons:
            self.absent.append(act)
        if reasons:
            self._check_refusal(core, act, run, reasons)
            return
        if act.name in DURABLE:
            self.entered_at = act.at
            self._entered(act, run)
            self._check_record(core, run)
        elif act.name == "stop" and run is not None and run.phase is Phase.RUNNING:
            self._fail("STOP", f"{run.identity} was stopped, and runs")
        elif act.name in ("pause", "resume"):
            run.is_paused, run.changed = act.name == "pause", act.at
            run.turn(act.at)
            if bool(core.box.zones[act.zone].run.why_paused) is not run.is_paused:
                self._fail("pause", f"{run.identity}: after {act.name}, the box shows something else")
            if not run.event.benchmark.rules.pause:
                self._fail("pause", f"{act.name} of {run.identity}, which its rules do not allow")
        elif act.name in PHASES:
            run.go_to_phase(act.at, run.place + PHASES[act.name])
            if not 1 <= run.place <= len(run.event.benchmark.rules.phases):
                self._fail("phases", f"{run.identity} went to phase {run.place}")
        elif act.name in GO:
            run.went = act.at
        self.look(core)

    def _check_refusal(self, core, act, run, reasons):
        if not all(reasons):
            self._fail("refusal without a reason", f"{act.name} {act.zone}")
        if core.box.authority.is_superseded or run is None:
            return
        if act.name == "stop" and run.phase is Phase.RUNNING:
            self._fail("STOP", f"refused for {run.identity}: {reasons}")
        is_scored = run.sign_off is None and run.event.benchmark.judges is None
        is_known = run.went > 0.0 and act.identity == run.identity
        if act.name in ("annul", "reopen", "move") and is_known and not self._why_not(act, run):
            self._fail("wrong run", f"{act.name} of {run.identity} was refused: {reasons}")
        if act.name == "mark" and is_scored and (run.phase is not Phase.CONNECTED or not run.is_left) and (
                self._is_possible(act, run)):
            self._fail("mark refused", f"{run.identity}: {reasons}")

    @staticmethod
    def _is_possible(act, run):
        """Whether a row can have the value of a mark."""
        most, value = run.row(act.given).most, run.after(act.given)
        return value >= 0 and (most is None or value <= most)

    def _entered(self, act, run):
        """An entry was made."""
        if run is None:
            self._fail("entry", f"{act.name} in {act.identity}, which is not known")
            return
        if run.sign_off is not None and act.name not in DECISIONS and not self._is_repeated(act, run):
            self._fail("sign-off", f"{act.name} in {run.identity}, which is signed off")
        entries = run.entries
        if act.name == "mark":
            kept, is_repeated = Kept(act, run.row(act.given), run.made(act.at)), self._is_repeated(act, run)
            kept.is_after_limit = run.phase is Phase.ENDED and run.reason is EndReason.TIMEOUT
            if not is_repeated and not self._is_possible(act, run):
                self._fail("mark", f"{run.identity} takes {act.given}, and has {run.values()}")
            if not is_repeated and (kept.added or kept.value != run.values().get(kept.key, 0)):
                entries.append(kept)
                # A mark that was lost and is sent again is there once.
                run.ever = [each for each in run.ever if each.act.given["id"] != act.given["id"]] + [kept]
            run.taken.setdefault(act.given["id"], act)
        elif act.name == "withdraw":
            entries[act.given["entry"] - 1].withdrawn = act
        elif act.name == "in_time":
            entries[act.given["entry"] - 1].said.append(act)
        elif act.name == "take_back":
            kept = next((kept for kept in entries if kept.act.given["id"] == act.given["id"]), None)
            if kept is not None and kept.withdrawn is None:
                kept.withdrawn = act
        elif act.name in DECISIONS - {"sign_off"}:
            why = self._why_not(act, run)
            if why:
                self._fail("wrong run", f"{act.name} of {run.identity}, which {why}")
                return
            run.decisions.append(act)
        elif act.name == "sign_off":
            run.decisions += [] if run.sign_off else [act]
            if not run.is_left and run.phase is Phase.RUNNING:
                self._fail("sign-off", f"{run.identity} is not over")
            rule, (submitted, waits) = run.event.benchmark.judges, run.judging()
            is_judged = rule is not None and run.reason not in (EndReason.NO_SHOW, EndReason.WITHDRAWN)
            if is_judged and waits and len(submitted) < rule.count:
                self._fail("judges", f"{run.identity} was signed off, and only {submitted} have submitted")
        elif act.name in JUDGED:
            run.judged += [] if self._is_repeated(act, run) else [act]
        elif act.name == "stop_reason":
            run.reasons["last"] = act

    def _why_not(self, act, run):
        """Why a run that is over cannot be put right in this way; empty: it can."""
        standing = run.standing()
        if not run.is_left:
            return "is connected"
        if act.name == "annul" and standing.is_annulled:
            return "is annulled"
        if act.name == "reopen" and standing.sign_off is None:
            return "is not signed off"
        if act.name == "undo" and not standing.can_undo:
            return "has nothing to undo"
        if act.name == "move":
            events = [event for zone in self._world.config.zones for event in zone.events]
            to = next(event for event in events if event.id == act.given["event"])
            most = to.benchmark.rules.attempts
            made = sum(each.is_attempt_at(to) for each in self.runs.values())
            made += any(each.event is to and each.went > 0.0 for each in self.current.values())
            if standing.event == to.id or to.team == "ALL" or to.benchmark.code != run.event.benchmark.code:
                return f"cannot count for {to.id}"
            if most and made >= most and run.went > 0.0 and not standing.is_annulled:
                return f"is one too many for {to.id}"
        return ""

    @staticmethod
    def _is_repeated(act, run):
        """Whether it changes nothing, because it was done before."""
        if act.name == "take_back":
            return all(kept.withdrawn is not None for kept in run.entries if kept.act.given["id"] == act.given["id"])
        if act.name == "submit":
            return act.given["judge"] in run.judging()[0]
        return act.name == "mark" and act.given["id"] in run.taken

    # -- what the box shows -------------------------------------------------------------------------

    def look(self, core):
        """Something may have happened."""
        for zone in core.box.zones.values():
            run, believed = zone.run, self.current.get(zone.name)
            if believed is not None and (run is None or run.identity != believed.identity):
                self._left(core, zone, believed)
                believed = None
            if run is None:
                continue
            if believed is None:
                believed = self._connected(zone, run)
            if run.phase is not believed.phase or run.end_reason is not believed.reason:
                self._changed(core, run, believed)
            believed.is_doubted = run.is_doubted

    def look_closely(self, core):
        """Now and then: the times and sheets of runs."""
        self.look(core)
        for zone in core.box.zones.values():
            if zone.run is not None:
                believed = self.current[zone.name]
                record = believed.record = zone.run.record(core.now())
                self._check_watch(zone.run, believed, record)
                if believed.phase is Phase.ENDED and believed.final is not None and believed.went > 0.0:
                    self._check_final(believed, record)
                self._check_sheet(believed, record)

    def _check_final(self, believed, record):
        limit, most = believed.event.benchmark.total_timeout, CLOCK_S + believed.watch.unsure_s
        first, last = (min(at, limit) for at in believed.final)
        if not first - most <= record.elapsed_s <= last + most:
            self._fail("clock", f"{believed.identity} ended after {last:.2f} s, and has {record.elapsed_s:.2f} s")

    def _connected(self, zone, run):
        now = self._world.scheduler.now
        known = self.runs.get(run.identity)
        if known is not None and known.is_left and self._sure is None:
            self._fail("run", f"{run.identity} was left, and is there again")
        if self._acting is None and self._sure is None:
            self._fail("run", f"{run.identity} began, and nobody connected")
        believed = self.current[zone.name] = self.runs[run.identity] = known or Believed(run, zone.name, now)
        believed.is_left = False
        believed.changed = now
        believed.turn(now if self._acting is None else self._acting.at)  # it may have waited for the disk
        self._world.witness.runs_at.update((member.port, believed) for member in members(run))
        most = run.event.benchmark.rules.attempts
        started = [each for each in self.runs.values() if each.is_attempt_at(run.event)]
        if known is None and most and len(started) >= most:
            self._fail("attempts", f"{run.identity} is one too many: {most} are allowed")
        return believed

    def _left(self, core, zone, believed):
        now, name = self._world.scheduler.now, zone.name
        acting = self._acting
        if self._sure is None and (acting is None or acting.zone != name or acting.name not in LEAVE):
            self._fail("run", f"{believed.identity} is gone, and nobody left it")
        if believed.phase is Phase.RUNNING and self._sure is None:
            record = _record_of(core, believed)
            if record is not None and not record.end_reason:
                self._fail("run", f"{believed.identity} was left, and has no end")
            believed.phase, believed.reason = Phase.ENDED, EndReason.STOPPED
            believed.final = (believed.watch.read(now if acting is None else acting.at),) * 2
        if acting is not None and acting.name.upper() in EndReason.__members__:
            believed.reason = EndReason[acting.name.upper()]
        believed.turn(now)
        believed.is_left, believed.changed = True, now
        del self.current[name]
        if acting is not None and acting.name == "disconnect":
            self._check_next(zone, believed)

    def _check_next(self, zone, believed):
        """After a run that is completed, the zone goes to the next event that still needs a run, unless its team has
        another attempt at this one (docs/referee.md)."""
        events = list(zone.planned)
        at, place = events.index(believed.event), events.index(zone.event)
        had_run = [any(run.is_attempt_at(event) or (run.event is event and run.is_left and not run.decisions)
                       for run in self.runs.values())
                   or any(act.event is event for act in self.absent) for event in events]
        is_right = place == at
        made = sum(run.is_attempt_at(believed.event) for run in self.runs.values())
        may_repeat = believed.reason is EndReason.COMPLETED and believed.event.benchmark.rules.attempts > made
        if believed.reason in TO_THE_NEXT and not may_repeat:
            later = range(at + 1, place if place > at else len(events))
            is_right = place >= at and all(had_run[skipped] for skipped in later)
        if not is_right:
            self._fail("next event", f"after {believed.identity} ({believed.reason}), {zone.name} is at {place + 1}")

    def _changed(self, core, run, believed):
        """The phase of a run has changed."""
        acting = self._acting
        name = acting.name if acting is not None and acting.zone == run.zone else ""
        now = acting.at if name else self._world.scheduler.now  # the call may have waited for the disk
        why = ""
        if run.phase is Phase.RUNNING and believed.phase is not Phase.RUNNING:
            believed.went = now if name else believed.went
            believed.started_utc = run.record(core.now()).started_utc
            if name != "start":
                why = "runs, and nobody started it"
            elif believed.phase is Phase.ENDED and run.event.benchmark.rules.restarts is Restarts.NOT_ALLOWED:
                why = "was started again, which its rules do not allow"
            elif believed.reason is EndReason.TIMEOUT:
                why = "was started again after its timeout"
        elif run.phase is Phase.ENDED and believed.phase is Phase.RUNNING:
            why = self._why_not_over(run, believed, name, now)
        elif run.phase is Phase.ENDED:
            if name not in ENDED_BY.get(run.end_reason, ()):
                why = f"is over ({run.end_reason}), and was not in progress"
        else:
            why = f"is {run.phase} after {believed.phase}"
        # The box has a note of STOP for a run with robots; one by hand is only in the journal.
        is_known = members(run) and run.phase is Phase.RUNNING and believed.stopped == believed.changed and all(
            keeps(believed.stopped) for keeps in self._keeps_stop)
        if why and (is_known or not self._may_be_lost(believed)):
            self._fail("phase", f"{run.identity} {why}")
        before = believed.phase
        believed.phase, believed.reason, believed.changed = run.phase, run.end_reason, now
        # While the box was away, the robot may have completed its task: these seconds are not counted.
        is_unseen = run.end_reason is EndReason.COMPLETED and self._world.witness.is_unseen(run, believed.went)
        read = believed.watch.read(now)
        came = self._world.witness.results(run, believed) if run.end_reason is EndReason.COMPLETED else ()
        first = min([read - self._world.box.process.hung_s(), *(at for at, _ in came)])
        believed.final = None if is_unseen else (first, read)
        if not believed.counts:  # of two ends that are possible, the box has one
            believed.watch.unsure_s += self._away_s if is_unseen else read - first
        believed.ends = len(run.record(core.now()).stops)
        is_alone = believed.event.team != "ALL"
        if is_unseen and before is Phase.RUNNING and is_alone and self._world.witness.is_counted(run):
            self._check_left_out(run.record(core.now()), believed)
        believed.is_paused = False
        believed.place, believed.phases = 0, []
        believed.turn(now)
        if run.phase is Phase.RUNNING and run.event.benchmark.rules.phases:
            believed.go_to_phase(now, 1)
        if run.phase is Phase.CONNECTED:  # its start was lost
            believed.went = float("-inf")
        if run.phase is Phase.ENDED:
            believed.stopped = now if name else believed.stopped
            if before is Phase.RUNNING and run.end_reason is not EndReason.COMPLETED and self.resumed != now:
                self._world.witness.stops(run)

    def _check_left_out(self, record, believed):
        """A robot has completed its task while the box was away: these seconds are not counted."""
        counted = min(believed.watch.read(self._world.scheduler.now), believed.event.benchmark.total_timeout)
        most = max(0.0, counted - self._away_s) + CLOCK_S + believed.watch.unsure_s
        if record.elapsed_s > most and not believed.is_paused and believed.went < self.resumed:
            self._fail("clock", f"{believed.identity} has {record.elapsed_s:.2f} s of {counted:.2f} s, and the box was "
                                f"away for {self._away_s:.2f} s")

    def _why_not_over(self, run, believed, name, now):
        reason, limit = run.end_reason, run.event.benchmark.total_timeout
        counted = believed.watch.read(now)
        if reason is EndReason.TIMEOUT:
            most = limit - CLOCK_S - believed.watch.unsure_s
            came = [] if believed.event.team == "ALL" else self._world.witness.results(run, believed)
            in_time = [at for at, is_awaited in came if is_awaited and at < most]
            return f"timed out after {counted:.2f} s" if counted <= most else "" if not in_time else (
                f"timed out, and its robot had completed it after {in_time[0]:.2f} s")
        if reason is EndReason.COMPLETED:
            return "" if self._world.witness.completed(run, believed.went) else "is completed, but not by its robot"
        if reason is EndReason.NO_MESSAGES_SAVED:
            is_due = self._world.witness.has_saved_nothing(run, believed.went)
            return "" if is_due and any(robot.saves_nothing for robot in self._world.robots) else (
                "is over, but its robot saves, or did not execute for long")
        return "" if name in ENDED_BY.get(reason, ()) else f"is over ({reason}), and nobody ended it"

    def _check_watch(self, run, believed, record):
        if believed.phase is not Phase.RUNNING:
            return
        now, limit = self._world.scheduler.now, run.event.benchmark.total_timeout
        counted, most = believed.watch.read(now), CLOCK_S + believed.watch.unsure_s
        if believed.is_paused is not bool(run.why_paused) and not self._may_be_lost(believed):
            self._fail("pause", f"{run.identity} is {'' if run.why_paused else 'not '}paused, and nobody did that")
        if abs(min(counted, limit) - record.elapsed_s) > most:
            self._fail("clock", f"in {run.identity}, {record.elapsed_s:.3f} s were counted of {counted:.3f} s")
        if counted > limit + most and not self._world.box.process.is_busy(now):
            self._fail("timeout", f"{run.identity} runs since {counted:.1f} s")

    # -- sheets -------------------------------------------------------------------------------------

    def check_all(self, core):
        """The records of all runs."""
        for believed in list(self.runs.values()):
            self._check_record(core, believed)
        for ruling in core.box.scores.rulings(core.now()):
            believed = self.runs.get(ruling.record.identity)
            if believed is not None and believed.is_left and (
                    ruling.why is Why.ANNULLED) is not believed.standing().is_annulled:
                self._fail("wrong run", f"{believed.identity}: {ruling.why}, and {believed.standing()}")

    def _check_record(self, core, believed):
        record = _record_of(core, believed)
        if record is None:
            if believed.is_something:
                self._fail("confirmed entry is missing", f"{believed.identity} is not known")
            return
        before = believed.record
        if before is not None and believed.is_left and before.closed_utc:
            same = "elapsed_s", "end_reason", "started_utc", "closed_utc", "robots"
            for name in same:
                if getattr(before, name) != getattr(record, name):
                    self._fail("result", f"{name} of {believed.identity} was {getattr(before, name)}, and is "
                                         f"{getattr(record, name)}")
        if believed.is_left and not record.closed_utc:
            self._fail("result", f"{believed.identity} was left, and is shown as connected")
        believed.record = record
        self._check_sheet(believed, record)

    def _check_sheet(self, believed, record):
        """A sheet has what was entered, and nothing else."""
        identity, history = believed.identity, record.history
        if len(history) != len(believed.entries):
            self._fail("entries", f"{identity} has {len(history)} instead of {len(believed.entries)}")
            return
        for entry, kept in zip(history, believed.entries):
            if (entry.group, entry.desc) != kept.key or entry.who != kept.act.who or (
                    (entry.added or "") != (kept.added or "")):
                self._fail("entries", f"{identity}: {entry} instead of {kept.act.given}")
            if bool(entry.withdrawn_utc) is not (kept.withdrawn is not None):
                self._fail("withdrawal", f"{identity}: entry {entry.number} is {'' if entry.withdrawn_utc else 'not '}"
                                         "withdrawn")
            self._check_time(identity, entry, kept, believed)
        judged = [(act.act, act.judge) for act in record.judging.acts]
        if judged != [(JUDGED[act.name], act.given.get("judge", "")) for act in believed.judged]:
            self._fail("judges", f"{identity} has {judged}, and not {[each.name for each in believed.judged]}")
        counts = believed.counted()
        for place, (entry, kept) in enumerate(zip(history, believed.entries)):
            is_void = not kept.is_withdrawn and place in counts.void | counts.late
            if bool(entry.void) is not is_void:
                self._fail("void", f"{identity}: entry {entry.number} is void: {entry.void or 'no'}, of {counts}")
        for item in record.items:
            if item.value != counts.values.get(item.key, 0):
                self._fail("points", f"{identity}: {item.desc} is {item.value}, not {counts.values.get(item.key, 0)}")
        if record.points is not None and counts.total != Fraction(record.points.total):
            self._fail("points", f"{identity} has {record.points.total} instead of {counts.total}")
        if (record.sign_off is not None) is not (believed.sign_off is not None):
            self._fail("sign-off", f"{identity} is {'' if record.sign_off else 'not '}signed off")
        standing = believed.standing()
        if record.is_annulled is not standing.is_annulled or (record.event or believed.event.id) != standing.event:
            self._fail("wrong run", f"{identity} is{' ' if record.is_annulled else ' not '}annulled, and counts for "
                                    f"{record.event}, not as {standing}")
        given = believed.reasons.get("last")
        if given is not None and given.given["reason"] not in [stop.reason for stop in record.stops]:
            self._fail("reason", f"{identity} has no {given.given['reason']!r}")

    def _check_time(self, identity, entry, kept, believed):
        """An entry has the counted time at which it was made, and only of a late one it is said whether it was in
        time."""
        said = kept.said[-1].who if kept.said else ""
        if (entry.in_time, entry.in_time_by) != (kept.is_in_time, said):
            self._fail("in time", f"{identity}: entry {entry.number} is {entry.in_time}, by {entry.in_time_by!r}")
        limit = believed.event.benchmark.sheet.limit_s
        if said and (limit is None or entry.clock_s <= limit):
            self._fail("in time", f"{identity}: entry {entry.number} of {entry.clock_s} s was not late")
        if kept.clock_s is None and kept.made is not None:
            first, last = kept.made
            most = CLOCK_S + believed.watch.unsure_s
            is_too_early = limit is not None and kept.is_after_limit and entry.clock_s <= limit
            if not first - most <= entry.clock_s <= last + most or is_too_early:
                self._fail("time of an entry", f"{identity}: {entry.clock_s} s, not {first:.2f} to {last:.2f} s")
        elif kept.clock_s not in (None, entry.clock_s):
            self._fail("time of an entry", f"{identity}: was {kept.clock_s} s, and is {entry.clock_s} s")
        kept.clock_s = entry.clock_s

    # -- losses -------------------------------------------------------------------------------------

    def lost(self, sure, has_confirmed=True, keeps_stop=lambda at: True, is_taken_over=False):
        """A box was lost. What happened up to `sure` (true time) must be there again, with `has_confirmed` also
        what was confirmed, and a STOP of a moment for which `keeps_stop` holds. `is_taken_over`: what the computer of
        that box kept does not matter any more."""
        before = self._sure
        self._keeps_stop = [*([] if is_taken_over else self._keeps_stop), keeps_stop]
        self.has_lost = self.has_lost or sure < self._world.scheduler.now
        if sure >= self._world.scheduler.now and before is None:
            return
        self._sure = (sure, has_confirmed) if before is None else (min(sure, before[0]), has_confirmed and before[1])

    def continues(self, core, is_other_clock, was_set, killed_at):
        """The next box has resumed. `was_set`: somebody has set its clock. `killed_at`: when the one before ended, on
        this computer."""
        now = self._world.scheduler.now
        self.resumed = now
        self._away_s = 0.0 if killed_at is None else now - killed_at
        if is_other_clock:
            for believed in self.current.values():
                believed.watch.unsure_s = max(believed.watch.unsure_s, float("inf") if was_set else OTHER_CLOCK_S)
        if self._sure is None:
            self._keeps_stop.clear()
            self.look(core)
            return
        for act in self._interrupted:
            self._take_interrupted(core, act)
        self._interrupted.clear()
        for believed in list(self.runs.values()):
            self._reconcile(core, believed)
        self.look(core)
        for believed in self.current.values():
            if believed.changed >= self._sure[0]:
                self._adopt(core, believed, now)
        self._sure = None
        self._keeps_stop.clear()

    def _take_interrupted(self, core, act):
        run = self.runs.get(act.identity) if act.identity else self.current.get(act.zone)
        if run is not None and act.name not in DURABLE:
            run.changed = act.at + CLOCK_S
        elif run is not None and re.search(rf"\b{act.who}\b", repr(_record_of(core, run))):
            self._entered(act, run)

    def _must_be_there(self, act):
        sure, has_confirmed = self._sure
        return act.at <= sure or (has_confirmed and act.is_confirmed)

    def _may_be_lost(self, believed):
        return self._sure is not None and believed.changed > self._sure[0]

    def _reconcile(self, core, believed):
        """Forget what may be lost, and is."""
        record = _record_of(core, believed)
        if record is None:
            if not any(self._must_be_there(kept.act) for kept in believed.entries) and (
                    believed.now > self._sure[0]):
                del self.runs[believed.identity]
                self.current = {zone: each for zone, each in self.current.items() if each is not believed}
            return
        there = record.marks.entries
        believed.entries = [kept for kept in believed.ever if kept.act.given["id"] in there or (
            kept in believed.entries and self._must_be_there(kept.act))]
        believed.taken = {id: act for id, act in believed.taken.items() if id in there}
        for kept, entry in zip(believed.entries, record.history):
            if kept.withdrawn is not None and not entry.withdrawn_utc and not self._must_be_there(kept.withdrawn):
                kept.withdrawn = None
            while kept.said and kept.said[-1].who != entry.in_time_by and not self._must_be_there(kept.said[-1]):
                kept.said.pop()
        kept = len(record.judging.acts)
        believed.judged = [act for number, act in enumerate(believed.judged)
                           if number < kept or self._must_be_there(act)]
        known = repr(record)
        believed.decisions = [act for act in believed.decisions
                              if self._must_be_there(act) or re.search(rf"\b{act.who}\b", known)]
        for name in [name for name, act in believed.reasons.items() if not self._must_be_there(act)]:
            del believed.reasons[name]
        if believed.changed > self._sure[0]:
            believed.record = None

    def _adopt(self, core, believed, now):
        """Take the state of a run from the box that has lost its newest changes."""
        run, watch = core.box.zones[believed.zone].run, believed.watch
        is_known = believed.phase is Phase.ENDED and believed.stopped == believed.changed and all(
            keeps(believed.stopped) for keeps in self._keeps_stop)
        record = run.record(core.now())
        if not is_known or (record.started_utc, len(record.stops)) != (believed.started_utc, believed.ends):
            believed.final = None
        believed.is_paused = run.times.state.paused
        if run.phase is not Phase.ENDED:
            watch.counted, watch.since = record.elapsed_s, None
            believed.phases, believed.place = [Watch() for _ in record.phases], run.times.state.phase
            for phase, found in zip(believed.phases, record.phases):
                phase.counted = found.elapsed_s
        elif believed.final is None:
            watch.unsure_s = float("inf")  # it may have ended and begun again
        believed.setup.unsure_s = float("inf")
        believed.turn(now)


def _record_of(core, believed):
    with contextlib.suppress(Refused):
        return core.box.scores.record_of(core.now(), RunName(believed.zone, believed.identity))
    return None


def members(run):
    """The robots of a run with their ports; none in a run by hand."""
    return [member for member in run.members() if isinstance(member, Run)]
