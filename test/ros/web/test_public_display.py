"""The public display's program: its browser fills the screen, comes back, and ends. The page is one of the test."""

import http.server
import os
import pathlib
import re
import signal
import sys
import threading
import unittest
from typing import List

import rospy
import rosservice
from support.gui_testing import SCREEN
from support.programs import Program, own
from support.real_input import close_all_windows
from support.waiting import happened, wait_until

from roah_rsbb.ros.browser import PAGE, find
from roah_rsbb.ros.public import URL
from roah_rsbb.srv import UInt8
from roah_rsbb.tools.reconnect import own_processes

LAUNCH = pathlib.Path(__file__).resolve().parents[3] / "launch" / "roah_rsbb_public.launch"
SAY_SIZE = "<script>onresize = () => fetch(`/size/${innerWidth}x${innerHeight}`); onresize()</script>"
# Without a window manager, Chromium leaves a line of pixels free.
WHOLE = {f"/size/{SCREEN[0] - free}x{SCREEN[1] - free}" for free in (0, 1)}


class Box(http.server.ThreadingHTTPServer):
    """A server of pages at an address of its own. Each page says what size it has."""

    def __init__(self, case: unittest.TestCase) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.asked: List[str] = []
        self.address = f"http://127.0.0.1:{self.server_port}/"
        threading.Thread(target=self.serve_forever, daemon=True).start()
        case.addCleanup(self.server_close)
        case.addCleanup(self.shutdown)

    def wait_shown(self) -> int:
        """Wait until a new page fills the screen; returns the process of its browser."""
        wait_until(lambda: f"/{PAGE}" in self.asked and WHOLE & set(self.asked),
                   lambda: f"the page fills the screen; it asked for {self.asked}")
        self.asked.clear()
        return self.browsers()[0]

    def browsers(self) -> List[int]:
        """The processes that show the page."""
        return [each.pid for each in own_processes() if self.address + PAGE in each.words]


class _Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.server.asked.append(self.path)
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(SAY_SIZE.encode())
        happened()

    def log_message(self, *_) -> None:
        pass


class TestPublicDisplay(unittest.TestCase):
    """The launch file and the program, as organisers use them."""

    def setUp(self) -> None:
        if find() is None:
            text = "NOT TESTED: the public display's program. No browser here has a window: apt-get install chromium"
            print(f"\n{'!' * 100}\n!!! {text}\n{'!' * 100}", file=sys.stderr, flush=True)
            self.skipTest(text)

    def test_the_page_stays_open_until_its_window_is_closed(self) -> None:
        launch = Program("roslaunch", str(LAUNCH))
        self.addCleanup(launch.close)
        launch.wait_printed("the box serves no pages")
        first, second = Box(self), Box(self)
        rospy.set_param(URL, first.address)
        self.addCleanup(rospy.delete_param, URL)
        os.kill(first.wait_shown(), signal.SIGKILL)
        first.wait_shown()
        names = rosservice.get_service_list()
        (service,) = [name for name in names if re.fullmatch("/roah_rsbb_public_[^/]+/screen", name)]
        choose = rospy.ServiceProxy(service, UInt8)
        with self.assertRaisesRegex(rospy.ServiceException, "no screen 9: give 0 to 1"):
            choose(9)
        choose(1)
        launch.wait_printed("on screen 1")
        choose(0)
        rospy.set_param(URL, second.address)
        second.wait_shown()
        self.assertEqual(first.browsers(), [])
        close_all_windows()
        launch.wait_ended()
        self.assertEqual(second.browsers(), [])
        self.assertNotIn("Traceback", launch.text)

    def test_the_browser_ends_with_the_program(self) -> None:
        box = Box(self)
        rospy.set_param(URL, box.address)
        self.addCleanup(rospy.delete_param, URL)
        for number in (signal.SIGINT, signal.SIGKILL):
            program = Program(own("roah_rsbb_public"))
            self.addCleanup(program.close)
            box.wait_shown()
            program.signal(number)
            program.wait_ended()
            wait_until(lambda: box.browsers() == [], "the browser has ended")
