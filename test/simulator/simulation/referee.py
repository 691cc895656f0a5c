"""Referees, who press buttons at random, as often a sensible one as not, and believe what they are answered."""

import itertools
from random import Random

from helpers.commands import COMMANDS, given_with
from roah_rsbb.box.calls import BoxCalls, Disks
from roah_rsbb.document.calls import Caller, Waiting, carried_out, waited
from roah_rsbb.journal.store import SYNC_TIMEOUT_S
from roah_rsbb.model.reason import decode
from roah_rsbb.model.records import Phase
from roah_rsbb.model.scoring import INCIDENTS, ScoreKind
from roah_rsbb.rulebook.benchmarks import Durable

from .disk import NotYet
from .ledger import DURABLE, Act
from .sheets import INCIDENT_WEIGHTS

# How long a call takes on its way, each way.
SHORTEST_S, LONGEST_S = 0.001, 0.01
# A mark without an answer is sent again after this time.
AGAIN_S = 1.0
# How often a thread that waits for the disk looks.
LOOK_S = 0.01


class Referee:
    """All referees of a box. Each call has a name of its own, by which it is found again."""

    def __init__(self, world, box, random):
        self.world, self.box, self.random = world, box, random
        self.pause_s = random.choice(((0.05, 0.5), (0.1, 1.5), (0.3, 3.0)))
        self.is_at_work, self.rests_until = True, 0.0
        self.then = []  # (commands, what happens soon after the next one of them, within how many seconds)
        self._numbers = itertools.count(1)
        self._organiser = Random(f"{world.seed} organiser")
        self._seen = {}  # identities of the runs that this referee knows, by zone, the newest first

    def begin(self):
        """Begin to work."""
        self.world.scheduler.after(self.random.uniform(*self.pause_s), self._act)
        if self.world.has_organiser:
            self.world.scheduler.after(self._organiser.uniform(0.5, 2.0), self._put_right)

    # -- what they do -------------------------------------------------------------------------------

    def _act(self):
        if not self.is_at_work:
            return
        self.world.scheduler.after(self.random.uniform(*self.pause_s), self._act)
        core = self.box.core
        if core is None or self.world.scheduler.now < self.rests_until:
            return
        box, random = core.box, self.random
        zone = random.choice(sorted(box.zones.keys()))
        run = box.zones[zone].run
        if run is not None and run.identity not in self._seen.setdefault(zone, []):
            self._seen[zone].insert(0, run.identity)
        what = random.random()
        if what < 0.45 and self._seen.get(zone):
            self._mark(zone, run)
        elif what < 0.53 and self._seen.get(zone):
            self._correct(zone)
        elif what < 0.95:
            self._sensible(box, zone, run)
        else:
            self._command(zone, random.choice(COMMANDS))

    def _sensible(self, box, zone, run):
        """Press a button that leads somewhere."""
        choose = self.random.choice
        if run is None:
            self._command(zone, choose(("connect", "connect", "connect", "next", "previous", "open_sheet", "no_show")))
        elif run.phase is Phase.RUNNING:
            if run.why_paused and self.random.random() < 0.5:
                self._command(zone, choose(("resume", "continue", "stop")))
            elif self.random.random() < 0.35:
                self._command(zone, choose(("stop", "stop", "pause", "resume", "next_phase")), run.identity)
        elif run.phase is Phase.ENDED:
            self._command(zone, choose(("disconnect", "disconnect", "start")))
        else:
            self._command(zone, "start")

    def _command(self, zone, command, identity=""):
        """Press a button. STOP has a call of its own, too."""
        given = given_with(command, self.box.core.box.zones[zone].event.team)
        is_lane = command == "stop" and identity and self.random.random() < 0.7
        self._call(command, zone, identity if is_lane else "", given, "stop" if is_lane else "act")

    def _mark(self, zone, run):
        """Mark an item of a run, mostly of the present one, and repeat it until there is an answer."""
        random = self.random
        identity = self._seen[zone][0] if random.random() < 0.8 else random.choice(self._seen[zone])
        known = self.world.ledger.runs.get(identity)
        if known is not None and known.event.benchmark.judges:
            self._judge(zone, identity)
            return
        event = self.box.core.box.zones[zone].event if known is None else known.event
        item = random.choice(event.benchmark.scoring)
        if event.benchmark.sheet.items:
            item = self._row(event.benchmark)
        given = {"group": item.group, "desc": item.desc, "id": str(next(self._numbers)), "role": "referee"}
        if item.kind is ScoreKind.UINT and random.random() < 0.7:
            given["added"] = random.choice(("1", "1", "2") if not item.id else ("1", "1", "2", "-1"))
        elif item.choices and random.random() < 0.7:
            given["text"] = random.choice(item.choices).name
        elif item.choices:
            given["value"] = 0
        else:
            given["value"] = random.choice((0, 40, 80, 100)) if item.kind is ScoreKind.DECIMAL else random.randint(
                0, 1 if item.kind is ScoreKind.BOOL else 5)
        self._send_mark(zone, identity, given)

    def _row(self, benchmark):
        """A row of a sheet with incidents, which are rarer."""
        if self.random.random() < 0.25:
            name = self.random.choices(*zip(*INCIDENT_WEIGHTS.items()))[0]
            return next(row for row in benchmark.scoring if (row.group, row.id) == (INCIDENTS, name))
        return self.random.choice([row for row in benchmark.scoring if row.group != INCIDENTS])

    def _send_mark(self, zone, identity, given):
        def answered(why):
            if why is None:
                self.world.scheduler.after(AGAIN_S, lambda: self._send_mark(zone, identity, given))
        self._call("mark", zone, identity, given, answered=answered)

    def _judge(self, zone, identity):
        """Judges submit their sheets, and the head referee decides."""
        name = self.random.choice(("submit", "submit", "hand_back", "waive", "sign_off"))
        given = {"judge": self.random.choice(("Ada", "Bert"))} if name in ("submit", "hand_back") else {}
        self._call(name, zone, identity, {**given, **({"reason": "late"} if name in ("hand_back", "waive") else {})})

    def _correct(self, zone):
        """Correct a run, or sign it off."""
        random = self.random
        identity, what = random.choice(self._seen[zone]), random.random()
        run = self.world.ledger.runs.get(identity)
        known = [self.world.ledger.runs[each] for each in self._seen[zone] if each in self.world.ledger.runs]
        late = [(each.identity, number) for each in known for number, kept in enumerate(each.entries, 1)
                if each.sign_off is None and (kept.said or number - 1 in each.counted().late)]
        has_incidents = run is not None and bool(run.event.benchmark.sheet.items and run.entries)
        if late and random.random() < 0.6:
            identity, number = random.choice(late)
            self._call("in_time", zone, identity, {"entry": number, "late": random.random() < 0.3})
        elif has_incidents and random.random() < 0.5:
            name, number = random.choice(("withdraw", "withdraw", "in_time")), random.randint(1, len(run.entries))
            self._call(name, zone, identity, {"entry": number, **({"late": False} if name == "in_time" else {})})
        elif what < 0.4:
            self._call("withdraw", zone, identity, {"entry": random.randint(1, 4)})
        elif what < 0.6 and run is not None and run.entries:
            self._call("take_back", zone, identity, {"id": random.choice(run.entries).act.given["id"]})
        elif what < 0.75:
            self._call("stop_reason", zone, identity, {"reason": f"because of {next(self._numbers)}"})
        else:
            self._call("sign_off", zone, identity, {})

    def _put_right(self):
        """An organiser puts a wrong run right."""
        random, world = self._organiser, self.world
        if not self.is_at_work:
            return
        world.scheduler.after(random.uniform(0.5, 2.0), self._put_right)
        runs = [run for run in world.ledger.runs.values() if run.is_left or random.random() < 0.2]
        if self.box.core is None or not runs:
            return
        run = random.choice(runs)
        name = random.choice(("annul", "move", "reopen", "reopen", "undo", "undo", "sign_off"))
        given = {} if name == "sign_off" else {"reason": f"because of {next(self._numbers)}"}
        if name == "move":
            given["event"] = random.choice([
                event.id for zone in world.config.zones for event in zone.events
                if event.benchmark.code == run.event.benchmark.code or random.random() < 0.2] or [run.event.id])
        self._call(name, run.zone, run.identity, given)

    # -- calls --------------------------------------------------------------------------------------

    def _call(self, name, zone, identity, given, call="act", answered=lambda why: None):
        """Make a call through the door of the box. `answered` gets why it failed; empty: it did not, None: nobody
        answered."""
        scheduler, box, process = self.world.scheduler, self.box, self.box.process
        who = f"Anna {next(self._numbers)}"
        given = {**given, "device": who} if name == "submit" else given
        text = f"{name} {' '.join(map(str, given.values()))} {identity or zone}"
        arguments = {"zone": zone, "run": identity, "by": who}
        if call == "act":
            arguments.update(action=name, given=given)
        done = Act(None, zone, identity, name, given, who)

        def answer(why):
            if why == "" and name in DURABLE and not process.is_ended:
                self.world.oracles.answers(box, done)
            scheduler.after(self._way_s(), lambda: arrive(why))

        def arrive(why):
            is_other = box is not self.box and self.world.config.durable is not Durable.TWO
            if process.is_ended or is_other:
                why = None  # the connection ended with it, or the referee uses another box now
            self.world.trace.note(f"{text}: {'no answer' if why is None else why or 'done'}")
            done.is_confirmed = done.is_confirmed or why == ""
            answered(why)

        def act():
            core = box.core
            if core is None or box.process is not process:
                answer(None)
                return
            questions = []
            until = process.loop.time() + SYNC_TIMEOUT_S

            def why_not_saved(ticket):
                box.storage.patient_until = until
                try:
                    why = core.store.why_not_saved(ticket)
                finally:
                    box.storage.patient_until = 0.0
                if not why and questions and not questions[0].done():
                    raise NotYet
                return why

            def ask_standby(ticket):
                questions.extend(filter(None, [core.standby.ask(ticket)]))
                return questions[0] if questions else None

            def wait(found):
                try:
                    reasons = _texts(waited(found))
                except NotYet:
                    process.loop.call_later(LOOK_S, wait, found)
                else:
                    answer("; ".join(reasons))

            def event(method, *arguments):
                def take(now, *those):
                    done.at = scheduler.now  # a core that hung asks its standby before that
                    method(now, *those)
                core.event(take, *arguments)

            done.at = scheduler.now
            calls = BoxCalls(core.box, event, Disks(
                core.journal.ticket, why_not_saved, ask_standby, core.why_not_recorded)).named()
            with self.world.ledger.acting(done, box):
                found = carried_out(calls[call], arguments, Caller("referee"))
                reasons = () if isinstance(found, Waiting) else _texts(found)
                if box.core is core and box is self.world.box:
                    self.world.ledger.done(core, done, reasons)
                elif box is self.world.box and not reasons:
                    self.world.ledger.interrupted(done)
            self._called(name)
            if isinstance(found, Waiting):
                wait(found)
            else:
                answer("; ".join(reasons))

        if process is None or process.is_ended:
            answered(None)
        else:
            scheduler.after(self._way_s(), lambda: process.soon(act))

    def _called(self, name):
        """A call was carried out. Some troubles wait for that."""
        found = next((waiting for waiting in self.then if name in waiting[0]), None)
        if found is not None:
            self.then.remove(found)
            self.world.scheduler.after(self.random.uniform(0.0, found[2]), found[1])

    def _way_s(self):
        return self.random.uniform(SHORTEST_S, LONGEST_S)


def _texts(answer):
    """Why a call was refused; empty: it was not."""
    return [str(decode(reason)) for reason in answer.get("refused", ())]
