"""A box in simulated time with a real journal: it can be killed at any moment, and resumes from the journal."""

import shutil

from helpers.box_driver import BoxDriver, beacon_bytes
from helpers.competition import competition, event
from roah_rsbb.box import journal
from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.standby.beside_copy import NOT_MEASURED

CATERING = event("HCFGAC", timeout=300.0)
NAVIGATION = event("HNF", team="Beta", timeout=60.0, total_timeout=300.0)
NO_LISTENING = Settings(listen_duration=0.0)


def two_zones():
    """A task benchmark in one zone, and a functionality benchmark in the other."""
    return competition(tbm=[CATERING, event("HWV")], fbm=[NAVIGATION])


class JournaledDriver(BoxDriver):
    """Like `BoxDriver`. `on_record(driver)` is called after each record, before its effects are carried out."""

    def __init__(self, log_dir, config, settings=None, on_record=None, **of_driver):
        self.config = config
        self.boot = "boot 1"
        self.journal = None
        self.troubles = []
        self.restarts = 0
        self.ahead = NOT_MEASURED
        self.on_record = on_record
        self._log_dir = log_dir
        super().__init__(config, settings, **of_driver)

    def _begin(self, listening):
        self.open(self._log_dir / "0")
        super()._begin(listening)

    def open(self, directory, resume=Resume.ALWAYS, launch="", version=0, earlier=()):
        """Open the journal in a directory, and resume from it. `earlier`: configurations of runs, by version."""
        session = CoreSession(self.now.utc, self.now.mono, self.boot, 1, "uuid", launch)
        events = journal.competition(self.config)
        self.journal = Journal(str(directory), session, events, resume, self.troubles.append)
        self._rules.restart()
        self.box = Box(self.config, self.settings, beacon_bytes, self.journal.previous.last_port, version)
        self.core_journal = journal.CoreJournal(self.box, self.journal)
        saved, warnings = journal.saved_state(self.journal.previous, self.now, self.boot, lambda boot: self.ahead)
        self.troubles += [*self.journal.warnings, *warnings]
        self.event(self.box.restart.resume, saved._replace(earlier=dict(earlier)))

    def _take_effects(self):
        todo = super()._take_effects()
        if todo:
            self.core_journal.record(self.now, todo)
            if self.on_record is not None:
                self.on_record(self)
        return todo

    def copy(self, directory):
        """The journal's files as a process that is killed now leaves them."""
        shutil.copytree(self._directory, directory, ignore=shutil.ignore_patterns("*.new"))

    @property
    def _directory(self):
        return self._log_dir / str(self.restarts)

    def kill(self, seconds=2.0, boot=None, config=None, ahead=NOT_MEASURED, set_s=0.0, **of_configuration):
        """The process is killed, and started again after so many seconds; `boot`: with the computer. `ahead`: on
        another computer, whose clocks are ahead by so much, and whose UTC was then set by `set_s`."""
        after = self._log_dir / str(self.restarts + 1)
        self.copy(after)
        self.journal.close()
        self.now = self.now.later(seconds)
        if boot is not None:
            self.boot = boot
            mono = 50.0 if ahead.mono_s is None else self.now.mono + ahead.mono_s
            self.now = Now(mono, self.now.utc + ahead.utc_s + set_s)
        self.config = config or self.config
        self.restarts += 1
        self.ahead = ahead
        self.resume_in(after, **of_configuration)

    def resume_in(self, directory, **of_configuration):
        """A core that is started with the journal in this directory."""
        self.channels = {}
        self.open(directory, **of_configuration)


def box(tmp_path, config=None, settings=NO_LISTENING, **of_driver):
    """A box with a journal, of two zones if nothing else is said."""
    return JournaledDriver(tmp_path, config or two_zones(), settings, **of_driver)
