"""Prints HTML pages as PDF files with a browser of the Chromium family, which need not be installed.

The browser starts once for all pages. It is controlled through two pipes, by the DevTools protocol: each message is
JSON and ends with a zero byte.
"""

import base64
import json
import os
import re
import select
import shutil
import subprocess
import tempfile
import time
from types import TracebackType
from typing import Any, Dict, Iterable, List, Optional, Type

from roah_rsbb.ground import linux
from roah_rsbb.results.runs import NotPossible

# The first one that is installed is used. The headless shell has no window and starts in a quarter of the time.
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
TIMEOUT_S = 120.0  # for a page
CLOSE_S = 5.0  # for the browser to end
# The browser reads commands from the first of these descriptors, and answers on the second.
_COMMANDS, _ANSWERS = 3, 4
_PIECE = 1 << 16
_MAX_LETTERS = 300  # that are looked for in fonts, each in milliseconds
_IMAGES = "Promise.all([...document.images].map(image => image.decode().catch(() => 0)))"


# The time at which the file was made, which Chromium writes into it.
_DATE = re.compile(rb"(?<=/)(CreationDate|ModDate) \(D:\d{14}")


def browser() -> str:
    """Return the browser's path; raises `NotPossible`."""
    found = next((path for path in map(shutil.which, BROWSERS) if path), None)
    if found is None:
        raise NotPossible(
            f"a PDF needs one of {', '.join(BROWSERS)}: install it (sudo apt install chromium), or export with --html "
            "and print the pages in any browser"
        )
    return found


def without_font(text: Iterable[str]) -> str:
    """Return the letters that no font of this computer has, such as emoji: in a PDF they are boxes. Empty: none, or
    not known."""
    if shutil.which("fc-list") is None:
        return ""
    letters = sorted({letter for letter in text if letter > "~" and letter.isprintable()})[:_MAX_LETTERS]
    return "".join(letter for letter in letters if not subprocess.run(
        ["fc-list", f":charset={ord(letter):x}", "family"], stdout=subprocess.PIPE, check=False).stdout.strip())


def print_pdf(html: str, path: str) -> None:
    """Print one page, as `Printer.print` does."""
    with Printer() as printer:
        printer.print(html, path)


class Printer:
    """A browser that prints pages until the end of the `with` block."""

    def __init__(self) -> None:
        self._program = browser()
        self._number = 0  # of the last command
        self._unread = b""

    def __enter__(self) -> "Printer":
        self._folder = tempfile.TemporaryDirectory()
        self._errors = tempfile.TemporaryFile()
        command = [
            self._program, "--headless", "--disable-gpu", "--remote-debugging-pipe",
            f"--user-data-dir={os.path.join(self._folder.name, 'profile')}", "about:blank",
        ]
        if os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # the sandbox does not work for root; the page runs no code
        commands, self._commands = os.pipe()
        self._answers, answers = os.pipe()
        # A shell moves the pipes to the two descriptors, which subprocess itself cannot do.
        shell = f'exec "$@" {_COMMANDS}<&{commands} {_ANSWERS}>&{answers}'
        self._process = subprocess.Popen(
            ["bash", "-c", shell, "bash", *command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=self._errors, pass_fds=(commands, answers), start_new_session=True)
        os.close(commands)
        os.close(answers)
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        os.close(self._commands)  # the browser ends when its pipe is closed
        os.close(self._answers)
        try:
            self._process.wait(CLOSE_S)
        except subprocess.TimeoutExpired:
            # Debian starts the browser by a script, which is in the same session.
            linux.end_with_children(self._process)
            self._process.wait()
        self._errors.close()
        self._folder.cleanup()

    def print(self, html: str, path: str) -> None:
        """Print a page into a file; raises `NotPossible` or OSError. An old file is replaced completely, or stays.
        """
        until = time.monotonic() + TIMEOUT_S
        target = self._ask(until, "Target.createTarget", url="about:blank")["targetId"]
        session = self._ask(until, "Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        frame = self._ask(until, "Page.getFrameTree", session)["frameTree"]["frame"]["id"]
        text = html.encode(errors="backslashreplace").decode()
        self._ask(until, "Page.setDocumentContent", session, frameId=frame, html=text)
        self._ask(until, "Runtime.evaluate", session, expression=_IMAGES, awaitPromise=True)
        made = self._ask(until, "Page.printToPDF", session, preferCSSPageSize=True)
        self._ask(until, "Target.closeTarget", targetId=target)
        draft = f"{path}.draft"
        with open(draft, "wb") as file:
            file.write(_undated(base64.b64decode(made["data"])))
        os.replace(draft, path)

    def _ask(self, until: float, method: str, session: str = "", **params: Any) -> Dict[str, Any]:
        """Give a command and return its result."""
        self._number += 1
        message: Dict[str, Any] = {"id": self._number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        try:
            left = memoryview(json.dumps(message).encode() + b"\0")
            while left:
                left = left[os.write(self._commands, left):]
        except BrokenPipeError:
            raise self._failed() from None
        while True:
            answer = json.loads(self._message(until))
            if answer.get("id") != self._number:
                continue  # an event
            if "error" in answer:
                raise NotPossible(f"{self._program} printed nothing ({answer['error'].get('message')}): export with "
                                  "--html instead, and print the pages in any browser")
            return dict(answer["result"])

    def _message(self, until: float) -> bytes:
        parts: List[bytes] = [self._unread]
        while b"\0" not in parts[-1]:
            if not select.select([self._answers], (), (), max(0.0, until - time.monotonic()))[0]:
                raise NotPossible(f"{self._program} did not print within {TIMEOUT_S:.0f} s: export with --html instead")
            parts.append(os.read(self._answers, _PIECE))
            if not parts[-1]:
                raise self._failed()
        message, _, self._unread = b"".join(parts).partition(b"\0")
        return message

    def _failed(self) -> NotPossible:
        """Return an error that says why the browser ended."""
        try:
            status = f"exit status {self._process.wait(CLOSE_S)}"
        except subprocess.TimeoutExpired:
            status = "it closed its pipe"
        self._errors.seek(0)
        said = self._errors.read().decode("utf-8", "replace").strip().splitlines()[-1:]
        return NotPossible(f"{self._program} printed nothing ({' '.join(said) or status}): export with --html instead, "
                           "and print the pages in any browser")


def _undated(pdf: bytes) -> bytes:
    """Return a PDF that does not depend on the time of printing; places in the file stay the same."""
    return _DATE.sub(lambda date: date.group()[:-14] + b"20000101000000", pdf)
