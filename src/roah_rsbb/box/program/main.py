"""The box of a competition, without ROS: all that its folder says, in one program.

The web pages are its face: they open in a browser, which is paired as the organiser's. Terminals use 'roah-rsbb
referee'. The box ends with Ctrl-C, and its runs continue when it is started again. If it ends unexpectedly, it is
started again at once.
"""

import argparse
import contextlib
import functools
import gc
import logging
import logging.handlers
import os
import sys
import textwrap
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Sequence

from roah_rsbb.ground.arguments import Parser, called, without_ros
from roah_rsbb.ground.durable import close_to_others
from roah_rsbb.ground.loop import LogLines
from roah_rsbb.ground.params import BadParams
from roah_rsbb.wording.times import Moments, has_zone

if TYPE_CHECKING:
    import asyncio

    from roah_rsbb.box.settings import BoxSettings

LOG_FILE, MAX_LOG_BYTES = "box.log", 5_000_000
_LINE = "%(asctime)s %(levelname)s %(message)s"
_log = logging.getLogger(__name__)
ALONE, SILENT, DUMMIES = "--unsupervised", "--no-browser", "--dummy-robots"

_EPILOG = """\
settings, given as name:=value; those in FOLDER/competition.launch are their defaults:
{settings}

Parameters of the core that no launch file has, such as allowed_skew:=0.2, can be given, too (docs/ros_interface.md).
"""


def _parser(explains: bool) -> argparse.ArgumentParser:
    """`explains`: whether the settings are explained, for which their files are read."""
    parser = Parser(called("run"), str(__doc__).strip(), _explanation() if explains else "",
                    usage=f"{called('run')} [-h] [--no-browser] [{ALONE}] [{DUMMIES}] [FOLDER] [name:=value ...]")
    parser.add_argument("folder", nargs="?", default="", metavar="FOLDER",
                        help="the competition's folder, made by 'roah-rsbb new'; without it, the settings say all")
    parser.add_argument(SILENT, action="store_true", help="do not open the pages in a browser")
    parser.add_argument(ALONE, action="store_true",
                        help="do not start the box again if it ends unexpectedly, because something else does")
    parser.add_argument(DUMMIES, action="store_true",
                        help="rehearse: with a dummy robot of each team, without a network, and with a copy of the "
                             "folder. As 'demo FOLDER', which has more options")
    return parser


def _explanation() -> str:
    from roah_rsbb.box.settings import of_box

    return _EPILOG.format(settings="\n".join(textwrap.fill(
        f"{name}: {found.doc} (default: {found.default or 'empty'})", 110, initial_indent="  ",
        subsequent_indent="      ") for name, found in of_box().items()))


class _VenueTimes(logging.Formatter):
    def formatTime(self, record: logging.LogRecord, datefmt: Optional[str] = None) -> str:
        """Return the time of a line, see `wording.times`; with its time zone, unless it is that of the competition."""
        return (Moments().time_of_day if has_zone() else Moments().with_zone)(record.created)


def log_to_terminal(level: int = logging.INFO, log_dir: str = "") -> None:
    """Let the lines of the log from this level on appear on the standard error, and all in a file of `log_dir`, if that
    can be written. Nothing waits for either."""
    terminal = logging.StreamHandler()
    terminal.setLevel(level)
    terminal.setFormatter(_VenueTimes(_LINE))
    handlers: List[logging.Handler] = [terminal]
    if log_dir:
        with contextlib.suppress(OSError):  # the box says what is wrong with the folder
            os.makedirs(log_dir, exist_ok=True)
            handlers.append(logging.handlers.RotatingFileHandler(
                os.path.join(log_dir, LOG_FILE), maxBytes=MAX_LOG_BYTES, backupCount=1, encoding="utf-8"))
    logging.basicConfig(level=logging.INFO, handlers=handlers, format=_LINE)
    logging.getLogger("tornado").setLevel(logging.ERROR)
    logging.raiseExceptions = False  # the standard error may be closed, or the disk full: the box says so elsewhere
    LogLines("")


def serve(make: Callable[["asyncio.AbstractEventLoop"], Any], work: Callable[[Any], Any], by_signal: int = 0) -> int:
    """Run a box until its `work` is done, somebody ends it, or a signal does; returns the exit status, which is then
    `by_signal`. `make` makes the box, and may raise what `BoxProgram` raises. `work` is a coroutine, and returns an
    exit status."""
    # Imported late: the supervisor, help or a wrong setting need none of it.
    import asyncio

    from roah_rsbb.ground.linux import end_loop, on_end
    from roah_rsbb.journal.log_dir import DamagedJournal
    from roah_rsbb.rulebook.errors import ConfigErrors

    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)  # tornado uses the thread's loop
    try:
        program = make(loop)
    except (BadParams, ConfigErrors, DamagedJournal, OSError) as error:
        for line in str(error).splitlines():
            _log.critical("%s", line)
        return 1
    working = loop.create_task(work(program))
    wishes: List[int] = []  # exit statuses

    def end(status: int) -> None:
        wishes.append(status)
        working.cancel()

    program.on_exit = functools.partial(end, 0)
    on_end(loop, functools.partial(end, by_signal))
    try:
        return int(loop.run_until_complete(working))
    except asyncio.CancelledError:
        return wishes[0]
    except OSError as error:
        _log.critical("%s", error)
        return 1
    finally:
        program.close()
        end_loop(loop)


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    options = _parser(bool({"-h", "--help"}.intersection(given))).parse_args(
        [word for word in given if ":=" not in word])
    if not options.folder and not any(":=" in word for word in given):
        sys.exit(f"{called('run')}: which competition? Give its FOLDER")
    if options.dummy_robots:
        command = without_ros("demo", options.folder)
        os.execvp(command[0], command)
    close_to_others()
    # Imported late, because the supervisor needs none of it before it has started the box.
    if not options.unsupervised:
        from roah_rsbb.box.program.supervisor import supervise
        from roah_rsbb.journal.copy_follower import copy_settings

        log_to_terminal()
        command = without_ros("run", *given, ALONE)
        sys.exit(supervise(
            command, [*command, SILENT], lambda memory: copy_settings(_settings(options.folder, given))))
    gc.disable()  # what is imported is no garbage, and to search it again and again takes a fifth of the start
    import asyncio

    from roah_rsbb.box.program.program import BoxProgram, door_file
    from roah_rsbb.box.program.supervisor import BY_SIGNAL, LAUNCH

    gc.freeze()
    gc.enable()
    try:
        settings = _settings(options.folder, given)
    except BadParams as error:
        sys.exit(f"{called('run')}: {error}")

    log_dir = settings.path("log_dir")
    log_to_terminal(log_dir=log_dir)

    async def work(program: BoxProgram) -> int:
        await program.start(door_file(log_dir))
        await program.open_pages(in_browser=not options.no_browser)
        await asyncio.get_event_loop().create_future()
        return 0

    launch = os.environ.get(LAUNCH, "")
    sys.exit(serve(lambda loop: BoxProgram(loop, settings, launch), work, BY_SIGNAL if launch else 0))


def _settings(folder: str, words: Sequence[str]) -> "BoxSettings":
    """Return the settings of the box of a competition. Raises `BadParams`."""
    from roah_rsbb.box.settings import of_competition, of_words

    return of_competition(folder, of_words(words))
