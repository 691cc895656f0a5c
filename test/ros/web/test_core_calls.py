"""Commands of paired devices as calls to the core: only an answer of the core ends the repetition of a STOP."""

import asyncio
import threading
import unittest
from typing import Any, Callable
from unittest import mock

import genpy
import rospy

from roah_rsbb.nodes.web import core_calls
from roah_rsbb.nodes.web.core_calls import MAX_WAITING, TOO_MANY, CoreCalls
from roah_rsbb.web.commands import Command, Outcome
from roah_rsbb.web.pairing import REFEREE, Grant, Session


class Ros:
    """A loop that takes calls from threads, as that of a node does."""

    def __init__(self) -> None:
        self.loop = asyncio.new_event_loop()

    def post(self, call: Callable[[], object]) -> None:
        """Call it in the loop."""
        self.loop.call_soon_threadsafe(call)


class TestCoreCalls(unittest.TestCase):
    """The core's services are replaced."""

    def setUp(self) -> None:
        self.ros = Ros()
        self.addCleanup(self.ros.loop.close)
        self.calls = CoreCalls(self.ros)
        proxy = mock.patch.object(core_calls, "KnownService", lambda *_of, **_how: self.service)
        proxy.start()
        self.addCleanup(proxy.stop)

    def stop(self) -> Outcome:
        """A device's STOP."""
        session = Session("id", Grant(REFEREE, "Home"), "Anna", "Linux", 0.0)
        return self.ros.loop.run_until_complete(
            self.calls.carry_out(Command("stop", "Home", session, {"identity": "run 1"})))

    def outcome(self, error: Exception) -> Outcome:
        """The outcome of a STOP whose call ends so."""
        self.service = mock.Mock(side_effect=error)
        return self.stop()

    def test_what_the_core_answers_is_a_refusal(self) -> None:
        refused = self.outcome(rospy.ServiceException(
            "service [/core/stop_run] responded with an error: b'service cannot process request: the run is over'"))
        self.assertEqual(refused, Outcome(("the run is over",)))

    def test_what_cannot_be_sent_is_a_refusal(self) -> None:
        self.assertEqual(self.outcome(genpy.SerializationError("too large")), Outcome(("too large",)))

    def test_a_call_without_an_answer_is_no_refusal(self) -> None:
        for error in (
            rospy.ServiceException("service [/core/stop_run] unavailable"),
            rospy.exceptions.TransportTerminated("the core was killed after it was connected"),
            rospy.exceptions.ROSInterruptException("node shutdown interrupted service call"),
            rospy.impl.validators.ParameterInvalid("rospy found no address, as the master was away"),
        ):
            with self.subTest(error=type(error).__name__):
                self.assertEqual(self.outcome(error), Outcome((str(error),), is_known=False))

    def test_a_stop_beside_many_that_wait_is_no_refusal(self) -> None:
        hanging = threading.Event()

        def service(*_request: Any) -> None:
            hanging.wait()
            raise rospy.ServiceException("too late")

        def end() -> None:
            hanging.set()
            for thread in threading.enumerate():
                if thread.name == "stop":
                    thread.join()

        self.addCleanup(end)
        self.service = service
        with mock.patch.object(core_calls, "TIMEOUT_S", 0.01):
            for _ in range(MAX_WAITING[True]):
                self.assertFalse(self.stop().is_known)
            self.assertEqual(self.stop(), Outcome((TOO_MANY,), is_known=False))
