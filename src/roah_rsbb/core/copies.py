"""What is known of the copies of the journal, and the warnings about them (docs/backup.md, "Warnings")."""

from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.core.clock import Now

# The place of the copy on a second computer.
STANDBY = "standby"
# A copy that is further behind is reported.
LATE_S = 3.0
# The node that copies reports once a second.
SILENT_S = 10.0
# An answer to a referee waits for the standby for at most this long.
SYNC_S = 0.5


class CopyReport(NamedTuple):
    """What the node that copies reports."""

    place: str
    is_of_this_box: bool  # whether it copies the journal of this core
    behind_s: float
    missing_entries: int
    trouble: str  # empty: none


class _Copy:
    """One copy."""

    def __init__(self, now: Now, is_expected: bool) -> None:
        self.is_expected = is_expected
        self.complete_mono = now.mono
        self.heard_mono = now.mono
        self.report: Optional[CopyReport] = None
        self.warning = ""  # the last one that was logged

    def is_connected(self, now: Now) -> bool:
        """Whether the latest report is recent and says that the copy works."""
        report = self.report
        return (report is not None and report.is_of_this_box and not report.trouble
                and now.mono - self.heard_mono < SILENT_S)

    def why_behind(self, now: Now) -> str:
        """Return why the copy is behind."""
        report = self.report
        if report is None or now.mono - self.heard_mono >= SILENT_S:
            return "node roah_rsbb_backup does not report. Check that it runs"
        if report.trouble:
            return report.trouble
        if not report.is_of_this_box:
            return "the journal of another core is copied. End the other core"
        return "it is being written. If this lasts, use a faster stick"


class Copies:
    """All copies of the journal."""

    def __init__(self) -> None:
        self._copies: Dict[str, _Copy] = {}
        # The box asks the standby whether it has everything up to now. These are numbers of such questions: the newest
        # one, the newest one with an answer, and the newest one for which the answer to a referee no longer waited.
        self._asked = self._answered = self._given_up = 0

    def expect(self, now: Now, place: str) -> None:
        """Warn from now on if this copy is missing."""
        self._copies[place] = _Copy(now, is_expected=True)

    def report(self, now: Now, report: CopyReport) -> Optional[str]:
        """Take a report. Return a text to log: a new warning, or empty: the copy is complete again; None: no change."""
        copy = self._copies.get(report.place)
        if copy is None:
            copy = self._copies[report.place] = _Copy(now, is_expected=False)
        copy.heard_mono, copy.report = now.mono, report
        if report.is_of_this_box:
            copy.complete_mono = max(copy.complete_mono, now.mono - max(0.0, report.behind_s))
        warning = copy.why_behind(now) if self._is_late(now, copy) else ""
        before, copy.warning = copy.warning, warning
        if warning == before:
            return None
        return self._text(now, report.place, copy) if warning else ""

    # -- answers that wait for the standby ----------------------------------------------------------

    def ask(self) -> int:
        """Return the number of a new question: whether the standby has everything up to now."""
        self._asked += 1
        return self._asked

    def is_worth_waiting(self, now: Now) -> bool:
        """Whether the standby will probably answer in time: it is connected, and it answered the earlier questions."""
        copy = self._copies[STANDBY]
        return copy.is_connected(now) and self._given_up <= self._answered

    def answer(self, number: int) -> bool:
        """Note that the standby has everything up to this question. Return whether that ends a warning."""
        copy = self._copies[STANDBY]
        if copy.report is not None:  # this report may be older than the answer
            copy.report = copy.report._replace(trouble="", is_of_this_box=True)
        was_missing = self._given_up > self._answered
        self._answered = max(self._answered, min(number, self._asked))
        return was_missing and self._given_up <= self._answered

    def give_up(self, now: Now, number: int) -> Optional[str]:
        """Note that the answer to a referee no longer waits for this question. Return a new warning to log, or None."""
        was_missing = self._given_up > self._answered
        self._given_up = max(self._given_up, number)
        is_missing = self._given_up > self._answered
        return self._unconfirmed(now) if is_missing and not was_missing else None

    def _unconfirmed(self, now: Now) -> str:
        copy = self._copies[STANDBY]
        why = f"it did not answer within {SYNC_S:g} s" if copy.is_connected(now) else copy.why_behind(now)
        return f"The standby does not have the referees' last entries yet. They are saved on this computer only: {why}"

    # -- warnings -----------------------------------------------------------------------------------

    def warnings(self, now: Now) -> List[str]:
        """Return the warnings for every referee."""
        # The node may have been started again with other settings.
        self._copies = {place: copy for place, copy in self._copies.items()
                        if copy.is_expected or now.mono - copy.heard_mono < SILENT_S}
        late = {place: copy for place, copy in self._copies.items() if self._is_late(now, copy)}
        is_unconfirmed = self._given_up > self._answered and STANDBY not in late  # the other warning says more
        return [*([self._unconfirmed(now)] if is_unconfirmed else []),
                *(self._text(now, place, copy) for place, copy in late.items())]

    @staticmethod
    def _is_late(now: Now, copy: _Copy) -> bool:
        return now.mono - copy.complete_mono >= LATE_S

    @staticmethod
    def _text(now: Now, place: str, copy: _Copy) -> str:
        missing = 0 if copy.report is None else copy.report.missing_entries
        entries = f", {missing} entries" if missing else ""
        return (f"The copy of the journal ({place}) is {now.mono - copy.complete_mono:.0f} s{entries} behind: "
                f"{copy.why_behind(now)}")
