"""The checks before a competition: each thing that may be wrong, and its remedy."""

import os
import pathlib
import re
import shutil
import socket
import threading
from types import SimpleNamespace

import pytest
import yaml

from helpers import slots
from helpers.config_files import SHIPPED
from roah_rsbb.comm.frame import encode
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.model.messages import Beacon, DevicesState, TabletState
from roah_rsbb.radio import wire_convert
from roah_rsbb.tools import preflight_checks as checks
from roah_rsbb.tools.competition.files import firewall_text
from roah_rsbb.tools.ports import Interface, Listener, interfaces, listeners, open_to
from roah_rsbb.tools.preflight_checks import Severity

LO = Interface("lo", "127.0.0.1", LOOPBACK_BROADCAST)
ETH = Interface("eth0", "192.168.1.2", "192.168.1.255")
VPN = Interface("tun0", "10.8.0.1", "")


def test_the_interfaces_of_this_computer():
    assert LO in interfaces()


@pytest.mark.parametrize("host, found, level, text", [
    ("192.168.1.255", [LO, ETH], Severity.OK, "broadcast address of eth0"),
    (LOOPBACK_BROADCAST, [LO, ETH], Severity.WARNING, "this computer only"),
    ("10.255.255.255", [LO, ETH, VPN], Severity.FAILED, "is not a broadcast address"),
    ("192.168.1.2", [LO, ETH], Severity.FAILED, "is not a broadcast address"),
    ("10.255.255.255", [], Severity.FAILED, "is not a broadcast address"),
])
def test_the_broadcast_address(host, found, level, text):
    finding = checks.check_network(host, found)
    assert finding.level is level
    assert text in finding.text
    if level is Severity.FAILED:
        assert ("192.168.1.255 (eth0, 192.168.1.2)" in finding.remedy) is (ETH in found)
        assert "tun0" not in finding.remedy, "it has no broadcast address"


def test_the_open_tcp_ports_of_this_computer():
    with socket.socket() as everywhere, socket.socket() as here, socket.socket(socket.AF_INET6) as newer:
        for sock, host in ((everywhere, "0.0.0.0"), (here, HOST), (newer, "::")):
            sock.bind((host, 0))
            sock.listen(1)
        ports = [sock.getsockname()[1] for sock in (everywhere, here, newer)]
        with socket.create_connection((HOST, ports[1])):  # a connection is no listener
            found = listeners()
    mine = [next(listener for listener in found if listener.port == port) for port in ports]
    assert [listener.address for listener in mine] == ["0.0.0.0", HOST, "::"]
    assert all(listener.program for listener in mine)
    assert [listener in open_to(found, "192.168.1.2") for listener in mine] == [True, False, True]
    assert mine[1] in open_to(found, HOST)


LOADED = firewall_text("x", "eth0", 6666, tablet=True)
MASTER, TABLET, LOCAL = (Listener("0.0.0.0", 11311, "rosmaster"), Listener("::", 8080, "tablet"),
                         Listener("127.0.0.1", 631, ""))


@pytest.mark.parametrize("host, loaded, level, text", [
    ("192.168.1.255", LOADED, Severity.OK, "eth0 reaches only"),
    ("192.168.1.255", LOADED.replace("eth0", "wlan0"), Severity.WARNING, "not for eth0"),
    ("192.168.1.255", "", Severity.WARNING, "open now: TCP 11311 (rosmaster)"),
    ("192.168.1.255", None, Severity.WARNING, "open now: TCP 11311 (rosmaster)"),
])
def test_what_the_robots_network_reaches(host, loaded, level, text):
    # nft prints a definition as its value.
    printed = loaded and loaded.replace("$robots", loaded.partition("define robots = ")[2].partition("\n")[0])
    finding, = checks.check_exposure(host, [LO, ETH], [LOCAL, MASTER, TABLET], printed, "erl/firewall.nft")
    assert finding.level is level
    assert text in finding.text
    assert "8080" not in finding.text
    assert "631" not in finding.text
    if level is Severity.WARNING:
        assert "sudo nft -f erl/firewall.nft" in finding.remedy


@pytest.mark.parametrize("host", [LOOPBACK_BROADCAST, "10.255.255.255"])
def test_without_a_robots_network_nothing_is_closed(host):
    assert checks.check_exposure(host, [LO, ETH], [MASTER], "", "x") == []


@pytest.fixture
def port():
    """A port with free ones above it. Another run of these tests on this machine has other ones."""
    with slots.free_slot() as slot:
        yield slots.first_port(slot)


HOST = "127.0.77.1"


@pytest.mark.parametrize("above, level", [(0, Severity.FAILED), (3, Severity.WARNING)])
def test_ports_that_are_taken(port, above, level):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind((HOST, port + above))
        finding, = checks.check_ports(HOST, port)
    assert finding.level is level
    assert str(port + above) in finding.text


def test_why_no_port_can_be_opened(port):
    finding, = checks.check_bind("203.0.113.7", port)
    assert (finding.level, finding.remedy) == (Severity.FAILED, "")
    assert "203.0.113.7 is not an address of this machine" in finding.text
    assert finding.text.endswith(": correct bind_host")
    assert "65540 is not a UDP port: choose an rsbb_port from 1 to 65535" in checks.check_bind(HOST, 65490)[0].text
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind((HOST, port))
        assert checks.check_bind(HOST, port) == []


def test_another_box_is_heard(port):
    beacon = encode(wire_convert.beacon_message(Beacon((), DevicesState(), TabletState())))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        other.bind(("127.0.77.9", 0))
        done = threading.Event()

        def transmit():
            while not done.wait(0.05):
                other.sendto(beacon, (LOOPBACK_BROADCAST, port))

        thread = threading.Thread(target=transmit)
        thread.start()
        finding = checks.check_other_box(LOOPBACK_BROADCAST, port, HOST, 30.0)
        done.set()
        thread.join()
    assert (finding.level, finding.text) == (Severity.FAILED, "another RSBB transmits from 127.0.77.9")


def test_no_other_box(port):
    assert checks.check_other_box(LOOPBACK_BROADCAST, port, HOST, 0.05).level is Severity.OK


def test_a_network_that_cannot_be_listened_to(port):
    assert checks.check_other_box(LOOPBACK_BROADCAST, port, "203.0.113.7", 0.05).level is Severity.FAILED


@pytest.mark.parametrize("synchronised, level", [
    (True, Severity.OK), (False, Severity.WARNING), (None, Severity.WARNING),
])
def test_the_clock(synchronised, level):
    finding = checks.check_clock(synchronised)
    assert (finding.level, bool(finding.remedy)) == (level, level is not Severity.OK)
    assert checks.is_synchronised() in (True, False, None)


@pytest.mark.parametrize("gib, levels", [
    (50, [Severity.OK, Severity.OK]), (1, [Severity.OK, Severity.WARNING]), (0.1, [Severity.OK, Severity.FAILED]),
])
def test_the_disk(tmp_path, gib, levels):
    found = checks.check_log_dir(str(tmp_path / "new" / "logs"), lambda _: SimpleNamespace(free=gib * 1024**3))
    assert [f.level for f in found] == levels
    assert os.listdir(tmp_path / "new" / "logs") == []


def test_a_log_dir_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    finding, = checks.check_log_dir(str(tmp_path / "file"))
    assert (finding.level, str(tmp_path / "file") in finding.text) == (Severity.FAILED, True)


def files(**others):
    shipped = {f"{name}_file": str(SHIPPED / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords")}
    return {**shipped, **others}


def check_configuration(files, modules_dir=SHIPPED / "modules"):
    return checks.check_configuration(files, str(modules_dir))


def test_the_shipped_configuration_is_good_but_its_passwords_are_known():
    found = check_configuration(files())
    assert found[0].level is Severity.OK
    assert "zones" in found[0].text
    assert (found[-1].level, "TestingTeam" in found[-1].text) == (Severity.WARNING, True)
    assert "PASSWORD" not in "".join(map(str, found))


def test_the_shipped_passwords_are_those_of_the_file():
    shipped = yaml.safe_load((SHIPPED / "passwords.yaml").read_text(encoding="utf-8"))
    assert set(shipped.values()) == checks.SHIPPED_PASSWORDS


def test_passwords_that_were_changed(tmp_path):
    shipped = pathlib.Path(SHIPPED / "passwords.yaml").read_text(encoding="utf-8")
    new = tmp_path / "passwords.yaml"
    new.write_text("".join(
        f"{line.split(':')[0]}: fresh{i}\n" if ":" in line and not line.startswith("#") else f"{line}\n"
        for i, line in enumerate(shipped.splitlines())
    ), encoding="utf-8")
    new.chmod(0o600)
    found = check_configuration(files(passwords_file=str(new)))
    assert [f.level for f in found if "no time zone" not in f.text] == [Severity.OK, Severity.OK, Severity.OK]


def test_every_error_of_the_configuration_is_a_line(tmp_path):
    wrong = tmp_path / "benchmarks.yaml"
    wrong.write_text("- name: a\n- name: b\n", encoding="utf-8")
    found = check_configuration(files(benchmarks_file=str(wrong)))
    assert len(found) >= 2
    assert {f.level for f in found} == {Severity.FAILED}
    assert all("benchmarks.yaml:" in f.text and "\n" not in f.text for f in found[:2])


def test_a_wrong_parameter_of_a_scheduled_module_fails(tmp_path):
    modules_dir = tmp_path / "modules"
    shutil.copytree(str(SHIPPED / "modules"), str(modules_dir))
    hnf = modules_dir / "HNF.yaml"
    hnf.write_text(re.sub("# goal_timeout: [0-9]+", "goal_timeout: sixty", hnf.read_text(encoding="utf-8")))
    failed = [f.text for f in check_configuration(files(), modules_dir) if f.level is Severity.FAILED]
    assert len(failed) == 1
    assert "HNF.yaml:" in failed[0]
    assert "goal_timeout" in failed[0]


@pytest.mark.parametrize("script, level, text", [
    ("exit 0", Severity.OK, "sounds are played by {player}"),
    ("echo ALSA lib; echo no soundcards found >&2; exit 1", Severity.WARNING,
     "{player} cannot play the sounds, so nobody will hear them: no soundcards found"),
    ("exit 3", Severity.WARNING,
     "{player} cannot play the sounds, so nobody will hear them: it failed with status 3"),
    ("exec sleep 60", Severity.WARNING,
     "{player} cannot play the sounds, so nobody will hear them: it did not end within 0.5 s"),
    (None, Severity.WARNING, "{player} is not installed: the sounds that it plays will not be heard"),
])
def test_a_player_is_tried_with_silence(tmp_path, script, level, text):
    player = tmp_path / "player"
    if script is not None:
        player.write_text(f"#!/bin/sh\n{script}\n")
        player.chmod(0o755)
    found = checks.check_player([str(player), "-q", "/sounds/silence.wav"], 0.5 if script and "sleep" in script else 60)
    assert (found.level, found.text) == (level, text.format(player=player))
    assert ("bell_ring_command" in found.remedy) == (level is Severity.WARNING)
    assert (f"try it: {player} -q /sounds/bell.wav" in found.remedy) == ("nobody" in text)


def test_a_command_of_the_organisers_own_is_not_tried(tmp_path):
    found = checks.check_player(["/bin/false", "bell.wav"])
    assert (found.level, "It was not tried" in found.text) == (Severity.OK, True)


def test_display():
    assert (checks.check_display(True).level, checks.check_display(False).level) == (Severity.OK, Severity.WARNING)
