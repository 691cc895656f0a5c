"""What the faces show: it is what referees believe, and it warns as docs/referee.md and organiser.md say."""

import re

from roah_rsbb.model.records import Phase
from roah_rsbb.protocol import RobotState

from .ledger import CLOCK_S, members
from .witness import SILENT_S

# Warnings of a robot that is not heard (docs/referee.md).
SILENT = re.compile("No message|no message|disappeared|not heard|not answered|knows? whether")
MISSED = re.compile("No message from the robot|has disappeared")
# When a warning that is due must be there, at the latest.
WARNED_S = 1.2
# When the disk takes nothing, every referee is warned after a second; a broken one is first tried again.
DISK_S = 4.0


class Shown:
    """Holds each document of the present box against the ledger."""

    def __init__(self, world):
        self._world, self._fail = world, world.oracles.fail
        self._waits = None  # since when an entry waits for a disk that takes nothing

    def look(self, core, document):
        """The box has a new document."""
        world, ledger = self._world, self._world.ledger
        if core.box.authority.is_superseded:
            if not document.box.superseded_by:
                self._fail("shown", "a box that is superseded does not say so")
            return
        playing = [(seen.event.team, seen.robot.robot) for seen in document.zones.values() if seen.robot]
        if len(playing) != len(set(playing)):
            self._fail("shown", f"a robot is in two runs: {playing}")
        for name, seen in document.zones.items():
            believed = ledger.current.get(name)
            if seen.identity != ("" if believed is None else believed.identity):
                self._fail("shown", f"{name} shows {seen.identity!r}")
            elif believed is not None:
                self._check_zone(core, seen, believed, core.box.zones[name].run)
        self._check_results(document, ledger)
        now, blocked_s = world.scheduler.now, world.storage.blocked_s()
        is_waiting = blocked_s > 0.0 and ledger.entered_at > max(now - blocked_s, ledger.resumed)
        self._waits = (self._waits or now) if is_waiting else None
        if is_waiting and now - self._waits > DISK_S and not document.box.warnings:
            self._fail("warning", f"nothing is written for {blocked_s:.1f} s, and nobody is warned")

    def _check_zone(self, core, seen, believed, run):
        identity, mono, clock = believed.identity, core.now().mono, seen.clock
        most = CLOCK_S + believed.watch.unsure_s
        is_running, rules = believed.phase is Phase.RUNNING, believed.event.benchmark.rules
        end = "" if believed.reason is None else believed.reason.name.lower()
        if (seen.phase, seen.end_reason) != (believed.phase.value, end):
            self._fail("shown", f"{identity} is shown as {seen.phase} {seen.end_reason}")
        limit, now = believed.event.benchmark.total_timeout, self._world.scheduler.now
        if is_running and abs(clock.spent(mono) - min(believed.watch.read(now), limit)) > most:
            self._fail("shown", f"{identity} shows {clock.spent(mono):.2f} s of {believed.watch.read(now):.2f} s")
        if bool(clock.paused) is not believed.is_paused:
            self._fail("shown", f"{identity} is shown as {clock.paused or 'not paused'}")
        if believed.is_stopped:
            left = max(0.0, core.box.settings.after_stop_duration - (now - believed.stopped))
            if abs(clock.after_stop(mono) - left) > most:
                self._fail("shown", f"{identity} shows {clock.after_stop(mono):.2f} s after its stop, not {left:.2f} s")
        values = believed.values()
        if {(item.group, item.desc): item.value for item in seen.items} != {
                item.key: values.get(item.key, 0) for item in believed.event.benchmark.scoring}:
            self._fail("shown", f"{identity} shows {seen.items} instead of {values}")
        counts = believed.counted()
        late = {number - 1 for item in seen.items for number in item.late}
        if not counts.late <= late <= counts.late | counts.void:
            self._fail("shown", f"{identity} shows {sorted(late)} as late: {counts}")
        self._check_times(seen, believed, mono, most)
        off = {name: bool(shown.off) for name, shown in seen.actions.items()}
        if off["stop"] is is_running:
            self._fail("shown", f"STOP of {identity} is {'off' if off['stop'] else 'on'}")
        if off["pause"] is (is_running and rules.pause and not believed.is_paused):
            self._fail("shown", f"pause of {identity} is {'off' if off['pause'] else 'on'}")
        if off["continue"] is run.is_doubted and not (is_running and bool(run.doubt(core.now())) is not run.is_doubted):
            self._fail("shown", f"continue of {identity} is {'off' if off['continue'] else 'on'}")
        self._check_not_stopped(seen, believed, run, now)
        for member in members(run) if is_running else ():
            silent_s, name = self._world.witness.silent_s(member.port), "" if seen.robot else member.robot.robot
            if silent_s > SILENT_S and member.phase is Phase.RUNNING and not any(
                    name in text and SILENT.search(text) for text in seen.warnings):
                self._fail("silent robot", f"{member.robot} is silent for {silent_s:.1f} s: {seen.warnings}")

            if seen.robot and self._world.witness.is_heard(member.port) and any(
                    MISSED.search(text) for text in seen.warnings):
                self._fail("warning", f"{member.robot} is heard, and there are warnings: {seen.warnings}")

    def _check_times(self, seen, believed, mono, most):
        """Setup time and phases, with their warnings."""
        identity, clock, rules = believed.identity, seen.clock, believed.event.benchmark.rules
        now = self._world.scheduler.now
        setup = believed.setup.read(now)
        if believed.phase is Phase.CONNECTED and rules.setup_time:
            if abs(clock.setup_elapsed.at(mono) - setup) > most + believed.setup.unsure_s:
                self._fail("shown", f"{identity}: {clock.setup_elapsed.at(mono):.2f} s of setup, not {setup:.2f} s")
            is_over = setup > rules.setup_time
            if abs(setup - rules.setup_time) > WARNED_S + most + believed.setup.unsure_s and is_over is not any(
                    "etup time" in text for text in seen.warnings):
                self._fail("warning", f"{identity} is in its setup time since {setup:.1f} s: {seen.warnings}")
        if not believed.place or believed.phase is not Phase.RUNNING:
            return
        if clock.phase_number != believed.place or clock.phase_name != rules.phases[believed.place - 1].name:
            self._fail("shown", f"{identity} shows phase {clock.phase_number} instead of {believed.place}")
            return
        elapsed, limit = believed.phases[believed.place - 1].read(now), rules.phases[believed.place - 1].limit
        if abs(clock.phase_elapsed.at(mono) - elapsed) > most:
            self._fail("phases", f"{identity}: {clock.phase_elapsed.at(mono):.2f} s of its phase, not {elapsed:.2f} s")
        late_s = self._world.box.process.hung_s()  # it looked at no time meanwhile
        if elapsed > limit + WARNED_S + late_s + most and not believed.is_paused and not any(
                clock.phase_name in text for text in seen.warnings):
            self._fail("warning", f"{identity} is in phase {believed.place} since {elapsed:.1f} s: {seen.warnings}")

    def _check_not_stopped(self, seen, believed, run, now):
        """A robot that has not stopped is named, also if its run ended by itself."""
        since = now - max(believed.changed, self._world.ledger.resumed)
        if believed.phase is not Phase.ENDED or since < 1.0 + WARNED_S:
            return
        for member in members(run):
            says = self._world.witness.says(member.port, now - since)
            if member.robot_state is not None and RobotState.STOP not in says and not (
                    seen.not_stopped and any("STOP" in text for text in seen.warnings)):
                self._fail("warning", f"{believed.identity} is over, and its robot says {says}: {seen.warnings}")

    def _check_results(self, document, ledger):
        absent = [line for identity, line in document.results.items() if identity not in ledger.runs]
        if len(absent) > len(ledger.absent) or (len(absent) < len(ledger.absent) and not ledger.has_lost):
            self._fail("shown", f"{len(ledger.absent)} teams did not appear, and there are {absent}")
        for identity, line in document.results.items():
            believed = ledger.runs.get(identity)
            if believed is None:
                if line.end_reason not in ("no_show", "withdrawn"):
                    self._fail("shown", f"there is a result of {identity}")
                continue
            signed = "" if believed.sign_off is None else believed.sign_off.who
            if line.signed_by != signed or (line.closed_utc_s is not None) is not believed.is_left:
                self._fail("shown", f"{identity} is shown as {line}")
