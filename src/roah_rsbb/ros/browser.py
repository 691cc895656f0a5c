"""The browser of the public display: which one, with which arguments and files, and at which address. ROS is not
imported."""

import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import urllib.parse
from typing import List, Optional

from roah_rsbb.ros.display import Screen

PAGE = "display?layout=board"
# The first one that works is used: Ubuntu has programs that only say how to install a browser.
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "firefox-esr", "firefox")
SNAPS = "/snap/bin"
ANSWER_S, VERSION_S = 2.0, 20.0
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


def find() -> Optional[str]:
    """Return the path of a browser that works; None: there is none."""
    return next(filter(_works, filter(None, map(shutil.which, BROWSERS))), None)


def _works(path: str) -> bool:
    try:
        return subprocess.run([path, "--version"], stdin=subprocess.DEVNULL, capture_output=True, check=False,
                              timeout=VERSION_S).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


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
        return [program, "--no-remote", "--profile", profile, "--width", str(screen.width), "--height",
                str(screen.height), "--kiosk-monitor", str(number), "--kiosk", address]
    more = ["--ozone-platform=x11"] if os.environ.get("DISPLAY") else []  # Wayland lets no program choose its screen
    more += ["--no-sandbox"] if os.geteuid() == 0 else []  # it does not work for root
    return [program, *CHROMIUM, *more, f"--user-data-dir={profile}", f"--window-size={screen.width},{screen.height}",
            f"--window-position={screen.left},{screen.top}", address]


def addresses(url: str, master: str) -> List[str]:
    """Return where the page may be: at the gateway's address, or at that of the ROS master's computer. A firewall may
    protect the first one, which is in the robots' network. None: the gateway's address is none of a web page."""
    try:
        parts, host = urllib.parse.urlsplit(url), urllib.parse.urlsplit(master).hostname
        if parts.scheme in ("http", "https") and parts.hostname and parts.port and ":" not in parts.hostname:
            return [f"{parts.scheme}://{one}:{parts.port}/{PAGE}" for one in (parts.hostname, host)]
    except ValueError:
        pass
    return []


def answers(address: str) -> bool:
    """Whether a server is at an address."""
    parts = urllib.parse.urlsplit(address)
    with contextlib.suppress(OSError, UnicodeError):
        socket.create_connection((parts.hostname or "", parts.port or 0), ANSWER_S).close()
        return True
    return False
