"""Prints HTML pages as PDF files with a browser of the Chromium family, which need not be installed."""

import os
import pathlib
import shutil
import subprocess
import tempfile

# The first one that is installed is used.
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
TIMEOUT_S = 120.0


class CannotPrint(Exception):
    """No PDF was made. The text names the remedy."""


def browser() -> str:
    """Returns the browser's path; raises `CannotPrint`."""
    found = next((path for path in map(shutil.which, BROWSERS) if path), None)
    if found is None:
        raise CannotPrint(
            f"a PDF needs one of {', '.join(BROWSERS)}: install it (sudo apt install chromium), or export with --html "
            "and print the pages in any browser"
        )
    return found


def print_pdf(html: str, path: str) -> None:
    """Print a page into a file; raises `CannotPrint` or OSError. An old file is replaced completely, or unchanged."""
    program = browser()
    with tempfile.TemporaryDirectory() as folder:
        page, printed = os.path.join(folder, "page.html"), os.path.join(folder, "page.pdf")
        pathlib.Path(page).write_text(html, encoding="utf-8", errors="backslashreplace")
        command = [
            program, "--headless", "--disable-gpu", "--no-pdf-header-footer", "--print-to-pdf-no-header",
            f"--user-data-dir={os.path.join(folder, 'profile')}", f"--print-to-pdf={printed}",
            pathlib.Path(page).as_uri(),
        ]
        if os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # the sandbox does not work for root; the page runs no code
        try:
            done = subprocess.run(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=TIMEOUT_S, check=False)
        except subprocess.TimeoutExpired:
            raise CannotPrint(f"{program} did not print within {TIMEOUT_S:.0f} s: export with --html instead") from None
        if not os.path.exists(printed):
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
            why = " ".join(said) or f"exit status {done.returncode}"
            raise CannotPrint(f"{program} printed nothing ({why}): export with --html instead, and print the pages in "
                              "any browser")
        draft = f"{path}.draft"
        shutil.copyfile(printed, draft)
        os.replace(draft, path)
