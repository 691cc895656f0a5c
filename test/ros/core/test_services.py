"""The core's services turn a call into an event with the caller's name, and answer reliably."""

import json
import unittest

import rospy

from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.copies import unconfirmed
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.referee import Refused, RunName
from roah_rsbb.msg import Score
from roah_rsbb.nodes.core.services import CoreServices
from roah_rsbb.srv import (
    Act,
    GetClock,
    GetRunSheet,
    StopRun,
    Zone,
    ZoneScore,
    ZoneUInt8,
)

NOW = Now(12.5, 1447000000.25)
RUN = RunName("Home", "HWV-1-2")
TICKET = 7
ITEM = {"number": 4, "value": 2, "not_attempted": False, "text": "2.5"}
RECORD = RunRecord(RUN.identity, "Home", "HWV", "Alpha", 1, 2, 0.0, 0.0)


class _Part:
    """Takes events for the box or a part of it, and puts down which."""

    def __init__(self, box, name) -> None:
        self._box = box
        self._name = name

    def __getattr__(self, method):
        def event(*arguments):
            if self._box.refuses:
                raise Refused(["no such run"] if method == "record_of" else ["first reason", "second reason"])
            if method == "why":
                return None
            self._box.happened.append((self._name + method, *arguments))
            return RECORD

        return event


class _Box:
    """A box whose parts record the calls of the services."""

    def __init__(self) -> None:
        self.happened = []
        self.refuses = False
        self.act = _Part(self, "").act
        self.outcome = lambda target, action, given: ITEM if action == "mark" else {}
        self.scores = _Part(self, "scores.")
        self.modules = _Part(self, "modules.")


class _Services:
    """Like LoopServices, but carries everything out in the threads of rospy."""

    def __init__(self) -> None:
        self.inside = False

    def add(self, name, kind, handle, wait=None, is_urgent=False):
        def answer(request):
            self.inside = True
            try:
                result = handle(request)
            finally:
                self.inside = False
            return wait(result) if wait else result

        rospy.Service(name, kind, answer)


class TestServices(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.box, cls.services = _Box(), _Services()

        def why_not_saved(ticket):
            assert ticket == TICKET
            cls.box.happened.append("blocks the loop" if cls.services.inside else "on disk")
            return cls.disk_trouble

        class Answer:
            """A question to the standby."""

            def result(self, _limit_s):
                cls.box.happened.append("blocks the loop" if cls.services.inside else "on the standby")
                return cls.standby_trouble

        def ask_standby(ticket):
            assert ticket == TICKET
            return Answer() if cls.waits else None

        cls.disk_trouble, cls.standby_trouble, cls.waits = "", "", False
        CoreServices(cls.box, cls.services, lambda method, *arguments: method(NOW, *arguments), lambda: TICKET,
                     why_not_saved, ask_standby, lambda: cls.box.happened.append("renewed"))

    def setUp(self) -> None:
        self.node = rospy.get_name()
        self.box.happened, self.box.refuses = [], False

    def call(self, name, kind, *request):
        """Call /core/NAME. Returns the events so far."""
        rospy.wait_for_service(f"/core/{name}", 30)
        rospy.ServiceProxy(f"/core/{name}", kind)(*request)
        return list(self.box.happened)

    def test_commands_have_the_name_of_the_calling_node(self) -> None:
        for name in ("connect", "disconnect", "start", "stop", "previous", "next"):
            with self.subTest(name):
                self.box.happened = []
                given = {"running": True} if name == "disconnect" else {}
                self.assertEqual(self.call(name, Zone, "Home"), [("act", NOW, Target("Home"), name, self.node, given)])
        for name, kind, request, event in (
            ("stop_run", StopRun, (RUN.identity,), ("scores.stop", NOW, RUN, self.node)),
            ("stop_run", StopRun, ("",), ("scores.stop", NOW, RunName("Home"), self.node)),
            ("manual_operation_complete", Zone, (), ("act", NOW, Target("Home"), "operation", self.node)),
            ("omf_switches/button", ZoneUInt8, (4,), ("act", NOW, Target("Home"), "switch", self.node, {"number": 4})),
            ("omf_switches/damaged", ZoneUInt8, (2,),
             ("act", NOW, Target("Home"), "damaged", self.node, {"number": 2})),
            ("omf_switches/complete", Zone, (), ("act", NOW, Target("Home"), "confirm_switches", self.node)),
        ):
            with self.subTest(name):
                self.box.happened = []
                self.assertEqual(self.call(name, kind, "Home", *request), [event])

    def test_an_action_has_the_run_and_the_event_that_its_caller_sees(self) -> None:
        rospy.wait_for_service("/core/act", 30)
        act = rospy.ServiceProxy("/core/act", Act)
        act("no_show", "Home", RUN.identity, "e1", '{"team": "Alpha"}', "Anna")
        act("start", "Home", "", "", "", "")
        self.assertEqual(self.box.happened, [
            ("act", NOW, Target("Home", RUN.identity, "e1"), "no_show", f"Anna ({self.node})", {"team": "Alpha"}),
            ("act", NOW, Target("Home"), "start", self.node, {})])
        for broken in ("[]", "{", "7", "[" * 400):
            with self.assertRaisesRegex(rospy.ServiceException, "not a JSON object, such as"):
                act("start", "Home", "", "", broken, "")

    def test_what_a_referee_writes_down_is_on_the_standby_when_the_call_returns(self) -> None:
        type(self).waits = True
        self.addCleanup(setattr, type(self), "waits", False)
        event = ("act", NOW, Target(*RUN), "sign_off", self.node, {})
        self.assertEqual(self.call("act", Act, "sign_off", *RUN, "", "", ""), [event, "on disk", "on the standby"])
        self.box.happened = []
        self.assertEqual(self.call("start", Zone, "Home"), [("act", NOW, Target("Home"), "start", self.node, {})])

    def test_what_a_referee_writes_down_is_on_the_disk_when_the_call_returns(self) -> None:
        named = f"Anna ({self.node})"
        for name, kind, request, event in (
            ("set_score", ZoneScore, ("Home", Score("G", "d", 2)),
             ("act", NOW, Target("Home"), "mark", self.node, {"group": "G", "desc": "d", "value": 2})),
            ("act", Act, ("withdraw", *RUN, "", '{"entry": 7}', "Anna"),
             ("act", NOW, Target(*RUN), "withdraw", named, {"entry": 7})),
        ):
            with self.subTest(name):
                self.box.happened = []
                self.assertEqual(self.call(name, kind, *request), [event, "on disk"])

    def test_the_answer_to_a_mark_has_the_item_as_it_is_then(self) -> None:
        rospy.wait_for_service("/core/act", 30)
        act = rospy.ServiceProxy("/core/act", Act)
        given = {"group": "G", "desc": "d", "added": "-1", "id": "id 1"}
        answer = act("mark", *RUN, "", json.dumps(given), " Anna ")
        self.assertEqual(self.box.happened, [
            ("act", NOW, Target(*RUN), "mark", f"Anna ({self.node})", given), "on disk"])
        self.assertEqual(json.loads(answer.answer), ITEM)
        self.assertEqual(act("start", "Home", "", "", "", "").answer, "")

    def test_a_name_in_the_header_goes_with_requests_that_have_no_field_for_it(self) -> None:
        rospy.wait_for_service("/core/stop_run", 30)
        rospy.ServiceProxy("/core/stop_run", StopRun, headers={"referee": " Jürgen = J. "})(*RUN)
        self.assertEqual(self.box.happened, [("scores.stop", NOW, RUN, f"Jürgen = J. ({self.node})")])

    def test_a_refusal_has_all_reasons_and_waits_for_no_disk(self) -> None:
        self.box.refuses = True
        reasons = r'\["first reason", "second reason"\]'
        for name, kind, request in (
            ("stop", Zone, ("Home",)), ("act", Act, ("sign_off", *RUN, "", "", "Anna")),
        ):
            with self.subTest(name), self.assertRaisesRegex(rospy.ServiceException, reasons):
                self.call(name, kind, *request)
        self.assertEqual(self.box.happened, [])

    def test_a_score_that_is_not_on_the_disk_is_not_confirmed(self) -> None:
        type(self).disk_trouble = "the disk is full"
        self.addCleanup(setattr, type(self), "disk_trouble", "")
        with self.assertRaisesRegex(rospy.ServiceException, "not saved: the disk is full. It counts"):
            self.call("act", Act, "sign_off", *RUN, "", "", "Anna")

    def test_a_score_that_the_standby_does_not_have_is_not_confirmed(self) -> None:
        type(self).standby_trouble, type(self).waits = unconfirmed("no standby"), True
        self.addCleanup(setattr, type(self), "standby_trouble", "")
        self.addCleanup(setattr, type(self), "waits", False)
        with self.assertRaisesRegex(rospy.ServiceException, "not confirmed: no standby. It counts, and is saved on"):
            self.call("act", Act, "sign_off", *RUN, "", "", "Anna")
        self.box.happened = []
        self.call("stop", Zone, "Home")
        self.assertEqual(len(self.box.happened), 1)

    def test_the_clock_is_that_of_the_loop(self) -> None:
        rospy.wait_for_service("/core/clock", 30)
        self.assertEqual(rospy.ServiceProxy("/core/clock", GetClock)().clock.to_sec(), NOW.utc)
        self.assertEqual(self.box.happened, ["renewed"], "whoever asks waits for newer messages")

    def test_the_sheet_of_a_run(self) -> None:
        rospy.wait_for_service("/core/run_sheet", 30)
        sheet = rospy.ServiceProxy("/core/run_sheet", GetRunSheet)(*RUN).sheet
        self.assertEqual((sheet.summary.identity, sheet.summary.run), (RUN.identity, 2))
        self.assertEqual(self.box.happened, [("scores.record_of", NOW, RUN)])
        self.box.refuses = True
        with self.assertRaisesRegex(rospy.ServiceException, "no such run"):
            self.call("run_sheet", GetRunSheet, *RUN)
