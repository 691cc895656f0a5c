"""The report of a competition in a real browser, from a folder: plots are drawn, tables are sorted, nothing is loaded.

`make test-all` leaves screenshots in build/screenshots.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
from typing import ClassVar

from support.browser import NeedsBrowser

from helpers.replayed import ReplayedCompetition

PROJECT = pathlib.Path(__file__).resolve().parents[3]
SHOTS = PROJECT / "build" / "screenshots"
SCREENS = {"360x740": (360, 740), "1920x1080": (1920, 1080)}
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


class TestReportPages(NeedsBrowser):
    PAGES = "the pages of a report"
    folder: ClassVar[pathlib.Path]

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        if cls.browser is None:
            return
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        journal = ReplayedCompetition(cls.folder / "log").play()
        subprocess.run([sys.executable, str(PROJECT / "scripts" / "results"), "--journal", journal, "--utc", "report",
                        "--html", str(cls.folder / "report")], check=True, stdout=subprocess.DEVNULL)

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
