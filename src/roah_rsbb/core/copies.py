"""What is known of the copies of the journal, and the warnings about them (docs/backup.md, "Warnings")."""

from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.core.clock import Now

# The place of the copy on a second computer.
STANDBY = "standby"
# A copy that is further behind is reported.
LATE_S = 3.0
# The node that copies reports once a second.
SILENT_S = 10.0


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

    def expect(self, now: Now, place: str) -> None:
        """Warn from now on if this copy is missing."""
        self._copies[place] = _Copy(now, is_expected=True)

    def report(self, now: Now, report: CopyReport) -> Optional[str]:
        """Take a report. Return a change to log: a warning, or empty if the copy is complete again."""
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

    def warnings(self, now: Now) -> List[str]:
        """Return the warnings for every referee."""
        # The node may have been started again with other settings.
        self._copies = {place: copy for place, copy in self._copies.items()
                        if copy.is_expected or now.mono - copy.heard_mono < SILENT_S}
        return [self._text(now, place, copy) for place, copy in self._copies.items() if self._is_late(now, copy)]

    @staticmethod
    def _is_late(now: Now, copy: _Copy) -> bool:
        return now.mono - copy.complete_mono >= LATE_S

    @staticmethod
    def _text(now: Now, place: str, copy: _Copy) -> str:
        missing = 0 if copy.report is None else copy.report.missing_entries
        entries = f", {missing} entries" if missing else ""
        return (f"The copy of the journal ({place}) is {now.mono - copy.complete_mono:.0f} s{entries} behind: "
                f"{copy.why_behind(now)}")
