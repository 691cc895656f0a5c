"""Sounds: commands that are run, with a player of the test; and the sound files."""

import os
import pathlib
import queue
import signal
import subprocess
import sys
import time

import pytest

from roah_rsbb.devices.sounds import BELL, SILENCE, TIMEOUT, Sound, default_command, words_of

ROOT = pathlib.Path(__file__).resolve().parents[3]
LIMIT_S = 20

PLAYER = """\
import os, sys
os.close(os.open(sys.argv[1], os.O_WRONLY))  # says that it plays, once somebody listens
with open(sys.argv[2]) as end: end.read()    # plays until the test lets it end
sys.exit(int(sys.argv[3]))
"""


class Player:
    """A player that plays for as long as the test wants."""

    def __init__(self, folder, status=0):
        self.folder = folder
        self.begin, self.end = folder / "be gin", folder / "end"
        os.mkfifo(self.begin)
        os.mkfifo(self.end)
        script = folder / "player.py"
        script.write_text(PLAYER)
        self.command = f"{sys.executable} {script} '{self.begin}' {self.end} {status}"

    def wait_begun(self):
        with open(self.begin) as begin:
            begin.read(0)

    def let_end(self):
        with open(self.end, "w"):
            pass


@pytest.fixture
def troubles():
    return queue.Queue()


@pytest.fixture
def sound(troubles):
    made = []

    def make(command, limit_s=LIMIT_S):
        made.append(Sound("the bell", words_of(command), troubles.put, limit_s))
        return made[-1]

    yield make
    for one in made:
        one.close()


def test_one_at_a_time_and_one_more_afterwards(tmp_path, sound, troubles):
    player = Player(tmp_path, status=3)
    bell = sound(player.command)
    bell.ring()
    player.wait_begun()
    for _ in range(5):
        bell.ring()
    player.let_end()
    player.wait_begun()  # of the five, one is heard
    player.let_end()
    assert "status 3" in troubles.get(timeout=LIMIT_S)
    bell.ring()
    player.wait_begun()
    player.let_end()
    assert troubles.empty(), "the same is reported once"


def test_each_ring_is_heard_once(tmp_path, sound):
    played = tmp_path / "played"
    bell = sound(f"sed -i '$ a x' {played}")
    played.write_text("begin\n")
    for count in (2, 3):
        bell.ring()
        end = time.monotonic() + LIMIT_S
        while bell._wanted.is_set() or bell._running or len(played.read_text().split()) < count:
            assert time.monotonic() < end, "the sound is played"
            time.sleep(0.01)
        assert len(played.read_text().split()) == count


def test_no_shell_sees_the_command(tmp_path, sound, troubles):
    evil = tmp_path / "made"
    bell = sound(f"false ';' touch {evil} $(touch {evil}) & touch {evil}")
    bell.ring()
    troubles.get(timeout=LIMIT_S)
    assert not evil.exists()


def test_a_missing_player_is_one_warning(sound, troubles):
    bell = sound("/nowhere/player now")
    for _ in range(3):
        bell.ring()
    text = troubles.get(timeout=LIMIT_S)
    assert "/nowhere/player cannot be run: No such file or directory" in text
    assert "Install it, or choose another command" in text
    bell.ring()
    bell.close()
    assert troubles.empty()


def test_a_player_that_hangs_is_ended(sound, troubles, monkeypatch):
    players = queue.Queue()

    class Popen(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            players.put(self)

    monkeypatch.setattr(subprocess, "Popen", Popen)
    bell = sound("sleep 1000", limit_s=0.1)
    bell.ring()
    assert "played for more than 0.1 s" in troubles.get(timeout=LIMIT_S)
    assert players.get(timeout=LIMIT_S).returncode == -signal.SIGKILL
    bell.ring()
    assert players.get(timeout=LIMIT_S).args == ["sleep", "1000"]


def test_closing_silences(tmp_path, sound, troubles):
    player = Player(tmp_path)
    bell = sound(player.command)
    bell.ring()
    player.wait_begun()
    bell.close()
    assert not bell._thread.is_alive()
    assert troubles.empty()


@pytest.mark.parametrize("command", ["", "  ", "aplay 'bell.wav"])
def test_invalid_commands(command):
    with pytest.raises(ValueError):
        words_of(command)


@pytest.mark.parametrize("command, words", [
    ("aplay -q '/a b/#1.wav' # x", ["aplay", "-q", "/a b/#1.wav", "#", "x"]), (r"play a\ b", ["play", "a b"]),
])
def test_words_of_a_command(command, words):
    assert words_of(command) == words


@pytest.mark.parametrize("installed, player", [
    (["aplay", "paplay", "pw-play", "ffplay", "afplay"], ["aplay", "-q"]),
    (["paplay", "pw-play", "ffplay"], ["paplay"]),
    (["pw-play", "ffplay"], ["pw-play"]),
    (["ffplay"], ["ffplay", "-nodisp", "-autoexit"]),
    ([], ["aplay", "-q"]),  # the warning then names what to install
])
def test_the_first_player_that_is_installed_plays(monkeypatch, installed, player):
    monkeypatch.setattr("shutil.which", lambda name: f"/bin/{name}" if name in installed else None)
    for file in (BELL, TIMEOUT, SILENCE):
        command = default_command(file)
        assert command[:-1] == player
        assert os.path.samefile(command[-1], ROOT / "resource" / "sounds" / file)


@pytest.mark.long
def test_the_files_are_what_the_script_makes(tmp_path):
    subprocess.run([sys.executable, str(ROOT / "tools" / "make_sounds"), str(tmp_path)], check=True)
    made = sorted(path.name for path in tmp_path.iterdir())
    assert made == sorted([BELL, SILENCE, TIMEOUT])
    for name in made:
        assert (tmp_path / name).read_bytes() == (ROOT / "resource" / "sounds" / name).read_bytes()
