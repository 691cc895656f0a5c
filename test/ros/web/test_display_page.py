"""The public display's page: all that can be on it, at all sizes of screens. The test says what is on it."""

import json
import pathlib
from typing import Any, Dict, List

from support.browser import IS_ALL, NeedsBrowser
from support.gateway import URL, wait_served

SHOTS = pathlib.Path(__file__).resolve().parents[3] / "build" / "screenshots"
SIZES = ((1280, 720), (1920, 1080), (1280, 1024), *([(3840, 2160)] if IS_ALL else []))
TEXT = "document.body.innerText"
TEAMS = ("BrassButlers", "CopperKettle", "HomeAlone", "TeaAtFive")
BENCHMARKS = ("Getting to know my home", "Welcoming visitors", "Catering for Granny Annie's Comfort")
LOOKS = {"executing": "running", "ready": "ready", "completed": "completed"}
CLOCK = 1_800_000_000.0
# Nothing comes from the gateway any more: the test has the only word. The box's clock is stopped.
TAKE_OVER = """(() => {
  live.close();
  live.reopen = () => {};
  live.socket = {readyState: WebSocket.OPEN};
  live.clock.at = () => CLOCK;
})()""".replace("CLOCK", str(CLOCK))
# Pages take turns so often, and not every 8 seconds; a result has the screen for 0.3 s, and not for 10.
TURN = """(set => window.setInterval = (what, ms) => set(what, ms === 8000 ? {ms} : ms))(setInterval);
(set => window.setTimeout = (what, ms) => set(what, {10000: 300, 15000: 100}[ms] ?? ms))(setTimeout)"""
# What is wrong: parts outside of the screen or of their zone, or that cover each other; texts that are not whole or too
# small.
FAULTS = """(() => {
  const seen = selector => [...document.querySelectorAll(selector)].filter(one => !one.closest(".copy"));
  const box = one => one.getBoundingClientRect();
  const size = one => parseFloat(getComputedStyle(one).fontSize);
  const isIn = (a, b) => a.left > b.left - 1 && a.right < b.right + 1 && a.top > b.top - 1 && a.bottom < b.bottom + 1;
  const covers = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1
    && b.top < a.bottom - 1;
  const said = one => `${one.className}: ${one.textContent}`;
  const screen = {left: 0, top: 0, right: innerWidth, bottom: innerHeight};
  const faults = seen("#page > *, .zone > *, .who > *, .when > *, .line, .row > *, tr > *")
    .filter(one => !isIn(box(one), screen)).map(said);
  for (const zone of seen(".zone")) {
    const parts = seen(".team-mark, .who > *, .when > *").filter(one => zone.contains(one) && box(one).width);
    faults.push(...parts.filter(one => !isIn(box(one), box(zone))).map(said));
    faults.push(...parts.filter(one => parts.some(other => other !== one && covers(box(one), box(other)))).map(said));
  }
  faults.push(...seen(".word, .big, .row > *, .number").filter(one => one.scrollWidth > one.clientWidth + 1).map(said));
  faults.push(...seen(".fit").filter(one => {
    const range = document.createRange();
    range.selectNodeContents(one);
    one.style.textOverflow = "clip";
    return range.getBoundingClientRect().width > box(one).width;
  }).map(said));
  // Capital letters of 1/30 of the height of a screen of 55 inches can be read from ten metres.
  const least = Math.min(innerHeight, innerWidth * 9 / 16) / 30;
  const far = seen(".row > *, .zone .team .fit, .zone .benchmark .fit, .big, .word, tbody .number, .next-up > *");
  faults.push(...far.filter(one => 0.73 * size(one) < least).map(one => `${said(one)} has ${size(one)} px`));
  return faults;
})()"""


def _line(number: int, **fields: Any) -> Dict[str, Any]:
    zone = f"Home {number + 1}"
    return {"zone": zone, "time": "12:50", "team": TEAMS[number % 4], "benchmark": BENCHMARKS[number % 3], "last": zone,
            "scores": [], "of_team": TEAMS[number % 4], "key": f"{zone} {fields}", **fields}


def _runs(count: int, **fields: Any) -> Dict[str, Any]:
    def run(number: int) -> Dict[str, Any]:
        look = ("executing", "ready", "completed")[number % 3]
        return {
            "zone": f"Home {number + 1}", "look": look, "team": TEAMS[number % 4], "teams": [TEAMS[number % 4]],
            "benchmark": BENCHMARKS[number % 3], "place": f"Home {number + 1} · round 1, run {1 + number % 3}",
            "big": "{time}" if look == "executing" else "10:00", "word": LOOKS[look], "is_paused": False,
            "limit": 600.0,
            "left_s": 300.0, "ends": CLOCK + 571 if look == "executing" else None, "counts_from": None, **fields}
    return {"page.runs": {"replay": "", "runs": [run(number) for number in range(count)]}}


def _lists(scores: int = 3) -> Dict[str, Any]:
    result = {"last": "completed", "look": "completed", "points": "12", "rank": "1",
              "scores": [[f"Achievements, part {n}", str(n)] for n in range(scores)]}
    ranks = [{"rank": str(n + 1), "team": TEAMS[n % 4] + " of Lisbon" * (n > 3), "numbers": ["5", ""]}
             for n in range(13)]
    return {
        "page.next": {"lines": [_line(number) for number in range(12)]},
        "page.results": {"results": [_line(number, **result) for number in range(5)],
                         "provisional": [_line(0, **result)]},
        "page.standings": {"standings": [{
            "title": "Standing: Welcoming visitors", "criteria": ["Achievements", "Time (less is better)"],
            "ranks": ranks,
            "notes": []}]},
    }


class TestDisplay(NeedsBrowser):
    """What the public display shows."""

    maxDiff = None

    PAGES = "the public display's page"

    def setUp(self) -> None:
        super().setUp()
        wait_served()
        self.page = self.browser.page("about:blank", *SIZES[0])
        self.addCleanup(self.page.close)
        self.open(turn_ms=2 ** 31 - 1)

    def open(self, turn_ms: int, query: str = "") -> None:
        """Open the page, and let it show only what the test says."""
        self.page.command("Page.addScriptToEvaluateOnNewDocument", source=TURN.replace("{ms}", str(turn_ms)))
        self.page.open(f"{URL}/display?layout=board{query}")
        self.page.wait("live.data['page.words'] && live.data['page.runs']", "the gateway has answered")
        self.page.get(TAKE_OVER)

    def show(self, *documents: Dict[str, Any]) -> None:
        """Let the page show these, as the gateway sends them."""
        data = {name: {"number": 1, "data": one} for each in documents for name, one in each.items()}
        message = {"type": "snapshot", "heard": True, "clock": CLOCK, "documents": data}
        self.page.get(f"live.receive({json.dumps(message)})")
        self.page.get("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))).then(() => 0)")

    def faults(self) -> List[str]:
        """What is wrong on the screen."""
        return self.page.get(FAULTS)

    def test_everything_is_whole_at_all_sizes(self) -> None:
        for size in SIZES:
            self.page.resize(*size)
            for count in (0, 1, 2, 3, 4, 5, 6, 20):
                self.show(_runs(count), _lists())
                self.page.screenshot(SHOTS / f"display_{size[1]}_{count}.png")
                with self.subTest(size=size, runs=count):
                    self.assertEqual(self.faults(), [])
                    times = self.page.get("[...document.querySelectorAll('.big')].map(one => one.textContent)")
                    self.assertEqual(len(times), count if count <= 6 else 5)
                    self.assertEqual(times[:1], ["9:31"][:count])

    def test_a_paused_run_has_a_band_that_says_so(self) -> None:
        for count in (1, 2, 3, 6):  # every kind of card
            self.show(_runs(count, big="1:40", word="PAUSED", look="executing", is_paused=True, ends=None))
            bands = self.page.get("[...document.querySelectorAll('.word')].map(one => "
                                  "[one.textContent, getComputedStyle(one).backgroundColor])")
            self.page.screenshot(SHOTS / f"display_paused_{count}.png")
            self.assertEqual(bands, count * [["PAUSED", "rgb(255, 255, 255)"]])
            self.assertEqual(self.faults(), [])

    def test_long_names_are_written_smaller_then_shortened(self) -> None:
        names = ", ".join(TEAMS * 2)
        for count in (1, 2, 3, 4):
            self.show(_runs(count, team="All teams", place=f"round 1, run 1 · {names}"))
            self.assertIn(names, self.page.get(TEXT))
            self.assertEqual([one for one in self.faults() if names not in one], [])

    def test_what_does_not_fit_takes_turns(self) -> None:
        self.open(turn_ms=200)
        self.show(_runs(20), _lists(scores=11))
        for title in ("Next", "Standing: ", "Results 1/", "Results 2/", "Provisional results"):
            self.assertEqual(self.wait_page(title), [], title)
            self.page.screenshot(SHOTS / f"display_{title.split()[0]}.png")
        self.page.wait("document.querySelector('.top .title').textContent.includes('4/4')", "the last runs are shown")

    def wait_page(self, title: str) -> List[str]:
        """Wait until a page with this title is shown; returns what is wrong on it."""
        return self.page.get(f"""new Promise(done => {{
            const said = () => (document.querySelector(".list h2") || document.body).textContent;
            const look = () => said().startsWith({json.dumps(title)})
                ? done({FAULTS}) : setTimeout(look, 10);
            look();
        }})""")

    def test_the_logo_of_the_competition(self) -> None:
        words = self.page.get("live.data['page.words']")
        self.show({"page.words": {**words, "logos": ["competition"]}})
        first = self.page.get("document.querySelector('.top > :first-child img').src")
        self.assertTrue(first.endswith("/logos/competition"), first)
        self.page.wait("document.querySelector('.top img').src.endsWith('?1')",
                       "a logo that did not come is tried again")
        self.assertEqual(self.page.get("document.querySelector('.top img').hidden"), True,
                         "a broken picture is not shown")

    def test_a_new_result_has_the_screen_for_a_moment(self) -> None:
        self.show(_runs(2), _lists())
        lists = _lists()
        new = _line(3, look="stopped", points="4711", rank="2=", scores=[["Achievements", "4711"]])
        lists["page.results"]["results"].insert(0, new)
        was_shown = self.page.note("['TeaAtFive', '4711', 'Rank 2=', 'Achievements'].every(one => "
                                   "(document.querySelector('.result') || document.head).innerText.includes(one))")
        self.show(_runs(2), lists)
        self.page.wait(f"{was_shown} && document.querySelector('.result') === null", "it was shown")
        self.assertEqual(self.faults(), [])

    def test_standings_fill_the_screen(self) -> None:
        self.open(2 ** 31 - 1, "&show=standings")
        for size in SIZES:
            self.page.resize(*size)
            self.show(_runs(2), _lists())
            self.page.screenshot(SHOTS / f"display_{size[1]}_standings.png")
            self.page.wait("document.querySelectorAll('.list tbody tr').length === 13", "all teams are on one page")
            self.assertEqual(self.faults(), [])
            bottom = "document.querySelector('.list table').getBoundingClientRect().bottom"
            self.assertTrue(self.page.get(f"{bottom} > 0.85 * innerHeight"), size)

    def test_a_standing_shows_the_columns_for_which_there_is_space(self) -> None:
        self.open(2 ** 31 - 1, "&show=standings")
        heads = "[...document.querySelectorAll('.list thead th')].slice(2).map(one => one.textContent)"
        names = ["Total", *(f"Task {number}" for number in range(1, 7))]
        for filled, shown in ((1, ["Task 1", "Total"]), (2, ["Task 1", "Task 2", "Total"]), (3, ["Total"])):
            ranks = [{"rank": "1", "team": team, "numbers": ["1290.5", *filled * ["645.25"], *["0"] * (6 - filled)]}
                     for team in ("Hibikino-Musashi@Home", *TEAMS)]
            standing = {"title": "Standing: Tasks", "criteria": names, "ranks": ranks,
                        "notes": [{"note": "Final has no runs yet", "team": ""}]}
            self.show(_runs(2), _lists(), {"page.standings": {"standings": [standing]}})
            self.page.wait(f"JSON.stringify({heads}) === '{json.dumps(shown, separators=(',', ':'))}'", "these columns")
            self.assertEqual(self.faults(), [])
