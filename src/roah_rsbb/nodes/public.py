"""Node roah_rsbb_public: the public display, a page of the box in a browser that fills the screen.

It opens the page as soon as the box serves it, opens it again if the browser crashes or the box has another address,
and ends when the window is closed (Alt-F4). Everything else is in the page (docs/public_display.md).

Parameter (private): screen (its number, from 0).
"""

import contextlib
import ctypes
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import urllib.parse
from typing import List, Optional

import rosgraph
import rospy

from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.display import Screen, screens
from roah_rsbb.ros.params import BadParams, Params

URL = "/roah_rsbb_web/url"  # the gateway's parameter
PAGE = "display?layout=board"
# The first one that works is used: Ubuntu has programs that only say how to install a browser.
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "firefox-esr", "firefox")
SNAPS = "/snap/bin"
ASK_S, ANSWER_S, LOOK_S, CLOSE_S = 2.0, 2.0, 0.2, 2.0
# A browser that ends sooner has failed; after this many failures in a row the program gives up.
SHORT_LIFE_S, MAX_SHORT_LIVES = 5.0, 5
# A profile that is new would welcome its user; one that was in use would ask whether to restore its pages.
CHROMIUM = ("--kiosk", "--no-first-run", "--no-default-browser-check", "--disable-session-crashed-bubble",
            "--hide-crash-restore-bubble", "--noerrdialogs", "--disable-features=Translate", "--password-store=basic",
            "--disable-component-update", "--log-level=3")
FIREFOX = """\
user_pref("browser.aboutwelcome.enabled", false);
user_pref("browser.sessionstore.resume_from_crash", false);
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("browser.startup.homepage_override.mstone", "ignore");
user_pref("browser.translations.automaticallyPopup", false);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
"""
_die_with_parent = ctypes.CDLL(None).prctl


class CannotShow(Exception):
    """The page cannot be shown on this computer. The text names the remedy."""


def find() -> Optional[str]:
    """Return the path of a browser that works; None: there is none."""
    paths = filter(None, map(shutil.which, BROWSERS))
    return next((path for path in paths if not subprocess.run(
        [path, "--version"], stdin=subprocess.DEVNULL, capture_output=True, check=False).returncode), None)


def is_firefox(program: str) -> bool:
    """Whether a browser takes the arguments of Firefox, and not those of Chromium."""
    return os.path.basename(program).startswith("firefox")


def make_profile(program: str) -> str:
    """Make a folder for the browser's own files. A snap can write only into a folder that all of its kind have."""
    name = "firefox" if is_firefox(program) else "chromium"
    is_snap = os.path.exists(f"{SNAPS}/{name}") and "google" not in program
    parent = os.path.expanduser(f"~/snap/{name}/common") if is_snap else tempfile.gettempdir()
    os.makedirs(parent, exist_ok=True)
    profile = tempfile.mkdtemp(prefix="roah_rsbb_public_", dir=parent)
    if name == "firefox":
        pathlib.Path(profile, "user.js").write_text(FIREFOX, encoding="utf-8")
    return profile


def command(program: str, profile: str, number: int, screen: Screen, address: str) -> List[str]:
    """Return the command that opens an address full screen, on a screen of this number and place."""
    if is_firefox(program):
        return [program, "--no-remote", "--profile", profile, "--kiosk-monitor", str(number), "--kiosk", address]
    more = ["--ozone-platform=x11"] if os.environ.get("DISPLAY") else []  # Wayland lets no program choose its screen
    more += ["--no-sandbox"] if os.geteuid() == 0 else []  # it does not work for root
    return [program, *CHROMIUM, *more, f"--user-data-dir={profile}", f"--window-size={screen.width},{screen.height}",
            f"--window-position={screen.left},{screen.top}", address]


def addresses(url: str, master: str) -> List[str]:
    """Return where the page may be: at the gateway's address, or at that of the ROS master's computer. A firewall may
    protect the first one, which is in the robots' network."""
    parts, host = urllib.parse.urlsplit(url), urllib.parse.urlsplit(master).hostname
    return [f"{parts.scheme}://{one}:{parts.port}/{PAGE}" for one in (parts.hostname, host)] if url else []


def answers(address: str) -> bool:
    """Whether a server is at an address."""
    parts = urllib.parse.urlsplit(address)
    with contextlib.suppress(OSError):
        socket.create_connection((parts.hostname or "", parts.port or 0), ANSWER_S).close()
        return True
    return False


class PublicDisplay:
    """The node. Raises `BadParams` and `CannotShow` at the start."""

    def __init__(self) -> None:
        params = Params()
        number = params.whole("screen", 0, 0, 255)
        params.done()
        self._address, self._said = "", ""  # of the page, when it is known; what was logged
        self._process: Optional[subprocess.Popen] = None
        found, program = screens(), find()
        if not found or program is None:
            self._ask()
            raise CannotShow(("no browser: install one (sudo apt install chromium, or firefox-esr)" if found else
                              "no display: log in at the screen, and start it there") +
                             f". Or open {self._address or 'http://ADDRESS_OF_THE_BOX:8081/display'} in any browser")
        if number >= len(found):
            rospy.logwarn("There is no screen %d: screen 0 is used", number)
            number = 0
        rospy.loginfo("On screen %d of: %s", number, ", ".join(f"{i} ({each})" for i, each in enumerate(found)))
        self._profile = make_profile(program)
        self._start = program, self._profile, number, found[number]

    def run(self) -> int:
        """Keep the page open until the window is closed or ROS ends; returns the exit status."""
        # The master may take long to answer if its computer is off.
        threading.Thread(target=self._follow, daemon=True).start()
        opened, opened_mono, short_lives = "", 0.0, 0
        try:
            while not rospy.is_shutdown():
                code = None if self._process is None else self._process.poll()
                if code is not None:
                    short_lives = short_lives + 1 if time.monotonic() - opened_mono < SHORT_LIFE_S else 0
                    if code == 0:
                        return 0
                    if short_lives >= MAX_SHORT_LIVES:
                        raise CannotShow(f"{self._start[0]} fails (exit code {code}): install another browser")
                    rospy.logwarn("The browser ended (exit code %d): it is opened again", code)
                if code is not None or self._address != opened:
                    self._close()
                    opened, opened_mono = self._address, time.monotonic()
                    rospy.loginfo("Opening %s with %s", opened, self._start[0])
                    self._process = subprocess.Popen(
                        command(*self._start, opened), stdin=subprocess.DEVNULL, start_new_session=True,
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

    def _follow(self) -> None:
        while True:
            self._ask()
            time.sleep(ASK_S)

    def _ask(self) -> None:
        """Find out where the page is. While it does not answer, it stays where it was: it connects again by itself."""
        master = rosgraph.get_master_uri()
        why = f"the box serves no pages (parameter {URL}): start it, without web:=false, and with 'sudo apt install "\
              "python3-tornado' on its computer"
        try:
            places = addresses(str(rospy.get_param(URL, "")), master)
        except (OSError, rosgraph.MasterException):
            places, why = [], f"the ROS master at {master} does not answer: start the box, or correct ROS_MASTER_URI"
        if self._address not in places:
            self._address = next(filter(answers, places), self._address)
        if self._address not in places:
            why = f"nothing answers at {' or '.join(places)}: check the network and the box" if places else why
            if why != self._said:
                rospy.logwarn("Waiting for the page of the public display: %s", why)
            self._said = why


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_public", __doc__, PublicDisplay, (BadParams, CannotShow), anonymous=True)
