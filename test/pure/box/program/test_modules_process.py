"""Rules in a process of their own: whatever they do, the box's loop continues, and the next process follows."""

import asyncio
import errno
import logging
import shutil

import pytest

from roah_rsbb.box.program import modules_process
from roah_rsbb.box.program.modules_process import OWN_NODE, ModulesProcess, modules_command
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.model.modules import ModulesState, RunForModule

LIMIT_S = 60.0
RULES = """
import logging, os, re, sys, time
from roah_rsbb.bmbox.hnf import HNF


class Rules(HNF):
    async def execute(self):
        print("from the rules")  # disturbs nothing
        EVIL
"""
# No signal ends it, and no other thread runs meanwhile.
HANG = "logging.error('hang now'); re.match('(a+)+$', 'a' * 60 + 'b')"


class Hosted:
    """The process, and what it sent."""

    def __init__(self, folder):
        self.states = []
        command = modules_command(str(folder), ["HNF"], True)
        self.process = ModulesProcess(asyncio.get_event_loop(), command, self.states.append)

    async def until(self, condition):
        async def wait():
            while not condition():
                await asyncio.sleep(0.02)
        await asyncio.wait_for(wait(), LIMIT_S)

    @property
    def nodes(self):
        """The identities of the processes, in their order."""
        return list(dict.fromkeys(state.node for state in self.states))

    async def __aenter__(self):
        self.process.start()
        await self.until(lambda: any(state.modules for state in self.states))
        return self

    async def __aexit__(self, *error):
        self.process.close()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(modules_process, "PAUSE_S", 0.0)
    shutil.copytree(str(shipped_folder() / "modules"), str(tmp_path / "modules"))
    return tmp_path / "modules"


def a_run(running=True):
    return RunForModule("HNF-1", 1, "Home", "HNF", "A", 1, 1, running)


def test_it_drives_runs_and_its_log_is_that_of_the_box(folder, caplog):
    async def play():
        async with Hosted(folder) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: hosted.states[-1].progress)
            return hosted.states[-1].progress[0]
    with caplog.at_level(logging.INFO):
        progress = asyncio.run(play())
    assert progress.run == "HNF-1" and progress.request is not None
    assert any("Running modules HNF" in record.getMessage() for record in caplog.records)


def with_rules(folder, evil):
    (folder / "HNF.py").write_text(RULES.replace("EVIL", evil), "utf-8")
    return folder


@pytest.mark.parametrize("end", [
    "os._exit(3)",
    pytest.param("os.fork() or time.sleep(1000); os._exit(3)", id="fork"),  # its child has the process's pipes, too
])
def test_after_rules_that_end_their_process_the_next_one_gets_the_runs(folder, caplog, monkeypatch, end):
    once = "os.path.exists('ended') or (open('ended', 'w').close(), END); await self.referee('go')"
    monkeypatch.chdir(folder)

    async def play():
        async with Hosted(with_rules(folder, once.replace("END", f"exec({end!r}, globals())"))) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: any(one.request for one in hosted.states[-1].progress))
    asyncio.run(play())
    assert "The rules of HNF in zone Home end their process with status 3" in caplog.text


def test_rules_that_end_their_process_at_import_are_named_and_left_out_until_they_change(folder, caplog):
    rules = folder / "HNF.py"
    rules.write_text("import os\nos._exit(4)\n")

    def problems(hosted):
        return [problem for state in hosted.states[-1:] for info in state.modules for problem in info.problems]

    async def play():
        async with Hosted(folder) as hosted:
            assert len(list(filter(None, hosted.nodes))) == 1, "the next process left the file out"
            (problem,) = problems(hosted)
            assert str(rules) in problem and "while they are loaded" in problem
            with_rules(folder, "await self.referee('go')")
            await hosted.until(lambda: not problems(hosted))
            hosted.process.take([a_run()])
            await hosted.until(lambda: any(one.request for one in hosted.states[-1].progress))
    asyncio.run(play())
    assert f"The rules in {rules} end their process with status 4 while they are loaded" in caplog.text


def test_whoever_ends_the_process_from_outside_blames_no_rules(folder, caplog):
    async def play():
        async with Hosted(with_rules(folder, "os.kill(os.getpid(), 9)")) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: len(hosted.nodes) >= 4)  # it got the run again, and was killed again
            assert OWN_NODE not in hosted.nodes
    asyncio.run(play())
    assert "The process of the benchmarking modules has ended (-9)" in caplog.text


def test_rules_that_crash_again_end_their_run(folder, caplog):
    async def play():
        async with Hosted(with_rules(folder, "import ctypes; ctypes.string_at(0)")) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: OWN_NODE in hosted.nodes)
            return next(state for state in hosted.states if state.node == OWN_NODE).progress
    assert [one.failed for one in asyncio.run(play())] == ["its rules end their process (HNF.py, line 9, execute)"]


@pytest.mark.parametrize("missing", ["folder", "files"])
def test_on_a_full_disk_modules_run_without_traces(folder, monkeypatch, tmp_path, missing):
    def full(**named):
        if missing == "folder":
            raise FileNotFoundError(errno.ENOENT, "No usable temporary directory")
        return str(tmp_path / "none")
    monkeypatch.setattr(modules_process.tempfile, "mkdtemp", full)

    async def play():
        async with Hosted(folder) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: hosted.states[-1].progress)
    asyncio.run(play())


@pytest.mark.parametrize("evil", ["while True: pass", HANG])
def test_rules_that_do_not_answer_are_replaced(folder, caplog, evil):
    async def play():
        async with Hosted(with_rules(folder, evil)) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: "do not answer" in caplog.text)
            hung, count = hosted.nodes[-1], len(hosted.states)
            hosted.process.take([])  # the referee leaves the run
            await hosted.until(lambda: hosted.states[-1].node != hung and len(hosted.states) > count + 2)
            assert ModulesState(hung, (), ()) in hosted.states, "the box knows at once that it is gone"
    asyncio.run(play())
    assert "The rules of HNF in zone Home do not answer (HNF.py, line 9, " in caplog.text


def test_a_run_whose_rules_hang_again_is_ended_because_others_wait(folder, caplog):
    other = RunForModule("HNF-2", 1, "Hall", "HNF", "B", 1, 1, True)
    hang = HANG.replace("; ", "\n            ")
    evil = f"if self.run.zone == 'Home':\n            {hang}\n        await self.referee('go')"

    async def play():
        async with Hosted(with_rules(folder, evil)) as hosted:
            hosted.process.take([other, a_run()])
            await hosted.until(lambda: any(state.node == OWN_NODE for state in hosted.states))
            (failed,) = next(state for state in hosted.states if state.node == OWN_NODE).progress
            hosted.process.take([other, a_run(running=False)])
            await hosted.until(lambda: hosted.states[-1].node != OWN_NODE and any(
                one.run == "HNF-2" and one.request is not None for one in hosted.states[-1].progress))
            return failed
    failed = asyncio.run(play())
    assert (failed.run, failed.attempt) == ("HNF-1", 1)
    assert failed.failed.startswith("its rules do not answer (HNF.py, line ")


def test_rules_that_read_the_input_take_nothing_from_the_box(folder):
    async def play():
        async with Hosted(with_rules(folder, "await self.referee(sys.stdin.read() or 'nothing')")) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: hosted.states[-1].progress)
            return hosted.states[-1].progress[0]
    assert "nothing" in str(asyncio.run(play()).request)


def test_a_computer_without_room_for_a_process_is_tried_again(folder, caplog, monkeypatch):
    full, opened = ["full"], modules_process.subprocess.Popen

    def popen(*arguments, **named):
        if full:
            raise OSError(errno.EAGAIN, full.pop())
        return opened(*arguments, **named)
    monkeypatch.setattr(modules_process.subprocess, "Popen", popen)

    async def play():
        async with Hosted(folder):
            pass
    asyncio.run(play())
    assert "cannot be started" in caplog.text


def test_the_box_ends_although_rules_hang(folder, caplog):
    async def play():
        async with Hosted(with_rules(folder, HANG)) as hosted:
            hosted.process.take([a_run()])
            await hosted.until(lambda: "hang now" in caplog.text)
            return hosted.process._process
    assert asyncio.run(play()).wait(LIMIT_S) is not None
