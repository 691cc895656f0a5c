"""The page of the whole box in a real browser: all that the panels do, against a box without ROS.

`make test-all` leaves screenshots of all parts in build/screenshots, in all sizes and languages.
"""

import json
import pathlib
import shutil
import tempfile
from typing import List

from support.browser import IS_ALL, NeedsBrowser, Page
from support.served_box import TEAM, ServedBox
from support.waiting import happened, wait_until

from web.test_stop_page import CLICKED

SHOTS = pathlib.Path(__file__).resolve().parents[3] / "build" / "screenshots"
HOME, HALL = "Home", "Hall"
PHONE, LOW, LAPTOP, LARGE = (360, 640), (900, 500), (1280, 720), (1920, 1080)
TEXT = "document.body.innerText"
PARTS = ("overview", "zone", "schedule", "runs", "robots", "log", "box")
# Times in more lines than they have texts or beside their column, and buttons whose text has no space around it.
CRAMPED = """[...document.querySelectorAll(".event .when > *, .stopall")].filter(node => {
  const range = document.createRange(), inner = node.getBoundingClientRect();
  range.selectNodeContents(node);
  const text = range.getBoundingClientRect(), column = node.parentNode.getBoundingClientRect();
  return node.matches(".stopall") ? text.height > inner.height - 6 || text.width > inner.width - 8
    : text.height > 1.5 * parseFloat(getComputedStyle(node).fontSize) || text.right > column.right;
}).map(node => node.textContent)"""
LOG = "document.querySelector('ol.log')"
EVENT = "    - {{ benchmark: {}, team: " + TEAM + ", round: 1, run: {}, scheduled_time: 2015-12-31 0{}:00:00 }}\n"
SCHEDULE = "".join([
    "- zone: Home\n  schedule:\n", EVENT.format("HGTKMH", 1, 1),
    EVENT.format("HGTKMH", 2, 2), EVENT.format("HWV", 1, 3),
    "- zone: Hall\n  schedule:\n", EVENT.format("HGTKMH", 3, 4), EVENT.format("HWV", 2, 5).replace("12-31", "12-30")])
LATER = EVENT.format("HWV", 3, 6)


class TestBoxPage(NeedsBrowser):
    PAGES = "the page of the whole box"

    def setUp(self) -> None:
        super().setUp()
        folder = pathlib.Path(tempfile.mkdtemp(prefix="roah_box_page_"))
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        self.schedule = folder / "schedule.yaml"
        self.schedule.write_text(SCHEDULE)
        self.box = ServedBox(folder, has_devices=True, schedule_file=str(self.schedule))
        self.addCleanup(self.box.close)

    def opened(self, part: str = "zone", role: str = "organiser", zone: str = "", language: str = "en") -> Page:
        """The page of a device that is paired in this role, on a laptop."""
        url = self.box.call("pair", role=role, zone=zone)["url"].replace("/pair", f"/pair?language={language}")
        page = self.browser.page(url, *LAPTOP, is_alone=True)
        page.fill("#person", "Olga" if language == "en" else "Ola")  # each device needs its own name
        page.press("form button")
        page.wait_address("/box" if role == "organiser" else "/referee")
        page.open(f"{url.split('/pair')[0]}/box?language={language}&part={part}")
        page.wait("document.querySelector('.all > *') !== null", "the part is shown")
        return page

    def open_part(self, page: Page, part: str) -> None:
        """Press the button of a part."""
        page.wait(CLICKED.format(f"[data-part={part}]"), f"the button of {part} is pressed")
        page.wait(f"document.querySelector('[data-part={part}]').getAttribute('aria-current') === 'page'", "it is open")

    def press(self, page: Page, selector: str) -> None:
        """Press a button as soon as it is on."""
        page.wait(CLICKED.format(selector), f"{selector} is pressed")

    def press_twice(self, page: Page, selector: str) -> None:
        """Press a button that asks for a second press."""
        self.press(page, selector)
        page.wait(f"document.querySelector({json.dumps(selector)}).textContent.includes('Press again')", "it asks")
        self.press(page, selector)

    def running(self, zone: str = HOME) -> str:
        """Begin a run; returns its identity."""
        for action in ("connect", "start"):
            self.box.wait(lambda document, name=action: document.zones[zone].is_on(name), f"{action} is on")
            self.box.act(action, zone)
        return self.box.document.zones[zone].identity

    def ended(self, zone: str = HOME) -> str:
        """A run that is over, with a mark; returns its identity."""
        identity = self.running(zone)
        item = self.box.document.zones[zone].items[0]
        self.box.act("mark", zone, group=item.group, desc=item.desc, value=1, role="referee", id="1")
        self.box.call("stop", zone=zone, run=identity, by="Rita")
        return identity

    def test_the_overview_leads_to_a_zone_and_any_event_is_chosen(self) -> None:
        self.ended()
        page = self.opened("overview")
        page.wait("document.querySelector('[data-zone=Home]').textContent.includes('ENDED: stopped')", "its phase")
        page.wait("document.querySelector('.rows').textContent.startsWith('2Zones without the phone')", "what waits")
        self.press(page, "[data-zone=Hall]")
        page.wait("document.querySelector('.who .names').textContent.includes('Hall')", "the zone is chosen")
        page.wait("document.querySelector('.commands') !== null", "its commands are shown")
        self.open_part(page, "schedule")
        event = next(one for one in self.box.document.events() if one.zone == HOME and one.code == "HWV")
        row = f'[data-event="{event.id}"]'
        self.press(page, f"{row} > button")
        page.wait(f"{TEXT}.includes('HGTKMH, team {TEAM}, round 1, run 1 is not signed off')", "what is left")
        self.press_twice(page, "[data-command=choose_event]")
        self.box.wait(lambda document: document.zones[HOME].event.id == event.id, "the event is chosen")
        page.wait(f"document.querySelector('{row}').matches('.current')", "the page shows it")
        for place, value, shown in ((0, "Hall", 2), (2, "2015-12-30", 1), (0, "", 1), (2, "2015-12-31", 4)):
            page.get(f"(s => (s.value = '{value}', s.dispatchEvent(new Event('change', {{bubbles: true}}))))"
                     f"(document.querySelectorAll('.filters select')[{place}])")
            page.wait(f"document.querySelectorAll('.event').length === {shown}", "only those of the zone and day")

    def test_a_zone_stands_on_the_colour_of_its_state(self) -> None:
        self.running()
        page = self.opened("overview")
        page.get("document.body.append(Object.assign(document.createElement('i'), {id: 'executing'}))")
        page.get("document.querySelector('#executing').style.background = 'var(--state-executing-band)'")
        page.wait(f"""['[data-zone="{HOME}"] .band', '#executing'].map(one => document.querySelector(one))
                  .map(one => one && getComputedStyle(one).backgroundColor)
                  .every((one, i, all) => one && one === all[0])""", "it is that of a run in progress")

    def test_an_event_is_not_chosen_while_a_run_is_connected(self) -> None:
        self.running()
        page = self.opened("schedule", "referee", HOME)
        self.assertEqual(page.get("[...document.querySelectorAll('.tabs button')].map(one => one.dataset.part)"),
                         ["zone", "schedule", "runs", "robots", "log", "box"])
        page.wait("document.querySelectorAll('.event').length === 3", "those of the own zone")
        self.press(page, ".event:last-child > button")
        page.wait(f"{TEXT}.includes('A run is running in Home. Stop it first.')", "why")
        self.assertTrue(page.get("document.querySelector('[data-command=choose_event]').disabled"))
        self.open_part(page, "robots")
        page.wait("document.querySelector('tbody tr:last-child').textContent.endsWith('Homejust now')", "the robot")
        page.wait("document.querySelector('tbody').textContent.includes('▮▮▮ good')", "its link")
        skew = r"[+\u2212-]\d+\.\d{3} s"  # of a busy computer, too
        self.assertRegex(page.get("document.querySelector('tbody').textContent"), skew)
        page.touch_at("button[data-command=stop]")
        self.box.wait(lambda document: document.zones[HOME].phase == "ended", "STOP works beside each part")

    def test_runs_with_history_reasons_and_sign_off(self) -> None:
        identity = self.ended()
        self.box.act("disconnect", HOME)
        page = self.opened("runs")
        run = f'[data-listed="{identity}"] '
        self.press(page, run + "[data-command=correct]")
        page.wait(f"document.querySelector('{run}.history') !== null", "the sheet is shown")
        page.get("document.querySelectorAll('.correction details').forEach(one => one.open = true)")
        self.press(page, run + "[data-command=withdraw]")
        page.fill(run + "[data-form=withdraw] input", "it was another robot")
        self.press(page, run + "[data-form=withdraw] > button")
        page.wait(f"document.querySelector('{run}.withdrawn').textContent.includes('another robot')", "it is withdrawn")
        self.press(page, run + "[data-command=stop_reason]")
        page.fill(run + "[data-form=stop_reason] input", "it fell over")
        sign_off = run + "[data-command=sign_off]"
        self.press(page, sign_off)
        self.press(page, run + "[data-form=stop_reason] > button")
        page.wait(f"document.querySelector('{run}.ends').textContent.includes('it fell over')", "the reason")
        self.assertFalse(page.get(f"document.querySelector('{sign_off}').textContent.includes('Press again')"),
                         "what was pressed once was another result")
        self.press_twice(page, run + "[data-command=sign_off]")
        page.wait(f"document.querySelector('{run}').textContent.includes('signed off by Olga')", "it stays in the list")
        sheet = self.box.call("sheet", zone=HOME, run=identity)
        self.assertEqual((sheet["history"][0]["withdrawn_note"], sheet["ends"][0]["reason"]),
                         ("it was another robot", "it fell over"))
        page.wait(f"document.querySelector('{run}.ends button, {run}[data-command=sign_off]') === null", "it is final")

    def test_the_log_grows_and_is_searched(self) -> None:
        self.running()
        page = self.opened("log")
        page.wait(f"{LOG}.textContent.includes('PREPARE')", "the log is shown")
        self.box.call("stop", zone=HOME, run=self.box.document.zones[HOME].identity, by="Rita")
        page.wait(f"{LOG}.textContent.includes('stopped by the referee')", "it grows")
        self.assertTrue(page.get(f"{LOG}.textContent.includes('PREPARE')"), "what was there stays")
        page.fill("input[type=search]", "prepare")
        page.wait(f"{LOG}.querySelector('.found.now').textContent.toLowerCase().includes('prepare')", "it is found")
        page.fill("input[type=search]", "no such text")
        page.wait(f"{TEXT}.includes('0 lines')", "nothing is found")
        page.get("(s => (s.value = 'online', s.dispatchEvent(new Event('change', {bubbles: true}))))"
                 "(document.querySelector('.filters select'))")
        page.wait(f"!{LOG}.textContent.includes('PREPARE')", "the other text")

    def test_changed_files_are_listed_and_then_applied(self) -> None:
        page = self.opened("box")
        self.press(page, "[data-command=reload]")
        page.wait(f"{TEXT}.includes('The files contain what is in force')", "nothing has changed")
        self.schedule.write_text(SCHEDULE + LATER)
        self.press(page, "[data-command=reload]")
        page.wait(f"{TEXT}.includes('Apply these changes?')", "the change is listed")
        self.assertEqual(len(self.box.document.schedule), 5, "it is only listed")
        self.press(page, "[data-command=apply]")
        self.box.wait(lambda document: len(document.schedule) == 6, "it is applied")
        page.wait(f"{TEXT}.includes('The changes are in force')", "the page says so")
        self.schedule.write_text(SCHEDULE.replace("HWV", "HWW"))
        self.press(page, "[data-command=reload]")
        page.wait(f"{TEXT}.includes('Correct this first') && {TEXT}.includes('HWW')", "errors are shown")
        self.assertIsNone(page.get("document.querySelector('[data-command=apply]')"))

    def test_the_day_is_edited_after_its_effect_was_shown_and_the_edit_undone(self) -> None:
        page = self.opened("schedule")
        before = self.schedule.read_text()
        self.choose(page, "action", "shift")
        self.choose(page, "zone", HOME)
        page.fill("[data-field=time]", "soon")
        self.press(page, "[data-command=look]")
        page.wait(f"{TEXT}.includes('is no delay')", "a mistake is explained")
        page.fill("[data-field=time]", "40")
        self.press(page, "[data-command=look]")
        page.wait("document.querySelector('[data-command=do]') !== null", "the effect is shown")
        self.assertIn("HGTKMH of " + TEAM, page.get(TEXT))
        self.assertEqual(self.schedule.read_text(), before, "nothing is changed")
        first = min(self.box.document.events(), key=lambda event: (event.zone != HOME, event.scheduled_utc_s))
        self.press(page, "[data-command=do]")
        self.box.wait(lambda document: document.schedule[first.id].scheduled_utc_s == first.scheduled_utc_s + 2400,
                      "it is in force")
        page.wait(f"{TEXT}.includes('The changes are in force')", "the page says so")
        self.assertIn("01:40:00", self.schedule.read_text())
        self.press(page, "[data-command=undo]")
        self.press(page, "[data-command=do]")
        self.box.wait(lambda document: document.schedule[first.id].scheduled_utc_s == first.scheduled_utc_s, "undone")
        page.wait("document.querySelectorAll('.day .chip').length === 1", "the list says so")
        self.assertEqual(page.inaccessible(), [])

    def choose(self, page: Page, field: str, value: str) -> None:
        """Choose something in a list of the form."""
        page.wait(f"""((node) => node && [...node.options].some(({{value}}) => value === {json.dumps(value)})
            && (node.value = {json.dumps(value)}, node.dispatchEvent(new Event("change", {{bubbles: true}}))))(
            document.querySelector("[data-field={field}]"))""", f"{field} is chosen")

    def test_home_devices_are_shown_and_operated(self) -> None:
        page = self.opened("box")
        row = "document.querySelector('[data-device={}]')"
        page.wait(f"{TEXT}.includes('● connected')", "the controller is connected")
        self.press(page, '[data-device=switch_2] [data-value="1"]')
        self.wait_controlled("switch_2 is set to 1")
        page.wait(f"{row.format('switch_2')}.innerText.includes('● ON\\n')", "the box has confirmed it")
        self.assertIn("○ off", page.get(f"{row.format('switch_1')}.innerText"))
        for kind, value in (("range", 37), ("number", 64)):
            page.get(f"(i => (i.value = {value}, ['input', 'change'].forEach(name => i.dispatchEvent(new Event(name, "
                     f"{{bubbles: true}})))))({row.format('dimmer')}.querySelector('[type={kind}]'))")
            self.wait_controlled(f"dimmer is set to {value}")
            page.wait(f"{row.format('dimmer')}.innerText.includes('{value} %\\n')", "it is confirmed")
        page.get(f"(i => (i.value = 5, i.dispatchEvent(new Event('input', {{bubbles: true}}))))"
                 f"({row.format('dimmer')}.querySelector('[type=number]'))")
        self.box.call("set_device", device="dimmer", value=80)
        page.wait(f"{row.format('dimmer')}.innerText.includes('80 %\\n')", "others set it, too")
        self.assertEqual(page.get(f"{row.format('dimmer')}.querySelector('[type=number]').value"), "5", "it is typed")
        self.press(page, "[data-device=bell] button")
        page.wait(f"{row.format('bell')}.innerText.includes('♪ RINGS')", "it rings")
        self.box.do(self.box.controller.close)
        page.wait(f"{TEXT}.includes('NOT CONNECTED') && {TEXT}.includes('takes effect when')", "it is away")

    def wait_controlled(self, report: str) -> None:
        """Wait until the controller reports something."""
        wait_until(lambda: report in self.box.controlled, lambda: f"{report}; {self.box.controlled}")

    def test_quick_changes_of_devices_are_sent_one_by_one_and_the_last_one_counts(self) -> None:
        page = self.opened("box")
        page.wait("document.querySelector('[data-device=blinds] [data-value]') !== null", "the devices are shown")
        page.wait("document.querySelector('[data-changed]') === null", "all buttons are on")
        page.get("""window.open_ = 0, window.most = 0, window.sent = [],
            window.gate = new Promise(go => { window.go = go; }), window.realFetch = fetch,
            window.fetch = async (path, what) => {
              if (!path.endsWith('set_device')) return realFetch(path, what);
              most = Math.max(most, open_ += 1);
              const {device, value} = JSON.parse(what.body);
              sent.push(`${device} ${value}`);
              await gate;
              return realFetch(path, what).finally(() => { open_ -= 1; });
            }, 0""")
        page.get("""['switch_1 1', 'blinds 100', 'blinds 0', 'blinds 100', 'switch_1 0'].forEach(one => {
            const [device, value] = one.split(' ');
            document.querySelector(`[data-device=${device}] [data-value='${value}']`).click(); })""")
        page.wait("document.querySelector('[data-device=blinds]').innerText.includes('100 % …')", "it waits")
        page.get("go(), 0")
        self.wait_controlled("blinds is set to 100")
        page.wait("!document.querySelector('.devices').innerText.includes('…')", "all are confirmed")
        self.assertEqual(page.get("sent"), ["switch_1 1", "switch_1 0", "blinds 100"])
        self.assertEqual(page.get("most"), 1, "STOP needs connections of the browser, too")

    def test_a_box_without_home_devices_says_so(self) -> None:
        self.box = ServedBox(self.schedule.parent / "other", schedule_file=str(self.schedule))
        self.addCleanup(self.box.close)
        page = self.opened("box")
        page.wait(f"{TEXT}.includes('this box controls no home devices: start it with devices:=true')", "it says so")

    def test_the_box_is_ended_after_a_question_that_names_the_runs(self) -> None:
        self.running()
        ended: List[str] = []
        self.box.program.on_exit = lambda: ended.append("box") or happened()
        page = self.opened("box")
        self.press(page, "[data-command=ask_exit]")
        page.wait(f"{TEXT}.includes('Runs in progress: Home (DummyRobot)')", "it asks")
        page.wait("document.querySelector('.exit [data-changed]') === null", "its buttons are on")
        self.assertEqual(ended, [])
        self.press(page, "[data-command=exit]")
        page.wait(f"{TEXT}.includes('The box has ended')", "the page says so")
        wait_until(lambda: ended, "the box ends")
        self.assertEqual(page.get("document.querySelector('fieldset')"), None, "nothing else is shown")
        page.get("live.reconnect(live.socket), 0")
        page.wait("document.querySelector('fieldset:not(:disabled)') !== null", "another box is shown")

    def test_a_device_is_paired_and_its_pairing_ended(self) -> None:
        page = self.opened("robots")
        self.press(page, "[data-command=new_code]")
        page.wait("document.querySelector('.code code') !== null", "a code is shown")
        self.assertEqual(page.get("document.querySelector('.square') === null"), False, "python3-qrcode is installed")
        url = page.get("document.querySelector('.square').getAttribute('aria-label')")
        other = self.browser.page(url, *PHONE, is_alone=True)
        other.fill("#person", "Rita")
        other.press("form button")
        other.wait_address("/referee")
        page.wait(f"{TEXT}.includes('Rita')", "it is listed")
        self.press_twice(page, "[data-command=end_pairing]")
        other.wait(f"{TEXT}.includes('This device is not paired')", "the phone says so")
        page.wait(f"!{TEXT}.includes('Rita')", "it is not listed any more")

    def test_keys_score_and_stop(self) -> None:
        identity = self.running()
        page = self.opened()
        page.wait("document.querySelectorAll('.sheet .item [data-changed]').length === 0 "
                  "&& document.querySelector('.sheet .item') !== null", "the sheet is shown")
        page.command("Input.dispatchKeyEvent", type="keyDown", key="1", code="Digit1")
        self.box.wait(lambda document: document.zones[HOME].items[0].value == 1, "the first item is a yes")
        page.command("Input.dispatchKeyEvent", type="keyDown", key="!", code="Digit1", modifiers=8)
        self.box.wait(lambda document: document.zones[HOME].items[0].value == 0, "and a no")
        asks = page.note("document.querySelector('.stopsaid').textContent.includes('Press again: Esc')")
        page.key("Escape")
        page.wait(asks, "it asks")
        self.assertEqual(self.box.document.zones[HOME].phase, "running")
        while self.box.document.zones[HOME].phase == "running":  # a busy machine may be too late: it is asked again
            page.key("Escape")
            page.get("new Promise(done => setTimeout(done, 300))")
        self.assertEqual(self.box.document.zones[HOME].phase, "ended")
        self.assertEqual(self.box.document.zones[HOME].identity, identity)

    def test_all_parts_are_accessible_and_fit_in_all_sizes(self) -> None:
        self.ended(HALL)
        self.box.act("disconnect", HALL)
        self.running()
        for language in ("en", "de"):
            page = self.opened(language=language)
            for part in PARTS:
                self.open_part(page, part)
                page.wait(f"document.querySelector('.all') && ({json.dumps(part)} === 'zone' "
                          "|| document.querySelector('.part').children.length > 1)", f"{part} is shown")
                for size in (PHONE, LOW, LAPTOP, LARGE):
                    page.resize(*size)
                    self.assertLessEqual(page.get("document.scrollingElement.scrollWidth"), size[0], (part, size))
                    self.assertEqual(page.get(CRAMPED), [], (part, size, language))
                    page.screenshot(SHOTS / f"web_box_{part}_{language}_{size[0]}.png")
                for size, scheme in ((PHONE, "light"), (LARGE, "dark")) if language == "en" or IS_ALL else ():
                    page.resize(*size)
                    feature = {"name": "prefers-color-scheme", "value": scheme}
                    page.command("Emulation.setEmulatedMedia", features=[feature])
                    self.assertEqual(page.inaccessible(), [], (part, scheme))
                    page.screenshot(SHOTS / f"web_box_{part}_{scheme}.png")
