"""The report of a competition in a real browser, from a folder, and the replays in it: plots are drawn, tables are
sorted, a replay shows at a moment what the box showed then, and nothing is loaded.

`make test-all` leaves screenshots in build/screenshots.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import wave
from typing import Any, ClassVar, Dict, List

from support.browser import NeedsBrowser, Page

from helpers.replayed import Look, ReplayedCompetition
from roah_rsbb.wording import sheets

PROJECT = pathlib.Path(__file__).resolve().parents[3]
SHOTS = PROJECT / "build" / "screenshots"
SCREENS = {"360x740": (360, 740), "1920x1080": (1920, 1080)}
# Pages with the number of their plots.
PLOTS = {"runs.html": 0, "items.html": 2, "times.html": 1, "link.html": 1}
# How many points of each plot are neither white nor grey: something is drawn there.
COLOURS = """[...document.querySelectorAll(".plot canvas")].map(canvas => {
  const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  let coloured = 0;
  for (let i = 0; i < data.length; i += 4) {
    const [red, green, blue, opaque] = data.slice(i, i + 4);
    coloured += opaque > 0 && Math.max(red, green, blue) - Math.min(red, green, blue) > 60;
  }
  return coloured;
})"""
FIRST_COLUMN = "[...document.querySelectorAll('table.sorted tbody tr')].map(row => row.cells[{}].textContent)"
SORTED = """(([texts, down]) => {
  const table = document.createElement("table"), body = table.createTBody();
  for (const text of texts) body.insertRow().insertCell().textContent = text;
  sort(table, 0, down);
  return [...body.rows].map(row => row.cells[0].textContent);
})(%s)"""
# Columns in the order in which they are sorted.
COLUMNS = (
    ["2026-11-28 09:30:00Z", "2026-11-28 10:00:00Z", "2026-11-29 08:00:00Z", "–"],
    ["0:07.1", "0:55.0", "9:58.3", "10:00.0", "1:02:03.4", "–"],
    ["-15", "-1.5", "0", "0.25", "9", "10", "85", ""],
    ["0%", "5%", "50%", "100%", "–"],
    ["1 / 2", "1 / 10", "2 / 1"],
    ["Alpha", "Beta 2", "Beta 10", "gamma"],
    ["9 lives", "10 lives", "Alpha"],
)
# With the scores at many heights in two columns: the titles, and those in another column than their first line.
TITLES = """(() => {
  const scores = document.querySelector(".scores"), space = document.createElement("div"), columns = [];
  scores.className = "scores two";
  scores.prepend(space);
  for (let height = 0; height < 120; height += 3) {
    space.style.height = `${height}px`;
    for (const {rows} of scores.querySelectorAll("table")) {
      columns.push([rows[0], rows[1]].map(row => row.getBoundingClientRect().left));
    }
  }
  return [columns.length, columns.filter(([title, line]) => title !== line).length];
})()"""
CLICK = "document.querySelectorAll('table.sorted th')[{}].click()"
# What stands beside a label of the state.
STATE = """Object.fromEntries([...document.querySelectorAll("#state dt")].map(
  label => [label.textContent, label.nextElementSibling.textContent]))"""
SCORES = """[...document.querySelectorAll("#scores tbody tr:not(.group):not(.total)")].map(
  row => [...row.cells].slice(0, 2).map(cell => cell.textContent))"""
CHOSEN = """document.querySelector('.row[aria-selected="true"]')?.textContent ?? ''"""
TIME_MS = "Number(document.getElementById('slider').value)"
# Texts whose contrast with their background is below 4.5 (WCAG 2.1, AA).
FAINT = """(() => {
  const numbers = (colour) => (colour.match(/[\\d.]+/g) || []).map(Number);
  const light = (colour) => colour.slice(0, 3).map(c => c / 255)
    .map(c => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = numbers(getComputedStyle(e).backgroundColor);
      if (colour.length === 3 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const texts = [...document.querySelectorAll("body *")].filter(e => e.getClientRects().length
    && [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()) && !e.matches("option"));
  return texts.filter(e => {
    const [high, low] = [light(numbers(getComputedStyle(e).color)), light(behind(e))].sort((a, b) => b - a);
    return (high + 0.05) / (low + 0.05) < 4.5;
  }).map(e => e.outerHTML.slice(0, 120));
})()"""
UNNAMED = """[...document.querySelectorAll("button, input, select, [tabindex]")].filter(
  e => !(e.labels?.length || e.ariaLabel || e.textContent.trim())).map(e => e.outerHTML)"""


class TestReport(NeedsBrowser):
    PAGES = "the pages of a report, and of replays"
    folder: ClassVar[pathlib.Path]
    competition: ClassVar[ReplayedCompetition]
    replays: ClassVar[List[pathlib.Path]]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        if cls.browser is None:
            return
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.competition = ReplayedCompetition(cls.folder / "log")
        subprocess.run([sys.executable, str(PROJECT / "scripts" / "results"), "--journal", cls.competition.play(),
                        "--utc", "report", "--html", str(cls.folder / "report")], check=True, stdout=subprocess.DEVNULL)
        cls.replays = sorted((cls.folder / "report" / "runs").glob("*_replay.html"))

    # -- the report ---------------------------------------------------------------------------------

    def test_pages_at_both_widths(self) -> None:
        for name, plots in PLOTS.items():
            path = self.folder / "report" / name
            for screen, size in SCREENS.items():
                page = self.browser.page(path.as_uri(), *size)
                drawn = page.get(COLOURS)
                self.assertEqual(len(drawn), plots, name)
                self.assertTrue(all(points > 10 for points in drawn), (name, drawn))
                self.assertLessEqual(page.get("document.documentElement.scrollWidth"), size[0], (name, screen))
                page.screenshot(SHOTS / f"report_{path.stem}_{screen}.png")
                page.close()
        self.assertEqual(self.browser.errors, [])

    def test_sheets_fit_a_phone(self) -> None:
        """Also those whose scores are printed in several columns, which would overlap."""
        for path in sorted((self.folder / "report" / "runs").glob("*run1.html")):
            page = self.browser.page(path.as_uri(), *SCREENS["360x740"])
            self.addCleanup(page.close)
            page.get("document.querySelector('.scores').className = 'scores two'")
            self.assertEqual(page.get("getComputedStyle(document.querySelector('.scores')).columnCount"), "1")
            self.assertLessEqual(page.get("document.documentElement.scrollWidth"), 360, path.name)

    def test_no_title_of_scores_stands_alone(self) -> None:
        path = next((self.folder / "report" / "runs").glob("*HCFGAC*run1.html"))
        page = self.browser.page(path.as_uri(), *SCREENS["1920x1080"])
        self.addCleanup(page.close)
        titles, alone = page.get(TITLES)
        self.assertGreater(titles, 50)
        self.assertEqual(alone, 0)

    def test_labels_of_a_narrow_plot_do_not_overlap(self) -> None:
        page = self.browser.page((self.folder / "report" / "link.html").as_uri(), *SCREENS["360x740"])
        self.addCleanup(page.close)
        for places, width, shown in (
            ([0, 1, 2, 50, 99, 100], 280, [0, 50, 99]), ([0, 1, 2, 50, 99, 100], 2000, [0, 1, 2, 50, 99, 100]),
            ([7], 280, [7]), ([], 280, []), (list(range(9)), 280, list(range(9))),
        ):
            self.assertEqual(page.get(f"spaced({places}, {width})"), shown)

    def test_each_kind_of_column_is_sorted(self) -> None:
        page = self.browser.page((self.folder / "report" / "runs.html").as_uri(), *SCREENS["1920x1080"])
        self.addCleanup(page.close)
        for column in COLUMNS:
            missing = [text for text in column if text in ("–", "")]
            known = column[:len(column) - len(missing)]
            for down, expected in ((False, column), (True, known[::-1] + missing)):
                for texts in (column, column[::-1], sorted(column)):
                    self.assertEqual(page.get(SORTED % json.dumps([texts, down])), expected)

    def test_a_click_sorts_and_texts_stay_texts(self) -> None:
        page = self.browser.page((self.folder / "report" / "runs.html").as_uri(), *SCREENS["1920x1080"])
        self.addCleanup(page.close)
        rows = page.get(FIRST_COLUMN.format(0))
        self.assertEqual(rows, ["1", "2"])
        for expected in (rows, rows[::-1]):
            page.get(CLICK.format(0))
            self.assertEqual(page.get(FIRST_COLUMN.format(0)), expected)
        teams = page.get(FIRST_COLUMN.format(4))
        page.get(CLICK.format(4))
        self.assertEqual(page.get(FIRST_COLUMN.format(4)), sorted(teams))
        items = self.browser.page((self.folder / "report" / "items.html").as_uri(), *SCREENS["1920x1080"])
        self.addCleanup(items.close)
        self.assertIn("objects <b>brought</b>", items.get("document.body.innerText"))
        self.assertEqual(items.get("document.querySelectorAll('td b').length"), 0)
        self.assertEqual(self.browser.errors, [])

    # -- replays ------------------------------------------------------------------------------------

    def open_replay(self, number: int, screen: str, dark: bool = False) -> Page:
        page = self.browser.page(self.replays[number].as_uri(), *SCREENS[screen])
        self.addCleanup(page.close)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        page.command("Emulation.setEmulatedMedia", features=[scheme])
        return page

    def seek(self, page: Page, ms: float) -> None:
        page.get(f"""(() => {{ const slider = document.getElementById("slider");
            slider.value = {round(ms)}; slider.dispatchEvent(new Event("input")); }})()""")

    def assert_same(self, state: Dict[str, str], scores: List[List[str]], look: Look) -> None:
        view = look.view
        phase = f"{view.phase}: {sheets.end_reason(view.end_reason)}" if view.end_reason else view.phase
        self.assertEqual((state["Phase"], state["Box's state"], state["Robot's state"]),
                         (phase, view.robot.box_state, view.robot.robot_state))
        minutes, seconds = state["Time used"].split(" ")[0].split(":")
        self.assertAlmostEqual(60 * int(minutes) + float(seconds), view.clock.spent(look.now.mono), delta=0.11)
        self.assertEqual("paused" in state["Time used"], bool(view.clock.paused))
        self.assertEqual(scores, [
            [sheets.item_value(i.type, i.value, i.not_attempted, i.text), i.points] for i in view.items])

    def test_each_moment_is_that_of_the_box(self) -> None:
        for number, (identity, looks) in enumerate(sorted(self.competition.looks.items())):
            page, opened = self.open_replay(number, "360x740", dark=bool(number)), float(identity.split("-")[2])
            for look in looks[::4]:
                self.seek(page, (look.now.utc - opened) * 1000)
                self.assert_same(page.get(STATE), page.get(SCORES), look)
            self.assertEqual(page.get("[document.documentElement.scrollWidth, innerWidth]"), [360, 360])
            self.assertEqual((page.get(FAINT), page.get(UNNAMED)), ([], []))
            page.screenshot(SHOTS / f"replay_{number + 1}_360x740.png")
        self.assertEqual(self.browser.errors, [])

    def test_it_plays_jumps_and_stays_text(self) -> None:
        page = self.open_replay(0, "1920x1080")
        page.screenshot(SHOTS / "replay_begin_1920x1080.png")
        page.get("document.getElementById('list').focus()")
        page.key("Home")
        begin = page.get(CHOSEN)
        page.key("ArrowDown")
        self.assertNotIn(page.get(CHOSEN), ("", begin))
        page.key("End")
        end = page.get(CHOSEN)
        page.key(",")
        self.assertNotIn(page.get(CHOSEN), ("", end))
        self._choose(page, "notification")
        self.assertIn("<script>alert", page.get("document.getElementById('whole').textContent"))
        page.screenshot(SHOTS / "replay_1920x1080_light.png")
        before = page.get(TIME_MS)
        page.key("ArrowRight")
        self.assertEqual(page.get(TIME_MS) - before, 5000)
        page.get("document.getElementById('speed').value = '64'; "
                 "document.getElementById('speed').dispatchEvent(new Event('change'))")
        page.key(" ")
        page.wait("document.getElementById('slider').value === document.getElementById('slider').max",
                  "it plays to the end")
        page.wait("document.getElementById('play').textContent === '▶ Play'", "it stops there")
        self.assertEqual(page.get(STATE)["Phase"], "disconnected: completed")
        self.assertEqual(page.get("[document.scripts.length, [...document.querySelectorAll('body b')].filter("
                                  "one => one.textContent.includes('door')).length]"), [2, 0])
        page.command("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        self.assertEqual(page.get(FAINT), [])
        page.screenshot(SHOTS / "replay_1920x1080_dark.png")
        self.assertEqual(self.browser.errors, [])

    def _choose(self, page: Page, text: str) -> None:
        """Choose the first event with this text, and show all events again."""
        for words in (text, ""):
            page.get(f"""(() => {{ const search = document.getElementById("search"); search.value = {words!r};
                search.dispatchEvent(new Event("input"));
                if (search.value) document.querySelector(".row").click(); }})()""")

    def test_a_click_on_a_known_event_sets_the_video(self) -> None:
        path = self.folder / "video.wav"  # a browser plays it like a video
        with wave.open(str(path), "wb") as sound:
            sound.setparams((1, 1, 8000, 8000 * 60, "NONE", ""))
            sound.writeframes(b"\x80" * 8000 * 60)
        page = self.open_replay(0, "1920x1080")
        page.command("DOM.enable")
        root = page.command("DOM.getDocument")["root"]["nodeId"]
        node = page.command("DOM.querySelector", nodeId=root, selector="#file")["nodeId"]
        page.command("DOM.setFileInputFiles", nodeId=node, files=[str(path)])
        page.wait("document.getElementById('video').duration > 59", "the video is loaded")
        self._choose(page, "executing")
        known_ms = page.get(TIME_MS)
        page.get("document.getElementById('video').currentTime = 7")
        page.get("document.getElementById('sync').click()")
        self.seek(page, known_ms + 12_000)
        self.assertAlmostEqual(self._video_s(page), 19.0, delta=0.01)
        self.assertIn("It follows the replay", page.get("document.getElementById('synced').textContent"))
        page.get("document.getElementById('unsync').click()")
        self.seek(page, known_ms)
        self.assertAlmostEqual(self._video_s(page), 19.0, delta=0.01)
        self.assertEqual(self.browser.errors, [])

    def _video_s(self, page: Page) -> Any:
        return page.get("document.getElementById('video').currentTime")
