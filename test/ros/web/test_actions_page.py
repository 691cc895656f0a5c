"""The referee's page has every action of the table, also those for which it has no place of its own."""

import pathlib
from typing import Any
from unittest import mock

from support.browser import NeedsBrowser
from support.fakes.gateway import FakeGateway

from helpers.forms import ODD, ODD_ASKED
from roah_rsbb.model.actions import ACTIONS, EVERY, Action, Row
from roah_rsbb.model.fields import Choice, Number, Toggle, TypedText
from roah_rsbb.model.reason import say
from web.test_stop_page import CLICKED

SHOTS = pathlib.Path(__file__).resolve().parents[3] / "build" / "screenshots"
NEW = {
    "extend": Action(
        "extend", say("More time"), say("Give the run more time"),
        (Number("seconds", say("How long"), low=1, high=600, unit="s"), TypedText("reason", say("Reason")),
         Choice("who", say("Who asked"), required=False, choices=("team", "jury")),
         Toggle("quiet", say("Without a sound"), required=False))),
    "call_jury": Action("call_jury", say("Call the jury"), say("The jury comes to this zone"), row=Row.CLOCK),
    "cross_out": Action("cross_out", say("Cross the event out"), say("It is not repeated"), careful=True, aims=True),
}
FORM = "document.querySelector('.form')"
ACT = f"{FORM}.querySelector('button[data-command=extend]')"


class TestActions(NeedsBrowser):
    def setUp(self) -> None:
        super().setUp()
        for table in (ACTIONS, EVERY):
            patched = mock.patch.dict(table, NEW)
            patched.start()
            self.addCleanup(patched.stop)
        self.gateway = FakeGateway()
        self.addCleanup(self.gateway.close)
        self.gateway.set(phase="running")

    def given(self, name: str) -> Any:
        """The fields of the command that was given."""
        self.gateway.wait_given(name, "Home A")
        return next(fields for given, _, fields in self.gateway.given if given == name)

    def test_an_action_with_fields_has_a_form(self) -> None:
        page = self.gateway.phone(self.browser, (390, 844))
        page.wait(f"{FORM} !== null", "the form is there")
        page.wait(CLICKED.format(".to-more:last-child"), "the drawer is opened")
        page.get(f"{FORM}.closest('details').open = true, {FORM}.scrollIntoView({{block: 'center'}})")
        self.assertIn("Give the run more time", page.get(f"{FORM}.textContent"))
        self.assertTrue(page.get(f"{ACT}.disabled"), "what is required is missing")
        SHOTS.mkdir(parents=True, exist_ok=True)
        page.screenshot(SHOTS / "action_form.png")
        page.fill(".form input[type=number]", "90")
        page.fill(".form input[maxlength]", "the door")
        page.get(f"{FORM}.querySelector('input[type=checkbox]').click()")
        page.get(f"(choice => (choice.value = 'jury', choice.dispatchEvent(new Event('change', {{bubbles: true}}))))"
                 f"({FORM}.querySelector('select'))")
        page.wait(f"!{ACT}.disabled", "it may be done now")
        page.wait(CLICKED.format(".form button[data-command=extend]"), "it is done")
        self.assertEqual(self.given("extend"), {
            "identity": "Home A run 1", "event_id": "",
            "given": {"seconds": 90, "reason": "the door", "who": "jury", "quiet": True}})
        page.wait(f"{FORM}.querySelector('input[type=number]').value === ''", "it is done, and the form is empty again")

    def test_the_form_of_a_module_that_nobody_knows_is_filled_in(self) -> None:
        page = self.gateway.phone(self.browser, (390, 844))
        self.gateway.do(lambda: setattr(self.gateway.zones[0], "form", ODD))
        self.gateway.set(operation=ODD_ASKED)
        asks = "document.querySelector('.now')"
        page.wait(f"{asks} !== null", "the form is there")
        for text in (ODD_ASKED, *(str(field.label) for field in ODD)):
            self.assertIn(text, page.get(f"{asks}.textContent"))
        act = f"{asks}.querySelector('button[data-command=operation]')"
        page.wait(f"{act} || (scrollTo(0, 9999), false)", "the end of what is asked was seen")
        self.assertTrue(page.get(f"{act}.disabled"), "what is required is missing")
        page.screenshot(SHOTS / "module_form.png")
        page.get(f"{asks}.querySelector('input[type=checkbox]').click()")
        page.fill(".now input[type=number]", "2")
        page.fill(".now input[maxlength]", "1.25 0,40 90")
        page.get(f"(choice => (choice.value = 'floor', choice.dispatchEvent(new Event('change', {{bubbles: true}}))))"
                 f"({asks}.querySelector('select'))")
        page.wait(CLICKED.format(".now button[data-command=operation]"), "it is answered")
        self.assertEqual(self.given("operation"), {
            "identity": "Home A run 1", "event_id": "",
            "given": {"operation": 7, "held": True, "drops": 2, "place": "floor", "pose": "1.25 0,40 90"}})
        page.wait(f"{asks} === null", "nothing is asked any more")

    def test_an_action_without_fields_is_a_button_in_its_row(self) -> None:
        page = self.gateway.phone(self.browser, (390, 844))
        page.wait(CLICKED.format(".commands [data-command=call_jury]"), "it is in the drawer")
        self.assertEqual(self.given("call_jury")["given"], {})
        page.wait(CLICKED.format(".commands [data-command=cross_out]"), "it is in the drawer")
        page.wait("document.querySelector('[data-command=cross_out]').textContent.includes('Press again')", "it asks")
        self.assertEqual(self.gateway.count("cross_out"), 0)
        page.wait(CLICKED.format("[data-command=cross_out]"), "once more")
        self.given("cross_out")
