"""The page that leads whoever uses no terminal to everything else."""

import asyncio
import re
import urllib.parse

import pytest
from tornado import httpclient

from helpers.running_loop import running  # noqa: F401
from roah_rsbb.box.program import start_page
from roah_rsbb.box.program.start_page import StartPage
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.tools.competition.answers import questions
from roah_rsbb.tools.competition.rulebooks import read_rulebook
from roah_rsbb.wording.device import StartWords as words

NEW = {"task": "new", "name": "erl", "rulebook": "erl2019", "teams": "A, B", "days": "2026-11-28"}


@pytest.fixture
def page(running, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.setenv("HOME", str(tmp_path))
    made = StartPage()

    async def opened():
        return made.open()
    made.url = running.do(opened())
    yield made
    made.close()


@pytest.fixture
def ask(running, page):  # noqa: F811
    """Make a request; returns its status and text."""
    def make(path="/", form=None, token=None, **headers):
        base = f"http://{page.host}"
        given = page.token if token is None else token
        body = None if form is None else urllib.parse.urlencode({**form, "token": given})
        answer = running.do(httpclient.AsyncHTTPClient().fetch(
            base + path + ("" if form else f"?token={given}"), method="GET" if form is None else "POST", body=body,
            headers=headers, raise_error=False, follow_redirects=False))
        return answer.code, answer.body.decode()
    return make


def ended(running, page):  # noqa: F811
    async def wait():
        await asyncio.get_event_loop().run_in_executor(None, page.started.process.wait)
    running.do(wait())
    return page.started.process.returncode


def test_only_the_browser_with_the_token_gets_in(page, ask):
    assert ask(token="wrong")[0] == ask(token="")[0] == 403
    assert ask("/do", NEW, token="wrong")[0] == 403
    assert ask(Host="evil.example")[0] == 403
    assert page.started is None
    assert ask()[0] == 200


def test_it_offers_all_tasks_in_the_language_of_the_browser(ask):
    english, german = ask()[1], ask(**{"Accept-Language": "de-AT,en"})[1]
    for task in start_page.TASKS:
        if task.name == words.RUN:
            assert f'value="{task.name}"' not in english  # there is no competition yet
            continue
        assert f'value="{task.name}"' in english and f'value="{task.name}"' in german
        assert f"<h2>{words.TITLES[task.name]}</h2>" in english
    assert 'lang="de"' in german and "<h2>Neuer Wettbewerb</h2>" in german and "New competition" not in german


def test_a_competition_is_created_and_can_be_run_then(running, page, ask, tmp_path):  # noqa: F811
    assert ask("/do", NEW)[0] == 303
    assert ended(running, page) == 0
    assert (tmp_path / "roah_rsbb" / "erl" / "competition.launch").is_file()
    shown = ask()[1]
    assert "New competition: done" in shown
    assert "<option>erl</option>" in shown and 'value="run"' in shown


def test_what_went_wrong_is_shown(running, page, ask):  # noqa: F811
    ask("/do", {**NEW, "days": "<soon>"})
    assert ended(running, page) != 0
    running.until(lambda: any("soon" in line for line in page.started.lines))
    shown = ask()[1]
    assert "ended with status" in shown and "&lt;soon&gt;" in shown and "<soon>" not in shown
    assert 'value="A, B"' in shown and "<option selected>erl2019</option>" in shown, "it is not typed again"


def test_what_runs_is_shown_until_it_is_ended(running, page, ask):  # noqa: F811
    ask("/do", {"task": "check", "team": "A", "password": "secret", "rsbb-host": "127.255.255.255"})
    assert page.is_busy
    shown = ask()[1]
    assert "Check a robot: in progress" in shown and 'http-equiv="refresh"' in shown
    assert not re.search(r'name="task"', shown), "nothing else is started meanwhile"
    first = page.started
    ask("/do", NEW)
    assert page.started is first
    assert "secret" not in " ".join(map(str, first.process.args))
    ask("/end", {"task": ""})
    ended(running, page)
    shown = ask()[1]
    assert 'http-equiv="refresh"' not in shown
    assert 'value="127.255.255.255"' in shown and "secret" not in shown


@pytest.mark.parametrize("form", [{"task": "nothing"}, {"task": "new", "name": "erl"}, {**NEW, "teams": " "}])
def test_an_incomplete_form_starts_nothing(page, ask, form):
    assert ask("/do", form)[0] == 303
    assert page.started is None
    assert ("value=\"erl\"" in ask()[1]) == ("name" in form), "it is not typed again"


def test_a_name_leads_out_of_no_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    for task in ("new", "run"):
        command = next(each.command for each in start_page.TASKS if each.name == task)
        arguments, _ = command({**NEW, "name": "../../etc"})
        assert arguments[1] == str(tmp_path / "roah_rsbb" / "etc")


@pytest.mark.parametrize("rulebook", sorted(path.name for path in (shipped_folder() / "rulebooks").iterdir()))
def test_the_form_of_a_new_competition_asks_what_the_wizard_in_the_terminal_asks(rulebook):
    """Each field is a question of the wizard with its example, and what must be answered is on the page or in the
    rulebook: the page cannot ask back."""
    book = read_rulebook(Report(), str(shipped_folder()), rulebook)
    asked = {question.option: question for question in questions(book.benchmarks, book.decisions())}
    new, = (task for task in start_page.TASKS if task.name == words.NEW)
    given = {field.name: field for field in new.inputs if field.name not in ("name", "rulebook")}
    for name, field in given.items():
        report = Report()
        asked[name].reader(report, Place(name, 0, 0), field.example)
        assert field.is_required == (asked[name].default is None) and not report.errors, name
    assert {name for name, question in asked.items() if question.default is None} <= {*given, *book.answers}
