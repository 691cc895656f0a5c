"""Replaces the names of teams, robots and people, addresses and free texts of a run with pseudonyms.

A pseudonym is a keyed hash (HMAC). The key comes from parts of the journal that are never published: the
same journal always has the same pseudonyms, but nobody can find a name by trying the names of all teams. Texts of the
rulebook stay: zones, benchmarks, items, groups, units, states.
"""

import hashlib
import hmac
import json
from typing import Tuple

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.records import (
    ItemRecord,
    JudgingRecord,
    PublicationRecord,
    Rating,
    RunRecord,
    ScoreEntry,
    ScoreValue,
    StopRecord,
)
from roah_rsbb.results.runs import LinkSecond, RobotPart, RunResult
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.wording.sheets import node_of

# Hexadecimal digits of a pseudonym: two names of a competition never get the same one.
_DIGITS = 12


class Names:
    """Makes the pseudonyms of a journal."""

    def __init__(self, key: bytes) -> None:
        self._key = key

    def of(self, kind: str, name: str) -> str:
        """Return the pseudonym of a name or text of this kind; empty stays empty."""
        if not name:
            return ""
        digest = hmac.new(self._key, f"{kind}\0{name}".encode("utf-8", "surrogatepass"), hashlib.sha256)
        return f"{kind}-{digest.hexdigest()[:_DIGITS]}"

    def person(self, who: str) -> str:
        """Return the pseudonym of a person, the same one whichever node their calls came from."""
        node = node_of(who)
        return self.of("person", who if node in ("", who) else who[:-len(f" ({node})")])


def names_of(reader: JournalReader) -> Names:
    """Return the pseudonyms of a journal."""
    secret = json.dumps([session[1:] for session in reader.sessions()])
    return Names(hashlib.sha256(secret.encode()).digest())


def anonymous(result: RunResult, names: Names) -> RunResult:
    """Return a run without names. Its entries are unchanged: `Names` replaces the texts that are made from them."""
    return result._replace(
        record=anonymous_record(result.record, names),
        robots=tuple(_robot(robot, names) for robot in result.robots),
    )


def anonymous_record(record: RunRecord, names: Names) -> RunRecord:
    """Return a run's record without names."""
    signed = record.sign_off
    return record._replace(
        team=_team(record.team, names), robots=tuple(names.of("robot", robot) for robot in record.robots),
        items=tuple(_item(item, names) for item in record.items),
        history=tuple(_entry(entry, names) for entry in record.history),
        module_scores=tuple(_score(score, names) for score in record.module_scores),
        stops=tuple(_stop(stop, names) for stop in record.stops),
        sign_off=signed and signed._replace(who=names.person(signed.who)), marks="",
        judging=_judging(record.judging, names), publication=_publication(record.publication, names),
    )


def _judging(judging: JudgingRecord, names: Names) -> JudgingRecord:
    waiver = judging.waiver
    return JudgingRecord(
        tuple(sheet._replace(
            judge=names.person(sheet.judge), device="", marks="", again=names.of("text", sheet.again),
            history=tuple(_entry(entry, names) for entry in sheet.history),
            items=tuple(_item(item, names) for item in sheet.items),
        ) for sheet in judging.sheets),
        tuple(one._replace(
            who=names.person(one.who), reason=names.of("text", one.reason),
            proposals=tuple(sorted((names.person(judge), value) for judge, value in one.proposals)),
        ) for one in judging.settlements),
        waiver and waiver._replace(who=names.person(waiver.who), reason=names.of("text", waiver.reason)),
        tuple(act._replace(
            who=names.person(act.who), judge=names.person(act.judge), reason=names.of("text", act.reason),
        ) for act in judging.acts),
    )


def _publication(publication: PublicationRecord, names: Names) -> PublicationRecord:
    published = publication.published
    return PublicationRecord(
        published and published._replace(who=names.person(published.who)),
        tuple(one._replace(
            by=names.of("text", one.by), text=names.of("text", one.text), who=names.person(one.who),
            answered_by=names.person(one.answered_by), answer=names.of("text", one.answer),
        ) for one in publication.objections),
    )


def _team(team: str, names: Names) -> str:
    return team if team == ALL_TEAMS else names.of("team", team)


def _item(item: ItemRecord, names: Names) -> ItemRecord:
    return item._replace(ratings=tuple(Rating(names.person(r.judge), r.text) for r in item.ratings))


def _entry(entry: ScoreEntry, names: Names) -> ScoreEntry:
    return entry._replace(
        who=names.person(entry.who), note=names.of("text", entry.note), judge=names.person(entry.judge),
        withdrawn_by=names.person(entry.withdrawn_by), withdrawn_note=names.of("text", entry.withdrawn_note),
        device=names.of("device", entry.device),
    )


def _score(score: ScoreValue, names: Names) -> ScoreValue:
    try:
        value = json.loads(score.value)
    except ValueError:
        value = score.value
    if value is None or isinstance(value, (bool, int, float)):
        return score
    return score._replace(value=json.dumps(names.of("text", score.value)))


def _stop(stop: StopRecord, names: Names) -> StopRecord:
    return stop._replace(who=names.person(stop.who), reason=names.of("text", stop.reason),
                         reason_by=names.person(stop.reason_by), desc=names.of("text", stop.desc))


def _robot(robot: RobotPart, names: Names) -> RobotPart:
    link: Tuple[LinkSecond, ...] = tuple(
        second._replace(sample=second.sample._replace(host=names.of("address", second.sample.host)))
        for second in robot.link)
    return RobotPart(robot.port, names.of("team", robot.team), names.of("robot", robot.robot), "", link)
