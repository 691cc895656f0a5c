"""`roah-rsbb` alone: a page in the browser that leads to everything else, for those who do not use a terminal.

It starts the other commands, shows what they print, and ends them. It is served on this computer only, and opens with a
token that only its own browser has. No script is needed.
"""

import asyncio
import hmac
import html
import os
import pathlib
import secrets
import subprocess
import threading
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

from tornado import web

from roah_rsbb.box.settings import LAUNCH
from roah_rsbb.comm.ciphers import PASSWORD_VARIABLE
from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.ground.linux import on_end, open_in_browser
from roah_rsbb.web.serving import BoundedServer, bind
from roah_rsbb.wording import language
from roah_rsbb.wording.device import StartWords as words
from roah_rsbb.wording.language import in_language, tr

HOST = "127.0.0.1"
# Where competitions are, each in a folder.
COMPETITIONS = pathlib.Path("~", "roah_rsbb")
MAX_LINES = 200
REFRESH_S = 2
END_S = 10.0

_FORBIDDEN = 403
_POLICY = "default-src 'none'; style-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"


class Input(NamedTuple):
    """A field of a form. `choices`: None: it is typed."""

    name: str
    label: str
    example: str = ""
    choices: Optional[Callable[[], List[str]]] = None
    is_required: bool = True
    kind: str = "text"


class Task(NamedTuple):
    """What a user may want, and the command for it."""

    name: str
    inputs: Tuple[Input, ...]
    # Arguments of `roah-rsbb`, and variables of its environment, made of what was typed.
    command: Callable[[Dict[str, str]], Tuple[List[str], Dict[str, str]]]


def competitions() -> List[str]:
    """Return the names of the competitions on this computer."""
    return sorted(path.parent.name for path in COMPETITIONS.expanduser().glob(f"*/{LAUNCH}"))


def _rulebooks() -> List[str]:
    return sorted(path.name for path in (shipped_folder() / "rulebooks").iterdir() if path.is_dir())


def _folder(name: str) -> str:
    return str(COMPETITIONS.expanduser() / pathlib.PurePath(name).name)


# Of the form of a new competition: options of the program.
_GIVEN = ("rulebook", "teams", "days", "arenas", "rounds", "decisions", "rsbb-host", "smartif-host")


def _new(typed: Dict[str, str]) -> Tuple[List[str], Dict[str, str]]:
    given = [f"--{name}={text}" for name, text in typed.items() if name in _GIVEN and text]
    return ["new", _folder(typed["name"]), *given], {}


def _run(typed: Dict[str, str]) -> Tuple[List[str], Dict[str, str]]:
    host = typed.get("rsbb-host", "")
    return ["run", _folder(typed["name"]), *([f"rsbb_host:={host}"] if host else [])], {}


def _check(typed: Dict[str, str]) -> Tuple[List[str], Dict[str, str]]:
    return ["check-robot", f"--team={typed['team']}", f"--host={typed['rsbb-host']}"], {
        PASSWORD_VARIABLE: typed["password"]}


TASKS = (
    Task(words.DEMO, (), lambda typed: (["demo"], {})),
    Task(words.RUN, (Input("name", words.COMPETITION, choices=competitions),
                     Input("rsbb-host", words.HOST, "192.168.1.255", is_required=False)), _run),
    Task(words.NEW, (Input("name", words.NAME, "erl2026"), Input("rulebook", words.RULEBOOK, choices=_rulebooks),
                     Input("teams", words.TEAMS, "BrassButlers, CopperKettle"),
                     Input("days", words.DAYS, "2026-11-28, 2026-11-29"),
                     Input("arenas", words.ARENAS, "2", is_required=False),
                     Input("rounds", words.ROUNDS, "2", is_required=False),
                     Input("decisions", words.DECISIONS, is_required=False),
                     Input("rsbb-host", words.HOST, "192.168.1.255", is_required=False),
                     Input("smartif-host", words.DEVICES, "192.168.1.56", is_required=False)), _new),
    Task(words.CHECK, (Input("team", words.TEAM, "BrassButlers"),
                       Input("password", words.PASSWORD, kind="password"),
                       Input("rsbb-host", words.HOST, "192.168.1.255")), _check),
)


class Started(NamedTuple):
    """A command that was started, and the end of what it printed."""

    task: Task
    process: "subprocess.Popen[str]"
    lines: List[str]


def start(task: Task, typed: Dict[str, str]) -> Started:
    """Start the command of a task."""
    arguments, variables = task.command(typed)
    process = subprocess.Popen(
        without_ros(*arguments), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, errors="replace", env={**os.environ, **variables, "PYTHONUNBUFFERED": "1"})
    found = Started(task, process, [])
    threading.Thread(target=_follow, args=(found,), daemon=True).start()
    return found


def _follow(started: Started) -> None:
    assert started.process.stdout is not None, "it is a pipe"
    for line in started.process.stdout:
        started.lines.append(line)
        del started.lines[:-MAX_LINES]


class StartPage:
    """Serves the page. Everything is called in the loop's thread."""

    def __init__(self) -> None:
        self.token = secrets.token_urlsafe(16)
        self.started: Optional[Started] = None
        self._typed: Dict[str, Dict[str, str]] = {}  # by task, to be tried again
        resource = shipped_folder().parent / "resource"
        sheets = {name: (resource / "web" / "assets" / f"{name}.css").read_text("utf-8")
                  for name in ("tokens", "dark", "parts", "public")}
        sheets["dark"] = f"@media (prefers-color-scheme: dark) {{{sheets['dark']}}}"
        self.style = "\n".join(sheets.values())
        files = (resource / "languages").glob("*.ts")
        self._languages = {language.ENGLISH: None, **language.translations(files)}
        self._server = BoundedServer(web.Application(
            [(r"/(|do|end|style\.css)", _Handler, {"page": self})], log_function=lambda handler: None))

    def open(self) -> str:
        """Serve the page; returns its address. Raises `ServeError`."""
        listening = bind(HOST, 0, "the start page", "start")
        self._server.add_sockets(listening)
        self.host = f"{HOST}:{listening[0].getsockname()[1]}"
        return f"http://{self.host}/?token={self.token}"

    def close(self) -> None:
        """Stop serving, and end what was started."""
        self._server.stop()
        self.end()

    def start(self, task: Task, typed: Dict[str, str]) -> None:
        """Start the command of a task, unless another one runs, or something that it needs is not typed."""
        self._typed[task.name] = {field.name: typed[field.name] for field in task.inputs if field.kind != "password"}
        if not self.is_busy and all(typed[field.name] or not field.is_required for field in task.inputs):
            self.started = start(task, typed)

    def end(self) -> None:
        """End what was started."""
        if self.started is not None and self.started.process.poll() is None:
            self.started.process.terminate()

    @property
    def is_busy(self) -> bool:
        """Whether something that was started has not ended."""
        return self.started is not None and self.started.process.poll() is None

    def text(self, accepted: str) -> str:
        """Return the page in the first language that a browser accepts."""
        name = language.chosen(accepted, self._languages)
        with in_language(self._languages[name]):
            body = self._shown() + ("" if self.is_busy else "".join(map(self._form, filter(_is_possible, TASKS))))
            refresh = f'<meta http-equiv="refresh" content="{REFRESH_S}">' if self.is_busy else ""
            style = f'<link rel="stylesheet" href="/style.css?token={self.token}">'
            return (f'<!DOCTYPE html><html lang="{name}"><head><meta charset="utf-8">{refresh}<meta name="viewport" '
                    f'content="width=device-width"><title>RoAH RSBB</title>{style}</head>'
                    f'<body class="device" data-layout="list"><main id="page"><h1>RoAH RSBB</h1>'
                    f'{body}</main></body></html>')

    def _shown(self) -> str:
        """What was started last."""
        if self.started is None:
            return ""
        task, process, lines = self.started
        status = process.poll()
        state = (tr(words.IN_PROGRESS) if status is None else tr(words.DONE) if status == 0
                 else tr(words.FAILED, status=status))
        end = (f'<form method="post" action="/end">{self._hidden()}<button class="button">{_said(words.END)}</button>'
               '</form>')
        return (f"<h2>{_said(words.TITLES[task.name])}: {html.escape(state)}</h2>"
                f"<pre>{html.escape(''.join(lines))}</pre>" + (end if status is None else ""))

    def _form(self, task: Task) -> str:
        name, typed = task.name, self._typed.get(task.name, {})
        inputs = "".join(_field(field, typed.get(field.name, "")) for field in task.inputs)
        return (f'<h2>{_said(words.TITLES[name])}</h2><form class="panel" method="post" action="/do">{self._hidden()}'
                f'<p class="quiet">{_said(words.EXPLANATIONS[name])}</p>'
                f'<input type="hidden" name="task" value="{name}">{inputs}'
                f'<button class="button next">{_said(words.BUTTONS[name])}</button></form>')

    def _hidden(self) -> str:
        return f'<input type="hidden" name="token" value="{self.token}">'


def _is_possible(task: Task) -> bool:
    """Whether each of its lists has an entry: without a competition, none can be run."""
    return all(field.choices is None or field.choices() for field in task.inputs)


def _said(text: str) -> str:
    return html.escape(tr(text))


def _field(field: Input, typed: str) -> str:
    label = f"<label>{_said(field.label)}{'' if field.is_required else f' ({_said(words.OPTIONAL)})'} "
    required = "required" if field.is_required else ""
    if field.choices is not None:
        options = "".join(f"<option{' selected' if choice == typed else ''}>{html.escape(choice)}</option>"
                          for choice in field.choices())
        return f'{label}<select name="{field.name}" {required}>{options}</select></label>'
    return (f'{label}<input name="{field.name}" type="{field.kind}" placeholder="{html.escape(field.example)}" '
            f'value="{html.escape(typed)}" autocomplete="off" spellcheck="false" {required}></label>')


class _Handler(web.RequestHandler):
    def initialize(self, page: StartPage) -> None:
        self._page = page

    def prepare(self) -> None:
        """Let only the browser in that was given the token, and only by the address of this computer."""
        token = self.get_argument("token", "")
        if self.request.host != self._page.host or not hmac.compare_digest(token.encode(), self._page.token.encode()):
            self.set_status(_FORBIDDEN)
            self.finish("Open this page by the address that 'roah-rsbb' prints.\n")

    def set_default_headers(self) -> None:
        self.set_header("Content-Security-Policy", _POLICY)
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("Cache-Control", "no-store")

    def get(self, name: str) -> None:
        """Show the page."""
        if name == "style.css":
            self.set_header("Content-Type", "text/css")
            self.finish(self._page.style)
            return
        self.finish(self._page.text(self.request.headers.get("Accept-Language", "")))

    def post(self, name: str) -> None:
        """Start a command, or end it."""
        task = next((task for task in TASKS if task.name == self.get_argument("task", "")), None)
        if name == "end":
            self._page.end()
        elif task is not None:
            self._page.start(task, {field.name: self.get_argument(field.name, "").strip() for field in task.inputs})
        self.redirect(f"/?token={self._page.token}", status=303)


def main(arguments: Optional[List[str]] = None) -> None:
    """Serve the page until Ctrl-C."""
    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)
    page = StartPage()
    url = loop.run_until_complete(_open(page))
    print(f"Open {url}\nCtrl-C ends this program and what it started. 'roah-rsbb --help' lists all commands.",
          flush=True)
    open_in_browser(url)
    on_end(loop, loop.stop)
    loop.run_forever()
    page.close()
    loop.close()


async def _open(page: StartPage) -> str:
    return page.open()
