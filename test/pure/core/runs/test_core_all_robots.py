"""HSUF: which robots take part, and which are named in warnings; what is shown and logged for all and for each."""

import pytest

from helpers.all_robots import (
    R1,
    R2,
    R3,
    SKEW,
    all_robots_box,
    connect_all,
    connected,
    counts,
    robots_of,
    running,
    start_all,
    state_lines,
    take_ports,
)
from helpers.competition import event
from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason

# -- connect ------------------------------------------------------------------------------------------


def test_all_active_robots_get_a_channel_each():
    driver, robots = connected()
    assert [robot.port for robot in robots] == [6667, 6668, 6669]
    assert driver.box.beacon().robots == (
        ("Alpha", "r1", 6667), ("Beta", "r2", 6668), ("Gamma", "r3", 6669),
    )
    assert driver.channels == {6667: "10.0.0.2", 6668: "10.0.0.3", 6669: "10.0.0.4"}
    assert {message.benchmark for port in driver.channels for message in driver.states[port]} == {"HSUF"}
    assert [run.robot.team for run in driver.box.zones.members()] == ["Alpha", "Beta", "Gamma"]


def test_one_robot_alone_is_all_robots():
    driver = all_robots_box()
    robot, = start_all(driver, connect_all(driver, robots_of(driver, ["Beta"])))
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_robots_that_cannot_take_part_are_named_and_do_not_block_others():
    driver = all_robots_box()
    gone = driver.robot("Gamma", "gone", "10.0.0.9")
    gone.beacon()
    driver.run(4.0)
    robots = robots_of(driver)
    driver.command("connect", "other")  # takes r1 of Alpha
    skewed = driver.robot("Beta", "late clock", skew=0.5)
    skewed.beacon()
    stranger = driver.robot("Nobody", "r9")
    stranger.beacon()
    names = [
        f"{R1} cannot take part: it is in a run in zone other",
        f"late clock of team Beta cannot take part: {SKEW}",
        "gone of team Gamma cannot take part: it was not heard for 4 s",
        "r9 of team Nobody cannot take part: its team has no password in the passwords file",
    ]
    assert driver.off("connect") == []
    view = driver.view()
    assert view.warnings == tuple(names)
    assert view.state.splitlines() == [
        f"2 robots ready to accept connection: {R2}, {R3}", *(f"WARNING: {name}" for name in names)
    ]
    driver.command("connect")
    take_ports(driver, [*robots, skewed, gone, stranger])
    assert [robot.port for robot in robots] == [6667, 6668, 6669]
    assert [robot.port for robot in (skewed, gone, stranger)] == [None] * 3
    assert driver.view().warnings == tuple(names)


def test_every_reason_of_a_robot_is_reported():
    driver = all_robots_box()
    driver.robot("Nobody", "r9", skew=0.5).beacon()
    driver.run(5.0)
    reason, = driver.off("connect")
    assert reason == (
        "r9 of team Nobody cannot take part: its team has no password in the passwords file; it was not heard for "
        f"5 s; {SKEW}"
    )
    with pytest.raises(Refused, match="has no password"):
        driver.command("connect")
    assert state_lines(driver) == [reason]  # and not a second time, as a warning
    assert driver.view("other").warnings == ()


def test_while_the_box_listens_nobody_is_connected():
    driver = all_robots_box(listening=True)
    robots_of(driver)
    assert driver.off("connect") == ["The box is still listening for another box, for 5 s"]


def test_a_late_robot_is_named_until_the_start_and_comes_with_the_next_connect():
    driver, robots = connected()
    late = driver.robot("Gamma", "late", "10.0.0.9")
    late.beacon()
    text = "late of team Gamma is active, but not in this run: disconnect and connect again to include it"
    assert driver.view().warnings == (text,)
    driver.command("start")
    assert driver.view().warnings == ()
    driver.command("stop")
    assert driver.view().warnings == ()
    driver.command("disconnect")
    for robot in robots:
        robot.beacon()
    driver.command("connect")
    assert [r.robot for r in driver.box.beacon().robots] == ["r1", "r2", "late", "r3"]


def test_a_robot_in_it_is_in_no_other_run():
    driver, _ = connected()
    assert driver.off("connect", "other") == [f"Robot {R1} is in a run in zone tbm"]
    driver.command("disconnect")
    assert driver.off("connect", "other") == []


def test_robots_of_one_team_have_channels_and_logs_of_their_own():
    driver = all_robots_box()
    robots = [driver.robot("Alpha", name, f"10.0.0.{i}") for i, name in enumerate("ab", 2)]
    for robot in robots:
        robot.beacon()
    start_all(driver, connect_all(driver, robots))
    opened = driver.taken(effects.RunOpened)
    assert opened == [
        effects.RunOpened(6667, "Alpha", 1, 1, "a"), effects.RunOpened(6668, "Alpha", 1, 1, "b"),
    ]
    robots[1].says(notifications=("heard it",))
    assert driver.logged(6667, run_log.NOTIFICATION) == []
    assert driver.logged(6668, run_log.NOTIFICATION) == ["heard it"]


# -- room ---------------------------------------------------------------------------------------------


THIRTY = [f"Team{i:02}" for i in range(30)]


def test_robots_that_the_beacon_has_no_room_for_refuse_connect_with_how_many_fit():
    driver = all_robots_box(teams=["Alpha", *THIRTY])
    robots = robots_of(driver, THIRTY)
    assert driver.off("connect") == [
        f"The beacon may need {100 + 32 * 30} bytes with 30 more robots, and robots may read only 1024: leave only "
        f"{(1024 - 100) // 32} of them switched on, or raise max_datagram if all robots are known to read more"
    ]
    driver.run(31)
    for robot in robots[:28]:
        robot.beacon()
    connect_all(driver, robots[:28])
    assert len(driver.box.zones.members()) == 28
    driver.robot("Alpha", "r0").beacon()
    assert driver.off("connect", "other")[0].startswith("The beacon may need")


@pytest.mark.parametrize("bytes_left, fit", [(-1, 2), (0, 3), (1, 3), (-32, 2), (-33, 1), (-64, 1), (-65, 0)])
def test_the_beacons_room_is_used_to_the_last_byte(bytes_left, fit):
    driver = all_robots_box(settings=Settings(max_datagram=100 + 32 * 3 + bytes_left))
    robots_of(driver)
    if fit == 3:
        assert driver.off("connect") == []
        return
    reason, = driver.off("connect")
    remedy = f"leave only {fit} of them switched on" if fit else "end another run first"
    assert f": {remedy}, or raise max_datagram" in reason


def test_robots_of_other_runs_take_room_too():
    driver = all_robots_box(teams=["Alpha", *THIRTY])
    driver.connected("other")
    robots_of(driver, THIRTY[:28])
    reason, = driver.off("connect")
    assert "leave only 27 of them switched on, end another run first, or raise max_datagram" in reason


def test_one_port_is_not_enough_for_two():
    driver = all_robots_box(last_port=65534)
    robots_of(driver, ["Alpha", "Beta"])
    reason, = driver.off("connect")
    assert reason.startswith("All UDP ports up to 65535 but 1 are used up, and 2 robots need one each")


def test_every_robot_needs_a_port():
    driver = all_robots_box(last_port=65533)
    robots = robots_of(driver)
    reason, = driver.off("connect")
    assert reason.startswith("All UDP ports up to 65535 but 2 are used up, and 3 robots need one each: start the box")
    driver.run(31)
    robots[0].beacon()
    robots[1].beacon()
    connect_all(driver, robots[:2])
    assert [robot.port for robot in robots[:2]] == [65534, 65535]


def test_a_channel_that_cannot_be_opened_for_one_robot_takes_the_next_port():
    driver = all_robots_box()
    driver.unusable_ports = {6668}
    robots = start_all(driver, connect_all(driver, robots_of(driver)))
    assert [robot.port for robot in robots] == [6667, 6670, 6669]
    assert counts(driver) == (0, 3, 0)
    assert set(driver.channels) == {6667, 6669, 6670}


def test_a_robot_without_a_channel_does_not_take_part_and_the_others_do():
    driver = all_robots_box(last_port=65532)
    driver.unusable_ports = {65534}
    robots = connect_all(driver, robots_of(driver))
    assert [robot.port for robot in robots] == [65533, None, 65535]
    assert f"No private channel could be opened: {R2} does not take part" in driver.notices(Level.ERROR)
    text = f"{R2} is active, but not in this run: disconnect and connect again to include it"
    assert driver.view().warnings == (text,)
    start_all(driver, [robots[0], robots[2]])
    assert counts(driver) == (0, 2, 0)


def test_where_no_channel_can_be_opened_the_run_is_not_begun():
    driver = all_robots_box()
    driver.unusable_ports = set(range(6667, 8000))
    robots_of(driver)
    driver.command("connect")
    assert driver.run_in() is None
    taken = driver.taken()
    tried = [e.port for e in taken if isinstance(e, effects.OpenChannel)]
    assert tried == list(range(6667, 6667 + len(tried)))
    assert 20 <= len(tried) <= 30
    errors = [e.text for e in taken if isinstance(e, effects.Notice) and e.level is Level.ERROR]
    assert errors[-1] == "No private channel could be opened: the run was not begun"
    assert driver.box.beacon().robots == ()
    assert driver.view().phase == "idle"


def test_log_and_online_data_of_all_are_shown_with_the_robots_names():
    driver, robots = running()
    robots[0].says(notifications=("one",))
    robots[2].says(notifications=("three",))
    view = driver.view()
    assert [line.split(" ", 1)[1] for line in view.online_data.splitlines()] == [
        f"{R1}: notifications: one", f"{R3}: notifications: three",
    ]
    assert f"{R2}: WAITING_RESULT: Robot prepared, executing" in view.log
    assert view.log.count("Started with 3 of 3 robots") == 1


def test_the_score_sheet_is_the_runs_and_every_robots_log_has_it():
    scored = event("HSUF", team="ALL", timeout=120.0)
    driver, robots = connected(scored)
    driver.command("disconnect")
    driver.command("next")
    connect_all(driver, robots_of(driver))
    driver.score("Penalized", "bumps", 2)
    assert [(item.desc, item.value) for item in driver.view().items][-1] == ("bumps", 2)
    ports = [run.port for run in driver.box.zones.members()]
    assert [driver.logged(port, run_log.SCORE) for port in ports] == [[("Penalized", "bumps", 2)]] * 3
    assert driver.view().log.count("Score: Penalized: bumps 0 -> 2") == 1
    with pytest.raises(Refused, match="no scoring group"):
        driver.score("Nothing", "bumps", 2)


def test_a_step_of_the_boxs_clock_makes_all_skews_be_measured_again():
    driver, robots = connected()
    driver.set_clock(100)
    driver.event(driver.box.timers.tick)
    assert all(member.link.skew is None for member in driver.run_in().members())
    for robot in robots:
        robot.says()
    assert driver.off("start") == []
