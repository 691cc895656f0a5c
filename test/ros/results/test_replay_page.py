"""The replay of a run in a real browser: what it shows at a moment is what the box showed then.

`make test-all` leaves screenshots in build/screenshots.
"""

import pathlib
import tempfile
import wave
from typing import Any, ClassVar, Dict, List

from support.browser import NeedsBrowser, Page

from helpers.replayed import Look, ReplayedCompetition
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.results.replay import page_parts, replay_name, replay_of
from roah_rsbb.results.runs import records, run_result
from roah_rsbb.wording import sheets

PROJECT = pathlib.Path(__file__).resolve().parents[3]
SHOTS = PROJECT / "build" / "screenshots"
SCREENS = {"360x740": (360, 740), "1920x1080": (1920, 1080)}
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


def _fail(text: str) -> None:
    raise AssertionError(text)


class TestReplayPage(NeedsBrowser):
    PAGES = "the page of a replay"
    folder: ClassVar[pathlib.Path]
    competition: ClassVar[ReplayedCompetition]
    pages: ClassVar[List[pathlib.Path]]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        if cls.browser is None:
            return
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.competition = ReplayedCompetition(cls.folder)
        cls.pages = []
        parts = page_parts(str(PROJECT / "resource" / "replay"))
        reader = JournalReader(cls.competition.play())
        for number, record in enumerate(records(reader, _fail), 1):
            path = cls.folder / replay_name(number, record)
            path.write_text(replay_of(reader, run_result(reader, number, record, _fail), parts, True, _fail))
            cls.pages.append(path)

    def open(self, number: int, screen: str, dark: bool = False) -> Page:
        page = self.browser.page(self.pages[number].as_uri(), *SCREENS[screen])
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
            page, opened = self.open(number, "360x740", dark=bool(number)), float(identity.split("-")[2])
            for look in looks[::4]:
                self.seek(page, (look.now.utc - opened) * 1000)
                self.assert_same(page.get(STATE), page.get(SCORES), look)
            self.assertEqual(page.get("[document.documentElement.scrollWidth, innerWidth]"), [360, 360])
            self.assertEqual((page.get(FAINT), page.get(UNNAMED)), ([], []))
            page.screenshot(SHOTS / f"replay_{number + 1}_360x740.png")
        self.assertEqual(self.browser.errors, [])

    def test_it_plays_jumps_and_stays_text(self) -> None:
        page = self.open(0, "1920x1080")
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
        self.assertEqual(page.get("[document.scripts.length, document.querySelectorAll('body b').length]"), [2, 0])
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
        page = self.open(0, "1920x1080")
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
