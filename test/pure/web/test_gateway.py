"""The gateway without ROS: what it serves and publishes, and its calls, which pair devices."""

import json
import pathlib
import shutil
import stat
import time

import pytest

from helpers.dict_params import DictParams
from helpers.http_clients import HOST, HttpClients
from helpers.public_box import PublicBox, event, run
from helpers.running_loop import running
from helpers.shown_box import zone_of
from roah_rsbb.document.calls import WEB_CALLS, Caller, InThread
from roah_rsbb.ground.params import BadParams
from roah_rsbb.model.reason import Refused
from roah_rsbb.web import gateway, serving
from roah_rsbb.web.gateway import Gateway, GatewayHost
from roah_rsbb.web.pairing import FILE

__all__ = ["running"]

RESOURCE = pathlib.Path(__file__).resolve().parents[3] / "resource"


class Box(PublicBox):
    """A box without a connection."""

    def __init__(self):
        super().__init__([run()], [event()])
        self.show(zone_of("Home"), zone_of("Hall"))
        self.is_started = self.is_closed = False

    def start(self):
        self.is_started = True

    def close(self):
        self.is_closed = True


class World(HttpClients):
    """A gateway, and what its program gives it."""

    def __init__(self, running, folder):
        self.running, self.folder = running, folder
        self.box, self.calls, self.urls = Box(), {}, []
        self.gateway = None
        self.settings = {"rsbb_host": "127.255.255.255", "web_port": 0, "log_dir": str(folder)}

    def make_client(self, on_change, calls):
        self.on_change, self.calls = on_change, calls
        return self.box

    def make(self, address="192.0.2.7", **settings):
        self.gateway = Gateway(self.running.loop, DictParams({**self.settings, **settings}), GatewayHost(
            RESOURCE, "/gateway", address, self.make_client, self.urls.append, ["rsbb.local"]))
        return self.gateway

    def start(self, **settings):
        self.make(**settings).start()
        self.port = int(self.urls[-1].rpartition(":")[2].strip("/"))
        return self

    def call(self, name, **arguments):
        found = self.calls[name](arguments, Caller("referee", HOST))
        if isinstance(found, InThread):
            found = self.running.do(self.running.loop.run_in_executor(None, found.make))
        return json.loads(json.dumps(found))

    def paired(self, person="Anna", **arguments):
        made = self.call("pair", **{"role": "referee", "zone": "Home", **arguments})
        answer = self.get("/api/v1/pair", method="POST", body=json.dumps(
            {"code": made["code"], "person": person, "device": "iPhone"}), headers={
                "Origin": f"http://{HOST}:{self.port}", "Content-Type": "application/json"})
        assert answer.code == 200, answer.body
        return made


@pytest.fixture
def world(running, tmp_path):
    made = World(running, tmp_path / "log")
    yield made
    if made.gateway is not None:
        made.gateway.stop()
    running.turn()


# -- the gateway ------------------------------------------------------------------------------------


def test_it_serves_the_pages_of_the_box_and_ends(world):
    world.start()
    assert world.box.is_started and world.urls == [f"http://{HOST}:{world.port}/"]
    world.on_change()
    assert json.loads(world.get("/api/v1/state").body)["data"]["runs"][0]["team"] == "Alpha"
    assert world.get("/", headers={"Host": "rsbb.local"}).code == 200
    world.gateway.stop()
    assert world.box.is_closed


def test_a_port_that_is_taken_is_tried_again(world, running, tmp_path, caplog, monkeypatch):
    world.start()
    monkeypatch.setattr(serving, "RETRY_S", 0.01)
    second = World(running, tmp_path / "second")
    second.make(web_port=world.port).start()
    assert not second.urls and [record.levelname for record in caplog.records] == ["ERROR"]
    with pytest.raises(Refused, match="not served yet"):
        second.call("pair", role="organiser")
    world.gateway.stop()
    running.until(lambda: second.urls == world.urls)
    assert second.call("pair", role="organiser")["url"].startswith(second.urls[0])
    second.gateway.stop()


@pytest.mark.parametrize("settings, text", [
    ({"web_port": "x"}, "web_port"), ({"team_pages": "none"}, "team_pages"), ({"web_cert": "a.pem"}, "give both"),
    ({"title": ["x"]}, "title"), ({"web_logos": 7}, "web_logos"),
])
def test_wrong_parameters_are_reported(world, settings, text):
    with pytest.raises(BadParams, match=text):
        world.make(**settings)


@pytest.mark.parametrize("address, web_host, expected", [
    ("192.0.2.7", "0.0.0.0", "192.0.2.7"), ("localhost", "0.0.0.0", HOST), ("192.0.2.7", HOST, HOST),
])
def test_devices_get_the_address_for_referees(world, address, web_host, expected):
    world.start(address=address, web_host=web_host)
    assert world.call("pair", role="organiser")["url"].startswith(f"http://{expected}:{world.port}/pair#")


# -- its calls --------------------------------------------------------------------------------------


def test_the_calls_have_their_names(world):
    world.make()
    assert tuple(world.calls) == WEB_CALLS


def test_devices_are_paired_listed_and_ended(world):
    world.start()
    made = world.paired()
    assert made["valid"] == 120.0 and f"/pair#{made['code']}-" in made["url"]
    world.paired("Olga", role="organiser", zone="")
    first, second = world.call("paired")["devices"]
    assert {name: first[name] for name in ("role", "zone", "person", "device", "connected")} == {
        "role": "referee", "zone": "Home", "person": "Anna", "device": "iPhone", "connected": False}
    assert first["paired"] > 1.7e9 and first["seen"] >= first["paired"] and second["zone"] == ""
    assert world.call("revoke", device="none") == {"revoked": 0}
    assert world.call("revoke", device=first["id"]) == {"revoked": 1}
    assert [one["person"] for one in world.call("paired")["devices"]] == ["Olga"]
    assert world.call("revoke") == {"revoked": 1}
    assert world.call("paired") == {"devices": []}


@pytest.mark.parametrize("arguments, reason", [
    ({"role": "king", "zone": "Home"}, "no role 'king'.*choose one of"),
    ({"role": "referee"}, "a referee needs a zone"),
    ({"role": "judge", "zone": "Hom"}, "did you mean"),
    ({"role": "organiser", "zone": "Home"}, "leave out zone 'Home'"),
    ({"role": 7}, "role is not a text"), ({"role": "referee", "zone": "x" * 501}, "zone is not a text"),
    ({"role": "referee", "zone": "\ud800"}, "zone is not a text"), ({}, "no role ''"),
])
def test_no_code_is_made_for_a_wrong_request(world, arguments, reason):
    world.start()
    with pytest.raises(Refused, match=reason):
        world.call("pair", **arguments)


def test_teams_have_their_codes_until_they_are_renewed(world):
    world.start()
    before = world.call("team_codes")
    assert (before["team_pages"], before["teams"]) == ("code", ["Alpha"])
    assert world.call("team_codes", renew=False) == before
    after = world.call("team_codes", renew=True)
    assert len(after["codes"]) == 1 and after["codes"] != before["codes"]


def test_what_cannot_be_saved_names_the_remedy(world, monkeypatch):
    world.start()
    world.paired()
    (world.folder / FILE).unlink()
    shutil.rmtree(world.folder)
    world.folder.write_text("no folder")
    with pytest.raises(Refused, match="Ended, but not saved .*valid again after a restart"):
        world.call("revoke")
    with pytest.raises(Refused, match="cannot be saved"):
        world.call("team_codes", renew=True)
    monkeypatch.setattr(gateway, "DISK_S", 0.01)
    monkeypatch.setattr("roah_rsbb.ground.kept_file.durable.write_file", lambda path, content: time.sleep(0.3))
    world.folder.unlink()
    with pytest.raises(Refused, match="cannot be saved .the disk takes no data"):
        world.call("team_codes", renew=True)
    assert world.call("paired") == {"devices": []}


def test_a_pairing_outlives_the_gateway(world, running, tmp_path):
    world.start()
    world.paired()
    assert stat.S_IMODE((world.folder / FILE).stat().st_mode) == 0o600
    again = World(running, world.folder)
    again.make()
    assert [one["person"] for one in again.call("paired")["devices"]] == ["Anna"]
