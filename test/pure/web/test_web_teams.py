"""Pages of teams: their codes, and what the box knows of their robots."""

import asyncio
import json
from urllib.parse import quote

import pytest

from helpers.public_box import PublicBox, event, result, run, standing
from helpers.served_pages import ServedPages
from helpers.shown_box import MONO, NOW, zone_of
from roah_rsbb.ground.kept_file import open_kept
from roah_rsbb.model.document import RobotSeen
from roah_rsbb.model.records import CaptainSign
from roah_rsbb.model.results import EventSeen, HistoryEntry, ObjectionLine, RunLine, RunSheet
from roah_rsbb.model.zone import RobotInRun, SheetItem
from roah_rsbb.web.commands import Outcome
from roah_rsbb.web.pairing import GUESSES_AT_ONCE
from roah_rsbb.web.teams import ALL, CODE, FILE, TeamCodes
from roah_rsbb.web.teams import COOKIE as TEAM_COOKIE
from roah_rsbb.wording.public import team_facts

TEAM = "Team & Söhne 100%"


def codes(kept=None):
    return TeamCodes((kept if kept is not None else []).append, {})


def box(phase="idle", off=("Robot not active",), robot=None, skew=0.25, silent_since=MONO - 2.0, events=()):
    """A box that hears the robot of a team."""
    made = PublicBox()
    made.show(*(zone_of(name, {"connect": off}, phase=phase, team=team, robot=robot)
                for name, team in (("Home", TEAM), ("Lab", "Others"))),
              robots={"R1": RobotSeen(TEAM, "R1", skew, silent_since)}, schedule={event.id: event for event in events})
    return made


def facts_of(made, team=TEAM):
    return team_facts(team, made.document, made.now())


# -- codes ------------------------------------------------------------------------------------------


def test_each_team_has_its_code_which_stays_the_same():
    kept = []
    made = codes(kept)
    asyncio.run(made.keep())
    assert made.code(TEAM) == made.code(TEAM) != made.code("Other")
    assert len(made.code(TEAM)) == 9
    again = TeamCodes(kept.append, kept[-1])
    assert again.code(TEAM) == made.code(TEAM) and again.is_token(TEAM, made.token(TEAM))
    assert len(kept) == 1 and made.code(TEAM) not in json.dumps(kept), "no code is kept"


def test_a_code_may_be_typed_in_other_ways():
    made = codes()
    code = made.code(TEAM)
    assert made.is_code(TEAM, code.lower().replace("-", " "))
    assert not any(made.is_code(TEAM, wrong) for wrong in ("", code[:-1], made.code("Other"), "é" * 8))


def test_new_codes_end_the_old_ones():
    made = codes()
    code, token = made.code(TEAM), made.token(TEAM)
    asyncio.run(made.keep(renews=True))
    assert not made.is_code(TEAM, code) and not made.is_token(TEAM, token)


def test_codes_that_cannot_be_saved_are_not_shown():
    def fails(_secret):
        raise OSError("full")
    with pytest.raises(OSError):
        asyncio.run(TeamCodes(fails, {}).keep())
    kept = TeamCodes(fails, {"secret": "ab" * 32})
    code = kept.code(TEAM)
    with pytest.raises(OSError):
        asyncio.run(kept.keep(renews=True))
    assert kept.code(TEAM) == code


@pytest.mark.parametrize("content", ["[1]", "{", '{"secret": "ab"}', '{"secret": 5}', '{"other": 5}'])
def test_a_damaged_file_is_moved_aside(tmp_path, content):
    (tmp_path / FILE).write_text(content)
    reports = []
    made = open_kept(str(tmp_path), FILE, TeamCodes, {}, reports.append, "the teams have new codes")
    asyncio.run(made.keep())
    assert len(made.code(TEAM)) == 9 and len(reports) == 1
    assert (tmp_path / FILE).stat().st_mode & 0o777 == 0o600


# -- what the box knows -----------------------------------------------------------------------------


def test_what_a_team_reads_before_its_run():
    assert facts_of(box()) == ["The box hears R1, last 2 s ago", "Its clock is 0.25 s ahead of the box",
                               "In zone Home, connect is off: Robot not active"]
    assert facts_of(box(skew=-0.5, off=(), silent_since=None)) == [
        "The box hears R1, last less than 2 s ago", "Its clock is 0.50 s behind the box",
        "In zone Home, the robot can be connected now"]
    assert facts_of(box(), "Unknown") == ["The box does not hear the robot"]


def test_what_a_team_reads_in_its_run():
    robot = RobotInRun("R1", 6701, "GOAL_TX", "EXECUTING", heard=True, silent_since=MONO - 3.0)
    assert facts_of(box("running", robot=robot))[-1].endswith("Its state: EXECUTING. Last message 3 s ago")
    assert facts_of(box("connected"))[-1].endswith("No message of it has come yet")


def test_the_next_event_with_its_estimated_time():
    def line(team, state, begins):
        return EventSeen(f"{team} {begins}", 1, "Lab", "HWV", "Visitors", team, 1, 1, NOW, begins, state, False)
    events = [line(TEAM, "done", NOW - 50.0), line("Others", "next", NOW + 5.0),
              line(TEAM, "later", NOW + 900.0), line(TEAM, "later", NOW + 300.0)]
    found = facts_of(box(events=events))[-1]
    assert found.startswith("Next event: Visitors in zone Lab, about ")
    assert facts_of(box(events=events[:-1]))[-1] != found


# -- on real loopback sockets -----------------------------------------------------------------------


class Served(ServedPages):
    """A server whose core was heard just now."""

    def __init__(self, running, **parts):
        heard = box()
        heard.publish([run()], [event(team=TEAM)], [result("Beta"), result("Gamma", signed=False)], [standing()])
        super().__init__(running, heard, **parts)

    def team(self, name=TEAM, **how):
        return self.ask(f"teams/{quote(name, safe='')}", **how)

    def facts(self, name=TEAM, **how):
        return json.loads(self.team(name, **how).body)


def test_the_code_of_the_team_shows_its_robot_and_no_other(served):
    assert served.facts() == {"is_allowed": False, "facts": None}
    answer = served.team(body={"code": served.server.team_codes.code(TEAM)})
    assert answer.code == 200
    cookie = answer.headers["Set-Cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    cookie = cookie.partition(";")[0]
    assert cookie.startswith(TEAM_COOKIE)
    found = served.facts(Cookie=cookie)
    assert found["is_allowed"] and found["facts"][0] == "The box hears R1, last 2 s ago"
    assert served.facts("Other", Cookie=cookie) == {"is_allowed": False, "facts": None}


def test_the_organisers_may_show_it_to_all(served):
    served.server.team_pages = ALL
    assert served.facts()["is_allowed"]
    served.server.team_pages = CODE
    assert not served.facts()["is_allowed"]


def test_paired_devices_see_every_team(served):
    assert served.facts(token=served.token())["is_allowed"]


def test_a_silent_box_is_not_known_to_hear_anything(served):
    served.server.team_pages = ALL
    served.box.is_old = True
    assert served.facts() == {"is_allowed": True, "facts": None}


def test_the_captain_reads_and_signs_with_the_code_of_the_team(running):
    given = []

    async def command(sent):
        given.append((sent.name, sent.zone, sent.fields, sent.session.who))
        return Outcome(result=RunSheet(own, (), 60.0, (SheetItem("Goal", "Door", "bool", 1),), (
            HistoryEntry(1, NOW, "Anna", "Goal", "Door", "bool", 0, False, 1, False, "a note"),), (),
            captain=(CaptainSign(NOW, "Cleo", drawing="M1 2L3 4"),)) if sent.name == "sheet" else {})

    own, others = (RunLine(name, 1, "Lab", "HWV", team, 1, 1, NOW, NOW, NOW, "stopped")
                   for name, team in (("own", TEAM), ("others", "Others")))
    served = Served(running, command=command)
    try:
        served.box.document = served.box.document._replace(results={
            run.identity: run for run in (own, others)})
        served.server.team_pages = ALL
        cookie = f"{TEAM_COOKIE}={served.server.team_codes.token(TEAM)}"
        assert [run["identity"] for run in served.facts(Cookie=cookie)["runs"]] == ["own"]
        sheet = f"teams/{quote(TEAM, safe='')}/sheet"
        for run, headers, code in (("own", {}, 403), ("others", {"Cookie": cookie}, 404)):
            assert served.ask(sheet, body={"identity": run}, **headers).code == code
        assert given == []
        answer = served.ask(sheet, body={"identity": "own"}, Cookie=cookie)
        found = json.loads(answer.body)
        assert (found["items"][0]["shown"], found["captain"][0]["drawing"]) == ("yes", "M1 2L3 4")
        assert "Anna" not in answer.body.decode() and "a note" not in answer.body.decode()
        sign = {"name": "Cleo", "comment": "", "drawing": "M1 2L3 4", "refused": False}
        assert served.ask(sheet, body={"identity": "own", "action": "reopen", **sign}, Cookie=cookie).code == 200
    finally:
        served.server.close()
        running.turn()
    assert [(name, zone) for name, zone, _, _ in given] == [(name, "Lab") for name in ("sheet", "captain", "sheet")]
    assert given[1][2]["given"] == sign and given[1][3] == f"Cleo, captain, page of {TEAM}"


def test_a_team_objects_with_its_code_as_long_as_the_rules_allow_it(running):
    given = []

    async def command(sent):
        given.append((sent.name, sent.zone, sent.fields["identity"], sent.fields["given"], sent.session.who))
        return Outcome(result={})

    answered = ObjectionLine(1, NOW, TEAM, "a cup", "Olga", NOW, "Olga", False, "it was away")
    runs = [RunLine(name, 1, "Lab", "HWV", team, 1, 1, NOW, NOW, NOW, "stopped", protests_until_utc_s=until,
                    objections=(answered,))
            for name, team, until in (("own", TEAM, NOW + 1e9), ("late", TEAM, NOW - 1.0), ("never", TEAM, None),
                                      ("others", "Others", NOW + 1e9))]
    served = Served(running, command=command)
    try:
        served.box.document = served.box.document._replace(results={run.identity: run for run in runs})
        served.server.team_pages = ALL
        assert "protests" not in served.facts()
        cookie = f"{TEAM_COOKIE}={served.server.team_codes.token(TEAM)}"
        found = served.facts(Cookie=cookie)["protests"]
        assert [run["identity"] for run in found["runs"]] == ["own"]
        assert found["objections"][0]["answer"] == "rejected: it was away"
        path = f"teams/{quote(TEAM, safe='')}/protest"
        for run, headers in (("own", {}), *((run, {"Cookie": cookie}) for run in ("late", "never", "others", ""))):
            assert served.ask(path, body={"identity": run, "text": "why"}, **headers).code == 403
        assert given == []
        assert served.ask(path, body={"identity": "own", "text": "why", "second": 161}, Cookie=cookie).code == 200
    finally:
        served.server.close()
        running.turn()
    assert given == [("object", "Lab", "own", {"by": TEAM, "text": "why", "second": 161},
                      f"{TEAM}, captain, page of {TEAM}")]


def test_many_readers_behind_one_address_have_the_code(served):
    right = {"code": served.server.team_codes.code(TEAM)}
    assert {served.team(body=right).code for _ in range(int(GUESSES_AT_ONCE) + 5)} == {200}


def test_wrong_codes_are_refused_and_limited(served):
    answers = [served.team(body={"code": "AAAA-AAAA", "language": "de"}) for _ in range(int(GUESSES_AT_ONCE) + 1)]
    assert [answer.code for answer in answers] == [403] * int(GUESSES_AT_ONCE) + [429]
    assert json.loads(answers[0].body)["reasons"] == ["auf Deutsch: This code is wrong"]
    assert served.team(body={"code": served.server.team_codes.code(TEAM)}).code == 429
    pairing = served.ask("pair", body={"code": "AAAA-AAAA", "person": "Anna"})
    assert pairing.code == 403, "referees can still pair"


@pytest.mark.parametrize("path", ["x" * 101, "%ff" * 101])
def test_names_are_bounded(served, path):
    assert served.ask(f"teams/{path}").code in (400, 404)


def test_organisers_see_the_codes_of_all_teams(served):
    over = EventSeen("e9", 1, "Lab", "HWV", "Visitors", "Delta", 1, 1, NOW, NOW, "skipped", False)
    served.box.document = served.box.document._replace(schedule={over.id: over})
    answer = served.ask("codes", token=served.token("organiser"))
    found = {line["team"]: line["code"] for line in json.loads(answer.body)["codes"]}
    assert set(found) == {"Alpha", "Beta", "Delta", "Gamma", TEAM}
    assert found[TEAM] == served.server.team_codes.code(TEAM)
    renewed = served.ask("codes", body={}, token=served.token("organiser"))
    assert json.loads(renewed.body)["codes"] != json.loads(answer.body)["codes"]


@pytest.mark.parametrize("role, code", [("referee", 403), ("judge", 403), (None, 401)])
def test_the_codes_are_for_organisers(served, role, code):
    token = served.token(role) if role else ""
    assert served.ask("codes", token=token).code == code
    before = served.server.team_codes.code(TEAM)
    assert served.ask("codes", body={}, token=token).code == code
    assert served.server.team_codes.code(TEAM) == before
