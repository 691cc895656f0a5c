"""The list of displays, and what the organiser sets for them."""

import json
import os

import pytest

from helpers.http_clients import HOST
from helpers.served_pages import ServedPages
from roah_rsbb.ground.kept_file import SavedBeside, open_kept
from roah_rsbb.web.displays import (
    FILE,
    MAX_BYTES,
    MAX_LISTED,
    MAX_OF_ADDRESS,
    MAX_SET,
    MAX_WINDOWS,
    NOTHING_SET,
    Displays,
    Setting,
    TooMany,
    display_of,
    read_logos,
    setting_of,
)
from roah_rsbb.web.pairing import MAX_NAME

UTC = 1_800_000_000.0


def id_of(number):
    return f"{number:032x}"


def display(number=1, address="10.0.0.1", zones=(), **asked):
    known = {"page": "display", "display": id_of(number), "size": "1920x1080", **asked}
    return display_of(lambda name: known.get(name, ""), zones, "en", address, UTC + number)


def nothing_kept():
    return Displays(lambda records: None, {})


@pytest.mark.parametrize("asked", [
    {"page": ""}, {"page": "referee"}, {"display": ""}, {"display": "x" * 32}, {"display": "a" * 31},
])
def test_other_readers_are_no_displays(asked):
    assert display(**asked) is None


def test_what_a_display_says_about_itself_is_bounded_and_plain():
    found = display(name="Hall\n\x1b[31m\u202e<b>" + "x" * 1000, size="1e9x-1", show="secrets", zones=["y" * 1000] * 99)
    assert found.name.startswith("Hall [31m <b>x") and len(found.name) <= MAX_NAME and found.name.isprintable()
    assert (found.size, found.show) == ("", "rotating")
    assert len(found.zones) == 10 and len(found.zones[0]) <= MAX_NAME


def test_windows_of_a_display_are_one_line():
    displays = nothing_kept()
    for window in range(MAX_WINDOWS):
        assert displays.add(window, display())
    assert not displays.add("one more", display())
    (row,) = displays.rows()
    assert (row.windows, displays.unlisted) == (MAX_WINDOWS, 1)
    assert displays.remove("one more") is None
    assert displays.unlisted == 0, "it is closed"
    assert [displays.remove(window) for window in range(MAX_WINDOWS)][-2:] == [None, id_of(1)]
    assert displays.rows() == []


def test_an_address_cannot_fill_the_list():
    displays = nothing_kept()
    assert [displays.add(number, display(number)) for number in range(1, MAX_OF_ADDRESS + 2)] == [
        *[True] * MAX_OF_ADDRESS, False]
    assert displays.add("other", display(999, "10.0.0.2"))


def test_the_list_is_bounded_and_a_display_that_is_set_has_a_place():
    displays = Displays(lambda records: None, {id_of(999): {"show": "run"}})
    for number in range(1, MAX_LISTED + 1):
        assert displays.add(number, display(number, f"10.0.1.{number % 50}"))
    assert not displays.add("crowd", display(998, "10.0.2.1"))
    assert displays.add("set", display(999, "10.0.2.1"))


def test_a_setting_counts_until_it_is_taken_back():
    kept = []
    displays = Displays(kept.append, {})
    displays.add("window", display(name="Hall"))
    displays.set(id_of(1), Setting(zone="", show="standings"))
    assert displays.setting(id_of(1)) == Setting(zone="", show="standings", called="Hall")
    displays.remove("window")
    displays.kept.newest.result()
    again = Displays(kept.append, kept[-1])
    assert again.setting(id_of(1)) == Setting(zone="", show="standings", called="Hall"), "also after a restart"
    (row,) = again.rows()
    assert (row.display, row.name) == (None, "Hall")
    again.set(id_of(1), NOTHING_SET)
    again.kept.newest.result()
    assert (again.rows(), kept[-1]) == ([], {})


def test_a_setting_that_cannot_be_saved_counts_until_a_restart(served):
    def fails(_records):
        raise OSError("full")
    served.displays.kept = SavedBeside(fails)
    served.shown()
    answer = served.asked({"id": id_of(1), "setting": {"show": "run"}, "language": "de"})
    assert answer.code == 500 and json.loads(answer.body)["reasons"][0].startswith("auf Deutsch: The setting cannot be")
    assert served.displays.setting(id_of(1)).show == "run"


def test_settings_are_bounded():
    displays = Displays(lambda records: None, {id_of(number): {"show": "run"} for number in range(MAX_SET)})
    displays.add("window", display(5000))
    with pytest.raises(TooMany):
        displays.set(id_of(5000), Setting(show="run"))
    displays.set(id_of(1), Setting(show="results"))
    with pytest.raises(KeyError):
        displays.set(id_of(6000), Setting(show="run"))


def test_the_name_of_the_organiser_comes_first():
    displays = nothing_kept()
    displays.add("window", display(name="Hall"))
    assert displays.name(id_of(1)) == "Hall"
    displays.set(id_of(1), Setting(name="Entrance"))
    assert displays.name(id_of(1)) == "Entrance"
    displays.add("unnamed", display(2))
    assert displays.name(id_of(2)) == id_of(2)[:4]


@pytest.mark.parametrize("body", [
    {"show": "secrets"}, {"language": "xx"}, {"zone": 5}, {"name": ["Hall"]}, {"zone": "x" * 201},
])
def test_bad_settings_are_refused(body):
    with pytest.raises(ValueError):
        setting_of(body, ["en", "de"])


@pytest.mark.parametrize("content", ["[]", '{"a": 5}', '{"a": {"show": "secrets"}}', "{", '{"a": {"zone": 5}}'])
def test_a_damaged_file_is_moved_aside(tmp_path, content):
    (tmp_path / FILE).write_text(content)
    reports = []
    displays = open_kept(str(tmp_path), FILE, Displays, {}, reports.append, "set them again")
    assert displays.rows() == [] and len(reports) == 1 and "set them again" in reports[0]
    assert (tmp_path / f"{FILE}.damaged").read_text() == content


# -- on real loopback sockets -----------------------------------------------------------------------


class Served(ServedPages):
    """A server, its displays, and an organiser."""

    def __init__(self, running):
        self.kept = []
        self.displays = Displays(self.kept.append, {})
        super().__init__(running, displays=self.displays)

    def asked(self, body=None, role="organiser", **headers):
        return self.ask("displays", body, token=role and self.token(role), **headers)

    def listed(self):
        return json.loads(self.asked().body)["displays"]

    def shown(self, number=1, more="&name=Hall&zone=Home"):
        return self.opened(f"events?documents=page.words&language=en&page=display&display={id_of(number)}"
                           f"&size=1920x1080{more}")

    def as_set(self, connection):
        """What the organiser has set, as the display gets it."""
        while True:
            documents = self.read(connection).get("documents", {})
            if "page.display" in documents:
                return documents["page.display"]["data"]


def test_a_display_is_listed_and_gets_what_is_set(served):
    window = served.shown()
    assert served.as_set(window) == {
        "name": "Hall", "zone": None, "show": None, "language": None, "caption": "", "shows_name": False}
    (row,) = served.listed()
    assert (row["name"], row["is_set"]) == ("Hall", False)
    shown = row["display"]
    assert (shown["page"], shown["address"], shown["size"], shown["zones"], shown["show"], shown["language"]) == (
        "display", HOST, "1920x1080", ["Home"], "rotating", "en")
    assert abs(shown["since"] - served.server.utc()) < 60.0
    setting = {"zone": "", "show": "run", "language": "de", "caption": "Ada | Judge"}
    assert served.asked({"id": id_of(1), "setting": setting}).code == 200
    assert served.as_set(window) == {"name": "Hall", **setting, "shows_name": False}
    assert served.kept == [{id_of(1): {**setting, "called": "Hall"}}]
    assert served.asked({"id": id_of(1), "setting": {"show": "results"}}).code == 200
    assert served.as_set(window)["show"] == "results", "the rest stays"
    assert served.asked({"id": id_of(1), "take_back": True}).code == 200
    assert served.as_set(window)["show"] is None


def test_what_is_set_for_a_display_is_for_no_other(served):
    first, second = served.shown(1), served.shown(2, "")
    served.asked({"id": id_of(1), "setting": {"show": "run"}})
    served.asked({"id": id_of(2), "setting": {"show": "results"}})
    assert served.as_set(first)["show"] is None and served.as_set(first)["show"] == "run"
    assert served.as_set(second)["show"] is None and served.as_set(second)["show"] == "results"


def test_a_display_that_is_closed_leaves_the_list(served):
    window = served.shown()
    served.as_set(window)
    window.close()
    served.running.until(lambda: not served.displays.rows())
    again = served.shown()
    assert served.as_set(again)["name"] == "Hall"


def test_displays_show_their_names_for_a_moment(served, monkeypatch):
    monkeypatch.setattr("roah_rsbb.web.displays.NAMED_S", 0.0)
    window = served.shown()
    assert served.as_set(window)["shows_name"] is False
    monkeypatch.setattr("roah_rsbb.web.displays.NAMED_S", 0.05)
    assert served.asked({"show_names": True}).code == 200
    assert [served.as_set(window)["shows_name"] for _ in range(2)] == [True, False]


@pytest.mark.parametrize("role, code", [("", 401), ("referee", 403), ("judge", 403), ("organiser", 200)])
def test_the_list_is_for_organisers(served, role, code):
    window = served.shown()
    served.as_set(window)
    assert served.asked(role=role).code == code
    assert served.asked({"id": id_of(1), "setting": {"show": "run"}}, role=role).code == code
    assert (served.displays.setting(id_of(1)).show == "run") == (role == "organiser")


def test_pages_of_other_sites_set_nothing(served):
    assert served.asked({"show_names": True}, Origin="https://evil.example").code == 403


@pytest.mark.parametrize("body, code", [
    ({"id": id_of(7), "setting": {"show": "run"}}, 409), ({"id": id_of(1), "setting": {"show": "secrets"}}, 400),
    ({"id": 5, "setting": {}}, 400), ({"id": id_of(1), "setting": [5]}, 400),
])
def test_wrong_settings_are_refused(served, body, code):
    served.as_set(served.shown())
    assert served.asked(body).code == code
    assert served.kept == []


# -- logos ------------------------------------------------------------------------------------------


@pytest.fixture
def logos(tmp_path):
    for name, content in (("Alpha.png", b"png"), ("Tea & Co.SVG", b"<svg/>"), ("notes.txt", b"x"),
                          ("Large.jpg", b"x" * (MAX_BYTES + 1))):
        (tmp_path / name).write_bytes(content)
    return tmp_path


def test_the_logos_of_a_folder(logos):
    reports = []
    assert list(read_logos(str(logos), reports.append)) == ["Alpha", "Tea & Co"]
    assert len(reports) == 1 and "Large.jpg" in reports[0]
    assert read_logos("", reports.append) == {} and len(reports) == 1
    assert read_logos(str(logos / "missing"), reports.append) == {} and "correct web_logos" in reports[1]


def test_a_link_serves_no_file_from_elsewhere(served, logos, tmp_path_factory):
    secret = tmp_path_factory.mktemp("elsewhere") / "passwords.yaml"
    secret.write_text("secret")
    (logos / "Beta.png").symlink_to(secret)
    (logos / "Gamma.png").symlink_to("Alpha.png")
    reports = []
    found = read_logos(str(logos), reports.append)
    assert list(found) == ["Alpha", "Gamma", "Tea & Co"] and "Beta.png" in reports[0]
    served.store.logos.update(found)
    os.replace(str(secret), str(logos / "Beta.png"))
    (logos / "Alpha.png").unlink()
    (logos / "Alpha.png").symlink_to(logos / "Beta.png")
    assert served.get("/logos/Alpha").code == 404, "it was replaced by a link after the start"


def test_only_logos_are_served(served, logos):
    served.store.logos.update(read_logos(str(logos), lambda text: None))
    answer = served.get("/logos/Alpha")
    assert (answer.body, answer.headers["Content-Type"]) == (b"png", "image/png")
    picture = served.get("/logos/Tea%20%26%20Co")
    assert picture.headers["Content-Type"] == "image/svg+xml"
    assert "script-src 'self'" in picture.headers["Content-Security-Policy"], "a picture runs no program"
    others = ("notes", "notes.txt", "..%2FAlpha", "Large", "Beta")
    assert [served.get(f"/logos/{name}").code for name in others] == [404] * len(others)
