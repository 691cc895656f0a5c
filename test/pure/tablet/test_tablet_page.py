"""The tablet's page without ROS: its parameters, and what it serves and publishes."""

import pathlib

import pytest

from helpers.dict_params import DictParams
from helpers.http_clients import HOST, HttpClients
from helpers.running_loop import running
from roah_rsbb.ground.params import BadParams
from roah_rsbb.tablet.server import TabletPage

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
