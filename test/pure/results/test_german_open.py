"""German Open 2026 of RoboCup@Home, run again: four teams and all their attempts, and the tables that were published.

The box is the real one with its journal, in simulated time. The robots do not speak its protocol, so referees start the
clock. Of an attempt only the points are known: the marks that give them are drawn.
"""

import csv
import datetime
import json
import pathlib
import random

import pytest

from helpers.journaled import NO_LISTENING, JournaledDriver
from helpers.results_of import keep_files
from helpers.simulated_day import make_competition
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.rules import Measure
from roah_rsbb.model.scoring import ScoreKind
from roah_rsbb.results.program.main import main
from roah_rsbb.rulebook import config
from roah_rsbb.scoring.sheet import Mark

DATA = pathlib.Path(__file__).resolve().parents[2] / "data/competitions/german_open_2026.json"
OPEN = json.loads(DATA.read_text("utf-8"))
CODES = {"PP": "PickAndPlace", "DL": "Laundry"}  # where they differ
# Hour of the first attempt, minutes from one to the next, and the teams in their order, each with two attempts.
FINALISTS = ("SCC", "Tobi", "Nimbro")
TUESDAY, WEDNESDAY, THURSDAY, FRIDAY, SATURDAY = (f"2026-03-{day}" for day in range(10, 15))
PLAN = (
    (TUESDAY, "Poster", 18, 15, "SCC Tobi Nimbro Bit"),
    (WEDNESDAY, "HRI", 10, 15, "SCC Tobi Nimbro Bit"), (WEDNESDAY, "PP", 12, 15, "Tobi Nimbro Bit SCC"),
    (WEDNESDAY, "DL", 14, 15, "Nimbro Bit SCC Tobi"), (WEDNESDAY, "GPSR", 16, 15, "Bit SCC Tobi Nimbro"),
    (THURSDAY, "HRI", 10, 15, "Bit Nimbro SCC Tobi"), (THURSDAY, "PP", 13, 15, "Nimbro SCC Tobi Bit"),
    (THURSDAY, "DL", 15, 15, "SCC Tobi Bit Nimbro"), (THURSDAY, "GPSR", 17, 15, "Tobi Bit Nimbro SCC"),
    (FRIDAY, "HRI", 10, 7, "Tobi SCC Bit Nimbro"), (FRIDAY, "PP", 11, 7, "SCC Bit Nimbro Tobi"),
    (FRIDAY, "DL", 13, 7, "Bit Nimbro Tobi SCC"), (FRIDAY, "GPSR", 14, 7, "Nimbro Tobi SCC Bit"),
    (FRIDAY, "Restaurant", 16, 15, "Tobi SCC Bit Nimbro"), (SATURDAY, "Final", 12, 15, " ".join(FINALISTS)),
)
DECISIONS = """\
Attempts that count: mean of the best 2
Posters: count
Halves of the final ranking: of the best team
Points of the best team in each half: 100
Teams that are not in the Final: with 0 points in it
"""
# Three attempts with more than marks: a restart before which 15 points were made, a robot that is removed for
# inactivity and marked afterwards, and a mark too many that is found after the sign-off.
RESTART, INACTIVE, CORRECTION = ("HRI", "Nimbro", 1), ("GPSR", "Tobi", 2), ("HRI", "SCC", 3)


def points_of(test, team):
    return [OPEN["final"][team]] if test == "Final" else OPEN["tests"][test][team]


@pytest.fixture(name="folder", scope="module")
def fixture_folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("german_open")
    with open(made / "plan.csv", "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("zone", "benchmark", "team", "date", "time"))
        for day, test, hour, minutes, teams in PLAN:
            tries = 2 if len(points_of(test, "Bit")) > 1 else 1
            for number, team in enumerate(team for team in teams.split() for _ in range(tries)):
                begins = datetime.datetime(2026, 3, 1, hour) + number * datetime.timedelta(minutes=minutes)
                rows.writerow(("Arena", CODES.get(test, test), team, day, begins.strftime("%H:%M")))
    folder = make_competition(made / "comp", "athome2026", "--sheet", str(made / "plan.csv"))
    (made / "comp/decisions.yaml").write_text(DECISIONS, "utf-8")
    return pathlib.Path(folder)


class Referee:
    """Conducts the whole schedule, as with a face."""

    def __init__(self, folder, log_dir):
        files = (str(folder / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords"))
        self.loaded, _ = config.load(*files)
        self.box = JournaledDriver(log_dir, self.loaded, NO_LISTENING)
        self.names = {}  # identities of the runs, by test, team, and number of the attempt from 0
        self.draw = random.Random(2026)

    def conduct(self):
        """Conduct the runs of all days."""
        (zone,) = self.loaded.zones
        tests = {CODES.get(test, test): test for test in (*OPEN["tests"], "Final")}
        self.box.set_clock(zone.events[0].scheduled - self.box.now.utc)
        for event in zone.events:
            self.box.jump(max(0.0, event.scheduled - self.box.now.utc))
            if self.box.box.zones["Arena"].event.id != event.id:
                self.box.command("next", "Arena")
            test = tests[event.benchmark.code]
            number = sum((test, event.team) == attempt[:2] for attempt in self.names)
            self._run(event, points_of(test, event.team)[number], (test, event.team, number))
        self.box.journal.close()

    def _run(self, event, points, attempt):
        box = self.box
        box.command("connect", "Arena")
        box.command("start", "Arena")
        self.names[attempt] = box.run_in("Arena").identity
        name = RunName("Arena", self.names[attempt])
        rows = {item.id: item for item in event.benchmark.scoring}
        marks = self._marks(event, points)
        if attempt == RESTART:
            marks = [(rows["4"], 1), (rows["restart"], 1), *marks]
        elif attempt == INACTIVE:
            marks = [*marks, (rows["inactive"], 1), (rows["3"], 1)]
        elif attempt == CORRECTION:
            marks = [*marks, (rows["22"], 1)]
        for item, value in marks:
            self._mark(name, item, value)
        box.command("stop", "Arena")
        box.command("disconnect", "Arena")
        box.enter("sign_off", name, "Anna")
        if attempt == CORRECTION:
            box.enter("reopen", name, "Olga", reason="one mark too many")
            self._mark(name, rows["22"], 0)
            box.enter("sign_off", name, "Anna")

    def _mark(self, name, item, value):
        if item.judges:
            for judge, rating in zip(item.judges, (0, *[value] * (len(item.judges) - 2), 10)):
                self.box.mark(name, Mark(item.group, item.desc, text=str(rating), judge=judge), "Anna")
            return
        self.box.run(5.0)
        is_counted = item.kind in (ScoreKind.BOOL, ScoreKind.UINT)
        self.box.mark(name, Mark(item.group, item.desc, value if is_counted else 0,
                                 text="" if is_counted else str(value)), "Anna")
        if item.id == "inactive":
            self.box.run(40.0)

    def _marks(self, event, points):
        """Draw marks that give these points."""
        plain = plain_rows(event.benchmark.sheet)
        items = [item for item in event.benchmark.scoring if item.id in plain]
        if items[0].judges:
            return [(items[0], points // 5)]
        self.draw.shuffle(items)
        penalty = next(([item] for item in items if -200 < item.points < 0 < points and self.draw.random() < 0.3), [])
        found = {points - sum(item.points for item in penalty): [(item, 1) for item in penalty]}
        for item in items:
            for left, marks in list(found.items()):
                rest = {left - worth: [*marks, (item, value)] for value, worth in worths(item) if 0 < worth <= left}
                found = {**rest, **found}
            if 0 in found:
                return found[0]
        raise AssertionError(f"no marks give {points} points at {event.benchmark.code}")


def plain_rows(sheet):
    """Ids of the rows that count as they are marked: no modifiers of other rows, and nothing that depends on others."""
    modified = {item.id for item in sheet.items if item.amount is not Measure.SECTION}
    named = {each.item for item in sheet.items for each in item.unless}
    return {item.id for item in sheet.items if item.id.isdigit() and item.points is not None
            and item.under not in modified and item.id not in named and not (item.needs or item.each)}


def worths(item):
    """What a referee may mark, with the points that it gives."""
    if item.unit == "%":
        return [(share, item.points * share / 100) for share in range(2, 101, 2)]
    most = {ScoreKind.BOOL: 1, ScoreKind.UINT: int(item.most or 3)}.get(item.kind, 100)
    return [(value, item.points * value) for value in range(1, most + 1)]


@pytest.fixture(name="conducted", scope="module")
def fixture_conducted(folder, tmp_path_factory):
    log_dir = tmp_path_factory.mktemp("log")
    referee = Referee(folder, log_dir)
    referee.conduct()
    keep_files(log_dir / "0", *((folder / f"{name}.yaml").read_text("utf-8") for name in (
        "benchmarks", "schedule", "standings", "decisions")))
    return referee


@pytest.fixture(name="journal")
def fixture_journal(conducted):
    return conducted.box.journal.path


def results(capsys, journal, *arguments):
    """What the program `results` prints."""
    with pytest.raises(SystemExit) as end:
        main([*arguments, "--journal", str(journal)])
    assert end.value.code == 0
    return capsys.readouterr().out


@pytest.fixture(name="tables")
def fixture_tables(journal, tmp_path, capsys):
    results(capsys, journal, "standings", "--tables", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("number, title", enumerate(OPEN["published"]["tables"]))
def test_the_published_tables_come_out_to_the_digit(tables, number, title):
    own = (tables / "standings.md").read_text("utf-8").split("\n\n")[number]
    head, _, *rows = ([cell.strip() for cell in line.split("|")[1:-1]] for line in own.splitlines()[1:])
    columns = [CODES.get(column, column) for column in OPEN["published"]["tables"][title]["columns"]]
    found = {row[0]: [dict(zip(head, row))[column] for column in columns] for row in rows}
    assert found == OPEN["published"]["tables"][title]["rows"]


def test_all_attempts_have_their_points_in_their_order(tables):
    with open(tables / "scores.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for test, teams in {**OPEN["tests"], "Final": {team: [OPEN["final"][team]] for team in FINALISTS}}.items():
        for team, points in teams.items():
            assert points == [int(row["Score"]) for row in rows
                              if (row["Task"], row["Team"]) == (CODES.get(test, test), team)]
    assert len(rows) == 107
    assert list(dict.fromkeys(row["Date"] for row in rows)) == ["Tue", "Wed", "Thu", "Fri", "Sat"]


@pytest.mark.parametrize("attempt, said", [
    (RESTART, "Looks where it drives (0:05.0): void because of: Restart"),
    (INACTIVE, "Shows its plan (1:05.0): void because of: Removed"),
    (CORRECTION, "Total: 0, now 50; Ignores a person who turns to it: 1, now 0"),
])
def test_what_else_happened_in_an_attempt_is_on_its_sheet(conducted, journal, capsys, attempt, said):
    assert said in results(capsys, journal, "show", conducted.names[attempt])
