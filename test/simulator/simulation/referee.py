"""Referees, who press buttons at random, as often a sensible one as not, and believe what they are answered."""

import itertools

from helpers.commands import COMMANDS, given_with, mark_with
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.journal.store import SYNC_TIMEOUT_S
from roah_rsbb.model.records import Phase
from roah_rsbb.model.referee import Refused, RunName
from roah_rsbb.model.scoring import ScoreKind
from roah_rsbb.rulebook.benchmarks import Durable

# How long a call takes on its way, each way.
SHORTEST_S, LONGEST_S = 0.001, 0.01
# A mark without an answer is sent again after this time.
AGAIN_S = 1.0
# How often a thread that waits for the disk looks.
LOOK_S = 0.01


class Referee:
    """All referees of a box. What they were answered is in `confirmed`, by the identity of the mark."""

    def __init__(self, world, box, random):
        self.world, self.box, self.random = world, box, random
        self.pause_s = random.choice(((0.05, 0.5), (0.1, 1.5), (0.3, 3.0)))
        self.is_at_work = True
        self.on_entry = []  # what happens soon after the next entry
        self._numbers = itertools.count(1)
        self.marks = {}  # by id: (run, mark)
        self.confirmed = {}  # by id: run
        self.signed = set()  # identities of runs
        self._seen = {}  # identities of the runs that this referee knows, by zone, the newest first

    def begin(self):
        """Begin to work."""
        self.world.scheduler.after(self.random.uniform(*self.pause_s), self._act)

    # -- what they do -------------------------------------------------------------------------------

    def _act(self):
        if not self.is_at_work:
            return
        self.world.scheduler.after(self.random.uniform(*self.pause_s), self._act)
        core = self.box.core
        if core is None:
            return
        box, random = core.box, self.random
        zone = random.choice(sorted(box.zones.keys()))
        run = box.zones[zone].run
        if run is not None and run.identity not in self._seen.setdefault(zone, []):
            self._seen[zone].insert(0, run.identity)
        what = random.random()
        if what < 0.5 and self._seen.get(zone):
            self._mark(zone, run)
        elif what < 0.56 and self._seen.get(zone):
            self._correct(zone)
        elif what < 0.95:
            self._sensible(box, zone, run)
        else:
            self._command(zone, random.choice(COMMANDS))

    def _sensible(self, box, zone, run):
        """Press a button that leads somewhere."""
        if run is None:
            self._command(zone, self.random.choice(("connect", "connect", "connect", "next", "previous", "open_sheet")))
        elif run.phase is Phase.RUNNING:
            if self.random.random() < 0.3:
                self._command(zone, self.random.choice(("stop", "pause", "resume", "next_phase")))
        elif run.phase is Phase.ENDED:
            self._command(zone, self.random.choice(("disconnect", "disconnect", "start")))
        else:
            self._command(zone, "start")

    def _command(self, zone, command):
        def call(core):
            team = core.box.zones[zone].event.team
            return core.box.act, (Target(zone), command, "Anna", given_with(command, team))
        self._call(f"{command} {zone}", call)

    def _mark(self, zone, run):
        """Mark an item of a run, mostly of the present one, and repeat it until there is an answer."""
        random = self.random
        identity = self._seen[zone][0] if random.random() < 0.8 else random.choice(self._seen[zone])
        name = RunName(zone, identity)
        event = (run or self.box.core.box.zones[zone]).event
        item = random.choice(event.benchmark.scoring)
        number = str(next(self._numbers))
        if item.kind is ScoreKind.UINT and random.random() < 0.7:
            mark = Mark(item.group, item.desc, added=random.choice(("1", "1", "2")), id=number, role="referee")
        else:
            value = random.randint(0, 1 if item.kind is ScoreKind.BOOL else 5)
            mark = Mark(item.group, item.desc, value, id=number, role="referee")
        self.marks[number] = name, mark
        self._send_mark(number)

    def _send_mark(self, number):
        name, mark = self.marks[number]

        def answered(why):
            if why is None:
                self.world.scheduler.after(AGAIN_S, lambda: self._send_mark(number))
            elif not why:
                self.confirmed[number] = name
                self.world.oracles.confirmed(number)
        self._call(f"mark {number} in {name.identity}", _enter(name, "mark", mark_with(mark)),
                   answered, is_durable=True)

    def _correct(self, zone):
        name = RunName(zone, self.random.choice(self._seen[zone]))
        what = self.random.random()
        self.world.oracles.corrected.add(name.identity)
        if what < 0.4:
            number = self.random.randint(1, 4)
            self._call(f"withdraw {number} of {name.identity}",
                       _enter(name, "withdraw", {"entry": number}), is_durable=True)
        elif what < 0.7 and self.marks:
            mark = self.random.choice([number for number, (run, _) in self.marks.items() if run == name] or ["0"])
            self._call(f"take back {mark}", _enter(name, "take_back", {"id": mark}),
                       is_durable=True)
        else:
            def answered(why):
                if why == "":
                    self.signed.add(name.identity)
            self._call(f"sign off {name.identity}", _enter(name, "sign_off", {}), answered,
                       is_durable=True)

    # -- calls --------------------------------------------------------------------------------------

    def _call(self, text, method, answered=lambda why: None, is_durable=False):
        """Call a service of the core. `answered` gets why it failed; empty: it did not, None: nobody answered."""
        scheduler, box = self.world.scheduler, self.box
        process = box.process

        def answer(why):
            scheduler.after(self._way_s(), lambda: arrive(why))

        def arrive(why):
            is_other = box is not self.box and self.world.config.durable is not Durable.TWO
            if process.is_ended or is_other:
                why = None  # the connection ended with it, or the referee uses another box now
            self.world.trace.note(f"{text}: {'no answer' if why is None else why or 'done'}")
            answered(why)

        def act():
            core = box.core
            if core is None or box.process is not process:
                answer(None)
                return
            try:
                core.event(*_flat(method(core)))
            except Refused as refused:
                self.world.oracles.refused(text, refused)
                answer("; ".join(refused.reasons))
                return
            finally:
                self.world.oracles.after_call(box, core)
                self._called(is_durable)
            if is_durable:
                ticket = core.journal.ticket()
                of_standby = None if ticket is None else core.standby.ask(ticket)
                wait(core, ticket, of_standby, process.loop.time() + SYNC_TIMEOUT_S)
            else:
                answer("")

        def wait(core, ticket, of_standby, until):
            if ticket is None:
                answer("not recorded")
            elif core.store.saved >= ticket and of_standby is not None and not of_standby.done():
                process.loop.call_later(LOOK_S, wait, core, ticket, of_standby, float("inf"))
            elif core.store.saved >= ticket:
                answer("" if of_standby is None or not of_standby.result() else "not confirmed by the standby")
            elif process.loop.time() >= until:
                answer("not saved")
            else:
                process.loop.call_later(LOOK_S, wait, core, ticket, of_standby, until)

        if process is None or process.is_ended:
            answered(None)
        else:
            scheduler.after(self._way_s(), lambda: process.soon(act))

    def _called(self, is_durable):
        """A call was carried out. Some troubles wait for an entry."""
        if is_durable and self.on_entry:
            self.world.scheduler.after(self.random.uniform(0.0, 0.1), self.on_entry.pop(0))

    def _way_s(self):
        return self.random.uniform(SHORTEST_S, LONGEST_S)


def _flat(call):
    method, arguments = call
    return (method, *arguments)


def _enter(run, entry, given):
    """Return what to call in a core to enter something for a run."""
    return lambda core: (core.box.act, (Target(*run), entry, "Anna", given))
