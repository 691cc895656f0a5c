"""The dialog that pairs phones, with a fake core that has the calls of the web pages."""

from typing import Any, Mapping
from unittest import mock

from support.gui_testing import LONG_S, click, limit, wait_until
from support.panel_case import PanelCase

from roah_rsbb import qr_code
from roah_rsbb.document.calls import Caller
from roah_rsbb.rqt.widgets import basic, pair_dialog
from roah_rsbb.rqt.widgets.pair_dialog import PairDialog


class TestPairDialog(PanelCase):
    """Codes and devices."""

    def setUp(self) -> None:
        super().setUp()
        self.asked = []
        self.devices = [
            {"id": number, "role": "referee", "zone": "Home A", "person": person, "device": "iPhone", "paired": 0.0,
             "seen": 0.0, "connected": True}
            for number, person in (("1f3c9a02", "Anna"), ("5d", "Ben"))
        ]
        for name, call in (("pair", self.pair), ("revoke", self.revoke),
                           ("paired", lambda given, caller: {"devices": self.devices})):
            self.core.add_call(name, call)

    def pair(self, given: Mapping[str, Any], caller: Caller) -> Any:
        self.asked.append((given["role"], given["zone"]))
        code = f"ABCD-EFG{len(self.asked) + 1}"
        return {"code": code, "url": f"http://192.0.2.1:8081/pair#{code}", "valid": 120.0}

    def revoke(self, given: Mapping[str, Any], caller: Caller) -> Any:
        self.devices = [one for one in self.devices if one["id"] != given["device"]]
        return {"revoked": 1}

    def open_dialog(self) -> PairDialog:
        """Open the dialog by its menu entry."""
        self.panel.more.pair.trigger()
        dialog = self.panel.findChildren(PairDialog)[-1]
        self.addCleanup(dialog.reject)
        return dialog

    def test_codes_and_devices(self) -> None:
        dialog = self.open_dialog()
        wait_until(lambda: dialog.code.text() == "ABCD-EFG2", "a code is shown")
        self.assertIn("http://192.0.2.1:8081/pair ", dialog.how.text())
        self.assertIn("not encrypted", dialog.how.text())
        if qr_code.modules_of("text") is not None:
            self.assertTrue(dialog.square.isVisible())
            self.assertEqual(dialog.square.accessibleName(), "http://192.0.2.1:8081/pair#ABCD-EFG2")
        dialog.roles.setCurrentIndex(2)
        click(dialog.make)
        wait_until(lambda: dialog.code.text() == "ABCD-EFG3", "another code is shown")
        self.assertEqual(self.asked, [("referee", "Home A"), ("organiser", "")])
        wait_until(lambda: dialog.devices.topLevelItemCount() == 2, "both devices are listed")
        self.assertEqual([dialog.devices.topLevelItem(0).text(column) for column in range(4)],
                         ["Anna", "Referee in Home A", "iPhone", "connected"])
        click(dialog.devices.itemWidget(dialog.devices.topLevelItem(0), 4))
        limit(self, basic, "HOLD_MS", round(1000 * LONG_S))
        wait_until(lambda: dialog.devices.topLevelItemCount() == 1, "the pairing is ended")
        other = dialog.devices.topLevelItem(0)
        self.assertEqual(other.text(0), "Ben")
        self.assertFalse(dialog.devices.itemWidget(other, 4).isEnabled(), "a double click ends one pairing only")

    def test_without_the_library_the_code_is_typed(self) -> None:
        with mock.patch.object(pair_dialog.qr_code, "modules_of", return_value=None):
            dialog = self.open_dialog()
            wait_until(lambda: dialog.code.text() == "ABCD-EFG2", "a code is shown")
        self.assertFalse(dialog.square.isVisible())
        self.assertIn(qr_code.INSTALL, dialog.how.text())

    def test_a_code_becomes_too_old(self) -> None:
        dialog = self.open_dialog()
        wait_until(lambda: dialog.code.text() == "ABCD-EFG2", "a code is shown")
        dialog._valid_until -= 120.0
        wait_until(lambda: "too old" in dialog.how.text(), "the code is not offered any more")
        self.assertFalse(dialog.square.isVisible())
