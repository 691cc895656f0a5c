"""An organiser edits the schedule of the day: looked at, done, kept over kills, beside edits by hand, and undone."""

import os
import shutil

import pytest

from helpers.box_driver import BoxDriver
from helpers.config_files import SHIPPED
from roah_rsbb.box import configuration, day_edits
from roah_rsbb.box.configuration import Configuration, Reloads
from roah_rsbb.box.day_edits import DayEdits
from roah_rsbb.core import effects
from roah_rsbb.ground import durable, installed
from roah_rsbb.journal.log_dir import CONFIGURATION, kept_files
from roah_rsbb.model.reason import Refused, RunName, decoded
from roah_rsbb.model.records import Phase
from roah_rsbb.rulebook.day import slots

SCHEDULE = """# Ours
- time_zone: UTC

- zone: Home
  schedule:
    - { benchmark: HGTKMH, team: Alpha, round: 1, run: 1, scheduled_time: 2027-01-15 14:00:00, id: ha }  # Friday
    # the guests of honour
    - { benchmark: HGTKMH, team: Beta,  round: 1, run: 1, scheduled_time: 2027-01-15 14:30:00, id: hb }  # Friday
    - { benchmark: HGTKMH, team: Gamma, round: 1, run: 1, scheduled_time: 2027-01-15 15:00:00, id: hg }  # Friday

- zone: Arena
  schedule:
    - { benchmark: HWV, team: Beta, round: 1, run: 1, scheduled_time: 2027-01-15 16:00:00, id: wb }
"""


class Place:
    """The folder of a competition, and the boxes that start there."""

    def __init__(self, folder, schedule=SCHEDULE, standings=None):
        folder.mkdir(exist_ok=True)
        self.standings = str(folder / "standings.yaml") if standings else None
        if standings:
            (folder / "standings.yaml").write_text(standings, "utf-8")
        self.folder, self.schedule = folder, folder / "schedule.yaml"
        self.schedule.write_text(schedule, "utf-8")
        shutil.copy(SHIPPED / "benchmarks.yaml", folder / "benchmarks.yaml")
        (folder / "passwords.yaml").write_text("Alpha: a\nBeta: b\nGamma: c\n", "utf-8")
        self.start()

    def start(self, launch="launch 1"):
        """A box starts; returns what every referee is warned of."""
        paths = [str(self.folder / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords")]
        self.configuration = Configuration(str(self.folder / "log"), launch, paths, self.standings)
        self.driver = driver = BoxDriver(self.configuration.content.config)
        self.reloads = Reloads(driver.box, self.configuration, lambda function: function(), driver.event,
                               lambda config, version: None)
        self.edits = DayEdits(driver.box, self.configuration, self.reloads, lambda function: function(), driver.event,
                              lambda: driver.now)
        return self.configuration.notices

    def look(self, action, **given):
        return self.edits.edit(action, given, "", "Olga")

    def do(self, action, **given):
        """Look at an edit, and do it; returns what it said."""
        return self.edits.edit(action, given, self.look(action, **given)["seen"], "Olga")

    @property
    def in_force(self):
        return spots(self.configuration.content.config.zones)

    @property
    def written(self):
        """What the file says now."""
        return spots(self.configuration.read().config.zones)

    @property
    def shown(self):
        """What the zones of the box have."""
        return {event.id: (zone.name, event.scheduled) for zone in self.driver.box.zones.values()
                for event in zone.planned}


def spots(zones):
    """Zone and time of each event."""
    return {own: (slot.zone, slot.scheduled) for own, slot in slots(zones).items()}


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setattr(durable.os, "fsync", lambda handle: None)  # only a power cut would notice
    return Place(tmp_path)


def lines(found, name="effects"):
    return list(map(str, decoded(found[name])))


def test_an_edit_is_looked_at_done_kept_and_undone(place):
    before = place.in_force
    looked = place.look("swap", event="ha", other="wb", reason="late")
    assert lines(looked) == ["HWV of Beta: 14:00 in zone 'Home' instead of 16:00 in zone 'Arena'",
                             "HGTKMH of Alpha: 16:00 in zone 'Arena' instead of 14:00 in zone 'Home'"]
    assert (place.in_force, place.schedule.read_text("utf-8"), looked["done"]) == (before, SCHEDULE, False)
    done = place.do("swap", event="ha", other="wb", reason="late")
    assert done["done"] and place.shown == place.in_force == place.written != before
    text = place.schedule.read_text("utf-8")
    assert text.startswith("# Ours\n") and "# the guests of honour" in text
    assert (place.folder / "schedule.yaml~").read_text("utf-8") == SCHEDULE
    recorded = [effect for effect in place.driver.effects if isinstance(effect, effects.Recorded)]
    assert [(effect.who, effect.value["edit"]["reason"]) for effect in recorded] == [("Olga", "late")]
    assert [(edit["number"], edit["who"], edit["reason"], lines(edit, "words")) for edit in place.edits.listed()] == [
        (1, "Olga", "late", lines(done))]
    place.start("launch 2")
    place.do("undo", number=1)
    assert place.shown == place.in_force == place.written == before
    assert [edit["undone"] for edit in place.edits.listed()] == [0, 2]
    with pytest.raises(Refused, match="no edit 1 that can be undone"):
        place.look("undo", number=1)
    place.do("undo", number=2)
    place.do("move", event="ha", time="17:00")
    with pytest.raises(Refused, match="HGTKMH of Alpha was changed since"):
        place.look("undo", number=3)


def test_an_edit_whose_effect_is_another_one_by_now_is_refused(place):
    seen = place.look("shift", zone="Home", time="40")["seen"]
    place.driver.command("next", "Home")
    with pytest.raises(Refused, match="another one by now"):
        place.edits.edit("shift", {"zone": "Home", "time": "40"}, seen, "Olga")
    assert lines(place.do("shift", zone="Home", time="40")) == [
        "HGTKMH of Beta: 15:10 instead of 14:30", "HGTKMH of Gamma: 15:40 instead of 15:00"]


@pytest.mark.parametrize("action, given, why", [
    ("shift", {"zone": "Home"}, "Minutes, or time is missing"), ("explode", {}, "no edit 'explode'"),
    ("insert", {"zone": "Home", "benchmark": "HGTKM", "team": "Beta", "time": "17:00"}, "did you mean 'HGTKMH'"),
    ("insert", {"zone": "Home", "benchmark": "HWV", "team": "Bet", "time": "17:00"}, "did you mean 'Beta'"),
    ("add_team", {"team": "ALL"}, "no name of a team"), ("withdraw_team", {"team": "Delta"}, "no such event to come"),
])
def test_a_refused_edit_changes_nothing(place, action, given, why):
    with pytest.raises(Refused, match=why):
        place.look(action, **given)
    assert place.schedule.read_text("utf-8") == SCHEDULE and place.edits.listed() == []


def test_the_current_event_follows_and_a_run_keeps_its_own(place):
    home = place.driver.box.zones["Home"]
    place.do("move", event="ha", time="15:15")
    assert home.event.id == "hb"
    place.driver.command("open_sheet", "Home")
    place.driver.command("start", "Home")
    assert lines(place.do("shift", zone="Home", time="10"))[0] == "HGTKMH of Gamma: 15:10 instead of 15:00"
    with pytest.raises(Refused, match="in progress"):
        place.look("remove", event="hb")
    assert home.run.phase is Phase.RUNNING and home.event.id == "hb"


def test_an_edit_that_is_refused_at_the_last_moment_leaves_nothing(place, monkeypatch):
    before, seen = place.in_force, place.look("shift", zone="Home", time="40")["seen"]
    with monkeypatch.context() as patched:
        def take(*arguments):
            raise Refused(["a run was connected just now"])
        patched.setattr(place.driver.box.reload, "take", take)
        with pytest.raises(Refused, match="just now"):
            place.edits.edit("shift", {"zone": "Home", "time": "40"}, seen, "Olga")
    assert (place.edits.listed(), place.in_force, place.schedule.read_text("utf-8")) == ([], before, SCHEDULE)
    assert place.start() == [] and place.in_force == place.written == before


def test_a_reload_ends_what_waits_to_be_written(place):
    by_hand = SCHEDULE.replace("14:30", "14:35")
    place.schedule.write_text(by_hand, "utf-8")
    place.do("move", event="hb", time="17:00")
    assert place.reloads.reload(place.reloads.reload("", "Olga").digest, "Olga").applied
    place.schedule.write_text(by_hand.replace("16:00:00", "18:00:00"), "utf-8")
    assert "was changed by hand, too" in str(decoded([place.do("move", event="hb", time="17:30")["trouble"]])[0])
    assert place.written["hb"] == place.in_force["hb"] and place.written["wb"] != place.in_force["wb"]


class Killed(BaseException):
    """The box is killed."""


@pytest.mark.parametrize("launch", ["launch 1", "launch 2"], ids=["crash", "new launch"])
def test_a_kill_between_any_two_steps_loses_no_edit_that_is_in_force(place, monkeypatch, launch):
    """Every replacement of a file is a step; a kill comes before it."""
    before, real, is_killed, step = place.in_force, os.replace, True, 0

    def replace(draft, path):
        if os.path.exists(draft):
            left[0] -= 1
            if left[0] < 0:
                raise Killed
        real(draft, path)
    while is_killed:
        left, is_killed = [step], False
        seen = place.look("shift", zone="Home", time="40")["seen"]
        with monkeypatch.context() as patched:
            patched.setattr(durable.os, "replace", replace)
            try:
                place.edits.edit("shift", {"zone": "Home", "time": "40"}, seen, "Olga")
            except Killed:
                is_killed = True
        assert place.start(launch) == [] and place.in_force == place.written == place.shown
        assert (place.in_force == before) == (step == 0), "what is kept in log_dir is in force"
        if step:
            texts = [(place.folder / name).read_text("utf-8") for name in os.listdir(place.folder) if "~" in name]
            assert SCHEDULE in texts, "the version before is kept"
            place.do("undo", number=place.edits.listed()[0]["number"])
        assert place.in_force == place.written == before
        step += 1
    assert step > 4


def test_an_edit_by_hand_at_the_same_time_is_noticed_and_not_lost(place):
    by_hand = SCHEDULE.replace("16:00:00", "18:00:00")
    place.schedule.write_text(by_hand, "utf-8")
    done = place.do("shift", zone="Home", time="40")
    assert "was changed by hand, too" in str(decoded([done["trouble"]])[0])
    assert place.in_force["wb"] != place.written["wb"] and place.in_force["ha"] == place.written["ha"]
    assert (place.folder / "schedule.yaml~").read_text("utf-8") == by_hand
    listed = place.reloads.reload("", "Olga")
    assert [change.split(":")[1] for change in listed.changes] == [" HWV of Beta, round 1, run 1"]


@pytest.mark.parametrize("by_hand", ["- zone: [", SCHEDULE.replace("14:30", "14:35")], ids=["broken", "moved"])
def test_an_edit_that_does_not_fit_what_was_written_by_hand_is_in_force_and_said(place, by_hand):
    place.schedule.write_text(by_hand, "utf-8")
    done = place.do("move", event="hb", time="17:00")
    assert "does not fit the edit" in str(decoded([done["trouble"]])[0])
    assert place.schedule.read_text("utf-8") == by_hand
    after = place.in_force
    assert "does not fit the edit" in place.start()[0] and place.in_force == after


def test_a_file_that_cannot_be_written_is_written_later(place, monkeypatch):
    with monkeypatch.context() as patched:
        def full(path, content, *more):
            if path.startswith(str(place.schedule)):
                raise OSError(28, "No space left on device")
            return write_file(path, content, *more)
        write_file = durable.write_file
        patched.setattr(durable, "write_file", full)
        done = place.do("shift", zone="Home", time="40")
        assert "cannot be written (No space left" in str(decoded([done["trouble"]])[0])
        after = place.in_force
        assert place.start("launch 2")[0] and place.in_force == after != place.written
    assert place.start("launch 3") == [] and place.in_force == place.written == after


def test_a_standby_that_takes_over_has_the_edits(place, tmp_path):
    before = place.in_force
    place.do("shift", zone="Home", time="40")
    (tmp_path / "standby" / "log").mkdir(parents=True)
    shutil.copy(tmp_path / "log" / CONFIGURATION, tmp_path / "standby" / "log")  # what it keeps, and begins with
    standby = Place(tmp_path / "standby", kept_files(str(tmp_path / "log"))["schedule"])
    assert standby.in_force == standby.shown == place.in_force
    standby.do("undo", number=1)
    assert standby.in_force == standby.written == before != place.written


def test_files_of_the_package_are_never_written(place, monkeypatch):
    monkeypatch.setattr(installed, "shipped_folder", lambda: place.folder)
    done = place.do("shift", zone="Home", time="40")
    after = place.in_force
    assert "a part of the program" in str(decoded([done["trouble"]])[0])
    with pytest.raises(Refused, match="a part of the program"):
        place.do("add_team", team="Tea")
    place.start("launch 2")
    assert place.in_force == after and place.schedule.read_text("utf-8") == SCHEDULE
    assert "Tea" not in (place.folder / "passwords.yaml").read_text("utf-8")


def test_a_late_team_gets_a_password_and_events_in_one_step(place):
    done = place.do("add_team", team="Tea at 5")
    assert lines(done)[:2] == ["HGTKMH of Tea at 5: 15:30 in zone 'Home', added",
                               "HWV of Tea at 5: 16:15 in zone 'Arena', added"]
    assert place.driver.box.robots.has_password("Tea at 5") and place.shown == place.written
    mode = (place.folder / "passwords.yaml").stat().st_mode
    assert (place.folder / "passwords.yaml").read_text("utf-8").startswith("Alpha: a\n") and mode & 0o777 == 0o644
    place.start("launch 2")
    assert place.driver.box.robots.has_password("Tea at 5")


def ends(place):
    return {record.event: record.end_reason for record in place.driver.box.finished.records()}


def test_a_team_withdraws_from_all_that_is_to_come(place):
    place.driver.command("next", "Home")
    done = place.do("withdraw_team", team="Beta", reason="broken")
    assert lines(done) == ["HGTKMH of Beta: 14:30 in zone 'Home', the team withdraws",
                           "HWV of Beta: 16:00 in zone 'Arena', the team withdraws"]
    assert ends(place) == {"hb": "withdrawn", "wb": "withdrawn"}
    assert {record.sign_off.who for record in place.driver.box.finished.records()} == {"Olga"}
    assert place.driver.box.zones["Home"].event.id == "hg"
    with pytest.raises(Refused, match="no such event to come"):
        place.look("withdraw_team", team="Beta")


def test_a_team_that_withdrew_comes_back(place):
    place.driver.command("next", "Home")
    place.do("withdraw_team", team="Beta")
    by_hand = next(run for run in place.configuration.edits[-1]["runs"] if run.event == "wb")
    place.driver.enter("annul", RunName("Arena", by_hand.identity), "Olga", reason="x")
    assert lines(place.do("undo", number=1)) == ["HGTKMH of Beta: 14:30 in zone 'Home', the team does not withdraw",
                                                 "HWV of Beta: 16:00 in zone 'Arena', the team does not withdraw"]
    assert all(record.is_annulled for record in place.driver.box.finished.records())
    assert place.driver.box.zones["Home"].event.id == "hb"
    assert [(edit["action"], edit["can_undo"]) for edit in place.edits.listed()] == [
        ("undo", False), ("withdraw_team", False)]


def test_a_team_withdraws_from_later_events_while_a_run_is_in_progress(place):
    place.driver.command("open_sheet", "Home")
    place.driver.command("start", "Home")
    place.do("withdraw_team", team="Beta", day="2027-01-15")
    assert ends(place) == {"hb": "withdrawn", "wb": "withdrawn"} and place.driver.box.zones["Home"].event.id == "ha"
    place.driver.command("stop", "Home")
    place.driver.command("disconnect", "Home")
    place.driver.command("next", "Home")
    with pytest.raises(Refused, match="no such event to come"):
        place.look("withdraw_team", team="Alpha", day="2027-01-16")
    assert lines(place.do("withdraw_team", team="Gamma", event="hg"))[0].startswith("HGTKMH of Gamma")


def test_an_edit_does_not_wait_for_a_reload_whose_disk_hangs(place, monkeypatch):
    monkeypatch.setattr(configuration, "WAIT_S", 0.0)
    with place.reloads.alone(), pytest.raises(Refused, match="another reload has not ended"):
        place.look("shift", zone="Home", time="40")
    assert day_edits.EDITS.keys() >= {"shift", "undo"}


FINALS = """- zone: Home
  schedule:
    - { benchmark: HGTKMH, team: Alpha, round: 1, run: 1, scheduled_time: 2027-01-15 14:00:00, id: ha }
    - { benchmark: HGTKMH, team: Beta,  round: 1, run: 1, scheduled_time: 2027-01-15 14:30:00, id: hb }
    - { benchmark: HGTKMH, team: Gamma, round: 1, run: 1, scheduled_time: 2027-01-15 15:00:00, id: hg }
- zone: Arena
  schedule:
    - { benchmark: HWV, team: Alpha, round: 1, run: 1, scheduled_time: 2027-01-15 16:00:00, id: wa }
    - { benchmark: HWV, team: Beta,  round: 1, run: 1, scheduled_time: 2027-01-15 16:30:00, id: wb }
    - { benchmark: HWV, team: Gamma, round: 1, run: 1, scheduled_time: 2027-01-15 17:00:00, id: wg }
"""
REMOVED = "HWV of Alpha: removed (it was at 16:00 in zone 'Arena')"
STAGES = """stages:
  - { name: Tasks, of: [ { test: HGTKMH } ], advance: 2, asks: yes }
  - { name: Final ranking, teams: Tasks, of: [ { stage: Tasks }, { test: HWV } ] }
"""


def finals(folder, *marks):
    """The tasks are over: each team has as many items of its sheet."""
    place = Place(folder, "- time_zone: UTC\n" + FINALS, STAGES)
    for number in marks:
        driver = place.driver
        driver.command("open_sheet", "Home")
        driver.command("start", "Home")
        for item in [item for item in driver.run_in("Home").record(driver.now).items if item.points != 0][:number]:
            driver.score(item.group, item.desc, 1, "Home")
        driver.command("stop", "Home")
        driver.command("disconnect", "Home")
        record = max(driver.box.finished.records(), key=lambda record: record.opened_utc)
        driver.enter("sign_off", RunName("Home", record.identity), "Olga")
        if record.event != "hg":  # the last one of the zone
            driver.command("next", "Home")
    return place


def test_teams_that_advance_take_the_places_of_the_final_the_best_one_last(tmp_path):
    place = finals(tmp_path, 1, 3, 2)
    done = place.do("advance")
    assert lines(done) == [
        "Tasks: 2 of 3 advance: Beta, Gamma", "HWV of Gamma: 16:00 instead of 17:00",
        REMOVED]
    assert place.shown == place.in_force == place.written
    place.do("undo", number=1)
    assert set(place.in_force) == set(spots(Place(tmp_path / "again", "- time_zone: UTC\n" + FINALS).configuration
                                            .content.config.zones))


def test_a_final_without_planned_events_begins_at_a_time(tmp_path):
    place = finals(tmp_path, 1, 3, 2)
    done = place.do("advance", stage="Tasks", time="2027-01-15 18:00", minutes=20)
    assert lines(done)[1:] == [
        REMOVED,
        "HWV of Gamma: 18:00 instead of 17:00",
        "HWV of Beta: 18:20 instead of 16:30"]


def test_a_planned_final_moves_to_a_zone_or_gets_other_minutes(tmp_path):
    place = finals(tmp_path, 1, 3, 2)
    place.do("insert", zone="Arena", benchmark="HGTKMH", team="Alpha", time="2027-01-15 20:00")
    assert lines(place.look("advance", zone="Home"))[1:] == [
        "HWV of Gamma: 16:00 in zone 'Home' instead of 17:00 in zone 'Arena'", REMOVED,
        "HWV of Beta: 16:30 in zone 'Home' instead of 16:30 in zone 'Arena'"]
    assert lines(place.look("advance", minutes=20))[1:] == [
        "HWV of Gamma: 16:00 instead of 17:00", REMOVED, "HWV of Beta: 16:20 instead of 16:30"]
    with pytest.raises(Refused, match="zone"):
        place.look("advance", zone="Hom")


def test_a_final_that_has_no_place_asks_for_time_and_zone(tmp_path):
    place = finals(tmp_path, 1, 3, 2)
    place.do("insert", zone="Arena", benchmark="HGTKMH", team="Alpha", time="2027-01-15 20:00")
    for event in ("wa", "wb", "wg"):
        place.do("remove", event=event)
    for given in ({}, {"time": "18:00"}):
        with pytest.raises(Refused, match="2 teams advance, and 0 events of HWV are planned: give the time .* zone"):
            place.look("advance", **given)
    assert lines(place.look("advance", time="18:00", zone="Arena"))[1:] == [
        "HWV of Gamma: 18:00 in zone 'Arena', added", "HWV of Beta: 18:15 in zone 'Arena', added"]


def test_who_advances_is_asked_where_nothing_decides(tmp_path):
    place = finals(tmp_path, 2, 2, 2)
    with pytest.raises(Refused, match="Alpha, Beta, Gamma tie, and 2 of them can advance"):
        place.look("advance")


def test_nobody_advances_without_a_signed_result_or_from_an_unknown_stage(tmp_path):
    place = finals(tmp_path)
    with pytest.raises(Refused, match="Nobody has a signed result in stage 'Tasks'"):
        place.look("advance")
    with pytest.raises(Refused, match="'Task' from which teams advance: .* has Tasks: did you mean 'Tasks'"):
        place.look("advance", stage="Task")
    place = finals(tmp_path, 2)
    assert lines(place.look("advance"), "warnings")[0] == (
        "2 events of stage 'Tasks' are still to come: who advances may change")
