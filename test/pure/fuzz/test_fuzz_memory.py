"""Memory does not grow, however long others continue: after many rounds, a box uses as much as after a few."""

import contextlib
import gc
import tracemalloc

import pytest

from fuzzing.core import CODES, HOSTS, Play
from helpers.examples import ALL
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.views import document
from roah_rsbb.model.messages import RobotReport, TabletState
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, ScoreValue
from roah_rsbb.model.reason import Refused
from roah_rsbb.protocol import RobotState

FEW = 3
MANY = 8 if ALL else 5
# What lists and caches of Python itself take now and then.
GROWTH_BYTES = 100_000


def _round(driver, number):
    """All that anybody can send, each time with other names, addresses and texts."""
    box = driver.box
    for i in range(20):
        name = f"{number} {i}"
        driver.jump(0.5)
        for run in box.zones.members():
            texts = tuple(f"{name} {k}" for k in range(80))
            report = RobotReport(
                driver.robot().time(), i, RobotState(i % 4), texts, (name * 1000,), visitor=("v" * 20_000 + name,),
                generic_result=name * 1000, dimmer=i,
            )
            driver.event(box.arrivals.on_robot_report, run.port, HOSTS[i % len(HOSTS)], report)
            driver.event(box.arrivals.on_unreadable, run.port, f"bad {name}")
        host = f"10.{number}.{i}.1"
        driver.event(box.arrivals.on_robot_beacon, host, f"Team {name}", "r", (i, number))
        driver.event(box.arrivals.on_tablet, host, TabletState(False, (i, number), (i, number), float(i), 0.0))
        driver.event(box.arrivals.on_foreign_box, host)
        driver.event(box.arrivals.on_complaint, f"complaint {name}" * 20)
        driver.event(box.watches.trouble, f"trouble {name}" * 100)
        driver.event(box.devices.on_refused, "catering", f"device {name}", i, name)
        driver.event(box.modules.on_modules, ModulesState(f"node {name}", (ModuleInfo("HOPF", (name * 50,)),)))
        _progress(driver, name)
        with contextlib.suppress(Refused):
            driver.event(box.act, Target("visitor"), ("connect", "disconnect")[i % 2], "",
                             {"running": True} if i % 2 else {})
        document.ZoneViews(box).look(driver.now)
        document.box_status(box, driver.now)


def _progress(driver, name):
    """The modules publish a new status of their run, without a new request."""
    said = tuple(
        Progress(
            run.run, run.attempt, run.steps[-1].request, (ScoreValue("a", name, "1", "s"),), name * 100,
            (name,) * 20, name,
        )
        for run in driver.box.modules.runs() if run.steps
    )
    driver.event(driver.box.modules.on_modules, ModulesState("n1", tuple(ModuleInfo(code) for code in CODES), said))


def _held_after(driver, rounds):
    for number in rounds:
        _round(driver, number)
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


@pytest.mark.random
def test_a_box_holds_no_more_after_many_rounds_than_after_a_few():
    driver = Play(b"").driver
    tracemalloc.start()
    try:
        few = _held_after(driver, range(FEW))
        many = _held_after(driver, range(FEW, MANY))
    finally:
        tracemalloc.stop()
    assert many - few < GROWTH_BYTES
