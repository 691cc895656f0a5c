"""What happened in a run, in one list: connect, starts, marks, notes, pauses, phases, goals, ends, the sign-off.

Every face shows these items and words none itself.
"""

from typing import Callable, Dict, Iterator, List, NamedTuple, Optional

from roah_rsbb.model.records import ANNULLED, REOPENED, CaptainSign, Objection, RunChange, Slot, TimelineEntry
from roah_rsbb.model.results import HistoryEntry, ProposedMark, RunEnd, RunTimeline
from roah_rsbb.wording import sheets
from roah_rsbb.wording.language import number, tr, tr_later, tr_said
from roah_rsbb.wording.sheets import When
from roah_rsbb.wording.times import clock_time

# The kinds of items besides those of `Occurred`; a second start is a restart.
MARK, STOP, END, RESTART = "mark", "stop", "end", "restart"
CONNECT, DISCONNECT, SIGN_OFF, OUTAGE = "connect", "disconnect", "sign_off", "outage"
NOTE, START, PHASE, GOAL, PAUSE, PROPOSAL = "note", "start", "phase", "goal", "pause", "proposal"
CAPTAIN, VERSION, CHANGE, OBJECTION = "captain", "version", "change", "objection"
_TITLES = {
    CONNECT: tr_later("Connected"), START: tr_later("Started"), RESTART: tr_later("Started again"),
    "continue": tr_later("Continued"), PAUSE: tr_later("Clock paused"), "resume": tr_later("Clock resumed"),
    GOAL: tr_later("Goal"), DISCONNECT: tr_later("Disconnected"),
    SIGN_OFF: tr_later("Signed off"),
}
_CHANGES = {ANNULLED: tr_later("Annulled: it counts nothing"), REOPENED: tr_later("Score sheet reopened")}
PROPOSED = tr_later("It was made before the sign-off and arrived after it: accept or drop it")
# Of the captain. A correction of the sheet makes what was said before it outdated.
SIGNED, REFUSED = (tr_later("Signed by captain {name} at {time}"),
                   tr_later("Captain {name} refused to sign at {time}"))
CORRECTED_SIGNED, CORRECTED_REFUSED = (tr_later("Corrected after captain {name} signed at {time}"),
                                       tr_later("Corrected after captain {name} refused to sign at {time}"))
NO_TEXT = tr_later("A moment to remember: no text yet")


class TimelineItem(NamedTuple):
    """Something that happened in a run, in words. A text is empty where it does not apply."""

    id: str  # its kind and its number, such as "mark 12": no other item of the run has the same
    kind: str  # one of the words above, or of `Occurred`
    utc_s: float
    time: str  # of the day
    clock: str  # of the run, counted
    text: str  # what: the name of the item, the note, or a sentence
    change: str = ""  # what a mark did, such as "+1"
    points: str = ""  # by how much it changed the total then, such as "+80"
    who: str = ""
    role: str = ""  # in words; empty: not known
    note: str = ""  # typed with a mark, or the reason of an end
    state: str = ""  # withdrawn, late, void, correction, proposed, dropped, refused or outdated; empty: as usual
    said: str = ""  # the state in words
    number: int = 0  # of the entry in the history, of the note, or of the end; 0: none
    group: str = ""  # of the item that was marked
    desc: str = ""
    arrived: str = ""  # how long it waited for a link to the box, such as "arrived 15 s later"


def timeline(run: RunTimeline, when: When) -> List[TimelineItem]:
    """Return what happened in a run, the latest first. `when`: how times of day are shown."""
    # In the order of what may come at one moment.
    found = [_plain(CONNECT, 0, run.opened_utc_s, when), *(_mark(entry, when) for entry in run.history),
             *(_end(end, when) for end in run.ends), *_entries(run, when), *_after(run, when),
             *(_proposal(each, when) for each in run.proposals if not each.accepted)]
    return sorted(found, key=lambda item: item.utc_s)[::-1]


def corrections(run: RunTimeline, when: When) -> List[TimelineItem]:
    """Return how a run was put right, which signed sheets were replaced, and the objections, the latest first."""
    return [item for item in timeline(run, when) if item.kind in (CHANGE, VERSION, OBJECTION)]


def _after(run: RunTimeline, when: When) -> Iterator[TimelineItem]:
    for place, outage in enumerate(run.outages, 1):
        yield _plain(OUTAGE, place, outage.utc, when)._replace(text=tr_said(sheets.outage_text(outage)))
    if run.closed_utc_s is not None:
        yield _plain(DISCONNECT, 0, run.closed_utc_s, when)
    for place, sign in enumerate(run.captain, 1):
        yield _plain(CAPTAIN, place, sign.utc, when)._replace(
            text=captain_text(sign, when), note=sign.comment, who=sheets.person(sign.who),
            state="refused" if sign.refused else "outdated" if sign.outdated else "")
    for version in run.versions:
        yield _plain(SIGN_OFF, version.number, version.signed_utc_s, when)._replace(
            who=sheets.person(version.signed_by))
    for one in run.objections:
        yield _plain(OBJECTION, one.number, one.utc, when, one.second or None)._replace(
            text=tr("Objection {number} of {name}: {text}", number=one.number, name=one.by, text=one.text),
            who=sheets.person(one.who), said=_answer(one, when), state="" if one.answered_utc else "proposed")
    for place, change in enumerate(run.changes, 1):
        yield _changed_run(change, place, when)
    for version in run.versions:
        yield _plain(VERSION, version.number, version.replaced_utc_s, when)._replace(
            text=tr("Version {number} of the sheet: {text}", number=version.number,
                    text=sheets.version_text(version, when)),
            said=sheets.difference_text(version), who=sheets.person(version.replaced_by), note=version.why)
    if run.signed_utc_s is not None:
        yield _plain(SIGN_OFF, 0, run.signed_utc_s, when)._replace(who=sheets.person(run.signed_by))


def _changed_run(change: RunChange, place: int, when: When) -> TimelineItem:
    """Return that a run was annulled, moved or reopened, and whether that was taken back."""
    text, before, after = tr(_CHANGES.get(change.what, change.what)), change.before, change.after
    if before is not None and after is not None:
        text = tr("Moved: {before}, now {after}", before=_slot(before), after=_slot(after))
    said = tr("taken back by {name} at {time}: {reason}", name=sheets.person(change.undone_by),
              time=when(change.undone_utc), reason=change.undone_reason) if change.undone_utc else ""
    return _plain(CHANGE, place, change.utc, when)._replace(
        text=text, who=sheets.person(change.who), note=change.reason, said=said, state="withdrawn" if said else "")


def _answer(one: Objection, when: When) -> str:
    if not one.answered_utc:
        return tr("not answered yet")
    name, time = sheets.person(one.answered_by), when(one.answered_utc)
    if one.upheld:
        return tr("upheld by {name} at {time}: {reason}", name=name, time=time, reason=one.answer)
    return tr("rejected by {name} at {time}: {reason}", name=name, time=time, reason=one.answer)


def _slot(slot: Slot) -> str:
    return tr("team {team}, {turn}", team=slot.team, turn=sheets.turn(slot.round, slot.run))


def _plain(kind: str, number_: int, utc_s: float, when: When, clock_s: Optional[float] = None) -> TimelineItem:
    return TimelineItem(f"{kind} {number_}" if number_ else kind, kind, utc_s, when(utc_s), clock_text(clock_s),
                        tr(_TITLES.get(kind, kind)), number=number_)


def _entries(run: RunTimeline, when: When) -> Iterator[TimelineItem]:
    is_started = False
    for entry in run.entries:
        kind = RESTART if entry.kind == START and is_started else entry.kind
        is_started = is_started or kind == START
        found = _plain(kind, entry.number, entry.utc, when, entry.clock_s)._replace(
            who=sheets.person(entry.who), role=sheets.role_word(entry.role))
        if kind == NOTE:
            yield found._replace(text=entry.text or tr(NO_TEXT), said=_changed(entry, when),
                                 arrived=sheets.arrived_text(entry.utc, entry.arrived_utc))
        elif kind == PHASE:
            yield found._replace(text=tr("Phase: {name}", name=entry.text))
        elif kind == PAUSE and entry.text:
            yield found._replace(text=tr("Clock paused: {why}", why=tr_said(entry.text)))
        elif kind == GOAL and entry.text:
            yield found._replace(text=tr("Goal: {text}", text=tr_said(entry.text)))
        else:
            yield found


def _changed(entry: TimelineEntry, when: When) -> str:
    """Return when the text of a note was entered, if that was later."""
    by, time = sheets.person(entry.changed_by), when(entry.changed_utc)
    return tr("text by {name} at {time}", name=by, time=time) if entry.changed_utc else ""


def _mark(entry: HistoryEntry, when: When) -> TimelineItem:
    texts = sheets.entry_texts(entry, when)
    state = ("withdrawn" if entry.withdrawn_utc_s else "late" if entry.late else "void" if entry.void
             else "correction" if entry.correction else "")
    return TimelineItem(
        f"{MARK} {entry.number}", MARK, entry.utc_s, texts.when, clock_text(entry.clock_s), entry.item,
        sheets.change_text(entry), points_text(entry.points), sheets.person(entry.by), sheets.role_word(entry.role),
        entry.note, state, "; ".join(filter(None, (texts.correction, texts.withdrawn, texts.void))), entry.number,
        entry.group, entry.item, sheets.arrived_text(entry.utc_s, entry.arrived_utc_s))


def _proposal(proposal: ProposedMark, when: When) -> TimelineItem:
    found, by = _mark(proposal.entry, when), sheets.person(proposal.decided_by)
    said = tr(PROPOSED) if proposal.decided_utc_s is None else tr(
        "dropped by {name} at {time}", name=by, time=when(proposal.decided_utc_s))
    return found._replace(
        id=f"{PROPOSAL} {proposal.number}", kind=PROPOSAL, number=proposal.number,
        state="proposed" if proposal.decided_utc_s is None else "dropped",
        said=f"{said}: {proposal.reason}" if proposal.reason else said)


def _end(end: RunEnd, when: When) -> TimelineItem:
    kind = STOP if end.who else END
    return _plain(kind, end.number, end.utc_s, when, end.clock_s)._replace(
        text=tr_said(end.desc) or sheets.end_reason(end.end_reason), who=sheets.person(end.who),
        note=sheets.stop_reason(end.reason, end.reason_by, end.who))


def clock_text(clock_s: Optional[float]) -> str:
    """Return the clock of a run at a moment, such as "2:41"; empty: not known."""
    return "" if clock_s is None else clock_time(clock_s)


def points_text(points: str) -> str:
    """Return a change of the points with its sign; empty: none."""
    return number(points if points.startswith("-") or not points else f"+{points}").replace("-", "−")


def captain_text(sign: CaptainSign, when: When) -> str:
    """Return that the captain signed, or refused to; and that the sheet was corrected afterwards."""
    said = (CORRECTED_REFUSED if sign.outdated else REFUSED) if sign.refused else (
        CORRECTED_SIGNED if sign.outdated else SIGNED)
    return tr(said, name=sign.name, time=when(sign.utc))


def said_of(item: TimelineItem) -> str:
    """Return what is unusual about an item, in words; empty: nothing."""
    return "; ".join(filter(None, (item.said, item.arrived if item.arrived not in item.said else "")))


def timeline_line(item: TimelineItem, mark: Callable[[str], str] = str) -> str:
    """Return an item in one line; `mark` makes what is unusual stand out."""
    by = ", ".join(filter(None, (item.who, item.role)))
    what = " ".join(filter(None, (item.text, item.change, f"({item.points})" if item.points else "")))
    said = said_of(item)
    times = f"{item.time} {item.clock:>5}"
    return f"{times}  {what}{f': {item.note}' if item.note else ''}{f' – {by}' if by else ''}" + (
        f"; {mark(said)}" if said else "")


def page_item(item: TimelineItem) -> Dict[str, object]:
    """Return an item for JSON, without what does not apply."""
    return {name: value for name, value in item._asdict().items() if value not in ("", 0)}
