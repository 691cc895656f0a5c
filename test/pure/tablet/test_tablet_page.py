"""The tablet's state and the requests of its pages, in simulated time."""

import json
import math
import pathlib

import pytest

from helpers.dict_params import DictParams
from helpers.http_clients import HOST, HttpClients
from helpers.running_loop import running
from roah_rsbb.ground.params import BadParams
from roah_rsbb.tablet.maps import Map
from roah_rsbb.tablet.radio import BOX_SILENT_S, NEVER, BoxPart, ShownTablet
from roah_rsbb.tablet.server import SAME_CALL_S, UNANSWERED_S, Pages, Refusal, TabletPage

PLAN = Map(b"png", 200, 100, 0.05, (-1.0, -2.0, 0.0), True)
SILENT = BoxPart(False, NEVER, NEVER)
NS = 1_451_556_000_123_456_789


@pytest.fixture
def state():
    made = ShownTablet()
    made.on_box(100.0, SILENT)
    return made


@pytest.fixture
def pages(state):
    return Pages(state, PLAN)


def shown(pages, now=100.0):
    return json.loads(pages.text(now))


def test_a_call_has_its_time_and_is_acknowledged_once_the_box_repeats_it(pages, state):
    assert shown(pages)["call"] == {"time": 0, "acknowledged": False}
    assert pages.do(100.0, NS, '{"do": "call"}') is True
    assert state.call_time == (1_451_556_000, 123_456_789)
    assert shown(pages)["call"] == {"time": 1_451_556_000_123, "acknowledged": False}
    assert state.on_box(100.1, SILENT._replace(call_time=state.call_time)) is True
    assert shown(pages)["call"]["acknowledged"] is True
    assert state.position_time == NEVER and shown(pages)["place"]["acknowledged"] is False


def test_a_position_is_acknowledged_once_the_box_repeats_it(pages, state):
    assert pages.do(100.0, NS, '{"do": "place", "u": 0.25, "v": 0.2}') is True
    assert (state.x, state.y) == pytest.approx((1.5, 2.0))
    place = shown(pages)["place"]
    assert (place["u"], place["v"], place["acknowledged"]) == (pytest.approx(0.25), pytest.approx(0.2), False)
    state.on_box(100.1, SILENT._replace(position_time=state.position_time))
    assert shown(pages)["place"]["acknowledged"] is True
    assert state.call_time == NEVER


def test_an_older_call_of_the_box_is_not_this_one(pages, state):
    state.on_box(100.0, SILENT._replace(call_time=(5, 0)))
    pages.do(100.0, NS, '{"do": "call"}')
    assert shown(pages)["call"]["acknowledged"] is False


def test_the_box_says_which_view_is_shown(pages, state):
    assert shown(pages)["view"] == "call"
    state.on_box(100.0, SILENT._replace(display_map=True))
    assert shown(pages)["view"] == "map"


def test_only_what_changes_is_news(state):
    assert state.on_box(100.5, SILENT) is False
    assert state.on_box(100.6, SILENT._replace(display_map=True)) is True
    assert state.on_box(100.7 + BOX_SILENT_S, SILENT._replace(display_map=True)) is True, "the box is there again"


def test_nothing_is_sent_while_the_box_is_silent(pages, state):
    late = 100.1 + BOX_SILENT_S
    for asked in ('{"do": "call"}', '{"do": "place", "u": 0.5, "v": 0.5}'):
        with pytest.raises(Refusal, match="silent"):
            pages.do(late, NS, asked)
    assert (state.call_time, state.position_time) == (NEVER, NEVER)
    assert shown(pages, late)["box"] is False
    assert shown(pages, 100.0 + BOX_SILENT_S)["box"] is True


def test_before_the_first_beacon_the_box_is_silent():
    pages = Pages(ShownTablet(), None)
    assert shown(pages)["box"] is False
    with pytest.raises(Refusal):
        pages.do(100.0, NS, '{"do": "call"}')


def test_an_unanswered_call_is_reported(pages):
    assert shown(pages)["unanswered"] is True
    pages.do(100.0, NS, '{"do": "call"}')
    assert shown(pages, 100.0 + UNANSWERED_S)["unanswered"] is False
    assert shown(pages, 100.1 + UNANSWERED_S)["unanswered"] is True


def test_a_page_that_is_there_touches_nothing(pages, state):
    assert pages.do(100.0, NS, '{"do": "here"}') is False
    assert (state.call_time, state.position_time) == (NEVER, NEVER)


@pytest.mark.parametrize("asked", [
    "", "null", "[]", "1", '"call"', "{}", '{"do": null}', '{"do": ["call"]}', '{"do": {}}', '{"do": "Call"}', "{",
    "\0", "[" * 1000, "NaN", b'{"do": "call"}', None, '{"do": "place"}', '{"do": "place", "u": 0.5}',
    '{"do": "place", "u": "0", "v": 0}', '{"do": "place", "u": NaN, "v": 0}', '{"do": "place", "u": Infinity, "v": 0}',
    '{"do": "place", "u": true, "v": 0}', '{"do": "place", "u": -0.001, "v": 0}', '{"do": "place", "u": 0, "v": 1.001}',
    '{"do": "place", "u": 1' + "0" * 400 + ', "v": 0}', '{"do": "place", "u": [0], "v": {}}',
])
def test_bad_input_is_refused_and_changes_nothing(pages, state, asked):
    with pytest.raises(Refusal):
        pages.do(100.0, NS, asked)
    assert (state.call_time, state.position_time, state.x, state.y) == (NEVER, NEVER, 0.0, 0.0)


@pytest.mark.parametrize(("u", "v"), [(0, 0), (1, 1), (0.0, 1.0)])
def test_the_edges_are_on_the_map(pages, state, u, v):
    assert pages.do(100.0, NS, json.dumps({"do": "place", "u": u, "v": v})) is True
    assert math.isfinite(state.x) and math.isfinite(state.y)


def test_without_a_map_there_is_only_the_call(state):
    pages = Pages(state, None)
    with pytest.raises(Refusal, match="map is missing"):
        pages.do(100.0, NS, '{"do": "place", "u": 0.5, "v": 0.5}')
    assert pages.do(100.0, NS, '{"do": "call"}') is True
    assert shown(pages)["map"] is None


def test_pages_know_the_maps_image_and_its_proportions(pages):
    assert shown(pages)["map"] == {
        "image": f"map.png?{PLAN.version}", "width": 200, "height": 100, "negate": True
    }


def test_forty_taps_are_one_call_and_a_tap_later_is_another(pages, state):
    assert pages.do(100.0, NS, '{"do": "call"}') is True
    for tap in range(1, 40):
        state.on_box(100.0 + tap, SILENT)
        assert pages.do(100.0 + tap, NS + tap, '{"do": "call"}') is False
    assert state.call_time == divmod(NS, 1_000_000_000)
    state.on_box(139.0 + SAME_CALL_S, SILENT)
    assert pages.do(139.0 + SAME_CALL_S, NS + 99, '{"do": "call"}') is True
    assert state.call_time == divmod(NS + 99, 1_000_000_000)


def test_a_position_on_a_wall_is_refused_and_changes_nothing(state):
    walls = bytearray(200 * 100)
    walls[50 * 200 + 100] = 1
    pages = Pages(state, PLAN._replace(walls=bytes(walls)))
    with pytest.raises(Refusal, match="on a wall: touch a free place"):
        pages.do(100.0, NS, '{"do": "place", "u": 0.501, "v": 0.505}')
    assert state.position_time == NEVER
    assert pages.do(100.0, NS, '{"do": "place", "u": 0.51, "v": 0.505}') is True


# -- the tablet's page without ROS: its parameters, and what it serves and publishes ------------------

__all__ = ["running"]

RESOURCE = str(pathlib.Path(__file__).resolve().parents[3] / "resource")


class Served(HttpClients):
    """The page and its map."""

    def __init__(self, running, **settings):
        self.running, self.urls = running, []
        # There is no box, so its port does not matter: the page works without one.
        self.page = TabletPage(running.loop, DictParams({
            "rsbb_host": "127.255.255.255", "rsbb_port": 1, "bind_host": HOST, "tablet_port": 0, **settings}), RESOURCE,
            ["rsbb.local"], self.urls.append)

    def start(self):
        self.page.start()
        self.port = int(self.urls[-1].rpartition(":")[2].strip("/"))


def test_it_serves_the_page_and_the_default_map(running):
    served = Served(running)
    served.start()
    assert served.urls == [f"http://{HOST}:{served.port}/"]
    assert served.get("/").code == served.get("/map.png").code == 200
    assert served.get("/", headers={"Host": "rsbb.local"}).code == 200
    assert served.get("/", headers={"Host": "another.example"}).code == 421
    served.page.stop()


def test_without_a_map_there_is_a_page(running, tmp_path, caplog):
    served = Served(running, map_file=str(tmp_path / "none.yaml"))
    assert "The tablet has no map" in caplog.text
    served.start()
    assert (served.get("/").code, served.get("/map.png").code) == (200, 404)
    served.page.stop()


def test_wrong_parameters_are_reported(running):
    with pytest.raises(BadParams, match="tablet_port"):
        Served(running, tablet_port="x")
