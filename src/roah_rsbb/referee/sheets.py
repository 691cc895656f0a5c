"""The commands of the terminal referee for runs and their score sheets, and for the decisions of the head referee
(docs/referee.md, "Judges and objections in the terminal")."""

from typing import List, Sequence, Tuple

from roah_rsbb.ground.arguments import number
from roah_rsbb.model.actions import BY_THE_FILE_S, ENTRIES
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import EventSeen, JudgedRun, Judging, RunLine
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import IDLE, SheetItem
from roah_rsbb.referee import view
from roah_rsbb.referee.at_once import ROLE, Exit
from roah_rsbb.referee.state import run_json, sheet_json
from roah_rsbb.referee.terminal import (
    BY,
    ITEM,
    MUST_BY,
    OF_RUN,
    ZONE,
    Argument,
    Call,
    Commands,
    argument,
    counted,
    given_in,
    note,
    run,
    switch,
    text,
    zone,
)
from roah_rsbb.referee.words import NOT_ATTEMPTED, BadWord, pick, pick_item, value_of
from roah_rsbb.scoring.publication import MAX_OBJECTION_TIME_S
from roah_rsbb.wording import judging
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.timeline import page_item, timeline, timeline_line

LAST = "last"
COMMANDS, _ACTIONS = Commands(), Commands()


def pick_run(word: str, runs: Sequence[RunLine]) -> RunLine:
    """Return the run that `word` names: `last`, or a part of its identity that no other run has; raises `BadWord`.

    `runs`: those of the zone, the latest one first.
    """
    over = [run for run in runs if run.closed_utc_s is not None]
    if word == LAST and over:
        return over[0]
    found = [run for run in runs if run.identity == word] or [run for run in runs if word and word in run.identity]
    if len(found) == 1:
        return found[0]
    listed: List[str] = [run.identity for run in found or runs]
    if not listed:
        raise BadWord("no run of this zone is connected or over")
    if word == LAST:
        raise BadWord(f"no run of this zone is over: {runs[0].identity} is still connected. Disconnect it first, or "
                      "leave out '--run last' to mean it")
    matches = f"{len(found)} runs have '{word}' in their name" if found else f"no run '{word}'"
    raise BadWord("\n  ".join([f"{matches}; there are", *listed]))


def _named(call: Call) -> str:
    return pick_run(call.options.run, [run for run in call.link.box.runs() if run.zone == call.zone_name]).identity


def which(call: Call) -> Tuple[str, str]:
    """Return the zone, and the identity of the run that is named; empty: the connected run. Raises `Refused`,
    `BadWord`."""
    if call.options.run is not None:
        return call.zone_name, _named(call)
    if call.zone.phase == IDLE:
        raise Refused(["No run is connected. For a finished run give its name, such as '--run last' (see 'runs')"])
    return call.zone_name, ""


def event_numbered(call: Call, zone_name: str, place: int) -> EventSeen:
    """Return an event of the schedule by its number in its zone. Raises `BadWord`."""
    own = sorted((one for one in call.link.box.schedule.values() if one.zone == zone_name), key=lambda one: one.number)
    if place > len(own):
        raise BadWord(f"zone '{zone_name}' has no event {place}: there are 1 to {len(own)} ('schedule' lists them)")
    return own[place - 1]


# -- runs and score sheets --------------------------------------------------------------------------


@COMMANDS.add("runs", "list connected and finished runs with their scores", ["", "'Home A'"],
              zone("only the runs of this zone; ", "?"))
def _runs(call: Call) -> Exit:
    only, style = call.one_zone, call.output.style
    found = [run for run in call.link.box.runs() if only in (None, run.zone)]
    lines: List[str] = view.run_lines(found, style) if only else []
    for name in [] if only else call.link.box.box.zones:
        of_zone = view.run_lines([run for run in found if run.zone == name], style)
        lines += [f"{name}:", *(f"    {line}" for line in of_zone)]
    return call.output.show({"runs": [run_json(run) for run in found]}, lines)


@COMMANDS.add("sheet", "show a score sheet with its history, and why the run ended",
              ["'Home A'", "'Home A' --run last"], ZONE, OF_RUN)
def show_sheet(call: Call) -> Exit:
    """Print a score sheet with its history."""
    return _shown(call, *which(call), command="sheet")


def _shown(call: Call, zone: str, identity: str, command: str = "") -> Exit:
    sheet = call.link.run_sheet(zone, identity)
    return call.done(view.sheet_lines(sheet, call.output.style), command, zone=zone, sheet=sheet_json(sheet))


@COMMANDS.add("timeline", "show what happened in a run: marks, notes, stops, starts, pauses, the latest first",
              ["'Home A'", "'Home A' --run last"], ZONE, OF_RUN)
def _timeline(call: Call) -> Exit:
    zone, identity = which(call)
    style = call.output.style
    items = timeline(call.link.run_sheet(zone, identity).timeline, style.moments.stamp)
    return call.output.show({"timeline": [page_item(item) for item in items]}, [
        escaped(timeline_line(item)) for item in items])


@COMMANDS.add("note", "note this moment of a run, or enter the text of a note",
              ["'Home A'", "'Home A' 'took the wrong cup'", "'Home A' 'took the cup' --number 3 --run last"], ZONE,
              argument("text", nargs="?", default="", metavar="TEXT", help="the text; it can be entered later"),
              argument("--number", metavar="N", type=counted, help="number of the note whose text this is"), BY, OF_RUN)
def _note(call: Call) -> Exit:
    zone, identity = which(call)
    call.act("note", {**given_in(call.options, ENTRIES["note"]), "role": ROLE}, identity)
    return _timeline(call)


@COMMANDS.add("decide", "accept or drop a mark that was made before the sign-off and arrived after it",
              ["'Home A' 1 --accept --run last --by Anna", "'Home A' 1 --run last --reason 'counted twice' --by Anna"],
              ZONE, argument("number", type=counted, help="number of the proposal ('timeline' shows it)"),
              switch("--accept", "it counts, and you sign the new sheet (default: it is dropped)"),
              text("--reason", "why; it is kept with the score sheet"), MUST_BY, OF_RUN)
def _decide(call: Call) -> Exit:
    return _entered(call, "decide")


def _put_right(name: str, help_text: str, *examples: str) -> None:
    """Add the command of an action of the table that only needs a reason."""
    @COMMANDS.add(name, help_text, [f"'Home A' --run last --reason '{each}' --by Olga" for each in examples], ZONE,
                  _REASON, MUST_BY, run(""))
    def _do(call: Call) -> Exit:
        return _entered(call, name)


_REASON = text("--reason", "why; it is kept with the score sheet", required=True)
_put_right("annul", "let a finished run count nothing, and give its attempt back", "the door was locked")
_put_right("reopen", "let a signed score sheet be corrected; the next sign-off makes a new version", "protest upheld")
_put_right("undo", "take back the last of annul, move and reopen of a finished run", "it was the other run")


@COMMANDS.add("move", "move a finished run to the right event of its benchmark",
              ["'Home A' 5 --run last --reason 'it was Beta' --by Olga",
               "'Home A' 2 --to 'Home B' --run last --reason 'wrong round' --by Olga"], ZONE,
              argument("event", type=counted, help="number of the event in its zone ('schedule' shows it)"),
              argument("--to", metavar="ZONE", help="the zone of that event (default: the zone of the run)"),
              _REASON, MUST_BY, run(""))
def _move(call: Call) -> Exit:
    zone, identity = which(call)
    to = zone if call.options.to is None else pick("zone", call.options.to, sorted(call.link.box.box.zones))
    event = event_numbered(call, to, call.options.event)
    call.act("move", {"event": event.id, "reason": call.options.reason}, identity)
    return _shown(call, zone, identity)


@COMMANDS.add("withdraw", "withdraw an entry of the history", ["'Home A' 3 --note 'another robot'"], ZONE,
              argument("entry", type=counted, help="number of the entry ('sheet' shows it)"),
              note("beside the withdrawal"), BY, OF_RUN)
def _withdraw(call: Call) -> Exit:
    return _entered(call, "withdraw")


@COMMANDS.add("in-time", "say that an entry after the time limit was seen before it, so that it counts",
              ["'Home A' 7", "'Home A' 7 --late --run last"], ZONE,
              argument("entry", type=counted, help="number of the entry ('sheet' shows it)"),
              switch("--late", "no, it was late"), BY, OF_RUN)
def _in_time(call: Call) -> Exit:
    return _entered(call, "in_time")


@COMMANDS.add("reason", "record why a run was stopped, until it is signed off",
              ["'Home A' 'fire alarm'", "'Home A' 'hit the vase' --run last --end 1"], ZONE,
              argument("reason", metavar="TEXT", help="the reason; it replaces an earlier one"),
              argument("--end", dest="stop", metavar="N", type=counted,
                       help="number of the end ('sheet' shows it; default: the last)"), BY, OF_RUN)
def _reason(call: Call) -> Exit:
    return _entered(call, "stop_reason")


def _entered(call: Call, action: str) -> Exit:
    zone, identity = which(call)
    call.act(action, given_in(call.options, ENTRIES[action]), identity)
    return _shown(call, zone, identity)


@COMMANDS.add("sign-off", "sign off the score sheet of a finished run, which makes it final",
              ["'Home A' --run last --by Anna"], ZONE, run(""), MUST_BY, switch("--yes", "sign off without asking"),
              has_keyboard=True)
def _sign_off(call: Call) -> Exit:
    """Sign off the score sheet of a finished run. Where a run is connected and nobody is shown the sheet, another one
    is meant only by its name."""
    options, connected = call.options, call.zone.identity
    if connected and (options.run is None or (options.run == LAST and options.yes)):
        raise Refused([f"run {connected} is still connected: disconnect it first. To sign off an earlier run, give its "
                       "name ('runs' lists them)"])
    zone, identity = which(call)
    with call.confirmed(
        zone, lambda: view.sheet_lines(call.link.run_sheet(zone, identity), call.output.style),
        f"Sign off as {escaped(options.referee)}? The sheet becomes final. [y/N]",
        "the sheet becomes final: give --yes, or use a terminal, where you are asked", "not signed off",
    ):
        call.act("sign_off", {}, identity)
        return _shown(call, zone, identity)


# -- several judges, and objections -----------------------------------------------------------------


@COMMANDS.add("judges", "several judges and objections: list them, settle, hand back, publish, answer",
              ["list", "settle Hall 1 3 --reason 'the video shows it' --by Hugo",
           "object Hall Beta 'the cup was away' --at 2:41 --run last --by Hugo", "settle --help"], actions=_ACTIONS)
def _judges(call: Call) -> Exit:
    return _ACTIONS[call.options.action].do(call)


def _add(name: str, help_text: str, examples: Sequence[str], *arguments: Argument, nargs: str = ""):
    """As `Commands.add`, of an action of the head referee for a run in a zone."""
    of_run = argument("--run", metavar="RUN", help="a run of the zone: 'last', or a part of its name (default: the one "
                                                   "that is not signed off)")
    return _ACTIONS.add(name, help_text, examples, zone("", nargs or None), of_run, *arguments)


@_add("list", "show who has submitted, the values side by side, and objections", ["", "Hall", "Hall --run last"],
      nargs="?")
def _list(call: Call) -> Exit:
    """Print the progress of the judges; for a single zone also what they submitted."""
    if call.options.zone is not None:
        return _show(call, _judged(call).judging)
    if call.options.run is not None:
        raise BadWord("give the zone of the run before --run")
    box, now, found = call.link.box, call.link.now(), list(call.link.box.judging.values())
    lines = [line for one in found for line in view.progress_lines(
        box.results.get(one.identity), one, now.utc, call.output.style, f"{escaped(one.zone)}: ")]
    return call.output.show({"runs": found}, lines or ["no run that judges score, and no provisional result"])


@_add("settle", "settle the value of an item where the judges differ",
      ["Hall 1 3 --reason 'the video shows it' --by Hugo", "Hall presentation 7.5 --reason 'mean of both' --by Hugo"],
      argument("item", help=ITEM),
      argument("value", help="a number, yes or no, a choice, or not-attempted; a rating is one number"),
      _REASON, MUST_BY)
def _settle(call: Call) -> Exit:
    run, value = _judged(call), call.options.value
    item = run.items[pick_item(call.options.item, run.items) - 1]
    entered = Entered(not_attempted=True) if value.lower() in NOT_ATTEMPTED else settled_value(value, item)
    return _decided(call, run, "settle", group=item.group, desc=item.desc, value=entered.value, text=entered.text,
                    not_attempted=entered.not_attempted, reason=call.options.reason)


def settled_value(word: str, item: SheetItem) -> Entered:
    """Return the value that settles an item, like `value_of`; but a sign belongs to the number and a rating is one.

    Raises `BadWord`, or `Refused` as the core itself does.
    """
    sign = "" if item.type == "choice" or word.startswith("=") else "="
    return value_of(f"{sign}{word}", item._replace(type="decimal") if item.type == "rating" else item)


def _of_entry(action: str, name: str, help_text: str, examples: Sequence[str], *arguments: Argument) -> None:
    """Add the command of an action of the table whose fields are its arguments."""
    @_add(name, help_text, examples, *arguments)
    def _do(call: Call) -> Exit:
        return _decided(call, _judged(call), action, **given_in(call.options, ENTRIES[action]))


def seconds_of(word: str) -> int:
    """Return the seconds of a time of a run, such as 2:41. Raises `ValueError`."""
    minutes, _, seconds = word.rpartition(":")
    return 60 * int(minutes or 0) + int(seconds)


_JUDGE = argument("judge", help="name of the judge")
_of_entry("hand_back", "hand-back", "hand a sheet back: the judge looks again, and submits again",
          ["Hall Ben --reason 'item 2 is empty' --by Hugo"], _JUDGE, _REASON, MUST_BY)
_of_entry("withdraw_sheet", "withdraw",
          "withdraw a sheet: it no longer counts, and another judge can take the place",
          ["Hall Ben --reason 'item 2 is empty' --by Hugo"], _JUDGE, _REASON, MUST_BY)
_of_entry("waive", "end-waiting", "do not wait for missing judges", ["Hall --reason 'Ben is ill' --by Hugo"],
          _REASON, MUST_BY)
_minutes = number(0, MAX_OBJECTION_TIME_S / 60)
_of_entry("publish", "publish", "publish the result of a finished run as provisional",
          ["Hall --by Hugo", "Hall --minutes 15 --by Hugo"],
          argument("--minutes", dest="seconds", metavar="N", default=BY_THE_FILE_S,
                   type=lambda word: round(60.0 * _minutes(word)),
                   help="the time for objections (default: that of the benchmarks file)"), BY)
_of_entry("object", "object", "enter an objection to a result: a protest, if it is signed off",
          ["Hall Epsilon 'the cup was on the table' --at 2:41 --run last --by Hugo"],
          argument("by", metavar="WHO", help="who objects, such as a team"), argument("text", help="the objection"),
          argument("--at", dest="second", metavar="M:SS", type=seconds_of, default=0,
                   help="the time of the run's clock that it is about"), BY)


@_add("answer", "answer an objection",
      ["Hall 1 uphold 'the video shows it' --by Hugo", "Hall 1 reject 'it fell' --by Hugo"],
      argument("number", metavar="N", type=counted, help="number of the objection ('judges list' shows it)"),
      argument("verdict", choices=("uphold", "reject"),
               help="uphold or reject it; the sheet is corrected separately, and reopened if it is signed"),
      argument("text", help="the answer"), BY)
def _answer(call: Call) -> Exit:
    options = call.options
    return _decided(call, _judged(call), "answer", number=options.number, upheld=options.verdict == "uphold",
                    text=options.text)


def _judged(call: Call) -> JudgedRun:
    """Return the run that the options name; by default the one of the zone that is not final. Raises `BadWord`."""
    zone, box = call.zone_name, call.link.box
    if call.options.run is not None:
        return call.link.judging(zone, _named(call))
    unsigned = [one.identity for one in judging.judgings_of(box, zone)]
    identities = [identity for identity in unsigned if identity in box.judging] or unsigned
    if not identities:
        raise Refused([f"zone '{zone}' has no run that is not signed off. Name another run with --run (see 'runs')"])
    if len(identities) > 1:
        raise BadWord("\n  ".join([f"zone '{zone}' has {len(identities)} such runs: name one with --run",
                                   *identities]))
    return call.link.judging(zone, identities[0])


def _decided(call: Call, run: JudgedRun, action: str, **given: object) -> Exit:
    """Do an action of the table, and show what became of the run."""
    call.act(action, given, run.judging.identity)
    return _show(call, run.judging)


def _show(call: Call, which_run: Judging) -> Exit:
    call.link.settle()
    shown = call.link.judging(which_run.zone, which_run.identity)
    run = call.link.box.results.get(which_run.identity)
    return call.done(
        view.judged_lines(run, shown, call.link.now().utc, call.output.style), f"judges {call.options.action}",
        zone=which_run.zone, run=None if run is None else run_json(run), judging=shown.judging,
        items=judging.judged_of(shown), objections=judging.objections_of(shown))
