#!/usr/bin/python3
"""Measures the box: reaction, load, panels, growth. See bench/README.md; `make bench` runs it.

Prints a table and writes build/bench.json. With --strict, a missed target gives exit status 1.
"""

import argparse
import contextlib
import os
import pathlib
import pstats
import sys
import tempfile
import time
import unittest
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple
from urllib.parse import urlparse

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT / "test" / "ros"), str(ROOT / "test" / "pure")]

import beside  # noqa: E402
import comm_nodes  # noqa: E402
import copying  # noqa: E402
import flood  # noqa: E402
import floods  # noqa: E402
import followers  # noqa: E402
import frozen  # noqa: E402
import gateway  # noqa: E402
import journal_speed  # noqa: E402
import load  # noqa: E402
import pages  # noqa: E402
import processes  # noqa: E402
import reaction  # noqa: E402
import results_speed  # noqa: E402
import resume  # noqa: E402
import rosgraph  # noqa: E402
import rospy  # noqa: E402
import takeover  # noqa: E402
import without_ros  # noqa: E402
from addresses import BOX_HOST, host_of  # noqa: E402
from fleet import REGULAR_S, Fleet  # noqa: E402
from processes import Box, wait  # noqa: E402
from table import Results, quantile  # noqa: E402

from roah_rsbb.client.client import Client  # noqa: E402
from roah_rsbb.client.places import DoorPlaces  # noqa: E402
from roah_rsbb.model.document import Document  # noqa: E402
from roah_rsbb.ros import connections  # noqa: E402
from roah_rsbb.srv import Zone  # noqa: E402

WINDOW_ZONES = 20
RESUMED, MANY_RESUMED, MOST_RESUMED = 10, 44, 100
MANY_VIEWERS = 200
REPEATING = 40  # robots
WARM_S = 2.0  # until a box that was started has done all that it does once
# How many times the bare loop's load the core's may be, without and with a subscriber, by the robots' period (s).
REPEAT_TARGETS = {load.ORIGINAL_PERIOD_S: (1.25, 1.4), load.PERIOD_S: (1.2, 1.2)}
START_RUNS = 500
FEW_RUNS = 100
# Clients of the door, and phones.
LOOKED_AT = ((0, 0), (1, 0), (5, 0), (5, 20))
# The core's share of a processor (per cent), by zones and by what is there.
CORE_TARGETS = {(1, "no run"): 1, (40, "in runs"): 12}
RESULTS_TARGETS = {"list": 0.5, "show": 0.5, "standings": 2.0}


class Extent(NamedTuple):
    """Extent of the measurements."""

    probes: int
    starts: int
    clicks: int
    kills: int
    takeovers: int  # of each kind
    seconds: float  # for each load
    idle_seconds: float
    runs: int  # in the journal of results
    reported_runs: int
    flood_rounds: int  # of each kind
    run_seconds: float  # until a core is killed among many runs
    journal_bytes: int  # when it is killed among most runs: of 60 minutes


QUICK = Extent(probes=36, starts=12, clicks=5, kills=2, takeovers=1, seconds=2.0, idle_seconds=2.0, runs=200,
               reported_runs=50, flood_rounds=2, run_seconds=10.0,
               journal_bytes=20_000_000)
FULL = Extent(probes=300, starts=100, clicks=40, kills=10, takeovers=5, seconds=15.0, idle_seconds=10.0, runs=10_000,
              reported_runs=1000, flood_rounds=5, run_seconds=180.0,
              journal_bytes=67_000_000)


class Bench:
    """All measurements, each with its own box."""

    def __init__(self, extent: Extent, soak_minutes: float) -> None:
        self.extent = extent
        self.soak_minutes = soak_minutes
        self.results = Results()

    # -- one robot ----------------------------------------------------------------------------------

    def one(self) -> None:
        """Reaction, start, click, and the load of one robot."""
        extent, results = self.extent, self.results
        with box_in_runs(1, idle=self._idle) as (box, fleet):
            robot = fleet.robots[0]
            taken = reaction.react(fleet, [robot], extent.probes)
            results.add_spread("reaction, 1 robot", "ms", taken, {0.5: 2, 0.99: 10})
            self._settle(fleet)
            taken = reaction.starts(fleet, robot, lambda word: box.command(word, 0), extent.starts)
            results.add_spread("/core/start to PREPARE on the wire", "ms", taken, {0.99: 10})
            self._settle(fleet)
            self._click(fleet)
            self._settle(fleet)
            self._load("1 robot, original's pace", box, fleet, load.ORIGINAL_PERIOD_S, cpu_target=3)
            self._load("1 robot, 50 ms", box, fleet)

    def _click(self, fleet: Fleet) -> None:
        import panels  # gives this process a display, so import it only when needed

        with tempfile.TemporaryDirectory() as folder:
            bench = panels.ClickBench(folder)
            try:
                starts, stops = bench.measure(fleet, fleet.robots[0], self.extent.clicks)
            finally:
                bench.close()
        self.results.add_spread("click on START to PREPARE on the wire", "ms", starts, {})
        self.results.add_spread("click on STOP to STOP on the wire", "ms", stops, {})

    # -- restart ------------------------------------------------------------------------------------

    def resume(self) -> None:
        """From kill -9 of the core to the last robot's channel."""
        for kind, robots, seconds, size in (
                (processes.LaunchedBox, RESUMED, 0.0, 0),
                (processes.LaunchedBox, MANY_RESUMED, self.extent.run_seconds, 0),
                (resume.SupervisedBox, MANY_RESUMED, self.extent.run_seconds, 0),
                (resume.SupervisedBox, MOST_RESUMED, 0.0, self.extent.journal_bytes)):
            with kind(robots) as box, Fleet(robots, box.port) as fleet:
                reaction.connect(box, fleet, robots)
                reaction.start(box, fleet, robots)
                time.sleep(seconds)
                if size:
                    resume.fill(box, fleet, size)
                taken = resume.kills(box, fleet, self.extent.kills)
            has_ros = kind is processes.LaunchedBox
            name = (f"kill -9 {'with' if has_ros else 'without'} ROS, {robots} robots, "
                    f"{f'{size / 1e6:g} MB' if size else f'{seconds:g} s'}: all served")
            self.results.add(f"{name}, median", "s", quantile([one.after_kill for one in taken], 0.5), 2)
            self.results.add(f"{name}, longest", "s", max(one.after_kill for one in taken), 3)
            self.results.add(f"{name}, from the process's start", "s",
                             quantile([one.after_start for one in taken], 0.5), 2 if size else 1)
            self.results.add(f"{name}, times import rospy", "",
                             quantile([one.after_start / one.import_rospy for one in taken], 0.5))

    def hung(self) -> None:
        """From the stop of the core (SIGSTOP), in each of 12 phases of a run, to the next core."""
        os.environ["ROAH_TEST_ALL"] = "yes"
        from core.test_hung import TestHungCore  # reads that

        done = unittest.TextTestRunner(verbosity=0).run(unittest.defaultTestLoader.loadTestsFromTestCase(TestHungCore))
        if not done.wasSuccessful():  # something that was acknowledged is lost, too
            raise SystemExit("bench: a core that hung was not replaced as it should be: see above")
        taken = TestHungCore.took_s
        for phase, seconds in taken.items():
            self.results.add(f"core stopped, {phase}: next core heard after", "s", seconds, 6)
        self.results.add("core stopped: next core heard after, median", "s", quantile(list(taken.values()), 0.5))

    def takeover(self) -> None:
        """From the loss of the box's computer to the last robot's channel with the standby."""
        takeover.measure(self.results, self.extent.takeovers, RESUMED)

    # -- many robots --------------------------------------------------------------------------------

    def hundred(self) -> None:
        """Load, reaction and a longer load with 100 robots."""
        with box_in_runs(100, idle=self._idle) as (box, fleet):
            self._load("100 robots, 50 ms", box, fleet, cpu_target=16, memory_target=150)
            fleet.keep_sending(load.PERIOD_S)
            waited, began = box.process.waited_s(), time.monotonic()
            taken = reaction.react(fleet, fleet.robots, self.extent.probes)
            waited = 100.0 * (box.process.waited_s() - waited) / (time.monotonic() - began)
            fleet.keep_sending(REGULAR_S)
            self.results.add_spread("reaction, 100 robots at 50 ms", "ms", taken, {0.99: 25})
            self.results.add("reaction, 100 robots: waited for a core that others used", "% of the time", waited)
            if self.soak_minutes:
                self._soak(box, fleet)

    def repeats(self) -> None:
        """The core in turns with a bare loop that only receives, decrypts, parses and answers once a second."""
        results, seconds = self.results, self.extent.seconds
        with box_in_runs(REPEATING, idle=self._unfollowed) as (box, fleet):
            memory = box.process.memory_mb()
            dropped = box.dropped()
            for period_s, found in beside.compare(box, fleet, tuple(REPEAT_TARGETS), seconds).items():
                name = f"{REPEATING} robots, {1.0 / period_s:g}/s each"
                results.add(f"{name}: CPU of the bare loop", "% of a core", quantile(found.bare, 0.5))
                for how, values, target in zip(("", ", with a subscriber"), (found.core, found.followed),
                                               REPEAT_TARGETS[period_s]):
                    results.add(f"{name}{how}: CPU", "% of a core", quantile(values, 0.5))
                    results.add(f"{name}{how}: as much as the bare loop", "times", found.ratio(values), target)
            results.add(f"{REPEATING} robots: memory grown", "MB", box.process.memory_mb() - memory, 5)
            results.add(f"{REPEATING} robots: lost in the box", "datagrams", box.dropped() - dropped, 0)
            fleet.keep_sending(load.PERIOD_S)
            taken = reaction.react(fleet, fleet.robots, self.extent.probes)
            results.add_spread(f"reaction, {REPEATING} robots at 50 ms", "ms", taken, {0.99: 5})

    def without_ros(self) -> None:
        """The box without ROS in turns with the nodes of the one with ROS: load, memory, start, reaction."""
        results, seconds = self.results, self.extent.seconds
        with without_ros.both_in_runs(REPEATING) as sides:
            for period_s in REPEAT_TARGETS:
                found = without_ros.shares(sides, period_s, seconds)
                name = f"{REPEATING} robots, {1.0 / period_s:g}/s each"
                results.add(f"{name}: CPU of core, pages and modules", "% of a core", quantile(found.node, 0.5))
                results.add(f"{name}: CPU of the box without ROS", "% of a core", quantile(found.without, 0.5))
                # Nearly all of it is the core's work for datagrams, which is the same in both.
                results.add(f"{name}: without ROS as much as with", "times", found.ratio, 1.0)
            for (box, fleet), what in zip(sides, ("box with ROS", "box without ROS")):
                fleet.keep_sending(load.PERIOD_S)
                taken = reaction.react(fleet, fleet.robots, self.extent.probes)
                fleet.keep_sending(REGULAR_S)
                results.add_spread(f"reaction, {REPEATING} robots at 50 ms, {what}", "ms", taken, {0.99: 5})
                results.add(f"{REPEATING} robots: memory of the {what}", "MB",
                            sum(process.memory_mb() for process in box.processes))
        with without_ros.BoxWithoutRos(1) as box:
            time.sleep(WARM_S)
            results.add("box without ROS: memory", "MB", box.process.memory_mb(), 60)
        taken_s = [without_ros.first_beacon_s() for _ in range(self.extent.kills)]
        results.add("box without ROS: start to the first beacon, median", "s", quantile(taken_s, 0.5), 0.6)

    def _unfollowed(self, box: Box) -> None:
        """Cost of robots without runs, without a subscriber."""
        time.sleep(1.5)  # until the box has heard all robots
        self.results.add(f"no run, {box.zones} zones and robots, no subscriber: CPU", "% of a core",
                         box.process.cpu_percent(self.extent.idle_seconds), 1.8)

    def _soak(self, box: Box, fleet: Fleet) -> None:
        parts = [load.measure(box, fleet, self.soak_minutes * 30.0) for _ in range(2)]
        name = f"100 robots for {self.soak_minutes:g} min"
        self.results.add(f"{name}: memory grown", "MB", sum(part.grown_mb for part in parts), 5)
        self.results.add(f"{name}: lost in the box", "datagrams", sum(part.lost for part in parts), 0)
        for label, part in zip(("first", "second"), parts):
            self.results.add(f"{name}: tick jitter, 99 %, {label} half", "ms", quantile(part.jitter_ms, 0.99))

    def _load(self, name: str, box: Box, fleet: Fleet, period_s=load.PERIOD_S, cpu_target=None,
              memory_target=None) -> None:
        measured = load.measure(box, fleet, self.extent.seconds, period_s)
        if not load.still_executing(fleet):
            raise SystemExit(f"bench: {name}: not all runs continued:\n{box.process.text[-2000:]}")
        load.add(self.results, name, measured, cpu_target, memory_target)

    @staticmethod
    def _settle(fleet: Fleet) -> None:
        """Wait until robots follow the box's states again."""
        wait(lambda: load.still_executing(fleet), "all robots execute")

    # -- hostile senders ----------------------------------------------------------------------------

    def hostile(self) -> None:
        """Reaction of one run while another run's channel is flooded."""
        for kind, rate in flood.ON_CHANNEL.items():
            with box_in_runs(2) as (box, fleet):
                robot, other = fleet.robots
                memory = box.process.memory_mb()
                with floods.flood(kind, BOX_HOST, other.port, "password 1", host_of(1)):
                    taken = reaction.react(fleet, [robot], self.extent.probes)
                name = f"reaction, {rate}/s of {kind} on another run's channel"
                self.results.add_spread(name, "ms", taken, {0.5: 25})
                self.results.add(f"{name}: memory grown", "MB", box.process.memory_mb() - memory, 30)

    def frozen(self) -> None:
        """STOP beside a disk that hangs. Needs root."""
        with frozen.BoxOnADisk(REPEATING) as box, Fleet(REPEATING, box.port) as fleet:
            reaction.connect(box, fleet, REPEATING)
            reaction.start(box, fleet, REPEATING)
            frozen.measure(self.results, box, fleet, self.extent.flood_rounds)

    def floods(self) -> None:
        """STOP beside floods of datagrams, calls and connections, as ratio to the idle machine."""
        rounds, zones = self.extent.flood_rounds, 2 * floods.STOPPED
        with Box(zones, has_pages=True) as box, Fleet(zones, box.port) as fleet:
            reaction.connect(box, fleet, zones)
            stopped, stop = floods.Stopped(box, fleet), rospy.ServiceProxy("/core/stop", Zone)
            client = Client(Document, DoorPlaces().find)
            client.start()
            client.wait(lambda document: True, 30.0)
            door = urlparse(DoorPlaces().find().url).port
            master = rosgraph.Master(rospy.get_name())
            ports = {name: urlparse(uri).port for name, uri in (
                ("calls", master.lookupService("/core/set_score")), ("stop", master.lookupService("/core/stop")),
                ("api", master.lookupNode(processes.CORE)))}

            def measure(name: str, call: Callable[[int], None], kind: str, *arguments: object) -> None:
                floods.add(self.results, f"STOP beside {name}", stopped.rounds(rounds, call, kind, *arguments))

            def by_service(zone: int) -> None:
                stop(f"zone {zone}")

            def by_panel(zone: int) -> None:
                client.stop(f"zone {zone}", "").result()

            measure("datagrams to the public port", by_panel, "datagrams", BOX_HOST, box.port)
            measure("datagrams to the public port, by service", by_service, "datagrams", BOX_HOST, box.port)
            private = [fleet.robots[zone].port for zone in stopped.flooded]
            measure("datagrams to ten private ports", by_panel, "datagrams", BOX_HOST, *private)
            for name, call in (("", by_panel), (", by service", by_service)):
                measure(f"{flood.CALLS} calls at once{name}", call, "calls", BOX_HOST, ports["calls"],
                        *(f"zone {zone}" for zone in stopped.flooded))
                measure(f"connections to the core{name}", call, "connections", BOX_HOST, *ports.values(), door)
            client.close()
            send = gateway.Phone(box).command

            def by_phone(zone: int) -> None:
                send("stop", {"zone": f"zone {zone}", "identity": ""})

            measure("connections to the gateway, by phone", by_phone, "connections", BOX_HOST, box.web_port)
            measure("datagrams to the public port, by phone", by_phone, "datagrams", BOX_HOST, box.port)

    # -- the door -----------------------------------------------------------------------------------

    def door(self) -> None:
        """The core with clients of its door, and with phones: load, and when others know a change."""
        with Box(1, has_pages=True) as box:
            self._followed(box, "no robots")
        for zones in (1, 40, 100):
            with box_in_runs(zones, idle=lambda box: self._followed(box, "no run"), has_pages=True) as (box, fleet):
                fleet.keep_sending(load.ORIGINAL_PERIOD_S)
                self._followed(box, "in runs")

    def _followed(self, box: Box, what: str) -> None:
        results, name = self.results, f"door, {box.zones} zones, {what}"
        is_idle = what != "in runs"
        target = CORE_TARGETS.get((box.zones, what))
        for count, phones in LOOKED_AT:
            cost = followers.cost(box, count, phones, self.extent.seconds)
            of = f"{name}, {count} clients" + (f", {phones} phones" if phones else "")
            results.add(f"{of}: CPU", "% of a core", cost.core_percent, None if phones else target)
            if count:
                results.add(f"{of}: to each client", "kB/s", cost.client_rate / 1e3,
                            2 if is_idle and not phones else None)
            if phones:
                results.add(f"{of}: to each phone", "kB/s", cost.phone_rate / 1e3)
        if is_idle:
            taken = followers.changes(self.extent.starts)
            results.add_spread(f"{name}: call to the change at another client", "ms", taken,
                               {0.5: 10} if box.zones == 1 else {})

    # -- panels -------------------------------------------------------------------------------------

    def _idle(self, box: Box) -> None:
        """Size and cost of the panels' message without a connected run."""
        time.sleep(1.5)  # until the box has heard all robots
        pace = load.Pace()
        cpu = box.process.cpu_percent(self.extent.idle_seconds)
        pace.close()
        name = f"no run, {box.zones} zones and robots"
        self.results.add(f"{name}: /core/to_gui", "kB", max(pace.sizes, default=0) / 1e3)
        self.results.add(f"{name}: /core/to_gui", "1/s", pace.rate)
        self.results.add(f"{name}: CPU", "% of a core", cpu)

    def window(self) -> None:
        """A client window beside a box whose zones all have runs."""
        import panels

        with box_in_runs(WINDOW_ZONES, idle=self._idle) as (_box, fleet):
            fleet.keep_sending(load.ORIGINAL_PERIOD_S)
            cpu = panels.window_cpu(self.extent.idle_seconds)
        self.results.add(f"client window, all panels, {WINDOW_ZONES} zones in runs: CPU", "% of a core", cpu, 20)

    # -- browsers -----------------------------------------------------------------------------------

    def web(self) -> None:
        """The core with its pages and without, with one reader and with many."""
        count, results = self.extent.starts, self.results
        with Box(1) as box:
            costs = [("without pages", gateway.change(box, None, count))]
        with Box(1, has_pages=True) as box:
            costs.append(("with pages, nobody reads", gateway.change(box, None, count)))
            for readers in (1, MANY_VIEWERS):
                viewers = gateway.Viewers(box.web_port, readers)
                cost = gateway.change(box, viewers, count)
                viewers.close()
                name = f"{readers} reader{'s' * (readers > 1)}"
                costs.append((f"with pages, {name}", cost))
                results.add_spread(f"call that changes the core to {name}", "ms", cost.late_ms, {0.95: 100})
            memory = box.process.memory_mb()
        for name, cost in costs:
            results.add(f"core {name}: CPU", "% of a core", cost.core_percent)
        results.add(f"core, after {MANY_VIEWERS} readers: memory", "MB", memory)

    def browser(self) -> None:
        """The pages in Chromium: what is painted when, START by phone, and the first page on a slow link."""
        count, results = self.extent.starts, self.results
        with Box(1, has_pages=True) as box, pages.Pages(box) as shown:
            visits = shown.first(max(3, self.extent.clicks // 4))
            results.add("first page, all files and data", "kB", max(one.kilobytes for one in visits), 150)
            results.add_spread("first page over 1 Mbit/s: painted after", "s",
                               [one.seconds for one in visits], {0.5: 1})
            results.add_spread("call that changes the core to painted, 1 browser", "ms",
                               shown.painted(box, count), {0.95: 100})
            viewers = gateway.Viewers(box.web_port, MANY_VIEWERS - 1)
            taken = shown.painted(box, count)
            viewers.close()
            name = f"call that changes the core to painted, beside {MANY_VIEWERS - 1} readers"
            results.add_spread(name, "ms", taken, {0.95: 100})
        with box_in_runs(1, has_pages=True) as (box, fleet):
            self._phone(box, fleet)
            self._beside_readers(box, fleet)

    def _phone(self, box: Box, fleet: Fleet) -> None:
        """START, by a command as the page sends it and by a finger on the page."""
        robot, send = fleet.robots[0], gateway.Phone(box).command

        def command(word: str) -> None:
            if word == "start":
                send("start", {"zone": "zone 0"})
            else:
                box.command(word, 0)

        taken = reaction.starts(fleet, robot, command, self.extent.starts)
        self.results.add_spread("START as the page sends it to PREPARE on the wire", "ms", taken, {0.99: 30})
        with pages.Pages(box) as shown:
            taken, clicked = shown.taps(box, fleet, robot, self.extent.clicks)
        self.results.add_spread("finger lifted from START to PREPARE on the wire", "ms", taken, {0.99: 30})
        self.results.add_spread("of this until Chromium reports the click", "ms", clicked, {})
        self._settle(fleet)

    def _beside_readers(self, box: Box, fleet: Fleet) -> None:
        """The core's reaction and CPU with many readers and without them, in turns."""
        taken: Dict[int, List[float]] = {0: [], MANY_VIEWERS: []}
        cpu_s: Dict[int, float] = dict.fromkeys(taken, 0.0)
        seconds: Dict[int, float] = dict.fromkeys(taken, 0.0)
        for readers in [0, MANY_VIEWERS] * 3:
            viewers = gateway.Viewers(box.web_port, readers) if readers else None
            began, used = time.monotonic(), box.process.cpu_s()
            taken[readers] += reaction.react(fleet, fleet.robots, self.extent.probes // 6)
            cpu_s[readers] += box.process.cpu_s() - used
            seconds[readers] += time.monotonic() - began
            if viewers is not None:
                viewers.close()
        for readers, values in taken.items():
            name = f"beside {readers or 'no'} readers"
            self.results.add_spread(f"reaction, 1 robot, {name}", "ms", values, {0.99: 10})
            self.results.add(f"core, 1 robot, {name}: CPU", "% of a core", 100.0 * cpu_s[readers] / seconds[readers])

    # -- results --------------------------------------------------------------------------------------

    def journal(self) -> None:
        """The journal's events and starts, and the results program, with a few runs and with many."""
        appended = journal_speed.append(self.extent.probes)
        self.results.add_spread("journal, an event until it is on the disk", "ms", appended.durable_ms, {0.99: 100})
        self.results.add("journal, events without waiting for the disk", "/s", appended.per_second)
        for runs in (START_RUNS, self.extent.runs):
            self.results.add(f"journal, start with {runs} runs", "s", journal_speed.start_s(runs), 2)
        few: Dict[str, float] = {}
        for runs in (FEW_RUNS, self.extent.runs):
            commands = {"list": ["list"], "show": ["show", str(runs)], "standings": ["standings"]}
            for name, taken in results_speed.measure(runs, commands).items():
                self.results.add(f"results {name}, {runs} runs", "s", taken.seconds, RESULTS_TARGETS[name])
                if name in few:
                    growth = taken.seconds / few[name] / (runs / FEW_RUNS)
                    self.results.add(f"results {name}: growth from {FEW_RUNS} runs, linear is 1", "", growth, 1)
                few[name] = taken.seconds
        few_s = 0.0
        for runs in sorted({min(FEW_RUNS, self.extent.reported_runs), self.extent.reported_runs}):
            report = results_speed.measure(runs, {"report": ["report"]})["report"]
            self.results.add(f"results report, {runs} runs", "s", report.seconds, 30)
            self.results.add(f"results report, {runs} runs: memory", "MB", report.memory_mb, 150)
            if few_s:
                growth = report.seconds / few_s / (runs / FEW_RUNS)
                self.results.add(f"results report: growth from {FEW_RUNS} runs, linear is 1", "", growth, 1)
            few_s = report.seconds

    # -- standby --------------------------------------------------------------------------------------

    def copying(self) -> None:
        """The copy on a standby: behind by how much, its cost for the core, and a new standby of many runs."""
        with box_in_runs(copying.ZONES) as (box, fleet):
            late_ms = copying.lag_ms(box, fleet, self.extent.seconds, load.ORIGINAL_PERIOD_S)
            self.results.add_spread(f"copy of the journal behind, {copying.ZONES} zones", "ms", late_ms, {0.99: 100})
            self._settle(fleet)
            costs = copying.beside(box, fleet, self.extent.probes)
        for has_standby, cost in costs.items():
            name = f"{copying.ZONES} zones, {'with' if has_standby else 'without'} a standby"
            self.results.add_spread(f"reaction, {name}", "ms", cost.reaction_ms, {0.99: 10})
            self.results.add(f"core, {name}: CPU", "% of a core", cost.core_percent)
        more = costs[True].core_percent - costs[False].core_percent
        self.results.add("core: CPU that a standby adds", "% of a core", more, 1)
        self.results.add(f"standby of a journal with {self.extent.runs} runs: paired again after", "s",
                         copying.paired_again_s(self.extent.runs), 30)

    # -- robots -------------------------------------------------------------------------------------

    def comm(self) -> None:
        """STOP from the wire to a program of the robot, and its calls, with the comm nodes of ROS 1 and ROS 2."""
        comm_nodes.ros1(self.results, self.extent.starts)
        comm_nodes.ros2(self.results, self.extent.starts)


@contextlib.contextmanager
def box_in_runs(count: int, profile: str = "", idle: Optional[Callable[[Box], None]] = None,
                has_pages: bool = False) -> Iterator[Tuple[Box, Fleet]]:
    """A box with a robot that executes in each zone. `idle` is called before they are connected."""
    with Box(count, profile, has_pages) as box, Fleet(count, box.port) as fleet:
        if idle is not None:
            idle(box)
        reaction.connect(box, fleet, count)
        reaction.start(box, fleet, count)
        yield box, fleet


def profile(robots: int, seconds: float) -> None:
    """Print the profile of the core's main thread with this many robots at 50 ms."""
    path = ROOT / "build" / "bench.prof"
    with box_in_runs(robots, str(path)) as (box, fleet):
        load.measure(box, fleet, seconds)
    pstats.Stats(str(path)).sort_stats("tottime").print_stats(35)


PARTS: Dict[str, str] = {name: getattr(Bench, name).__doc__ for name in (
    "one", "door", "resume", "hung", "takeover", "copying", "repeats", "without_ros", "hundred", "hostile", "floods",
    "frozen", "window", "web", "browser", "journal", "comm")}


def main() -> int:
    """Measure the chosen parts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", help=f"parts to measure: {', '.join(PARTS)} (default: all)")
    parser.add_argument("--quick", action="store_true", help="takes about six minutes; numbers are less exact")
    parser.add_argument("--minutes", type=float, help="duration of the load of 100 robots (default: 1, --quick: 0)")
    parser.add_argument("--strict", action="store_true", help="exit with status 1 if a target is missed")
    parser.add_argument("--profile", type=int, metavar="ROBOTS", help="only print a profile of the core")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build" / "bench.json")
    options = parser.parse_args()
    unknown = [part for part in options.parts if part not in PARTS]
    if unknown:
        parser.error(f"unknown part: {', '.join(unknown)}; choose from {', '.join(PARTS)}")
    extent = QUICK if options.quick else FULL
    minutes = options.minutes if options.minutes is not None else (0.0 if options.quick else 1.0)
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as home:
        os.environ.update(ROS_HOME=home, ROS_LOG_DIR=home)
        master = processes.start_master()
        try:
            connections.init_node("roah_rsbb_bench", disable_signals=True)
            if options.profile:
                profile(options.profile, extent.seconds)
                return 0
            return measure(Bench(extent, minutes), options, began)
        finally:
            rospy.signal_shutdown("the bench ends")
            master.close()


def measure(bench: Bench, options: argparse.Namespace, began: float) -> int:
    """Run the parts, and report the results."""
    for part in options.parts or PARTS:
        part_began = time.monotonic()
        getattr(bench, part)()
        print(f"{part} took {time.monotonic() - part_began:.0f} s")
    bench.results.add("load of the machine, mean of the last minute", "processes", os.getloadavg()[0])
    bench.results.write(options.output)
    missed = bench.results.missed
    print(f"{len(bench.results.numbers)} numbers in {time.monotonic() - began:.0f} s, {len(missed)} beyond their "
          f"targets; also in {options.output}")
    return 1 if missed and options.strict else 0


if __name__ == "__main__":
    sys.exit(main())
