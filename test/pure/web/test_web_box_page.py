"""The parts of the page of the whole box: what they show, to whom, and how much at most; and what organisers ask."""

import json

import pytest
from tornado import httpclient

from helpers.served_pages import GERMAN, ServedPages
from helpers.shown_box import MONO, NOW, ShownBox, zone_of
from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE
from roah_rsbb.model.document import RobotSeen, TabletSeen
from roah_rsbb.model.messages import DevicesSeen, DevicesState
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import EventSeen, HistoryEntry, Judging, RunEnd, RunLine, RunSheet, UnsavedParts
from roah_rsbb.model.zone import AllRobots, Count, RobotInRun, RunClock
from roah_rsbb.web.commands import BadCommand, Outcome, call_of, command_of, may
from roah_rsbb.web.device_documents import (
    MAX_EVENTS,
    MAX_HISTORY,
    MAX_LOG,
    MAX_ROBOTS,
    MAX_RUNS,
    PARTS,
    Desk,
    devices_page,
    may_show,
    whole_sheet_page,
)
from roah_rsbb.web.pairing import DeviceSession, Grant
from roah_rsbb.web.public_documents import Store
from roah_rsbb.wording.whole_box import AWAY

ORGANISER, REFEREE, JUDGE = Grant("organiser", ""), Grant("referee", "Home"), Grant("judge", "Home")
RUNNING = RunClock(600.0, Count(10.0, MONO))


def event_of(number, zone="Home", state="later", **fields):
    return EventSeen(**{
        "id": f"{zone} {number}", "number": number, "zone": zone, "code": "HWV", "benchmark": "Visitors",
        "team": "Alpha", "round": 1, "run": number, "scheduled_utc_s": NOW + 600.0 * number,
        "begins_utc_s": NOW + 600.0 * number, "state": state, "current": False, **fields})


def run_of(number, zone="Home", **fields):
    return RunLine(**{
        "identity": f"{zone} {number}", "revision": 7, "zone": zone, "code": "HWV", "team": "Alpha", "round": 1,
        "run": number, "opened_utc_s": NOW, "closed_utc_s": NOW + number, "end_reason": "stopped", **fields})


class World:
    """A desk whose box changes as the test says, and a device that shows one part."""

    def __init__(self):
        self.box = ShownBox(zone_of(clock=RUNNING), zone_of("Hall", team="Beta"))
        self.desk = Desk(Store(self.box, GERMAN))

    def part(self, part, own="", zone="Home", language="en", **sections):
        """What the part shows after such a change of the box."""
        self.box.show(*self.box.document.zones.values(), **sections)
        key = (language, zone, part, own)
        self.desk.show([key])
        return json.loads(self.desk.document(self.desk.keys(*key)[-1]).text)

    def again(self, part):
        self.desk.look()
        return json.loads(self.desk.document((f"part.{part}", "en", "Home", "")).text)


@pytest.fixture
def world():
    return World()


# -- who is shown what ------------------------------------------------------------------------------


def test_a_judge_has_no_part_and_a_referee_no_overview():
    assert all(may_show(part, ORGANISER) for part in PARTS)
    assert [part for part in PARTS if not may_show(part, REFEREE)] == ["overview"]
    assert not any(may_show(part, JUDGE) for part in PARTS)
    assert not may_show("secrets", ORGANISER)


def test_a_referee_sees_only_events_of_the_own_zone(world):
    events = {one.id: one for one in (event_of(1), event_of(1, "Hall"))}
    of_all, own = world.part("schedule", schedule=events), world.part("schedule", own="Home")
    assert {one["zone"] for one in of_all["events"]} == {"Home", "Hall"} and set(of_all["leaving"]) == {"Home", "Hall"}
    assert {one["zone"] for one in own["events"]} == {"Home"} and set(own["leaving"]) == {"Home"}


def test_a_part_is_made_only_while_a_device_shows_it(world):
    before = world.part("robots", robots={"R of team Alpha": RobotSeen("Alpha", "R", 0.1)})
    world.desk.show([("en", "Home")])
    world.box.show(*world.box.document.zones.values(), robots={})
    world.box.mono += 5.0
    assert world.again("robots") == before
    assert "part.robots" not in [key[0] for key in world.desk.keys("en", "Home")]


def test_a_part_of_a_zone_that_is_gone_is_empty(world):
    assert world.part("runs", zone="Attic") is None


def test_parts_are_in_the_language_of_the_reader(world):
    assert world.part("box", language="de")["facts"][0][0] == "auf Deutsch: Broadcast to"


# -- what they show ---------------------------------------------------------------------------------


def test_the_overview_has_each_clock_and_what_needs_attention(world):
    home, hall = world.part("overview")["zones"]
    assert (home["zone"], home["team"], home["phase_text"]) == ("Home", "Alpha", "RUNNING")
    assert home["clock"]["main"] == {"label": "Run: time left", "text": "9:50", "hurry": 0}
    assert home["is_urgent"] and home["todo"] == "No message from the robot for 3 s"
    world.box.mono += 0.5
    world.box.show(zone_of(clock=RUNNING, team="Gamma"))
    assert world.again("overview")["zones"][0] == home, "it is made once a second at most"
    world.box.mono += 0.5
    (home,) = world.again("overview")["zones"]
    assert (home["team"], home["clock"]["main"]["text"]) == ("Gamma", "9:49")
    world.box.is_old = True
    world.box.mono += 60.0
    assert world.again("overview")["zones"][0]["clock"]["main"]["text"] == "9:49", "nothing is known of a silent box"


def test_the_overview_lists_what_waits_for_somebody_and_what_comes(world):
    phone = DeviceSession("1", REFEREE, "Rita", "iPhone", NOW)
    world.desk = Desk(Store(world.box, GERMAN), lambda: [phone])
    runs = [run_of(1), run_of(2), run_of(3, signed_utc_s=NOW, proposals=3), run_of(1, "Hall", closed_utc_s=None)]
    judging = {"Home 2": Judging("Home", "Home 2", differences=2, open_objections=1)}
    events = [event_of(1, state="running", current=True), event_of(2, begins_utc_s=NOW + 2000.0),
              event_of(3, state="done")]
    shown = world.part("overview", results={one.identity: one for one in runs}, judging=judging,
                       schedule={one.id: one for one in events})
    assert [(one["count"], one["what"], one["part"], one["zone"]) for one in shown["open"]] == [
        (2, "Score sheets to sign off", "runs", "Home"),
        (3, "Marks from before the sign-off to decide on", "runs", "Home"), (1, "Objections to answer", "runs", "Home"),
        (2, "Items to settle", "runs", "Home"), (1, "Zones without the phone of a referee", "robots", "Hall")]
    assert shown["open"][0]["more"].endswith("HWV, team Alpha, round 1, run 1"), "the oldest one"
    assert [one["people"] for one in shown["zones"]] == ["Rita (Referee)", ""]
    assert [one["id"] for one in shown["coming"]] == ["Home 1", "Home 2"]
    assert shown["zones"][0]["next"]["late"] == "+13 min" and shown["zones"][1]["next"] is None


def test_the_schedule_says_why_an_event_cannot_be_chosen_and_what_is_left(world):
    current = event_of(1, state="ended", current=True, identity="run", end_reason="stopped", score="5")
    late = event_of(2, state="next", begins_utc_s=NOW + 2000.0)
    running = event_of(1, "Hall", state="running", current=True)
    other = event_of(2, "Hall")
    shown = world.part("schedule", schedule={one.id: one for one in (current, late, running, other)})
    rows = {one["id"]: one for one in shown["events"]}
    assert shown["left"] == {"Home": {"id": "Home 1", "name": "HWV, team Alpha, round 1, run 1", "score": "5"}}
    assert rows["Home 2"]["off"] == "" and rows["Hall 2"]["off"] == "A run is running in Hall. Stop it first."
    assert rows["Home 2"]["late"] == "+13 min" and rows["Home 2"]["begins"].startswith("~ ")
    assert rows["Home 1"]["current"] and "not signed off" in rows["Home 1"]["shows"]
    assert "not signed off" not in rows["Home 2"]["shows"] and "to come" in rows["Home 2"]["shows"]


def test_a_long_schedule_is_cut_around_the_current_event(world):
    events = [event_of(number, current=number == 900) for number in range(1, 1001)]
    shown = world.part("schedule", schedule={one.id: one for one in events})
    assert len(shown["events"]) == MAX_EVENTS and shown["hidden"] == 1000 - MAX_EVENTS
    assert "Home 900" in [one["id"] for one in shown["events"]]
    shown = world.part("schedule", schedule={one.id: one for one in events[:5]})
    assert len(shown["events"]) == 5 and shown["hidden"] == 0


def test_robots_with_their_link_skew_and_zone(world):
    robots = {f"{robot} of team {team}": RobotSeen(team, robot, skew, silent) for team, robot, skew, silent in (
        ("Alpha", "R", 0.15, None), ("Beta", "S", 0.0, MONO - 4.0), ("Gamma", "T", 0.0, MONO - 40.0))}
    all_robots = zone_of("Yard", robot=None, all_robots=AllRobots(1, 0, 1, 0, ("T of team Gamma: executing",)))
    world.box.show(zone_of(robot=RobotInRun("R", 6701, "STOP")), all_robots)
    shown = world.part("robots", robots=robots)["robots"]
    assert shown == [
        ["Alpha", "R", "▮▮▮ good", "+0.150 s", "Home", "just now"],
        ["Beta", "S", "▮▯▯ poor, 4.0 s", "+0.000 s", "–", "4 s ago"],
        ["Gamma", "T", "▯▯▯ silent", "+0.000 s", "Yard", "40 s ago"]]
    many = {str(n): RobotSeen(str(n), "R", 0.0) for n in range(MAX_ROBOTS + 3)}
    assert world.part("robots", robots=many)["hidden"] == 0, "it is made once a second at most"
    world.box.mono += 1.0
    shown = world.again("robots")
    assert (len(shown["robots"]), shown["hidden"]) == (MAX_ROBOTS, 3)


def test_a_gap_of_a_link_is_shown_for_ten_seconds_also_if_it_was_before_the_part_was_opened(world):
    def hear(silent, part="overview"):
        world.box.mono += 1.0
        return world.part(part, robots={"R of team Alpha": RobotSeen("Alpha", "R", 0.0, silent)})

    since = world.box.mono - 3.0
    hear(since)
    links = [hear(None, "robots")["robots"][0][2] for _ in range(12)]
    assert links == ["▮▯▯ poor, 5.0 s"] * 11 + ["▮▮▮ good"]


def test_all_runs_of_the_zone_also_those_that_are_signed_off(world):
    runs = [run_of(1, signed_utc_s=NOW, signed_by="Anna (/node)"), run_of(2, corrected=True), run_of(3, "Hall"),
            run_of(4, closed_utc_s=None, end_reason="")]
    shown = world.part("runs", results={one.identity: one for one in runs},
                       judging={"Home 2": Judging("Home", "Home 2", 1, count=2)})["runs"]
    assert [one["identity"] for one in shown] == ["Home 4", "Home 2", "Home 1"]
    assert [(one["is_closed"], one["is_signed"], one["is_judged"]) for one in shown] == [
        (False, False, False), (True, False, True), (True, True, False)]
    assert shown[2]["sheet"].startswith("signed off by Anna at ") and shown[1]["sheet"] == "corrected; not signed off"
    box = world.box.document.box._replace(unsaved=(UnsavedParts("Home 1", "Home", sign_off=True),))
    world.box.document = world.box.document._replace(box=box)
    assert world.again("runs")["runs"][2]["sheet"].startswith("⚠ not saved yet; signed off by ")
    many = [run_of(n) for n in range(MAX_RUNS + 2)]
    shown = world.part("runs", results={one.identity: one for one in many})
    assert (len(shown["runs"]), shown["hidden"], shown["runs"][0]["identity"]) == (
        MAX_RUNS, 2, f"Home {MAX_RUNS + 1}"), "the newest"


def test_only_the_end_of_a_log_is_sent(world):
    log = "".join(f"08:00:00Z line {number}\n" for number in range(2000))
    world.box.show(zone_of(log=log, online_data="08:00:01Z said\n"))
    shown = world.part("log")
    assert shown["log"].endswith("line 1999\n") and len(shown["log"]) <= MAX_LOG
    assert shown["log"].splitlines()[0].partition(" ")[2].startswith("line "), "it begins with a whole line"
    assert shown["online"].endswith(" said\n") and shown["of"] == "Home kx2"


def test_the_box_with_its_warnings_and_the_tablet(world):
    shown = world.part("box", warnings=["The disk is full"])
    assert (shown["is_ok"], shown["warnings"], shown["tablet"]) == (True, ["The disk is full"], None)
    world.box.document = world.box.document._replace(
        box=world.box.document.box._replace(status="No disk; No stick", warnings=("No disk", "No stick")))
    world.box.mono += 1.0
    again = world.again("box")
    assert (again["status"], again["warnings"]) == ("", ["No disk", "No stick"]), "nothing is said twice"
    assert ["Running", "2 of 2 zones"] in shown["facts"] and shown["runs"] == "Home (R), Hall (R)"
    box = world.box.document.box._replace(tablet=TabletSeen(True, MONO - 7.0, True, NOW, NOW, 1.0, 2.5))
    world.box.document = world.box.document._replace(box=box)
    world.box.mono += 1.0
    tablet = dict(world.again("box")["tablet"])
    assert "⚠ silent" in tablet["Last heard"] and tablet["Display"] == "Map"
    assert tablet["Position"].startswith("x 1.00 m, y 2.50 m")


def test_a_sheet_with_its_history_and_ends():
    entries = tuple(HistoryEntry(n, NOW, "Anna (/node)", "Penalized", "Bumps", "uint", 0, False, 1, False,
                                 withdrawn_utc_s=NOW if n == 1 else None) for n in range(1, MAX_HISTORY + 3))
    end = RunEnd(1, NOW, "Anna (/node)", "stopped", "Stopped", "it fell", "Bert")
    completed = RunEnd(2, NOW, "", "completed", "Completed", "")
    shown = whole_sheet_page(RunSheet(run_of(1), ("R",), 61.5, (), entries, (end, completed)))
    assert [one["is_stop"] for one in shown["ends"]] == [True, False], "what was completed was not stopped"
    history = shown["history"]
    assert (len(history), history[0]["number"]) == (MAX_HISTORY, len(entries)), "the newest first"
    assert "Anna: Penalized: Bumps: 0 → 1" in history[0]["text"] and not history[0]["is_withdrawn"]
    assert shown["ends"][0]["text"].endswith("Anna · Stopped") and shown["ends"][0]["reason"] == "it fell (Bert)"
    assert shown["facts"] == ["1:01.5", "R"]


def test_the_home_devices_with_their_commands_and_the_bell():
    state = DevicesState(bell=(int(NOW) - 70, 0), switch_2=True, dimmer=40, door_win_detect=True)
    shown = devices_page(DevicesSeen(state, True, "connected to it"), NOW)
    assert [one["device"] for one in shown["devices"]] + ["bell"] == [*DevicesState._fields[1:], "bell"]
    rows = {one["name"]: one for one in [*shown["devices"], shown["bell"]]}
    assert {name: row["states"][row["value"]] if row["states"] else row["value"] for name, row in rows.items()
            if name != "Bell"} == {"Switch 1": "○ off", "Switch 2": "● ON", "Switch 3": "○ off", "Dimmer": 40,
                                   "Blinds": 0, "Door": "● OPEN"}
    assert rows["Switch 1"]["commands"] == [("Turn on", 1), ("Turn off", 0)]
    assert rows["Dimmer"]["commands"] == [("0 %", 0), ("100 %", 100)]
    assert rows["Bell"]["states"][0].endswith("(70 s ago)") and rows["Bell"]["value"] == 0
    assert (shown["connection"], shown["reason"]) == ("● connected", "connected to it")
    away = devices_page(DevicesSeen(state, False, "it is off"), NOW - 68)
    assert away["connection"] == "NOT CONNECTED"
    assert away["reason"].splitlines() == ["it is off", AWAY]
    assert away["bell"]["value"] == 1 and away["bell"]["states"][1].startswith("♪ RINGS")
    assert devices_page(DevicesSeen(DevicesState(), False, ""), NOW)["bell"]["states"] == ["Last ring: never"] * 2


# -- what may be asked ------------------------------------------------------------------------------


def session(grant):
    return DeviceSession("1", grant, "Olga", "laptop", 0.0)


@pytest.mark.parametrize("name, fields", [
    ("reload", {"digest": "d", "for_all": False}), ("exit", {"anyway": True}), ("devices", {}),
    ("set_device", {"device": "dimmer", "value": 40})])
def test_only_an_organiser_commands_the_whole_box(name, fields):
    commands = [command_of(name, {**fields, "zone": "Home"}, session(grant)) for grant in (ORGANISER, REFEREE, JUDGE)]
    assert [may(one) for one in commands] == [True, False, False]
    assert call_of(commands[0]) == (name, {**fields, "by": "Olga, organiser, laptop 1"})
    for field in fields:
        with pytest.raises(BadCommand):
            command_of(name, {field: None}, session(ORGANISER))


@pytest.mark.parametrize("name, body", [
    ("choose_event", {"given": {"event": "e"}}), ("withdraw", {"entry": 1}), ("stop_reason", {"stop": 1})])
def test_a_referee_reaches_no_other_zone(name, body):
    for zone, allowed in (("Home", True), ("Hall", False)):
        assert may(command_of(name, {**body, "zone": zone}, session(REFEREE))) == allowed
        assert not may(command_of(name, {**body, "zone": zone}, session(JUDGE)))
        assert may(command_of(name, {**body, "zone": zone}, session(ORGANISER)))


# -- on real loopback sockets -----------------------------------------------------------------------


class Served(ServedPages):
    """A server with devices, and calls for pairing that answer as the test says."""

    def __init__(self, running):
        self.commands, self.asked, self.refusal = [], [], []
        super().__init__(running, ShownBox(zone_of(), zone_of("Hall")), command=self.carry_out,
                         calls={name: self.call(name) for name in (PAIR, PAIRED, REVOKE)})

    async def carry_out(self, command):
        self.commands.append(command)
        return Outcome(result={"digest": "d", "applied": False, "errors": [], "warnings": [], "changes": ["x"]})

    def call(self, name):
        answers = {
            PAIR: {"code": "ABCD-EFGH", "url": "http://192.0.2.7:8081/pair#ABCD-EFGH", "valid": 120.0}, REVOKE: {},
            PAIRED: {"devices": [{"id": "7", "role": "referee", "zone": "Home", "person": "Anna", "device": "iPhone",
                                  "paired": NOW, "seen": NOW, "connected": True}]}}

        def answer(arguments, caller):
            self.asked.append((name, arguments))
            if self.refusal:
                raise Refused(self.refusal)
            return answers[name]
        return answer

    def asks(self, path, body=None, role="organiser"):
        return self.ask(path, body, token=role and self.token(role))


PAIRINGS = "pairings"


@pytest.mark.parametrize("role, code", [("", 401), ("referee", 403), ("judge", 403), ("organiser", 200)])
def test_pairings_are_for_organisers(served, role, code):
    for body in (None, {"role": "referee", "zone": "Home"}, {"end": "7"}):
        assert served.asks(PAIRINGS, body, role).code == code
    assert len(served.asked) == (3 if code == 200 else 0)


def test_an_organiser_pairs_lists_and_ends(served):
    (listed,) = json.loads(served.asks(PAIRINGS).body)["devices"]
    assert (listed["person"], listed["role"], listed["seen"], listed["is_own"]) == (
        "Anna", "Referee in Home", "connected", False)
    assert json.loads(served.asks(f"{PAIRINGS}?language=de").body)["devices"][0]["seen"] == "auf Deutsch: connected"
    made = json.loads(served.asks(PAIRINGS, {"role": "referee", "zone": "Home"}).body)
    assert made["code"] == "ABCD-EFGH" and "not encrypted" in made["encryption"]
    assert made["square"] is None or {*"".join(made["square"])} == {"0", "1"}
    assert served.asks(PAIRINGS, {"end": "7"}).code == 200
    assert served.asked[2:] == [(PAIR, {"role": "referee", "zone": "Home"}), (REVOKE, {"device": "7"})]
    served.refusal = ["no zone 'Rom'"]
    refused = served.asks(PAIRINGS, {"role": "referee", "zone": "Rom"})
    assert (refused.code, json.loads(refused.body)) == (409, {"reasons": ["no zone 'Rom'"]})
    assert served.asks(PAIRINGS, {"role": 7}).code == 400


def test_a_part_is_sent_to_who_may_see_it(served):
    message = served.read(served.opened("device?zone=Hall&part=runs", served.token("organiser")))
    assert message["documents"]["part.runs"]["data"] in (None, {"hidden": 0, "runs": []})
    for role, query in (("judge", "part=runs"), ("referee", "part=overview"), ("referee", "zone=Hall&part=runs"),
                        ("organiser", "part=secrets")):
        with pytest.raises(httpclient.HTTPClientError, match="403"):
            served.opened(f"device?{query}", served.token(role))


def test_the_answer_to_a_reload_lists_the_changes(served):
    answer = served.asks("commands/reload", {"digest": ""})
    assert (answer.code, json.loads(answer.body)["changes"]) == (200, ["x"])
    assert served.asks("commands/reload", {"digest": ""}, "referee").code == 403
    assert [one.name for one in served.commands] == ["reload"]


def test_the_page_has_stop_and_the_looks_of_the_referees_page(served):
    page = served.get("/box").body.decode()
    assert '<script src="/assets/stop.js"></script>' in page and 'class="box device referee"' in page
    assert 'src="/assets/referee.js"' in page
