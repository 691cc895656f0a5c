"""Planted faults: each is a change of one place in the source, and the simulator must find it.

`make test` checks that each still fits the source, and that the simulator finds a few of them. With ROAH_TEST_ALL it
must find every one.
"""

import pathlib
from typing import NamedTuple

from .world import ORGANISED

# Within so many seeds.
SEEDS = 500


class Fault(NamedTuple):
    """A mistake that somebody could make."""

    name: str
    module: str
    right: str
    wrong: str
    first: int = 1  # the seed from which on it is found


FAULTS = (
    # -- the journal
    Fault("a record counts as saved when it is written", "roah_rsbb.journal.log",
          "            self._prove(target, end)\n            self.saved = target\n",
          "            self._prove(target, end)\n            self.saved = self.written\n"),
    Fault("an answer does not wait for the disk", "roah_rsbb.journal.store",
          "max(0, self._writer.log.saved - self._first)", "max(0, self._writer.log.written - self._first)"),
    Fault("a failed fsync is tried again in the same place", "roah_rsbb.journal.log",
          "        self._must_begin = True  # until the fsync has succeeded\n", ""),
    Fault("a new segment lacks the records that are not proven", "roah_rsbb.journal.log",
          "            for waiting in self._waiting:\n                content.append(",
          "            for waiting in ():\n                content.append("),
    Fault("a segment gets its name before it is on the disk", "roah_rsbb.journal.log",
          "            self._files.sync(fd)\n            self._switch(", "            self._switch("),
    Fault("the name of a segment is not synced", "roah_rsbb.journal.log",
          "        self._files.sync_folder(self.folder)\n        self._files.sync_folder(os.path",
          "        self._files.sync_folder(os.path"),
    Fault("what a killed core left in the page cache counts as proven", "roah_rsbb.journal.log",
          "        self._waiting.extend(_Waiting(f.number, f.payload) for f in found.records "
          "if f.number > found.proven)",
          "        self._proven = self.saved = found.last"),
    Fault("records that were written during an fsync count as synced", "roah_rsbb.journal.log",
          "            self._prove(target, end)\n            self.saved = target\n",
          "            self._prove(self.written, self._at)\n            self.saved = self.written\n"),
    Fault("a record that did not fit on a full disk is forgotten", "roah_rsbb.journal.log",
          "                self._files.write(self._fd, frame, self._at)\n                with",
          "                self._unwritten.popleft()\n"
          "                self._files.write(self._fd, frame, self._at)\n"
          "                self._unwritten.appendleft(waiting)\n                with"),
    # -- the program around the core
    Fault("an answer names the ticket of the record before", "roah_rsbb.box.journal",
          "return None if lost else self._ticket", "return None if lost else self._ticket - 1"),
    Fault("a result is written only until it is corrected", "roah_rsbb.box.journal",
          "        self._batch.outcomes[record.identity] = ",
          "        if not any(entry.correction for entry in record.history):\n"
          "            self._batch.outcomes[record.identity] = "),
    Fault("used ports are forgotten in a restart", "roah_rsbb.box.game",
          "max(last_ports), version)", "0, version)"),
    Fault("a restarted core does not use the time that passed", "roah_rsbb.model.clock",
          "        return now.mono - passed - self.mono\n", "        return now.mono - self.mono\n"),
    # -- what a referee relies on
    Fault("STOP is ignored for a silent robot", "roah_rsbb.core.runs.run",
          "        self._end(now, EndReason.STOPPED, by=by)\n",
          "        if not self.link.is_silent(now):\n            self._end(now, EndReason.STOPPED, by=by)\n"),
    Fault("a pause does not stop the clock", "roah_rsbb.core.runs.run",
          "        self.clock.set_paused(now, bool(why))\n", ""),
    Fault("a pause is forgotten in a restart", "roah_rsbb.core.runs.times",
          "        self.state = state or CountdownState()\n",
          "        self.state = state or CountdownState()\n        self.state.paused_at = None\n"),
    Fault("the limit counts again from each start", "roah_rsbb.core.runs.times",
          "        super().start(now)\n        if self._stops",
          "        self.state.deadline = None\n        super().start(now)\n        if self._stops"),
    Fault("a withdrawal in a finished run is not recorded", "roah_rsbb.core.desks",
          "        self.report_correction(run, run.withdraw_score(now, by, number))\n",
          "        run.withdraw_score(now, by, number)\n"),
    Fault("a sign-off is not waited for", "roah_rsbb.model.actions",
          "of a run that is over becomes final\"), durable=True", "of a run that is over becomes final\")"),
    Fault("a restarted core sends robots nothing", "roah_rsbb.core.runs.run",
          "        self.state.doubted = self._is_in_progress\n        self.send(How.CHANGE)\n",
          "        self.state.doubted = self._is_in_progress\n"),
    # -- box and standby
    Fault("a copy lacks the last bytes of a segment that ended", "roah_rsbb.journal.copy_follower",
          "in present.items():\n            for part",
          "in list(present.items())[-1 if self._sizes else 0:]:\n            for part"),
    Fault("a standby answers before its disk", "roah_rsbb.journal.copy_folder",
          "                    os.fsync(file.fileno())\n", "                    pass\n"),
    Fault("of two boxes with one epoch, the wrong one stops", "roah_rsbb.standby.pair",
          "self.epoch, self.side is Side.STANDBY", "self.epoch, self.side is Side.BOX"),
    Fault("a box that slept does not ask", "roah_rsbb.box.fence", "if away_s >= AWAY_S and", "if away_s >= 99.0 and"),
    Fault("an entry does not wait for the standby", "roah_rsbb.box.standby_answers",
          "        waiting = ticket, answer\n",
          "        waiting = ticket, answer\n        answer.set_result(\"\")\n        return answer\n"),
    Fault("a box does not stop when it hears its successor", "roah_rsbb.standby.pair",
          "if word.claims and own.claims and word.rank > own.rank:",
          "if word.claims and own.claims and word.rank > own.rank and self.state is State.ASKING:"),
    # -- the core
    Fault("the timeout waits for the robot", "roah_rsbb.core.runs.run",
          "        elif out_of_time:\n",
          "        elif out_of_time and self.robot_state is not RobotState.EXECUTING:\n"),
    Fault("a mark counts again after a restart", "roah_rsbb.scoring.sheet",
          "self._taken = dict(self.state.marks.entries)", "self._taken = {}"),
    Fault("a withdrawn entry still counts", "roah_rsbb.scoring.sheet",
          "if not entry.withdrawn_utc and entry.number not in self._void:",
          "if (not entry.withdrawn_utc or entry.added == '2') and entry.number not in self._void:"),
    Fault("points of penalties are left out", "roah_rsbb.scoring.tree",
          "        total = sum(terms, ZERO)\n        points,",
          "        total = sum((term for term in terms if term > 0), ZERO)\n        points,"),
    # -- incidents and late marks
    Fault("an incident that was withdrawn makes marks void", "roah_rsbb.scoring.course",
          "if entry.withdrawn_utc or row is None or entry.judge:",
          "if row is None or entry.judge or (entry.withdrawn_utc and row.group != INCIDENTS):"),
    Fault("marks after the time limit have its time", "roah_rsbb.scoring.book",
          "return state.elapsed_s + max(0.001, now.utc - state.stops[-1].utc)", "return state.elapsed_s"),
    Fault("that a mark was late cannot be said again", "roah_rsbb.scoring.sheet",
          "entry._replace(in_time=in_time, ", "entry._replace(in_time=True, "),
    Fault("that a mark of a finished run was in time is not recorded", "roah_rsbb.core.desks",
          "        self.report_correction(run, run.say_in_time(now, by, number, in_time))\n",
          "        run.say_in_time(now, by, number, in_time)\n"),
    Fault("what takes something away is late", "roah_rsbb.scoring.course",
          "corrects = _takes_away(row, before, after)", "corrects = False"),
    Fault("what takes something away is void", "roah_rsbb.scoring.tree",
          "mark.at_s > happened.at_s and not mark.corrects", "mark.at_s > happened.at_s"),
    Fault("an incident is allowed once too often", "roah_rsbb.scoring.tree",
          "rule.times is not None and held >= rule.times", "rule.times is not None and held > rule.times"),
    Fault("a robot that is active again is removed", "roah_rsbb.scoring.tree",
          "for name in (*rule.ends, rule.name)", "for name in (rule.name,)"),
    Fault("a mark has the time of the run's last end", "roah_rsbb.core.runs.run",
          "return self.clock.elapsed(now) if self.phase is Phase.RUNNING else None", "return None"),
    Fault("a refusal has no reason", "roah_rsbb.core.actions.runs",
          "return [STARTED]", "return ['']"),
    Fault("a late message counts", "roah_rsbb.core.link.link",
          "if verdict is Freshness.DUPLICATE or verdict is Freshness.STALE:", "if verdict is Freshness.DUPLICATE:"),
    Fault("one old message is enough for a clock that was set back", "roah_rsbb.core.link.freshness",
          "if self._rising >= RISING and mono - self.state.newest_mono >= QUIET_S:",
          "if self._rising >= 1 and mono >= self.state.newest_mono:"),
    Fault("a relayed copy counts as the robot's own datagram", "roah_rsbb.radio.radio",
          "if run is not None and run.link.host == address[0]:", "if run is not None:"),
    # -- a wrong run
    Fault("that a run was annulled is not recorded", "roah_rsbb.core.desks",
          "self.report_correction(run, run.annul(now, _checked(by)))", "run.annul(now, _checked(by))", ORGANISED),
    Fault("a run that was annulled and is signed off counts", "roah_rsbb.scoring.counting",
          "if record.is_annulled:", "if record.is_annulled and not record.sign_off:", ORGANISED),
    Fault("a sheet that was reopened stays signed", "roah_rsbb.scoring.book",
          "signed = None if change.what == REOPENED else SignOff", "signed = SignOff", ORGANISED),
    # -- the short way of datagrams
    Fault("what is new overtakes what waits", "roah_rsbb.radio.short_way",
          "        turns.take()\n        if sender", "        if sender"),
    Fault("datagrams that waited have the moment at which they are taken", "roah_rsbb.radio.short_way",
          "self._moment = Now(one.mono, one.utc)", "self._moment = one_moment(self.mono, self.utc)"),
    Fault("a robot's clock may jump on the short way", "roah_rsbb.radio.short_way", "least < skew < most", "True"),
    # -- the robot
    Fault("a robot that executes does not obey STOP", "roah_rsbb.robot.machine",
          "    (BoxState.STOP, _R.EXECUTING): Transition(_R.STOP, _HALT),",
          "    (BoxState.STOP, _R.EXECUTING): Transition(_R.EXECUTING, _KEEP),"),
)


def planted(fault, source):
    """Return the file in the source, and its text with a fault. Raises ValueError if it does not fit any more."""
    path = pathlib.Path(source).joinpath(*fault.module.split(".")[1:]).with_suffix(".py")
    text = path.read_text("utf-8")
    if text.count(fault.right) != 1:
        raise ValueError(f"'{fault.name}': {fault.module} does not contain this once: {fault.right}")
    return path, text.replace(fault.right, fault.wrong)


def plant(fault, source):
    """Put a fault into a copy of the source. Raises ValueError."""
    path, text = planted(fault, source)
    path.write_text(text, "utf-8")
