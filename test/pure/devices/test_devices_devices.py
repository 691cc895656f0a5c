"""The home devices of a program, with the dummy controller on loopback; and their file in log_dir."""

import asyncio
import json
import logging
import queue
import threading
import time

import pytest

from helpers.waiting import News
from roah_rsbb.devices.devices import FILE, HomeDevices, open_settings
from roah_rsbb.devices.dummy_server import DummyServer
from roah_rsbb.devices.smartif import BadSetting, Home, devices_state
from roah_rsbb.model.messages import DevicesState

LIMIT_S = 10


class Program:
    """A program with home devices and the dummy controller. Every event wakes `until`."""

    def __init__(self, saved=None, save=None):
        self.saved = queue.Queue()
        self.states, self.statuses, self.reports, self.rings = [], [], [], 0
        self._given, self._save = saved, save or self.saved.put
        self._news = News()

    async def open(self):
        self.server = DummyServer("127.0.0.1", 0, lambda text: self._take(self.reports.append, text))
        await self.server.open()
        self.devices = HomeDevices(
            asyncio.get_event_loop(), "127.0.0.1", self.server.port,
            on_state=lambda home: self._take(self.states.append, devices_state(home)), on_bell=self._on_bell,
            on_status=lambda connected, text: self._take(self.statuses.append, (connected, text)),
            saved=self._given, save=self._save)

    async def until(self, condition, what):
        await self._news.until(condition, lambda: f"{what}; {self.states}, {self.statuses}, {self.reports}")

    async def until_connected(self):
        await self.until(lambda: self.statuses[-1][0] and any("blinds is set to" in text for text in self.reports),
                         "it is connected")

    def _on_bell(self):
        self.rings += 1
        self._news.set()

    def _take(self, add, value):
        add(value)
        self._news.set()


def played(script, **options):
    """Run a coroutine function with a program that has not started; returns the program when it has closed."""
    async def run():
        program = Program(**options)
        await program.open()
        try:
            await script(program)
        finally:
            program.devices.close()
            await program.until(lambda: program.server._client is None, "the controller is free")
            program.server.close()
        return program
    return asyncio.run(run())


def test_states_and_statuses_from_the_start_to_the_connection():
    async def script(program):
        program.devices.start()
        where = f"the SmartIF controller at 127.0.0.1:{program.server.port}"
        assert (program.states, program.statuses) == ([DevicesState()], [(False, f"connecting to {where}")])
        await program.until_connected()
        assert program.statuses[1:] == [(True, f"connected to {where}")]
    assert played(script).saved.empty(), "nothing has changed"


def test_a_setting_reaches_the_controller_the_program_and_what_is_saved():
    async def script(program):
        program.devices.start()
        await program.until_connected()
        for device, value in (("dimmer", 40), ("switch_2", 1)):
            program.devices.set(device, value)
        program.devices.set_door(True)
        assert program.states[1:] == [
            DevicesState(dimmer=40), DevicesState(dimmer=40, switch_2=True),
            DevicesState(dimmer=40, switch_2=True, door_win_detect=True)]
        assert program.states[-1].switch_2 is True
        await program.until(lambda: program.reports[-1] == "switch_2 is set to 1", "the controller has both")
        assert program.reports[-2] == "dimmer is set to 40"
    program = played(script)
    home = Home()
    while devices_state(home) != program.states[-1]:
        assert home.restore(program.saved.get(timeout=LIMIT_S))


def test_a_wrong_setting_is_refused_and_changes_nothing():
    async def script(program):
        program.devices.start()
        with pytest.raises(BadSetting, match="dimmer cannot be set to 101: it takes 0 to 100 per cent"):
            program.devices.set("dimmer", 101)
        assert len(program.states) == 1
    assert played(script).saved.empty()


def test_a_ring_of_the_controller_and_one_by_hand():
    async def script(program):
        program.devices.start()
        await program.until_connected()
        before = time.time_ns()
        program.server.ring()
        await program.until(lambda: program.rings == 1, "the ring")
        program.devices.ring()
        assert program.rings == 2
        first, second = (sec * 10**9 + nsec for sec, nsec in (state.bell for state in program.states[1:]))
        assert before <= first <= second <= time.time_ns()
    played(script)


def test_without_a_connection_a_setting_waits_and_is_a_warning(caplog):
    async def script(program):
        program.devices.set("blinds", 30)
        assert "blinds is set to 30, which the controller receives when it is connected" in caplog.text
        program.devices.start()
        await program.until(lambda: "blinds is set to 30" in program.reports, "it is sent")
        await program.until_connected()
        caplog.clear()
        program.devices.set("blinds", 31)
        assert caplog.text == ""
    played(script)


def test_another_program_continues_with_what_was_saved():
    home = Home()
    home.set("blinds", 35)
    home.bell, home.door = (7, 8), True

    async def script(program):
        program.devices.start()
        await program.until(lambda: "blinds is set to 35" in program.reports, "it is sent again")
    program = played(script, saved=json.loads(json.dumps(home.saved())))
    assert program.states == [DevicesState(bell=(7, 8), blinds=35, door_win_detect=True)]


def test_a_closed_program_leaves_the_controller_to_another():
    async def script(program):
        program.devices.start()
        await program.until_connected()
        program.devices.close()
        await program.until(lambda: program.reports[-1].endswith("(it closed the connection)") or
                            "the connection broke" in program.reports[-1], "it has left")
    played(script)


def test_slow_saving_delays_nothing_and_keeps_the_newest():
    begun, gate, saved = threading.Semaphore(0), threading.Event(), queue.Queue()

    def save(values):
        assert threading.current_thread() is not threading.main_thread()
        begun.release()
        assert gate.wait(LIMIT_S)
        saved.put(values["values"]["dimmer"])

    async def script(program):
        program.devices.set("dimmer", 1)
        assert begun.acquire(timeout=LIMIT_S)
        for value in range(2, 100):
            program.devices.set("dimmer", value)
        assert program.states[-1].dimmer == 99
        assert saved.empty()
    program = played(script, save=save)
    gate.set()
    program.devices._saver.shutdown(wait=True)
    assert list(saved.queue) == [1, 99]


def test_values_that_cannot_be_saved_are_one_warning_until_they_can(caplog):
    done, fails = queue.Queue(), [True, True, False, True]

    def save(values):
        done.put(values)
        if fails.pop(0):
            raise OSError("the disk is full")

    async def script(program):
        for value in range(1, 5):
            program.devices.set("dimmer", value)
            done.get(timeout=LIMIT_S)
    program = played(script, save=save)
    program.devices._saver.shutdown(wait=True)
    warnings = [record.getMessage() for record in caplog.records if "saved" in record.getMessage()]
    assert warnings == ["the settings of the home devices cannot be saved for a restart: the disk is full"] * 2


def test_settings_are_kept_in_a_file(tmp_path):
    folder = str(tmp_path / "log")
    saved, save = open_settings(folder)
    assert saved is None
    home = Home()
    home.set("dimmer", 70)
    save(home.saved())
    saved, _ = open_settings(folder)
    other = Home()
    assert other.restore(saved)
    assert other.values == home.values
    assert [path.name for path in (tmp_path / "log").iterdir()] == [FILE]


def test_another_launch_starts_with_all_devices_off(tmp_path):
    home = Home()
    home.set("dimmer", 70)
    saved, save = open_settings(str(tmp_path), "first")
    assert saved is None
    save(home.saved())
    again = Home()
    assert again.restore(open_settings(str(tmp_path), "first")[0])
    assert again.values == home.values
    assert open_settings(str(tmp_path), "second")[0] is None


@pytest.mark.parametrize("content", [
    "", "{", "[]", "5", '{"values": {"dimmer": 101}, "bell": ["0", "0"], "door": false}'])
def test_a_damaged_file_is_moved_aside(tmp_path, caplog, content):
    (tmp_path / FILE).write_text(content)
    saved, save = open_settings(str(tmp_path))
    assert saved is None
    assert f"cannot read {tmp_path / FILE}" in caplog.text
    assert "every device is off" in caplog.text
    assert [record.levelno for record in caplog.records] == [logging.WARNING]
    assert (tmp_path / f"{FILE}.damaged").read_text() == content
    save(Home().saved())
    assert open_settings(str(tmp_path))[0] == Home().saved()
