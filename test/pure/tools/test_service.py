"""The box's service has few rights, but those that the box needs (docs/security.md, "The service")."""

import configparser
import pathlib
import re
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
UNIT = ROOT / "packaging" / "debian" / "roah-rsbb@.service"
# Of 10.0.
MOST_EXPOSED = 2.0


def _settings():
    unit = configparser.RawConfigParser(strict=False, interpolation=None)
    unit.optionxform = str
    unit.read(str(UNIT))
    return dict(unit["Service"])


def _analyze():
    """The output of systemd-analyze; None: this system has none that reads files."""
    program = shutil.which("systemd-analyze")
    if program is None:
        return None
    asked = subprocess.run([program, "security", "--offline=true", str(UNIT)], stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT, text=True, timeout=60)
    return asked.stdout if "exposure level" in asked.stdout else None


def test_it_is_hardly_exposed():
    output = _analyze()
    if output is None:
        pytest.skip("this system has no systemd-analyze of systemd 250 or later")
    rating = float(re.search(r"Overall exposure level .*: ([\d.]+)", output).group(1))
    assert rating <= MOST_EXPOSED, output


def test_it_can_do_what_the_box_does():
    """What a later, stricter unit would break. A trial of these needs a running systemd."""
    settings = _settings()
    assert settings["UMask"] == "0027", "the group reads log_dir"
    assert settings["ProtectSystem"] == "full", "log_dir and a stick may be anywhere"
    assert not {"ProtectHome", "ReadOnlyPaths", "InaccessiblePaths"} & set(settings)
    assert "char-alsa" in settings["DeviceAllow"] and "PrivateDevices" not in settings, "sounds"
    assert "ProcSubset" not in settings, "the journal needs the boot id in /proc/sys"
    assert not {"PrivateNetwork", "IPAddressDeny", "SocketBindDeny"} & set(settings), "robots may be in any network"
    assert set(settings["RestrictAddressFamilies"].split()) >= {"AF_UNIX", "AF_INET", "AF_INET6", "AF_NETLINK"}
    assert "RemoveIPC" not in settings, "its user may be logged in"
    assert "MemoryDenyWriteExecute" not in settings, "players may compile when they run"
