"""The button that opens the box's page in the browser, with a fake core that has the calls of the web pages."""

from typing import Any, Mapping

from support.gui_testing import Qt, limit, wait_until
from support.panel_case import PanelCase

from roah_rsbb.document.calls import Caller
from roah_rsbb.model.reason import Refused
from roah_rsbb.rqt.panels import benchmark_control
from roah_rsbb.wording.device import NO_WEB


class TestPagesButton(PanelCase):
    def setUp(self) -> None:
        limit(self, benchmark_control, "AGAIN_MS", 1)
        super().setUp()
        self.button = self.panel.pages
        self.asked, self.opened, self.has_browser = [], [], True
        limit(self, benchmark_control, "open_in_browser", self.open_in_browser)

    def open_in_browser(self, url: str) -> bool:
        self.opened.append(url)
        return self.has_browser

    def serve(self) -> None:
        self.core.add_call("paired", lambda given, caller: {"devices": []})
        self.core.add_call("pair", self.pair)
        wait_until(self.button.isEnabled, "the button is on")

    def pair(self, given: Mapping[str, Any], caller: Caller) -> Any:
        self.asked.append((given["role"], given["zone"]))
        return {"code": "ABCD-EFGH", "url": "http://192.0.2.1:8081/pair#ABCD-EFGH-JK", "valid": 120.0}

    def press(self, text: str) -> None:
        next(action for action in self.button.menu().actions() if action.text() == text).trigger()

    def test_each_part_is_opened_with_a_code_once_pages_are_served(self) -> None:
        wait_until(lambda: NO_WEB in self.button.toolTip(), "it says why it is off")
        self.assertFalse(self.button.isEnabled())
        self.serve()
        first = self.panel.nextInFocusChain()
        while not (first.focusPolicy() & Qt.TabFocus and first.isEnabled()):
            first = first.nextInFocusChain()
        self.assertIs(first, self.panel.zones, "a stray space bar does not open it")
        self.client.referee.set("Anna & Ben")
        parts = {action.text(): part for action, part in zip(self.button.menu().actions(), benchmark_control.PARTS)}
        self.assertEqual(list(parts), ["Results, history, judges", "Schedule", "Pair phones and tablets"])
        for text, part in parts.items():
            self.press(text)
            url = f"http://192.0.2.1:8081/pair?part={part}&zone=Home+A&person=Anna+%26+Ben#ABCD-EFGH-JK"
            wait_until(lambda url=url: self.opened[-1:] == [url], lambda: f"it is opened: {self.opened}")
        self.assertEqual(self.asked, [("organiser", "")] * 3)
        self.wait_answered()
        self.assertEqual(self.panel.answer.text(), " ")

    def test_without_a_browser_it_says_what_to_open(self) -> None:
        self.serve()
        self.has_browser = False
        self.press("Schedule")
        wait_until(lambda: "Open http://192.0.2.1:8081/pair in one, and type the code ABCD-EFGH" in
                   self.panel.answer.text(), "the address and the code are shown")

    def test_pages_that_are_gone_turn_it_off(self) -> None:
        self.serve()
        for name in ("paired", "pair"):
            self.core.add_call(name, self.core_without_pages)
        self.press("Schedule")
        wait_until(lambda: not self.button.isEnabled() and NO_WEB in self.panel.answer.text(), "it is off")

    @staticmethod
    def core_without_pages(given: Mapping[str, Any], caller: Caller) -> Any:
        raise Refused([NO_WEB])
