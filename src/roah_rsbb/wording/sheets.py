"""Runs and their score sheets as people read them: items, sums, history, ends, sign-off, whether a run counts.

Panels, terminal, pages and exports decorate these words (colour, marks, columns) and add none of their own. Moments
are shown in the format that the caller passes (`When`).
"""

import json
import math
import re
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

from roah_rsbb.model.reason import joined, say
from roah_rsbb.model.records import ItemRecord, Outage, ScoreEntry, SheetPoints, grouped
from roah_rsbb.model.results import HistoryEntry, VersionLine
from roah_rsbb.model.scoring import INCIDENTS
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.wording.language import number, tr, tr_later, tr_said
from roah_rsbb.wording.times import NOTHING, clock_time

NOT_ATTEMPTED = tr_later("not attempted")
CORRECTED = tr_later("corrected")
NOT_SAVED = tr_later("not saved yet")
IN_TIME = tr_later("in time")
BY_INCIDENT = tr_later("by an incident")
LATE = tr_later("After the time limit: it does not count")
CORRECTION = tr_later("correction")
OPEN = tr_later("open")
SIGNED_OFF = tr_later("signed off")
NOT_SIGNED_OFF = tr_later("not signed off")
PHASES = {
    "idle": tr_later("NOT CONNECTED"),
    "connected": tr_later("CONNECTED"),
    "running": tr_later("RUNNING"),
    "ended": tr_later("ENDED"),
}
MARKS = {"idle": "○", "connected": "●", "running": "▶", "ended": "■"}
_LOOKS = {"idle": "waiting", "connected": "ready", "running": "executing"}
_LOOKS_OF_ENDS = {"completed": "completed", "goals_timed_out": "timeout", "timeout": "timeout"}
END_REASONS = {
    "stopped": tr_later("stopped"),
    "completed": tr_later("completed"),
    "goals_timed_out": tr_later("all goals timed out"),
    "timeout": tr_later("timeout"),
    "no_messages_saved": tr_later("no data saved"),
    "module_failed": tr_later("module failed"),
    "no_show": tr_later("no-show"),
    "withdrawn": tr_later("withdrawn"),
}

_AWAY = say("The box was away for {time} s of the run")
_AWAY_IN_GOAL = say("The box was away for {time} s of goal {goal}")
_POINTS = say("{points} points")
_POINTS_AND = say("{points} points, and {more} for the team")
# Of a share of an item, and how much of it a touch gives.
PERCENT, PERCENT_STEP = "%", 25
_INCIDENTS = tr_later("Incidents")  # the group `model.scoring.INCIDENTS`
_TIME_LEFT = say("Time left")  # the name of a group of the box's own: `model.scoring.TIME_LEFT`
_LEFT_OUT = say("{text}. The robot was done meanwhile, so {left_out} s are not counted: the true time is up to "
                "{left_out} s longer. Check it")

When = Callable[[float], str]
# From here on, a delay (s) is said in minutes.
MANY_SECONDS = 100


# -- runs -------------------------------------------------------------------------------------------


def turn(round_number: int, run: int) -> str:
    """Return the round and the number of a run as a text."""
    return tr("round {round}, run {run}", round=round_number, run=run)


def run_name(code: str, team: str, round_number: int, run: int) -> str:
    """Return the name of a run for people."""
    return tr("{benchmark}, team {team}, {turn}", benchmark=code, team=team, turn=turn(round_number, run))


def end_reason(name: str) -> str:
    """Return why a run ended; the name of a reason that a newer version wrote is shown unchanged."""
    return tr(END_REASONS.get(name, name))


def phase(name: str, end: str = "") -> str:
    """Return the phase of a zone; `end`: name of the reason for which the run has ended."""
    word = tr(PHASES.get(name, name.upper()))
    return f"{word}: {end_reason(end)}" if end else word


def marked_phase(name: str, end: str = "") -> str:
    """Return the phase of a zone with its mark."""
    return f"{MARKS.get(name, '–')} {phase(name, end)}"


def look(name: str, end: str = "") -> str:
    """Return the look of a phase on all faces: of tokens.css it has the colours ``--state-LOOK``, of icons.svg the icon
    ``i-LOOK``."""
    return _LOOKS.get(name) or _LOOKS_OF_ENDS.get(end, "stopped")


def outage_text(outage: Outage) -> str:
    """Return what must be known of a time in which the box was away."""
    text = _AWAY_IN_GOAL(time=f"{outage.seconds:.1f}", goal=outage.goal) if outage.goal else _AWAY(
        time=f"{outage.seconds:.1f}")
    return _LEFT_OUT(text=text, left_out=f"{outage.left_out_s:.1f}") if outage.left_out_s else text


def run_state(started: object, closed: object, end: str) -> str:
    """Return how a run ended, or how far it is. `started`, `closed`: false until then; `end`: name of its end."""
    if end:
        return end_reason(end)
    if started:
        return tr("running")
    return tr("never started") if closed else tr("connected")


def stop_reason(reason: str, reason_by: str, stopped_by: str) -> str:
    """Return why somebody stopped a run, and who wrote that down if it was somebody else."""
    by = person(reason_by)
    return f"{reason} ({by})" if reason and reason_by and reason_by != stopped_by else reason


# -- people -----------------------------------------------------------------------------------------

NO_NAME = tr_later("no name")
ROLES = {
    "referee": tr_later("Referee"), "assistant": tr_later("Assistant"), "judge": tr_later("Judge"),
    "timekeeper": tr_later("Timekeeper"), "observer": tr_later("Observer"), "organiser": tr_later("Organiser"),
}
# The core writes the name that was typed, if any, and the node that called (docs/ros_interface.md): a ROS node, or a
# part of a box without ROS.
_WITH_NODE = re.compile(r"(.*) \(((?:/|roah_rsbb)[^\s()]*)\)")


def person(who: str) -> str:
    """Return the name of the referee in `who`, such as "Anna" of "Anna (/roah_rsbb_window)"; empty: nobody."""
    match = _WITH_NODE.fullmatch(who)
    if match is not None:
        return match.group(1)
    return tr(NO_NAME) if who.startswith("/") else who


def node_of(who: str) -> str:
    """Return the ROS node in `who`; empty: there is none."""
    match = _WITH_NODE.fullmatch(who)
    if match is not None:
        return match.group(2)
    return who if who.startswith("/") else ""


def role_word(role: str) -> str:
    """Return a role in words; empty: it is not known. One of a newer version is shown unchanged."""
    return tr(ROLES.get(role, role)) if role else ""


def author(who: str, role: str, device: str) -> str:
    """Return who made an entry, such as "Anna, judge, phone 3 (/roah_rsbb_web)". A referee's role goes without saying.
    """
    node = node_of(who)
    name = who[:-len(f" ({node})")] if node and node != who else "" if node else who
    known = ", ".join(filter(None, (name, role if role != "referee" else "", device)))
    return f"{known} ({node})" if known and node else known or node


# -- items and sums ---------------------------------------------------------------------------------


def item_text(item: SheetItem) -> str:
    """Return the value of a scoring item of a sheet."""
    if _is_by_incident(item):
        return tr(BY_INCIDENT)
    return with_unit(item_value(item.type, item.value, item.not_attempted, item.text), item)


def worth_text(item: SheetItem) -> str:
    """Return what an item gives, after its value, such as "of 5, 15 points each"; empty: nothing is known."""
    most = number(item.max) if item.type in ("uint", "int") else ""
    if item.percent:
        return tr("{percent} % of the points before", percent=number(item.percent))
    if not item.each or item.type == "rating":
        return tr("of {most}", most=most) if most and item.group != INCIDENTS else ""
    each = number(item.each).replace("-", "−")
    if item.type == "bool":
        return tr("{points} points", points=each)
    if item.unit == PERCENT:
        return tr("of {points} points", points=each)
    if item.each == "1" and item.type == "decimal":
        return tr("points")
    return (tr("of {most}, {points} points each", most=most, points=each) if most
            else tr("{points} points each", points=each))


def gives_text(item: SheetItem) -> str:
    """Return what one touch gives, such as "+80" or "+25 %"; empty: it has no such touch."""
    if item.unit == PERCENT:
        return f"+{PERCENT_STEP} %"
    if item.type not in ("bool", "uint", "int"):
        return ""
    if item.percent:
        return f"{signed(item.percent)} %"
    return signed(item.each) if item.each not in ("", "0") else "" if item.type == "bool" else "+1"


def signed(text: str) -> str:
    """Return a decimal number with its sign, and a minus as people write it."""
    return number(text if text.startswith("-") else f"+{text}").replace("-", "−")


def with_unit(text: str, item: Any) -> str:
    """Return a value with the unit of its item: of a sheet, of a record or of the history."""
    return f"{text} {item.unit}" if item.unit and text != tr(NOT_ATTEMPTED) else text


def steps_text(points: Optional[SheetPoints]) -> List[str]:
    """Return in the present language how points came about, where a reader could doubt it."""
    return [] if points is None else list(map(tr_said, points.steps))


def item_value(type_: str, value: int, not_attempted: bool = False, text: str = "") -> str:
    """Return the value of a scoring item. `text`: of a type that is not a whole number."""
    if not_attempted:
        return tr(NOT_ATTEMPTED)
    if type_ == "bool":
        return tr("yes") if value else tr("no")
    if text:
        return number(text) if type_ in ("decimal", "rating") else text
    return NOTHING if type_ in ("choice", "rating") else str(value)


def in_words(item: ItemRecord) -> str:
    """Return the value of an item as people read it."""
    if _is_by_incident(item):
        return tr(BY_INCIDENT)
    return with_unit(proposal(item), item)


def proposal(item: ItemRecord) -> str:
    """Return the value of an item as settlements record what the judges gave."""
    return item_value(item.kind, item.value, item.not_attempted, item.text)


def _is_by_incident(item: Union[SheetItem, ItemRecord]) -> bool:
    """Whether an item that nobody has marked has points: only an incident gives them."""
    return not (item.not_attempted or is_marked(item.value, item.text)) and item.points not in ("", "0")


def grouped_shown(items: Iterable[ItemRecord]) -> Dict[str, List[ItemRecord]]:
    """Return the items of a sheet by group, as results show them: of the incidents only those that happened."""
    return grouped(item for item in items if item.group != INCIDENTS or is_marked(item.value, item.text)
                   or _is_by_incident(item))


def ratings_text(ratings: Iterable[Tuple[str, str]]) -> str:
    """Return ratings as a text, such as "Anna 7, Ben 8.5"; `ratings`: judges and what they gave."""
    return ", ".join(f"{judge} {number(text)}" for judge, text in ratings if text)


# Incidents that many rule books have. Others are shown as the rules call them.
KNOWN_INCIDENTS = (
    tr_later("Restart"), tr_later("Restarted"), tr_later("Inactive"), tr_later("Active again"), tr_later("Removed"),
    tr_later("Longer time"), tr_later("Disqualified"), tr_later("Cheating"), tr_later("Absent"),
    tr_later("Commands received"), tr_later("Extra run"))


def incidents_text(items: Iterable[SheetItem]) -> str:
    """Return the title of the incidents of a sheet, with those that happened, such as "Incidents: restart 1"."""
    happened = incidents_said((item.desc, item.value) for item in items if item.group == INCIDENTS and item.value)
    return f"{tr(_INCIDENTS)}: {happened}" if happened else tr(_INCIDENTS)


def incidents_said(happened: Iterable[Tuple[str, int]]) -> str:
    """Return incidents with how often each happened, such as "Restart 1, Removed 2"."""
    return ", ".join(f"{tr(desc)} {count}" for desc, count in happened)


def is_marked(value: int, text: str) -> bool:
    """Return whether the value of an item differs from its initial value."""
    return bool(value) or text not in ("", "0")


class GroupOfValues(NamedTuple):
    """The values of a group of scoring items; `not_attempted`: how many items the robot did not try."""

    name: str
    values: Sequence[int]
    not_attempted: int


def sums_text(groups: Iterable[GroupOfValues]) -> str:
    """Return the sums of groups, such as "Achievements 5 (1 not attempted) · Penalized 2".

    A yes counts as 1; empty groups are left out.
    """
    return " · ".join(f"{group.name} {sum_text(group)}" for group in groups if group.values)


def points_said(points: SheetPoints) -> str:
    """Return the points, such as "85 points: Achievements 100 · Penalized -15"; of a single group only the total.

    See `groups_shown` for which of them.
    """
    found = [joined(group, " ") for group in groups_shown(points)]
    said = _POINTS(points=points.total)
    if points.for_team:
        said = _POINTS_AND(points=points.total, more=points.for_team)
    return joined([said, joined(found, " · ")], ": ") if found else said


def groups_shown(points: SheetPoints) -> List[Tuple[str, str]]:
    """Return the names and points of the groups, if there are several: without those that are part of another one,
    because readers add them up, and those without points."""
    return [(_TIME_LEFT if name == _TIME_LEFT else name, number) for name, number in points.groups
            if name not in points.inner and number != "0" and len(points.groups) > 1]


def points_text(points: Optional[SheetPoints]) -> str:
    """Return the points in the present language; empty: the sheet gives none."""
    return "" if points is None else tr_said(points_said(points))


def sum_text(group: GroupOfValues) -> str:
    """Return the sum of a group, such as "5 (1 not attempted)"."""
    mark = tr("({n} not attempted)", n=group.not_attempted) if group.not_attempted else ""
    return f"{sum(group.values)} {mark}".rstrip()


# -- sign-off ---------------------------------------------------------------------------------------


def sheet_state(closed: object, signed: object) -> str:
    """Return how far a score sheet is: open while the run is connected, then signed off or not."""
    if signed:
        return tr(SIGNED_OFF)
    return tr(NOT_SIGNED_OFF) if closed else tr(OPEN)


def signature(signed_utc_s: Optional[float], signed_by: str, when: When, versions: int = 0) -> str:
    """Return who signed a score sheet off, and when. `versions`: earlier signed ones."""
    if not signed_utc_s:
        return tr("reopened, not signed off again yet") if versions else tr(NOT_SIGNED_OFF)
    if versions:
        return tr("corrected at {time} by {name} (version {number})", time=when(signed_utc_s), name=person(signed_by),
                  number=versions + 1)
    if not signed_by:
        return tr("signed off at {time}", time=when(signed_utc_s))
    return tr("signed off by {name} at {time}", name=person(signed_by), time=when(signed_utc_s))


def version_text(version: VersionLine, when: When) -> str:
    """Return an earlier version of a signed sheet, and since when it does not hold."""
    points = f"{number(version.points)}, " if version.points else ""
    return points + tr("{signed}; replaced at {time} by {name}: what was printed or published in between has it",
                       signed=signature(version.signed_utc_s, version.signed_by, when),
                       time=when(version.replaced_utc_s), name=person(version.replaced_by))


def difference_text(version: VersionLine) -> str:
    """Return how the version after it differs, such as "Total: 180, now 150; Balance: 3, now 4"; empty: in nothing."""
    found = [(tr("Total"), number(version.points), number(version.then_points))] \
        if version.points != version.then_points else []
    found += [(before.desc, *_values(before, after)) for before, after in version.changed]
    return "; ".join(tr("{what}: {before}, now {after}", what=what, before=before or NOTHING, after=after or NOTHING)
                     for what, before, after in found)


def _values(before: ItemRecord, after: ItemRecord) -> Tuple[str, str]:
    """Return an item's values in words; of equal ones, which count differently by another sheet, their points."""
    values = in_words(before), in_words(after)
    if values[0] != values[1]:
        return values
    return (tr("{points} points", points=number(before.points or "0")),
            tr("{points} points", points=number(after.points or "0")))


# -- history ----------------------------------------------------------------------------------------


def mark_text(entry: HistoryEntry) -> str:
    """Return what an entry did, such as "Bumps into the furniture +1"."""
    return f"{entry.item} {change_text(entry)}"


def change_text(entry: HistoryEntry) -> str:
    """Return how an entry changed its item, such as "+1"."""
    is_number = entry.type in ("uint", "int") and not (entry.text or entry.old_text)
    if entry.not_attempted or not is_number:
        return with_unit(item_value(entry.type, entry.value, entry.not_attempted, entry.text), entry) + _of_judge(entry)
    return f"{entry.value - entry.old:+d}"


def _of_judge(entry: HistoryEntry) -> str:
    return f" ({entry.judge})" if entry.judge else ""


def to_undo(history: Sequence[HistoryEntry], count: int) -> List[HistoryEntry]:
    """Return the last `count` entries that count, the newest first."""
    return [entry for entry in reversed(history) if not entry.withdrawn_utc_s][:count]


def history_entry(entry: ScoreEntry, kind: str, unit: str) -> HistoryEntry:
    """Return an entry of a sheet as faces have it. `kind`, `unit`: of its item."""
    return HistoryEntry(
        entry.number, entry.utc, author(entry.who, entry.role, entry.device), entry.group, entry.desc, kind,
        entry.old, entry.old_not_attempted, entry.value, entry.not_attempted, entry.note, entry.correction,
        entry.withdrawn_utc or None, entry.withdrawn_by, entry.withdrawn_note, entry.withdrawal_corrects,
        entry.old_text, entry.text, entry.judge, entry.clock_s, entry.in_time, entry.in_time_by,
        entry.void, unit, entry.points, entry.who, entry.role,
        arrived_utc_s=entry.arrived_utc or None)


class EntryTexts(NamedTuple):
    """An entry of the history in words; a text is empty where it does not apply."""

    number: str
    when: str
    who: str
    item: str
    change: str
    note: str
    correction: str
    withdrawn: str
    void: str = ""  # why it does not count although nobody withdrew it, and who said whether it was in time


def entry_texts(entry: HistoryEntry, when: When) -> EntryTexts:
    """Put an entry into words."""
    old = with_unit(item_value(entry.type, entry.old, entry.old_not_attempted, entry.old_text), entry)
    new = with_unit(item_value(entry.type, entry.value, entry.not_attempted, entry.text), entry)
    return EntryTexts(
        str(entry.number), when(entry.utc_s), person(entry.who), f"{entry.group}: {entry.item}{_of_judge(entry)}",
        f"{old} → {new}", entry.note, tr(CORRECTION) if entry.correction else "", _withdrawal(entry, when),
        _counting(entry),
    )


def _counting(entry: HistoryEntry) -> str:
    """Return why an entry does not count although nobody withdrew it, and who said whether it was in time."""
    by = person(entry.in_time_by)
    said = "" if not by else tr("in time, says {name}", name=by) if entry.in_time else tr("late, says {name}", name=by)
    if entry.in_time and not by:
        said = tr(IN_TIME)
    return "; ".join(filter(None, (tr_said(entry.void) if entry.void else "", said,
                                   arrived_text(entry.utc_s, entry.arrived_utc_s))))


def arrived_text(utc_s: float, arrived_utc_s: Optional[float]) -> str:
    """Return how long something waited for a link to the box; empty: it did not."""
    if not arrived_utc_s:
        return ""
    seconds = round(arrived_utc_s - utc_s)
    if seconds < MANY_SECONDS:
        return tr("arrived {time} s later", time=seconds)
    return tr("arrived {time} min later", time=clock_time(seconds))


def _withdrawal(entry: HistoryEntry, when: When) -> str:
    """Return who withdrew an entry, when and why; empty: it counts."""
    if not entry.withdrawn_utc_s:
        return ""
    time = when(entry.withdrawn_utc_s)
    if entry.withdrawn_by:
        text = tr("withdrawn by {name} at {time}", name=person(entry.withdrawn_by), time=time)
    else:
        text = tr("withdrawn at {time}", time=time)
    if entry.withdrawal_corrects:
        text = tr("{withdrawn}, a correction", withdrawn=text)
    return f"{text}: {entry.withdrawn_note}" if entry.withdrawn_note else text


def entry_line(texts: EntryTexts, mark: Callable[[str], str] = str) -> str:
    """Return an entry in one line, without its number; `mark` makes what is unusual stand out."""
    who = f" {texts.who}:" if texts.who else ""
    note = f" ({texts.note})" if texts.note else ""
    marks: List[str] = [f"; {mark(text)}" for text in (texts.correction, texts.withdrawn, texts.void) if text]
    return f"{texts.when}{who} {texts.item}: {texts.change}{note}{''.join(marks)}"


# -- whether a run counts: `scoring.counting` decides it, and names it by a word -------------------

_TEXTS = {
    "counts": tr_later("counts"),
    "counts_as_zero": tr_later("counts as 0"),
    "not_over": tr_later("is not over"),
    "never_started": tr_later("does not count: never started"),
    "all_robots": tr_later("no score: all robots at once"),
    "annulled": tr_later("does not count: annulled"),
    "excluded": tr_later("does not count: excluded"),
    "not_signed_off": tr_later("does not count: not signed off"),
    "not_last": tr_later("does not count: a later attempt counts"),
    "not_best": tr_later("does not count: a better attempt counts"),
    "ran": tr_later("does not count: a run of the team at this event counts"),
    "no_score": tr_later("no score"),
}


def counting_text(word: str) -> str:
    """Return whether a run counts, and why or why not; a word of a newer version is shown unchanged."""
    return tr(_TEXTS.get(word, word))


def with_counting(state: str, word: str, only_unusual: bool = False) -> str:
    """Return the state of a run, followed by whether it counts. The state alone says that a run is not over.
    `only_unusual`: only if the run does not count as it is."""
    silent = ("", "not_over", "never_started", *(("counts", "all_robots") if only_unusual else ()))
    return state if word in silent else f"{state}, {counting_text(word)}"


# -- scores of benchmarking modules: anything with the fields of ModuleScore -----------------------

# The title of the scores that belong to the run as a whole.
WHOLE_RUN = tr_later("Whole run")
_WORDS = {True: tr_later("yes"), False: tr_later("no"), None: NOTHING}


class ScoreLine(NamedTuple):
    """One score: what it is, and its value with the unit."""

    name: str
    value: str


def score_line(score: Any) -> ScoreLine:
    """Return one score, such as ("Distance error", "0.124 m")."""
    return ScoreLine(score.desc or score.name.replace("_", " "), _with_unit(_value(score.value), score.unit))


def scores_by_group(scores: Iterable[Any]) -> List[Tuple[str, List[ScoreLine]]]:
    """Return all scores by group, in their order; those of the whole run come first."""
    groups: Dict[str, List[ScoreLine]] = {}
    for score in scores:
        groups.setdefault(score.group, []).append(score_line(score))
    whole = [(tr(WHOLE_RUN), groups.pop(""))] if "" in groups else []
    return whole + list(groups.items())


def _value(text: str) -> str:
    try:
        value = json.loads(text)
    except ValueError:
        return text
    if value is None or isinstance(value, bool):
        return tr(_WORDS[value])
    if isinstance(value, float):
        # Adding 0.0 turns a rounded "-0.0" into "0.0".
        return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".") if math.isfinite(value) else str(value)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _with_unit(value: str, unit: str) -> str:
    return number(f"{value} {unit}" if unit and value != NOTHING else value)
