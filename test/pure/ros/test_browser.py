"""How the public display's program starts browsers, and where it looks for the page."""

import os

import pytest

from roah_rsbb.ros import browser
from roah_rsbb.ros.display import Screen

SCREEN = Screen(1920, 0, 1280, 720)
ADDRESS = "http://10.0.0.1:8081/display?layout=board"


def _program(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


def test_chromium_fills_the_screen_and_asks_nothing():
    words = browser.command("/usr/bin/chromium", "/tmp/p", 1, SCREEN, ADDRESS)
    assert words[0] == "/usr/bin/chromium" and words[-1] == ADDRESS
    assert {"--kiosk", "--user-data-dir=/tmp/p", "--window-position=1920,0", "--window-size=1280,720"} <= set(words)
    assert {"--no-first-run", "--hide-crash-restore-bubble", "--disable-features=Translate"} <= set(words)


def test_the_sandbox_is_off_only_for_root(monkeypatch):
    for user, is_off in ((0, True), (1000, False)):
        monkeypatch.setattr(os, "geteuid", lambda user=user: user)
        assert ("--no-sandbox" in browser.command("chromium", "/tmp/p", 0, SCREEN, ADDRESS)) == is_off


@pytest.mark.parametrize("name", ["firefox", "firefox-esr"])
def test_firefox_fills_the_screen_and_asks_nothing(name, tmp_path, monkeypatch):
    monkeypatch.setattr(browser, "SNAPS", str(tmp_path / "none"))
    profile = browser.make_profile(f"/usr/bin/{name}")
    assert browser.command(f"/usr/bin/{name}", profile, 1, SCREEN, ADDRESS) == [
        f"/usr/bin/{name}", "--no-remote", "--profile", profile, "--width", "1280", "--height", "720",
        "--kiosk-monitor", "1", "--kiosk", ADDRESS]
    with open(f"{profile}/user.js", encoding="utf-8") as file:
        assert 'user_pref("browser.aboutwelcome.enabled", false);' in file.read()


@pytest.mark.parametrize("program, snap", [
    ("/usr/bin/chromium-browser", "chromium"), ("/snap/bin/chromium", "chromium"), ("/usr/bin/firefox", "firefox"),
    ("/usr/bin/google-chrome", None),
])
def test_a_snap_has_a_profile_where_it_may_write(program, snap, tmp_path, monkeypatch):
    monkeypatch.setattr(browser, "SNAPS", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    for name in ("chromium", "firefox"):
        (tmp_path / name).touch()
    parent = os.path.dirname(browser.make_profile(program))
    assert (parent == str(tmp_path / "home" / "snap" / str(snap) / "common")) == (snap is not None)


def test_the_first_browser_that_works_is_used(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(browser, "BROWSERS", ("chromium-browser", "google-chrome", "firefox"))
    assert browser.find() is None
    _program(tmp_path / "chromium-browser", "echo 'install the snap'; exit 1")
    expected = _program(tmp_path / "firefox", "exit 0")
    assert browser.find() == expected


def test_the_page_is_at_the_gateway_or_at_the_computer_of_the_master():
    assert browser.addresses("https://10.0.0.1:8081/", "http://box:11311") == [
        "https://10.0.0.1:8081/display?layout=board", "https://box:8081/display?layout=board"]
    for url in ("", "http://box:99999/", "http://box:abc/", "http://[::1/", "http://[::1]:8081/", "http://box/",
                "box:8081"):
        assert browser.addresses(url, "http://box:11311") == [], url
    assert not browser.answers(f"http://{'x' * 70}:80/") and not browser.answers("http://a..b:80/")
