"""The loss of the box's computer, on a network of separate hosts: a standby takes over (docs/standby.md).

`make test` runs only the first test; `make test-net NET=--all` and `make test-all` run all.
"""

import os
import pathlib
import signal
import subprocess
import time
from typing import Callable, Iterator, List, NamedTuple

import pytest
from namespaces import NoRight, Switch, address, other_address
from support.waiting import wait_until
from two_boxes import (
    BOX,
    FIRST_ROBOT,
    LIMIT_S,
    STANDBY,
    WITNESS,
    Capture,
    Pair,
    addresses_of,
    zone_of,
)

from box import WITH_ROS, WITHOUT_ROS
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.protocol import RobotState
from roah_rsbb.standby.program.ears import NoAddress, give_back_address, take_address

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "build" / "net" / "pair"
ALPHA = zone_of("Alpha")
DOOR = "Dr. Kimble rings"


@pytest.fixture(params=[WITH_ROS, WITHOUT_ROS])
def pair(request) -> Iterator[Pair]:
    """Two computers, and two robots."""
    if not request.config.getoption("--all"):
        pytest.skip("takes half a minute: only with --all")
    try:
        made = Pair(FOLDER, kind=request.param)
    except NoRight as reason:
        pytest.skip(f"NOT TESTED on a network: {reason}")
    with made:
        yield made


def test_the_address_of_the_lost_box(tmp_path) -> None:
    """It is announced to the network, and given back."""
    try:
        switch = Switch()
    except NoRight as reason:
        pytest.skip(f"NOT TESTED on a network: {reason}")
    standby, robot = (switch.station(number).host for number in (STANDBY, FIRST_ROBOT))
    capture = Capture(switch.host)
    try:
        assert standby.do(take_address, address(BOX), str(tmp_path)) == "eth0"
        wait_until(lambda: capture.announced(STANDBY, address(BOX)), "the address is announced")
        assert standby.do(addresses_of) == [address(STANDBY), address(BOX)]
        assert standby.do(take_address, address(BOX), str(tmp_path)) == "eth0", "it has the address"
        assert standby.do(give_back_address, str(tmp_path)) == address(BOX)
        assert standby.do(addresses_of) == [address(STANDBY)]
        assert standby.do(give_back_address, str(tmp_path)) == "", "there is nothing left to give back"
        with pytest.raises(NoAddress, match="10.78.0.1"):
            robot.do(take_address, "10.78.0.1", str(tmp_path))
    finally:
        capture.close()
        for host in (standby, robot, switch):
            host.close()


def test_a_takeover_by_command(pair: Pair, measured: List[str]) -> None:
    """The run continues with its scores; the lost box comes back, sends nothing, and becomes the standby."""
    pair.begin()
    pair.run()
    pair.wait_ready()
    pair.box.referee("score", ALPHA, DOOR, "yes")
    pair.wait_copied()
    ports = pair.private_ports(BOX)
    refused = pair.standby.takeover()
    assert refused.wait_ended(LIMIT_S) == 1 and f"The box at {address(BOX)} is heard" in refused.text

    pair.lose_box()
    pair.wait_robots_silent()
    commanded = pair.now()
    assert pair.standby.takeover().wait_ended(LIMIT_S) == 0
    took_s = pair.wait_followed(commanded, ports)
    measured.append(f"takeover by command: robots sent to the standby after {took_s:.1f} s")
    shown = pair.standby.shows("status", ALPHA)
    assert "running" in shown.lower(), shown
    assert_marked(pair.standby.shows("score", ALPHA))
    pair.release()
    pair.standby.wait_shows("Benchmark completed by the robot", "status", ALPHA)
    assert all(len(robot.did("EXECUTING")) == 1 for robot in pair.robots)

    # The lost box starts again.
    pair.box.plug()
    returned = pair.now()
    again = pair.box.box()
    again.wait_printed("This box is superseded")
    pair.standby.referee("disconnect", ALPHA)  # robots' beacons pass, and so would the box's
    pair.wait_beacon(STANDBY, pair.now())
    assert pair.sent_to_robots(BOX, returned) == []
    again.signal(2)
    again.wait_ended(LIMIT_S)
    rejoined = pair.box.rejoin()
    rejoined.wait_printed("This computer is the standby of the box at")
    rejoined.wait_printed("The copy is kept")
    wait_until(lambda: _has(pair.box.copy_dir, DOOR), "it has the run", LIMIT_S)


def test_a_box_that_was_only_cut_off(pair: Pair, measured: List[str]) -> None:
    """It stops when it hears its successor."""
    first = pair.begin()
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    pair.box.cut()
    pair.wait_robots_silent()
    commanded = pair.now()
    assert pair.standby.takeover().wait_ended(LIMIT_S) == 0
    pair.wait_followed(commanded, ports)
    plugged = pair.now()
    pair.box.plug()
    both_s = pair.assert_box_stops(first, plugged, ports)
    measured.append(f"both boxes sent to robots for {both_s:.1f} s after a cut")


def test_an_automatic_takeover(pair: Pair, measured: List[str]) -> None:
    """The standby takes over when nothing is heard of the box, but not while it is cut off itself."""
    pair.begin("--automatic", "5", "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    pair.standby.cut()
    pair.follower.wait_printed("does not answer either: no automatic takeover")
    pair.standby.plug()
    pair.follower.wait_printed("The copy is kept", 2)
    lost = pair.now()
    pair.lose_box()
    took_s = pair.wait_followed(lost, ports)
    measured.append(f"automatic takeover: robots sent to the standby after {took_s:.1f} s")
    assert "Nothing was heard of the box for 5 s" in pair.follower.text


def test_a_box_that_hangs_and_continues(pair: Pair, measured: List[str]) -> None:
    """All its processes are stopped. When they continue, the core sends nothing before it ends."""
    first = pair.begin("--automatic", "2", "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    pair.box.referee("score", ALPHA, DOOR, "yes")
    pair.wait_copied()
    ports = pair.private_ports(BOX)
    lost = pair.now()
    pair.box.signal(signal.SIGSTOP)
    took_s = pair.wait_followed(lost, ports)
    measured.append(f"takeover after the box hung: robots sent to the standby after {took_s:.1f} s")
    assert_marked(pair.standby.shows("score", ALPHA))
    continued = pair.now()
    pair.box.signal(signal.SIGCONT)
    first.wait_printed("has taken over meanwhile: this core ends")
    pair.box.wait_shows("This box is superseded", "status")
    pair.wait_beacon(STANDBY, pair.now())
    assert pair.sent_to_robots(BOX, continued) == [], "not one datagram"


def test_a_core_that_hangs_and_is_not_replaced_is_handed_over(pair: Pair, measured: List[str]) -> None:
    """The standby takes over by itself, without an option."""
    pair.begin()
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    lost = pair.now()
    # Only the copy is still made.
    pair.box.let_only_copy()
    took_s = pair.wait_followed(lost, ports)
    measured.append(f"takeover after a handover: robots sent to the standby after {took_s:.1f} s")
    assert "its computer hands over: taking over" in pair.follower.text
    continued = pair.now()
    pair.box.signal(signal.SIGCONT)
    pair.box.wait_shows("This box is superseded", "status")
    pair.wait_beacon(STANDBY, pair.now())
    assert pair.sent_to_robots(BOX, continued) == []


@pytest.fixture
def disk(tmp_path) -> Iterator[pathlib.Path]:
    """A disk of its own, mounted here."""
    image, folder = tmp_path / "image", tmp_path / "disk"
    folder.mkdir()
    with image.open("wb") as file:
        file.truncate(64 << 20)
    for command in (["mkfs.ext4", "-q", str(image)], ["mount", "-o", "loop", str(image), str(folder)]):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            pytest.skip(f"NOT TESTED with a disk that hangs: {done.stderr.strip()}")
    yield folder
    subprocess.run(["umount", str(folder)])


def test_a_disk_that_hangs(disk: pathlib.Path, pair: Pair) -> None:
    """The core continues. STOP leaves at once and is with the standby, though no journal has it."""
    pair.box.log_dir.symlink_to(disk)
    first = pair.begin("--automatic", "2", "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    pair.wait_copied()
    core = pair.box.core()
    subprocess.run(["fsfreeze", "--freeze", str(disk)], check=True)
    try:
        assert "stopped, not yet recorded" in pair.box.run("referee", "stop", ALPHA).text
        pair.robots[0].wait_did(RobotState.STOP, LIMIT_S)
        pair.box.wait_shows("takes no data", "status")
        assert pair.box.core() == core and "taking over" not in pair.follower.text
        lost = pair.now()
        pair.box.cut()
        pair.wait_beacon(STANDBY, lost)
        pair.standby.wait_shows("Benchmark stopped by the referee", "status", ALPHA)
    finally:
        subprocess.run(["fsfreeze", "--unfreeze", str(disk)], check=True)
    pair.box.plug()
    first.wait_printed("This box is superseded")
    assert [len(robot.did("EXECUTING")) for robot in pair.robots] == [1, 1]


def test_robots_do_not_hear_the_box_but_the_standby_does(pair: Pair) -> None:
    """Nothing happens by itself, and the command is refused until the box is cut off."""
    pair.begin("--automatic", "2", "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    pair.separate(BOX, FIRST_ROBOT, FIRST_ROBOT + 1)
    pair.wait_robots_silent()  # for longer than the automatic takeover waits
    refused = pair.standby.takeover()
    assert refused.wait_ended(LIMIT_S) == 1 and "is heard" in refused.text
    assert "taking over" not in pair.follower.text
    assert pair.sent_to_robots(STANDBY) == []
    lost = pair.now()
    pair.box.cut()
    pair.wait_followed(lost, ports)


def test_the_standby_does_not_hear_the_box_but_robots_do(pair: Pair, measured: List[str]) -> None:
    """An automatic takeover replaces a healthy box. Robots stay with it until the split ends."""
    first = pair.begin("--automatic", "3", "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    pair.separate(BOX, STANDBY)
    pair.follower.wait_printed("Listening on UDP")
    pair.wait_beacon(STANDBY, pair.now())
    for robot in pair.robots:
        assert len(robot.did("EXECUTING")) == 1, "it stays with the box that it hears"
    healed = pair.now()
    pair.separate()
    both_s = pair.assert_box_stops(first, healed, ports)
    measured.append(f"both boxes sent to robots for {both_s:.1f} s after a split")
    pair.wait_followed(healed, ports)


class Loss(NamedTuple):
    """How a box is lost that stops a robot."""

    cut: Callable[[Pair], None] = lambda pair: None  # before STOP
    heals: bool = False  # after STOP
    dies: bool = True  # else the standby has taken over before STOP, and the box is superseded after it
    dies_after_s: float = 0.0
    automatic_s: int = 3


LOSSES = {
    "cut both ways": Loss(lambda pair: pair.separate(BOX, STANDBY)),
    "cut to the standby": Loss(lambda pair: pair.lose_frames(BOX, STANDBY)),
    "cut to the box": Loss(lambda pair: pair.lose_frames(STANDBY, BOX)),
    "split that heals": Loss(lambda pair: pair.separate(BOX, STANDBY), heals=True, dies=False),
    # The standby waits for long enough that it does not take over in between.
    "healed before the takeover": Loss(lambda pair: pair.separate(BOX, STANDBY), heals=True, automatic_s=10),
    **{f"{ms} ms after STOP": Loss(dies_after_s=ms / 1000) for ms in (0, 15, 31)},
}


@pytest.mark.parametrize("loss", LOSSES)
def test_a_robot_that_was_stopped_stays_stopped(pair: Pair, loss: str) -> None:
    """The standby may have the record of STOP, its note, or nothing of it. The other run continues."""
    cut, heals, dies, dies_after_s, automatic_s = LOSSES[loss]
    schedule = pair.box.folder / "schedule.yaml"
    schedule.write_text("- durable: two\n" + schedule.read_text("utf-8"), "utf-8")
    first = pair.begin("--automatic", str(automatic_s), "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    pair.wait_copied()
    alpha, beta = pair.robots
    ports, core = pair.private_ports(BOX), pair.box.core()
    cut(pair)
    if not dies:
        pair.follower.wait_printed("Listening on UDP")
        pair.wait_beacon(STANDBY, pair.now())
    stop = pair.box.start("referee", "stop", ALPHA)
    wait_until(lambda: alpha.did("STOP"), "it stopped", LIMIT_S)
    if "cut" in loss:
        stop.wait_ended(LIMIT_S)
    healed = pair.now()
    if heals:
        pair.separate()
    if not dies:
        pair.assert_box_stops(first, healed, ports)
    else:
        time.sleep(dies_after_s)  # the moment that is tested
        os.kill(core, signal.SIGKILL)
        pair.lose_box()
    asked, known = "reports STOP, and the box cannot know", "Benchmark stopped by the referee"
    shown = pair.standby.wait_shows((asked, known), "status", ALPHA)
    pair.release()
    pair.standby.wait_shows("Benchmark completed by the robot", "status", zone_of("Beta"))
    if known not in shown:
        pair.standby.referee("stop", ALPHA)
        pair.standby.wait_shows(known, "status", ALPHA)
    for robot in alpha, beta:
        assert len(robot.did("PREPARING")) == len(robot.did("EXECUTING")) == 1


def test_robots_that_send_to_the_address_of_the_box(pair: Pair) -> None:
    """The standby takes the address over, and gives it back when it is the standby again."""
    pair.begin("--take-address", host=address(BOX))
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    pair.lose_box()
    pair.wait_robots_silent()
    commanded = pair.now()
    assert pair.standby.takeover().wait_ended(LIMIT_S) == 0
    assert pair.capture.announced(STANDBY, address(BOX))
    assert pair.standby.addresses() == [address(STANDBY), address(BOX)]
    pair.wait_followed(commanded, ports)
    # A robot without a run sends beacons only to the address that it was given.
    pair.standby.referee("disconnect", ALPHA)
    pair.standby.referee("connect", ALPHA)

    # The lost computer needs another address. It rejoins, and takes over in its turn.
    pair.box.plug()
    pair.box.readdress()
    pair.box.rejoin().wait_printed("waiting for a takeover")
    pair.standby.cut()
    pair.standby.burn()
    assert pair.box.takeover("--log-dir", str(pair.box.copy_dir)).wait_ended(LIMIT_S) == 0
    pair.standby.plug()
    pair.standby.rejoin().wait_printed(f"no longer has the address {address(BOX)}")
    assert pair.standby.addresses() == [address(STANDBY)]
    assert pair.box.addresses() == [other_address(BOX)]


def assert_marked(sheet: str) -> None:
    """The referee's mark is on the sheet."""
    line = next(line for line in sheet.splitlines() if DOOR in line)
    assert "yes" in line.lower(), sheet


def _has(log_dir: pathlib.Path, text: str) -> bool:
    return any(text.encode("utf-8") in segment.read_bytes() for segment in (log_dir / JOURNAL).glob("*.log"))
