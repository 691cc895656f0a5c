"""A whole box in one process: with robots in memory, from its start to scored runs, and over a restart."""

import asyncio
import errno
import os
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from helpers.waiting import LIMIT_S, News
from roah_rsbb.box import door
from roah_rsbb.box.program import program
from roah_rsbb.box.program.demo import copied, settings
from roah_rsbb.box.program.main import serve
from roah_rsbb.box.program.neighbours import InProcessClient
from roah_rsbb.box.program.program import BoxProgram, door_file
from roah_rsbb.client.places import OWN_VARIABLE, read_place, write_place
from roah_rsbb.comm.peer import MemoryAir
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.ground import durable
from roah_rsbb.ground.params import BadParams
from roah_rsbb.model.zone import ENDED, IDLE, RUNNING
from roah_rsbb.robot.dummy import DummyOptions, dummy_client
from roah_rsbb.tools.competition.program import main as new_competition

ZONE, TEAM = "Testing TestingTeam", "TestingTeam"


def box_program(log_dir, air, **changes):
    return BoxProgram(asyncio.get_event_loop(), settings(str(log_dir), web="false", tablet="false", **changes), "",
                      air.peer, is_dummy=True)


class Demonstration:
    """A box, a robot and a referee in this loop. What happens is waited for, and never a time."""

    def __init__(self, log_dir, execute_s=0.05, **changes):
        self.air = MemoryAir()
        self.program = box_program(log_dir, self.air, **changes)
        self._changed = News()
        loop = asyncio.get_event_loop()
        self.client = InProcessClient(self.program.door, loop, loop, self._changed.set, "referee")
        self.door_file = os.path.join(str(log_dir), "door.json")
        self.asked = False
        self._behaviour = DummyOptions(prepare_duration=0.05, execute_duration=execute_s, seed=1)

    async def __aenter__(self):
        self.client.start()
        await self.program.start(self.door_file)
        self.program.keep(dummy_client(
            TEAM, "PASSWORD", options=self._behaviour, rsbb_host=LOOPBACK_BROADCAST, bind_host="127.0.0.2",
            make_peer=self.air.peer).run())
        return self

    async def __aexit__(self, *error):
        self.program.close()

    @property
    def zone(self):
        return self.client.document.zones[ZONE]

    async def until(self, condition):
        """Wait until a condition holds for the zone."""
        await self._changed.until(lambda: condition(self.zone))

    async def ask(self, name, **arguments):
        """Make a call; returns its answer, and why it was refused."""
        call = self.client.call(name, **arguments)
        answer = await asyncio.wait_for(asyncio.wrap_future(call), LIMIT_S)
        return answer.answer, "; ".join(map(str, answer.reasons))

    async def act(self, action, **given):
        _, refused = await self.ask("act", action=action, zone=ZONE, run=self.zone.identity, given=given, by="Ann")
        assert not refused

    async def choose(self, code):
        """Go to the next event with this benchmark."""
        while self.zone.event.code != code:
            await self.act("next")

    async def begin(self):
        """Connect and start."""
        await self.until(lambda zone: zone.is_on("connect"))
        await self.act("connect")
        await self.until(lambda zone: zone.is_on("start"))
        await self.act("start")
        await self.until(lambda zone: zone.phase == RUNNING)


def test_a_task_benchmark_from_the_start_to_its_score(tmp_path):
    async def play():
        async with Demonstration(tmp_path) as demo:
            await demo.begin()
            await demo.until(lambda zone: zone.phase == ENDED)
            item = demo.zone.items[0]
            await demo.act("mark", group=item.group, desc=item.desc, value=1, role="referee", id="1")
            await demo.until(lambda zone: zone.items[0].value == 1)
            await demo.act("disconnect")
            await demo.until(lambda zone: zone.phase == IDLE)
            return list(demo.client.document.results.values())
    results = asyncio.run(play())
    assert [(result.code, result.end_reason) for result in results] == [("HGTKMH", "completed")]
    assert len(list(tmp_path.glob("*.bag"))) == 1


def test_clients_are_sent_what_a_robot_does_before_the_next_look(tmp_path, monkeypatch):
    monkeypatch.setattr(program, "PERIOD_S", LIMIT_S)
    monkeypatch.setattr(door, "SIGN_S", LIMIT_S)

    async def play():
        async with Demonstration(tmp_path) as demo:
            await asyncio.wait_for(demo.begin(), LIMIT_S / 2)
    asyncio.run(play())


def test_a_functionality_benchmark_is_driven_and_scored_by_its_module(tmp_path):
    async def play():
        async with Demonstration(tmp_path) as demo:
            await demo.choose("HNF")
            await demo.begin()
            while demo.zone.phase == RUNNING:
                await demo.until(lambda zone: zone.phase == ENDED or zone.operation)
                if demo.zone.operation:
                    number = demo.zone.operation
                    await demo.act("operation")
                    await demo.until(lambda zone, number=number: zone.operation != number)
            return demo.zone
    zone = asyncio.run(play())
    assert zone.end_reason == "completed"
    assert {score.desc: score.value for score in zone.module_scores}["Waypoints reached"] == "3"


def test_modules_have_a_process_once_a_functionality_benchmark_is_scheduled(tmp_path):
    def schedule(code):
        event = f"{{benchmark: {code}, team: {TEAM}, round: 1, run: 1, scheduled_time: 2026-01-01 00:00:00}}"
        (tmp_path / "schedule.yaml").write_text(f"- zone: {ZONE}\n  schedule: [{event}]\n", "utf-8")

    async def play():
        async with Demonstration(tmp_path, schedule_file=str(tmp_path / "schedule.yaml")) as demo:
            assert not demo.program._modules._is_started
            schedule("HNF")
            listed, _ = await demo.ask("reload")
            done, _ = await demo.ask("reload", digest=listed["digest"], by="Ann")
            assert done["applied"] and demo.program._modules._is_started
            await demo.until(lambda zone: zone.event.code == "HNF")
            await demo.begin()  # a module drives it
    schedule("HGTKMH")
    asyncio.run(play())


def test_two_events_are_swapped_while_the_box_is_off(tmp_path):
    async def shown(codes, action=""):
        events = ", ".join(f"{{id: {code}, benchmark: {code}, team: {TEAM}, round: 1, run: 1, "
                           f"scheduled_time: 2026-01-01 {hour:02}:00:00}}" for hour, code in enumerate(codes))
        (tmp_path / "schedule.yaml").write_text(f"- zone: {ZONE}\n  schedule: [{events}]\n", "utf-8")
        async with Demonstration(tmp_path, schedule_file=str(tmp_path / "schedule.yaml")) as demo:
            if action:
                await demo.act(action)
            await demo.until(lambda zone: not action or zone.event.code != codes[0])
            return demo.zone.event.code
    before, after = ("HGTKMH", "HWV", "HCFGAC"), ("HGTKMH", "HCFGAC", "HWV")
    starts = (before, "next"), (before,), (after,), (after,)
    assert [asyncio.run(shown(*start)) for start in starts] == ["HWV", "HWV", "HCFGAC", "HCFGAC"]
    assert asyncio.run(shown(("HGTKMH", "HCFGAC", "STB", "HWV"))) == "HCFGAC"


def test_a_run_continues_with_the_next_start(tmp_path):
    async def play(demo):
        async with demo:
            await demo.begin()
            await demo.until(lambda zone: zone.robot.robot_state == "EXECUTING")
            return demo.zone

    async def continued(before):
        async with Demonstration(tmp_path) as demo:
            assert (demo.zone.phase, demo.zone.identity) == (RUNNING, before.identity)
            await demo.until(lambda zone: zone.robot.heard)
            await demo.act("stop")
            await demo.until(lambda zone: zone.phase == ENDED)
            assert demo.zone.robot.port == before.robot.port

    async def first():
        return await play(Demonstration(tmp_path, execute_s=1000.0))
    asyncio.run(continued(asyncio.run(first())))


def test_the_door_is_open_for_programs_and_its_file_goes_with_the_box(tmp_path):
    async def play():
        async with Demonstration(tmp_path) as demo:
            return demo.door_file, read_place(demo.door_file)
    path, place = asyncio.run(play())
    assert place.url.startswith("ws://127.0.0.1:") and place.token
    assert not os.path.exists(path)


def test_a_robots_command_for_a_device_is_refused_where_there_are_none(tmp_path):
    async def play():
        async with Demonstration(tmp_path) as demo:
            await demo.choose("HCFGAC")
            await demo.begin()
            await demo.until(lambda zone: "no home devices" in zone.log)
    asyncio.run(play())


def test_a_referee_operates_the_devices(tmp_path):
    async def play():
        async with Demonstration(tmp_path, devices="true", smartif_host="127.0.0.1", smartif_port="1",
                                 bell_ring_command="true") as demo:
            before, _ = await demo.ask("devices")
            for device, value in (("dimmer", 37), ("switch_2", 1), ("door_win_detect", 1), ("bell", 1)):
                assert await demo.ask("set_device", device=device, value=value) == (None, "")
            after, _ = await demo.ask("devices")
            refused = [(await demo.ask("set_device", device=device, value=value))[1]
                       for device, value in (("dimmer", 101), ("dimmer", "37"), ("oven", 1), (["dimmer"], 1))]
            return before, after, refused
    before, after, refused = asyncio.run(play())
    assert before["devices"]["dimmer"] == 0 and before["devices"]["bell"] == [0, 0]
    assert not before["connected"] and "127.0.0.1:1" in before["text"]
    seen = after["devices"]
    assert (seen["dimmer"], seen["switch_2"], seen["switch_1"], seen["door_win_detect"]) == (37, True, False, True)
    assert seen["bell"] > [0, 0]
    assert "takes 0 to 100" in refused[0]
    assert all("there is no device" in reason for reason in refused[1:])


def test_a_box_without_devices_says_so(tmp_path):
    async def play():
        async with Demonstration(tmp_path) as demo:
            return await demo.ask("devices"), await demo.ask("set_device", device="dimmer", value=1)
    assert all("start it with devices:=true" in refused for _, refused in asyncio.run(play()))


def test_a_referee_ends_the_box_but_no_run_without_being_asked(tmp_path):
    async def play():
        async with Demonstration(tmp_path, execute_s=1000.0) as demo:
            ended = asyncio.Event()
            demo.program.on_exit = ended.set
            await demo.begin()
            _, refused = await demo.ask("exit", by="Ann")
            assert not ended.is_set()
            answered = await demo.ask("exit", by="Ann", anyway=True)
            await asyncio.wait_for(ended.wait(), LIMIT_S)
            return refused, answered
    refused, answered = asyncio.run(play())
    assert refused.startswith(f"Runs in progress: {ZONE} (DummyRobot)")
    assert answered == (None, "")


def test_the_exit_of_a_box_is_a_success():
    async def work(program):
        program.on_exit()
        await asyncio.get_event_loop().create_future()
    closed = []
    assert serve(lambda loop: SimpleNamespace(close=lambda: closed.append(True)), work, 7) == 0
    assert closed == [True]


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGQUIT"])
def test_a_signal_ends_it_in_good_order(name):
    async def work(_program):
        os.kill(os.getpid(), getattr(signal, name))
        await asyncio.get_event_loop().create_future()
    closed = []
    assert serve(lambda loop: SimpleNamespace(close=lambda: closed.append(True)), work, 7) == 7
    assert closed == [True]


def test_the_journal_is_copied(tmp_path):
    async def play():
        async with Demonstration(tmp_path / "log", backup_dir=str(tmp_path / "stick")) as demo:
            await demo.begin()
            while not list((tmp_path / "stick").rglob("journal-*.log")):  # the program that copies is starting
                await asyncio.sleep(0.01)
            item = demo.zone.items[0]
            await demo.act("mark", group=item.group, desc=item.desc, value=1, role="referee", id="1")
    (tmp_path / "stick").mkdir()
    asyncio.run(play())
    written = {path.name: path.read_bytes() for path in (tmp_path / "log").rglob("journal-*.log")}
    copied = {path.name: path.read_bytes() for path in (tmp_path / "stick").rglob("journal-*.log")}
    assert written and copied == written


def test_what_cannot_be_is_said_before_anything_is_opened(tmp_path):
    async def make():
        box_program(tmp_path / "log", MemoryAir(), web_prot="1")
    with pytest.raises(BadParams, match="did you mean 'web_port'"):
        asyncio.run(make())
    assert not (tmp_path / "log").exists()


def test_other_programs_find_a_box_that_could_not_write_at_its_start(tmp_path, monkeypatch):
    monkeypatch.setattr(program, "DOOR_S", 0.01)
    places = [tmp_path / folder / "door.json" for folder in ("log", "home")]
    for place in places:
        place.mkdir(parents=True)  # as on a disk that is full

    async def play():
        demo = Demonstration(tmp_path / "log")
        demo.door_file = str(places[1])
        async with demo:
            for place in places:
                place.rmdir()
            while not all(place.exists() for place in places):
                await asyncio.sleep(0.01)
            return {read_place(str(place)).token for place in places} == {demo.program.door.token}
    assert asyncio.run(play())
    assert not any(place.exists() for place in places), "it is over"


def test_on_a_full_disk_the_door_takes_the_place_of_the_one_before(tmp_path, monkeypatch):
    def full(*_arguments):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    path = str(tmp_path / "door.json")
    write_place(path, "ws://127.0.0.1:12345/door", "of before")
    monkeypatch.setattr(durable, "write_file", full)
    write_place(path, "ws://127.0.0.1:999/door", "of now")
    assert read_place(path) == ("ws://127.0.0.1:999/door", "of now")
    for other, token in ((path, "longer" * 9), (str(tmp_path / "none"), "")):
        with pytest.raises(OSError, match="No space left"):
            write_place(other, "ws://127.0.0.1:999/door", token)
    assert read_place(path).token == "of now"


def test_terminals_are_not_led_from_one_box_to_another(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv(OWN_VARIABLE, raising=False)
    usual = str(tmp_path / ".roah_rsbb" / "door.json")
    assert door_file("log") == usual
    write_place(usual, "ws://127.0.0.1:1/door", "of a box that was killed")
    assert door_file("log") == usual

    async def play():
        async with Demonstration(tmp_path / "log") as demo:
            place = read_place(demo.door_file)
            write_place(usual, place.url, place.token)
            return door_file("other")
    assert asyncio.run(play()) == os.path.join("other", "door.json")


def test_a_rehearsal_leaves_the_folder_as_it_is(tmp_path):
    folder = tmp_path / "erl"
    with pytest.raises(SystemExit):
        new_competition([str(folder), "--teams", TEAM, "--benchmarks", "HWV", "--days", "2037-11-29"])
    (folder / "log").mkdir()
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}

    async def play(copy):
        async with Demonstration(tmp_path / "demo", folder=copy) as demo:
            edit = {"action": "shift", "given": {"zone": "Task Benchmarks", "time": "40"}, "by": "Ann"}
            looked, _ = await demo.ask("edit", **edit)
            done, refused = await demo.ask("edit", **edit, seen=looked["seen"])
            assert done["done"] and not refused
    asyncio.run(play(copied(str(folder), str(tmp_path / "demo"))))
    assert {path: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before
    assert (tmp_path / "demo" / "rehearsed" / "schedule.yaml~").exists()


def test_two_boxes_of_a_user_are_not_at_the_same_address_and_port(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))

    async def make():
        loop = asyncio.get_event_loop()
        given = {"web": "false", "tablet": "false", "rsbb_port": "17"}
        first = BoxProgram(loop, settings(str(tmp_path / "1"), **given), "")
        with pytest.raises(BadParams, match="another box of this user is at 127.0.0.1, UDP port 17: end it, or"):
            BoxProgram(loop, settings(str(tmp_path / "2"), **given), "")
        with pytest.raises(BadParams, match="another box of this user is at 0.0.0.0, UDP port 17"):
            BoxProgram(loop, settings(str(tmp_path / "2"), **given, bind_host="0.0.0.0"), "")
        BoxProgram(loop, settings(str(tmp_path / "3"), **given, bind_host="127.0.0.9"), "").close()
        other = BoxProgram(loop, settings(str(tmp_path / "2"), **{**given, "rsbb_port": "18"}), "")
        first.close()
        again = BoxProgram(loop, settings(str(tmp_path / "1"), **given), "")
        other.close()
        again.close()
    asyncio.run(make())


def test_a_log_dir_that_cannot_be_created_is_named_with_the_remedy(tmp_path):
    (tmp_path / "file").touch()

    async def make():
        box_program(tmp_path / "file" / "log", MemoryAir())
    with pytest.raises(BadParams, match="cannot be created .*: choose another folder"):
        asyncio.run(make())


def test_referees_are_warned_when_nobody_watches_the_box(tmp_path, monkeypatch):
    async def play():
        monkeypatch.setattr(program, "LOOK_S", 0.01)
        async with Demonstration(tmp_path) as demo:
            demo.program._is_supervised = True
            parent = os.getppid()
            monkeypatch.setattr(os, "getppid", lambda: parent + (1 if demo.asked else 0))
            demo.program.keep(demo.program._watch_supervisor(parent))
            await demo.until(lambda zone: demo.client.document is not None)
            demo.asked = True
            await demo.until(lambda zone: any(
                "watches this box has ended" in str(line) for line in demo.client.document.box.warnings))
    asyncio.run(play())


@pytest.mark.parametrize("module, unneeded", [
    ("box.settings", {"yaml", "asyncio"}),  # the supervisor reads the settings
    ("web.gateway", {"xml.etree.ElementTree"}),
])
def test_a_process_imports_nothing_that_it_hardly_ever_needs(module, unneeded):
    script = f"import sys, roah_rsbb.{module}; print(*sys.modules)"
    found = subprocess.run([sys.executable, "-c", script], stdout=subprocess.PIPE, check=True, text=True).stdout
    assert not unneeded & set(found.split())
