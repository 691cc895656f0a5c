"""Every table, sheet, page, export and message says the same of each run: what `counting.rulings` says.

A random competition runs in a box with a journal: attempts, withdrawals, sign-offs, events with another
time, zone, team or benchmark, restarts. Then whatever the box shows, and whatever is made of its journal, is compared
with that one function.
"""

import dataclasses
import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.competition import BUMPS, OBJECTS, UTC0, competition, event
from helpers.examples import examples
from helpers.journaled import NO_LISTENING, JournaledDriver
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import Publicity, PublicResults
from roah_rsbb.core.views.schedule import schedule
from roah_rsbb.core.views.sheets import run_sheet
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.rules import AttemptsRule, Scale, Stage, StageColumn
from roah_rsbb.results.dataset import _run_rows
from roah_rsbb.results.export import exported, result_rows
from roah_rsbb.results.lists import checklist, list_lines
from roah_rsbb.results.report_numbers import facts_of
from roah_rsbb.results.runs import records, run_result
from roah_rsbb.results.sheet import sheet_lines, sheet_page
from roah_rsbb.results.standing_pages import index_page
from roah_rsbb.results.standings import public_standings
from roah_rsbb.rulebook.benchmarks import CountingAttempt, EventRules
from roah_rsbb.rulebook.standing_rules import Criterion, Rules, StandingRules, Term
from roah_rsbb.scoring.counting import RunChoice, Why, attempts_of, rulings
from roah_rsbb.scoring.standings import standings
from roah_rsbb.wording.sheets import counting_text

CODES, ZONES, TEAMS = ("HGTKMH", "HWV"), ("a", "b"), ("Alpha", "Beta")
HOUR = 3600.0
RANKING = StandingRules({"HGTKMH": Rules(AttemptsRule(), (), (
    Criterion("Objects", True, (Term(item=OBJECTS.desc, weight=0.1),)),
    Criterion("Bumps", False, (Term(group=BUMPS.group),))))})
RANKING.stages = (Stage("All", (StageColumn("HGTKMH"), StageColumn("HWV")), normalised=Scale.BEST),)

ACTIONS = st.one_of(
    st.tuples(st.just("attempt"), st.sampled_from(ZONES), st.integers(0, 3), st.integers(0, 2)),
    st.tuples(st.just("attempt"), st.sampled_from(ZONES), st.integers(0, 3), st.integers(0, 2)),
    st.tuples(st.just("stay"), st.sampled_from(ZONES), st.booleans()),
    st.tuples(st.sampled_from(["withdrawn", "no_show"]), st.sampled_from(ZONES)),
    st.tuples(st.just("choose"), st.sampled_from(ZONES), st.integers(0, 3)),
    st.tuples(st.just("sign"), st.integers(0, 4)),
    st.tuples(st.just("move"), st.integers(0, 3), st.sampled_from(ZONES), st.integers(-3, 30), st.sampled_from(TEAMS),
              st.sampled_from(CODES)),
    st.tuples(st.just("restart")),
)
RULES = st.builds(EventRules, counting=st.sampled_from(CountingAttempt),
                  absent=st.sampled_from([(), ("no_show", "withdrawn")]))


class Organised:
    """A competition whose organiser moves events while it runs."""

    def __init__(self, folder, rules):
        self.rules = dict(zip(CODES, rules))
        self.events = [("a", 0.0, "Alpha", "HGTKMH"), ("a", 1.0, "Beta", "HGTKMH"), ("b", 0.0, "Alpha", "HWV"),
                       ("b", 1.0, "Beta", "HWV")]
        self.driver = JournaledDriver(folder, self.config(), NO_LISTENING)
        self.version = 0

    def config(self):
        zones = {zone: [] for zone in ZONES}
        for number, (zone, hours, team, code) in enumerate(self.events):
            made = event(code, team=team, run=1, scheduled=UTC0 + HOUR * hours, rules=self.rules[code])
            zones[zone].append(dataclasses.replace(made, id=f"id{number}"))
        found = competition(**{zone: sorted(events, key=lambda e: e.scheduled) for zone, events in zones.items()})
        benchmarks = {code: event(code, rules=self.rules[code]).benchmark for code in CODES}
        return dataclasses.replace(found, ranking=RANKING, benchmarks=benchmarks)

    def act(self, kind, *arguments):
        try:
            getattr(self, f"_{kind}")(*arguments)
        except Refused as refused:
            assert refused.reasons
        self.driver.run(1.0)

    def _attempt(self, zone, objects, bumps):
        for command in ("open_sheet", "start"):
            self.driver.command(command, zone)
        self.driver.run(5.0)
        self.driver.score(OBJECTS.group, OBJECTS.desc, objects, zone)
        self.driver.score(BUMPS.group, BUMPS.desc, bumps, zone)
        self.driver.command("stop", zone)
        self.driver.command("disconnect", zone)

    def _stay(self, zone, runs):
        """A run that is over, or not, and still connected; one that is there already is left."""
        if self.driver.run_in(zone) is not None:
            self.driver.command("disconnect", zone)
            return
        self.driver.command("open_sheet", zone)
        self.driver.command("start", zone)
        if not runs:
            self.driver.command("stop", zone)

    def _withdrawn(self, zone):
        self.driver.command("withdrawn", zone)

    def _no_show(self, zone):
        self.driver.command("no_show", zone)

    def _choose(self, zone, place):
        events = self.driver.box.zones[zone].events
        self.driver.choose(place % len(events), zone, True)

    def _sign(self, number):
        found = self.driver.box.finished.records()
        if found:
            record = found[number % len(found)]
            self.driver.enter("sign_off", RunName(record.zone, record.identity), "Anna")

    def _move(self, number, zone, hours, team, code):
        before = list(self.events)
        self.events[number] = (zone, self.events[number][1] + hours, team, code)
        config = self.config()
        if any(not plan.events for plan in config.zones):
            self.events = before
            return
        self.version += 1
        self.driver.event(self.driver.box.reload.take, config, self.version, ["moved"], "Olga")

    def _restart(self):
        if all(zone.run is None for zone in self.driver.box.zones.values()):
            self.driver.kill(config=self.config(), version=self.version)


@examples(120)
@given(actions=st.lists(ACTIONS, min_size=3, max_size=25), rules=st.tuples(RULES, RULES))
def test_all_say_the_same_of_each_run(tmp_path_factory, actions, rules):
    organised = Organised(tmp_path_factory.mktemp("competition"), rules)
    for action in actions:
        organised.act(*action)
    driver, config = organised.driver, organised.config()
    choice = RunChoice(events=dict(zip(CODES, rules)))
    reader = JournalReader(driver.journal.path)
    known = records(reader, pytest.fail)
    truth = {ruling.record.identity: ruling for ruling in rulings(known, RANKING, choice)}
    found = [run_result(reader, number, record, pytest.fail)._replace(counts=truth[record.identity].why.value)
             for number, record in enumerate(known, 1)]
    check_sense(known, truth, dict(zip(CODES, rules)))
    check_box(driver, truth)
    check_public(driver, truth, choice)
    check_results(config, known, truth, choice, found)


def check_sense(known, truth, rules):
    """What the rules say in any case: it does not depend on how the function decides."""
    for (code, _, _), attempts in attempts_of(known).items():
        counting = [record for record in attempts if truth[record.identity].counts]
        ran = [record for record in attempts if record.end_reason in ("stopped", "completed", "timeout")]
        if rules[code].counting is CountingAttempt.ALL:
            assert counting == ran or not ran
        else:
            assert len(counting) == (1 if ran else len(counting[:1]))
        if ran and rules[code].counting is CountingAttempt.BEST:
            values = {r.identity: [i.value for i in r.items if i.desc == OBJECTS.desc] for r in ran}
            if code == "HGTKMH":
                assert values[counting[0].identity] == max(values.values())
        assert all(record in ran for record in counting) or not ran
        assert not ran or all(truth[record.identity].why is Why.RAN for record in attempts
                              if record.end_reason in ("withdrawn", "no_show"))
        if not ran:
            zero = bool(rules[code].absent)
            gone = [record for record in attempts if record.end_reason]
            assert counting == (gone[-1:] if zero else [])


def results_of(truth):
    """By the event's id, benchmark and team: the runs that count, or the last one that is over."""
    found = {}
    for (code, team, own), attempts in attempts_of(ruling.record for ruling in truth.values()).items():
        over = [record for record in attempts if record.end_reason]
        shown = [record for record in over if truth[record.identity].counts] or over[-1:]
        if shown:
            found[own, code, team] = shown
    return found


def document_of(driver):
    """What every face shows; the public may see everything."""
    return Documents(driver.box, "", "", Publicity(PublicResults.SCORES, True, True, public_standings)).look(driver.now)


def check_box(driver, truth):
    """What referees see: the list of runs, each sheet, and the schedule."""
    box, now = driver.box, driver.now
    assert {ruling.record.identity: ruling.why for ruling in box.scores.rulings(now)} == {
        identity: ruling.why for identity, ruling in truth.items() if not unlisted(ruling)}
    document = document_of(driver)
    for identity, line in document.results.items():
        assert line.counts == truth[identity].why.value
        record = box.scores.record_of(now, RunName(line.zone, identity))
        assert run_sheet(record, box.scores.why(now, identity)).run == line
    expected = results_of(truth)
    events = document.schedule
    for line in schedule(box, now):
        event_shown, shown = events[line.event.id], expected.get(place_of(line.event), [])
        assert event_shown.identity == (shown[-1].identity if shown else "")
        if shown:
            assert event_shown.counts == truth[event_shown.identity].why.value
            assert (event_shown.signed_utc_s is not None) is all(record.sign_off for record in shown)


def place_of(planned):
    """By what `results_of` has the result of an event."""
    return planned.id, planned.benchmark.code, planned.team


def unlisted(ruling):
    """Whether the box does not list a run any more: it was left without a start."""
    return ruling.why is Why.NEVER_STARTED


def check_public(driver, truth, choice):
    """What spectators see: results and standings."""
    document = document_of(driver)
    shown = [record for found in results_of(truth).values() for record in found if record.closed_utc]
    for signed in (True, False):
        assert {identity for identity, result in document.public_results.items() if result.signed is signed} == {
            record.identity for record in shown if (record.sign_off is not None) is signed}
    assert [result.disconnected_utc_s for result in document.public_results.values()] == [
        next(r.closed_utc for r in shown if r.identity == identity) for identity in document.public_results]
    ranked = standings([ruling.record for ruling in truth.values()], RANKING, choice._replace(signed_off=True))
    assert [[rank.team for rank in standing.ranks] for standing in document.public.standings] == [
        [line.team for line in standing.lines] for standing in ranked if standing.lines]


def check_results(config, known, truth, choice, found):
    """What is made of the journal."""
    for signed_off in (False, True):
        overall, *ranked = standings(known, RANKING, choice._replace(signed_off=signed_off))
        counting = {identity for identity, ruling in truth.items()
                    if ruling.counts and (ruling.record.sign_off or not signed_off)}
        assert {run.record.identity for standing in ranked for line in standing.lines for run in line.runs} == counting
        assert {run.record.identity for line in overall.lines for run in line.runs} <= counting
        assert {line.team for line in overall.lines} >= {
            record.team for record in known if record.end_reason and (record.sign_off or not signed_off)}
    lines = checklist(config.zones, list(truth.values()), in_utc=True)
    expected = results_of(truth)
    finals = {place_of(e): all(r.sign_off for r in expected.get(place_of(e), [None]) if r) and
              place_of(e) in expected for zone in config.zones for e in zone.events}
    assert sum(line.is_final for line in lines[:len(finals)]) == sum(finals.values())
    for line in lines:
        if line.number is not None:
            why = truth[known[line.number - 1].identity].why
            assert why is Why.NOT_OVER or line.state.endswith(f", {counting_text(why.value)}")
            assert truth[known[line.number - 1].identity].counts or why in (Why.NO_SCORE, Why.NOT_OVER)
    words = {identity: ruling.why.value for identity, ruling in truth.items()}
    listed = list(list_lines(known, True, words))[1:]
    rows = {row["run_id"]: row["counts"] for row in result_rows(
        known, True, {identity: ruling.why for identity, ruling in truth.items()})}
    assert rows == words
    value = json.loads(json.dumps(exported(found, [], "journal", 0.0)))
    assert {run["identity"]: run["counts"] for run in value["runs"]} == words
    whole = re.sub("<[^>]*>", " ", index_page(list(enumerate(known, 1)), {}, [], 0.0, True, why={
        identity: ruling.why for identity, ruling in truth.items()}))
    for result, text in zip(found, listed):
        counts = counting_text(result.counts)
        silent = result.counts in ("not_over", "never_started")
        assert silent or (text.endswith(f", {counts}") and f", {counts}" in whole)
        assert f"Counting:     {counts}" in list(sheet_lines(result, True, False))
        page = sheet_page(result, True)
        assert page.count(f"<td>{counts}</td>") == 2, "on the front page and in the appendix"
        assert facts_of(result).counts == result.counts
        assert next(_run_rows(result, None))["counts"] == result.counts
