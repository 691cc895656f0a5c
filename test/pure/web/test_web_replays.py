"""The page that plays a run again: who may see it, and what becomes of the journal's answer."""

import subprocess

import pytest

from helpers.served_pages import ServedPages
from helpers.shown_box import NOW
from roah_rsbb.model.results import RunLine
from roah_rsbb.web import replays
from roah_rsbb.web.own_pages import COOKIE

RUN = RunLine("HWV-6667-1", 1, "Home", "HWV", "Alpha", 1, 1, NOW, NOW, NOW, "stopped")


class Served(ServedPages):
    """A server with a journal that has a run."""

    def __init__(self, running):
        super().__init__(running, log_dir="the journal")
        self.box.document = self.box.document._replace(results={RUN.identity: RUN})

    def replay(self, token="", identity=RUN.identity):
        return self.get(f"/replay/{identity}", headers={"Cookie": f"{COOKIE}={token}"})


@pytest.fixture
def served(running):
    served = Served(running)
    yield served
    served.server.close()
    running.turn()


def test_referees_and_organisers_see_the_page_with_its_own_rules(served, monkeypatch):
    monkeypatch.setattr(replays, "_made", lambda log_dir, identity: f"{log_dir}: {identity}".encode())
    for token in (served.token("organiser"), served.token("referee")):
        answer = served.replay(token)
        assert (answer.code, answer.body) == (200, b"the journal: HWV-6667-1")
        assert "Content-Security-Policy" not in answer.headers
    tokens = served.token("judge"), served.token("referee", "Hall"), served.token("observer"), ""
    assert [served.replay(token).code for token in tokens] == [404, 404, 404, 401]
    assert served.replay(served.token("organiser"), "HWV-1").code == 404


def test_one_page_is_made_at_a_time_and_a_failure_is_no_end(served, monkeypatch):
    token = served.token("organiser")
    served.server.is_replaying = True
    assert served.replay(token).code == 429
    served.server.is_replaying = False

    def fails(log_dir, identity):
        raise subprocess.CalledProcessError(1, "results")

    monkeypatch.setattr(replays, "_made", fails)
    assert [served.replay(token).code, served.replay(token).code] == [500, 500]


def test_the_process_that_makes_the_page_reads_the_journal(tmp_path):
    with pytest.raises(subprocess.CalledProcessError):
        replays._made(str(tmp_path), RUN.identity)
