"""Node roah_rsbb_public: the public display, a page of the box in a browser that fills the screen.

It opens the page as soon as the box serves it, opens it again if the browser crashes or the box has another address,
and ends when the window is closed (Alt-F4). Everything else is in the page (docs/public_display.md).

Parameter (private): screen (its number, from 0).
"""

import contextlib
import ctypes
import os
import shutil
import signal
import subprocess
import threading
import time
import xmlrpc.client
from http.client import HTTPException
from typing import Any, List, Optional

import rosgraph
import rospy

from roah_rsbb.ground.params import BadParams
from roah_rsbb.ros.browser import addresses, answers, command, find, make_profile
from roah_rsbb.ros.display import Screen, screens
from roah_rsbb.ros.node import NodeParams, run_node
from roah_rsbb.srv import UInt8, UInt8Response

URL = "/roah_rsbb_web/url"  # the core's parameter
ASK_S, LOOK_S, CLOSE_S, REOPEN_S = 2.0, 0.2, 2.0, 1.0
# A browser that ends sooner has failed; after this many failures in a row the program gives up.
SHORT_LIFE_S, MAX_SHORT_LIVES = 5.0, 5
_die_with_parent = ctypes.CDLL(None).prctl


class CannotShow(Exception):
    """The page cannot be shown on this computer. The text names the remedy."""


class PublicDisplay:
    """The node. Raises `BadParams` and `CannotShow` at the start."""

    def __init__(self, found: List[Screen]) -> None:
        """`found`: the screens."""
        params = NodeParams()
        number = params.whole("screen", 0, 0, 255)
        params.done()
        self._address, self._said = "", ""  # of the page, when it is known; what was logged
        self._process: Optional[subprocess.Popen] = None
        program = find()
        if not found or program is None:
            self._ask()
            raise CannotShow(("no browser: install one (sudo apt install chromium, or firefox-esr)" if found else
                              "no display: log in at the screen, and start it there") +
                             f". Or open {self._address or 'http://ADDRESS_OF_THE_BOX:8081/display'} in any browser")
        if number >= len(found):
            rospy.logwarn("There is no screen %d: screen 0 is used", number)
            number = 0
        self._program, self._screens, self._number = program, found, number
        rospy.loginfo("Screens: %s", ", ".join(f"{i} ({each})" for i, each in enumerate(found)))
        self._profile = make_profile(program)
        rospy.Service("screen", UInt8, self._choose)

    def run(self) -> int:
        """Keep the page open until the window is closed or ROS ends; returns the exit status."""
        # The master may take long to answer if its computer is off.
        threading.Thread(target=self._follow, daemon=True).start()
        opened, opened_mono, short_lives = ("", self._number), 0.0, 0
        try:
            while not rospy.is_shutdown():
                code = None if self._process is None else self._process.poll()
                if code is not None:
                    short_lives = short_lives + 1 if time.monotonic() - opened_mono < SHORT_LIFE_S else 0
                    if code == 0:
                        rospy.loginfo("The window was closed, or its browser ended by itself: the display ends")
                        return 0
                    if short_lives >= MAX_SHORT_LIVES:
                        raise CannotShow(f"{self._program} fails (exit code {code}): install another browser")
                    rospy.logwarn("The browser ended (exit code %d): it is opened again", code)
                    time.sleep(REOPEN_S)
                wanted = address, number = self._address, self._number
                if address and (code is not None or wanted != opened):
                    self._close()
                    opened, opened_mono = wanted, time.monotonic()
                    rospy.loginfo("Opening %s on screen %d with %s", address, number, self._program)
                    self._process = subprocess.Popen(
                        command(self._program, self._profile, number, self._screens[number], address),
                        stdin=subprocess.DEVNULL, start_new_session=True,
                        preexec_fn=lambda: _die_with_parent(1, signal.SIGTERM))
                time.sleep(LOOK_S)
        finally:
            self._close()
            shutil.rmtree(self._profile, ignore_errors=True)
        return 0

    def _close(self) -> None:
        """End the browser with all its processes."""
        for number in (signal.SIGTERM, signal.SIGKILL) if self._process is not None else ():
            with contextlib.suppress(ProcessLookupError, subprocess.TimeoutExpired):
                os.killpg(self._process.pid, number)
                self._process.wait(CLOSE_S)

    def _choose(self, request: Any) -> UInt8Response:
        """The original's service. It starts the browser again: none can be moved."""
        if request.data >= len(self._screens):
            raise rospy.ServiceException(f"there is no screen {request.data}: give 0 to {len(self._screens) - 1}")
        self._number = request.data
        return UInt8Response()

    def _follow(self) -> None:
        while True:
            self._ask()
            time.sleep(ASK_S)

    def _ask(self) -> None:
        """Find out where the page is. While it does not answer, it stays where it was: it connects again by itself."""
        master = rosgraph.get_master_uri()
        why = f"the box serves no pages yet (parameter {URL}). If it stays so, start it without web:=false, and with "\
              "'sudo apt install python3-tornado' on its computer"
        try:
            url = str(rospy.get_param(URL, ""))
            places = addresses(url, master)
            if url and not places:
                why = f"parameter {URL} is {url!r}, no address of a web page: restart the box's web gateway"
        except (OSError, rosgraph.MasterException, xmlrpc.client.Error, HTTPException):
            places, why = [], f"the ROS master at {master} does not answer: start the box, or correct ROS_MASTER_URI"
        if self._address not in places:
            self._address = next(filter(answers, places), self._address)
        if self._address in places:
            why = ""
        elif places:
            why = f"nothing answers at {' or '.join(places)}: check the network and the box"
        if why and why != self._said:
            rospy.logwarn("Waiting for the page of the public display: %s", why)
        elif self._said and not why:
            rospy.loginfo("The page of the public display is there: %s", self._address)
        self._said = why


def main() -> None:
    """Entry point of the node."""
    found: List[Screen] = []  # they cannot be looked for later
    run_node("roah_rsbb_public", __doc__, lambda: PublicDisplay(found), (BadParams, CannotShow),
             before=lambda: found.extend(screens()), anonymous=True)
