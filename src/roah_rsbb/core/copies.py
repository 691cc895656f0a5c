"""What is known of the copies of the journal, and the warnings about them (docs/backup.md, "Warnings").

With `durable: two`, entries of referees are confirmed when the standby has them, too (docs/standby.md, "No entry is
lost"). They are known by the journal's tickets, which only rise.
"""

from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import say
from roah_rsbb.rulebook.benchmarks import Config, Durable
from roah_rsbb.wording import times

# The place of the copy on a second computer.
STANDBY = "standby"
# No box has more. The limit keeps a fault from growing.
MAX_COPIES = 8
# A copy that is further behind is reported.
LATE_S = 3.0
# A standby that lacks what is newer than this may have taken over: it does so when it has heard nothing for 2 s, or
# later.
REPLACED_S = 2.0
# The node that copies reports once a second.
SILENT_S = 10.0
# An answer to a referee waits for the standby for at most this long. Faces wait for an answer for 5 s.
SYNC_S = 2.0
UNCONFIRMED = say("not confirmed: {why}. It counts, and is saved on this computer: do not enter it again. It is "
                  "confirmed as soon as the standby has it")
UNCONFIRMED_OLD = say("not confirmed: the box at {address} has taken over, and may not have this entry. Look there, "
                      "and enter it there if it is missing")
LAST_ENTRIES = say("NOT CONFIRMED: the standby does not have the last entries: {why}")
ONE_COMPUTER = say("{why}. To continue with one computer, delete 'durable: two' in {place} and reload")
NO_ANSWER = say("the standby did not answer within {time} s")
NO_REPORT = say("the program that copies it does not report. See the terminal of the box")
NOT_COPIED = say("the journal of this box is not copied yet. If this lasts, the program that copies it has another "
                 "log_dir: end it, and the box starts it again")
BEING_WRITTEN = say("the copy is being written. If this lasts, its disk or its connection is too slow")
BEHIND = say("The copy of the journal ({place}) is {time} s behind: {why}")
BEHIND_BY = say("The copy of the journal ({place}) is {time} s, {size} kB behind: {why}")
NO_PORT = "{place}: 'durable: two' needs a standby: start the box with standby_port:=8083, or delete this line"


def unconfirmed(why: str) -> str:
    """Return the answer to an entry that the standby does not have yet."""
    return UNCONFIRMED(why=why)


def unconfirmed_by_old_box(by: str) -> str:
    """Return the answer to an entry that a box took just before another one, at this address, took over."""
    return UNCONFIRMED_OLD(address=by)


class CopyReport(NamedTuple):
    """What the node that copies reports."""

    place: str
    is_of_this_box: bool  # whether it copies the journal of this core
    behind_s: float  # infinite: it was not complete since the node that copies started
    missing_bytes: int
    trouble: str  # empty: none
    notice: str = ""  # what every referee must know besides; empty: nothing


class _Copy:
    """One copy."""

    def __init__(self, now: Now, is_expected: bool) -> None:
        self.is_expected = is_expected
        self.complete_mono = now.mono
        self.was_complete = False
        self.heard_mono = now.mono
        self.report: Optional[CopyReport] = None
        self.warning = ""  # the last one that was logged

    def is_connected(self, now: Now) -> bool:
        """Whether the latest report is recent and says that the copy works."""
        report = self.report
        return (report is not None and report.is_of_this_box and not report.trouble
                and now.mono - self.heard_mono < SILENT_S)

    def has_notice(self, now: Now) -> bool:
        """Whether the latest report is recent and says something that every referee must know."""
        return self.report is not None and bool(self.report.notice) and now.mono - self.heard_mono < SILENT_S

    def why_behind(self, now: Now) -> str:
        """Return why the copy is behind."""
        report = self.report
        if report is None or now.mono - self.heard_mono >= SILENT_S:
            return NO_REPORT
        if report.trouble:
            return report.trouble
        if not report.is_of_this_box:
            return NOT_COPIED
        return BEING_WRITTEN


class Copies:
    """All copies of the journal."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self.is_quiet = False
        """Whether nothing of them is logged any more: another box has taken over."""
        self._copies: Dict[str, _Copy] = {}
        self._two_at = ""  # where the configuration demands two copies; empty: one is enough
        # Tickets: the newest one that the standby was asked for, the newest one that it has, and the newest one that
        # was reported as not confirmed.
        self._asked = self._answered = self._given_up = 0

    def expect(self, now: Now, place: str, was_complete: bool = False) -> None:
        """Warn from now on if this copy is missing. `was_complete`: an earlier core had it complete, or copied it from
        there."""
        copy = self._copies[place] = _Copy(now, is_expected=True)
        copy.was_complete = was_complete

    def report(self, now: Now, report: CopyReport) -> None:
        """The node that copies reports how complete a copy is."""
        copy = self._copies.get(report.place)
        if copy is None and len(self._copies) >= MAX_COPIES:
            return
        if copy is None:
            copy = self._copies[report.place] = _Copy(now, is_expected=False)
        copy.heard_mono, copy.report = now.mono, report
        if report.is_of_this_box:
            copy.was_complete = copy.was_complete or report.behind_s < REPLACED_S
            copy.complete_mono = max(copy.complete_mono, now.mono - max(0.0, report.behind_s))
        warning = copy.why_behind(now) if self._is_late(now, copy) else ""
        is_new, copy.warning = warning != copy.warning, warning
        if is_new and not self.is_quiet:
            self._outbox.notice(*((Level.ERROR, self._text(now, report.place, copy)) if warning else (
                Level.INFO, f"The copy of the journal ({report.place}) is complete again")))

    # -- two copies ---------------------------------------------------------------------------------

    def why_not(self, config: Config) -> str:
        """Return why a configuration cannot be used: it demands a standby, and this box has none; empty: it can."""
        is_missing = config.durable is Durable.TWO and STANDBY not in self._copies
        return NO_PORT.format(place=config.durable_at) if is_missing else ""

    def use(self, config: Config) -> None:
        """Demand as many copies as this configuration."""
        self._two_at = str(config.durable_at) if config.durable is Durable.TWO else ""
        if not self._two_at:
            self._given_up = 0

    @property
    def are_two(self) -> bool:
        """Whether an entry is confirmed only when the standby has it, too."""
        return bool(self._two_at) and STANDBY in self._copies

    def may_be_replaced(self, now: Now) -> bool:
        """Whether the standby may have taken over, and may command the same robots, without a word from it here."""
        copy = self._copies.get(STANDBY)
        return copy is not None and copy.was_complete and now.mono - copy.complete_mono >= REPLACED_S

    @property
    def answered(self) -> int:
        """The newest ticket that the standby has on its disk."""
        return self._answered

    def ask(self, ticket: int) -> None:
        """Note that the standby was asked whether it has everything up to this ticket."""
        self._asked = max(self._asked, ticket)

    def is_worth_waiting(self, now: Now) -> bool:
        """Whether the standby will probably answer in time: it is connected, and it answered the earlier questions."""
        return self._copies[STANDBY].is_connected(now) and not self._is_unconfirmed

    def answer(self, _now: Now, ticket: int) -> None:
        """The standby has everything up to this ticket of the journal (`ask`)."""
        copy = self._copies[STANDBY]
        if copy.report is not None:  # this report may be older than the answer
            copy.report = copy.report._replace(trouble="", is_of_this_box=True)
        was_missing = self._is_unconfirmed
        self._answered = max(self._answered, min(ticket, self._asked))
        if was_missing and not self._is_unconfirmed:
            self._outbox.notice(Level.INFO, "The standby has all entries again")

    def give_up(self, now: Now, ticket: int) -> None:
        """A referee's entry is reported as not confirmed."""
        was_missing = self._is_unconfirmed
        self._given_up = max(self._given_up, ticket)
        if self._is_unconfirmed and not was_missing:
            self._outbox.notice(Level.WARNING, self._not_confirmed(now))

    def why_not_confirmed(self, now: Now) -> str:
        """Return why the standby does not have an entry, and what to do."""
        copy = self._copies[STANDBY]
        why = NO_ANSWER(time=f"{SYNC_S:g}") if copy.is_connected(now) else copy.why_behind(now)
        return ONE_COMPUTER(why=why, place=self._two_at)

    @property
    def _is_unconfirmed(self) -> bool:
        return self._given_up > self._answered

    def _not_confirmed(self, now: Now) -> str:
        return LAST_ENTRIES(why=self.why_not_confirmed(now))

    # -- warnings -----------------------------------------------------------------------------------

    def warnings(self, now: Now) -> List[str]:
        """Return the warnings for every referee."""
        # The node may have been started again with other settings.
        self._copies = {place: copy for place, copy in self._copies.items()
                        if copy.is_expected or now.mono - copy.heard_mono < SILENT_S}
        late = {place: copy for place, copy in self._copies.items() if self._is_late(now, copy)}
        texts = [self._text(now, place, copy) for place, copy in late.items()]
        if self._is_unconfirmed and STANDBY not in late:
            texts.insert(0, self._not_confirmed(now))
        return texts + [copy.report.notice for copy in self._copies.values()
                        if copy.report is not None and copy.has_notice(now)]

    @staticmethod
    def _is_late(now: Now, copy: _Copy) -> bool:
        return now.mono - copy.complete_mono >= LATE_S

    def _text(self, now: Now, place: str, copy: _Copy) -> str:
        if place == STANDBY and self.are_two:
            return self._not_confirmed(now)
        missing = 0 if copy.report is None else copy.report.missing_bytes
        time, why = times.in_sentence(now.mono - copy.complete_mono), copy.why_behind(now)
        if not missing:
            return BEHIND(place=place, time=time, why=why)
        return BEHIND_BY(place=place, time=time, size=-(-missing // 1000), why=why)
