"""A second computer that has a copy of the box's journal, and takes over when the box is lost (docs/standby.md).

    rosrun roah_rsbb standby code --log-dir ~/competition/log
    rosrun roah_rsbb standby follow 192.168.1.2 --code
    rosrun roah_rsbb standby status
    rosrun roah_rsbb standby takeover
    rosrun roah_rsbb standby rejoin ~/competition/log
"""

import argparse
import contextlib
import json
import os
import pwd
import shutil
import signal
import socket
import sys
import threading
import time
from typing import Any, Dict, Iterator, List, Optional, Sequence, TextIO, Tuple

from roah_rsbb.comm import sockets
from roah_rsbb.copies.folder import drop_drafts
from roah_rsbb.ground import durable, linux
from roah_rsbb.ground.arguments import Parser, called, is_without_ros, number, read_by, typed, without_ros
from roah_rsbb.journal import epochs
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.contents import BoxEpoch, open_journal
from roah_rsbb.journal.log import NewerFormat, names_in
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.rulebook.config import ScheduleSettings, settings_in
from roah_rsbb.rulebook.text_files import known
from roah_rsbb.standby import pairing
from roah_rsbb.standby.beside_copy import unpack
from roah_rsbb.standby.channel import MODULES, NETWORK, PASSWORDS, Lost
from roah_rsbb.standby.pair import hashed, rejoin_key
from roah_rsbb.standby.pairing import (
    FOLDER,
    PairedBox,
    PairedStandby,
    forget_standby,
    read_box,
    read_standby,
    set_aside_damaged_box,
    write_box,
    write_standby,
)
from roah_rsbb.standby.program.ears import PING, Automatic, Ears, NoAddress, give_back_address, is_own, take_address
from roah_rsbb.standby.program.prepared import Prepared
from roah_rsbb.standby.program.rehearsal import Failed, rehearse
from roah_rsbb.standby.program.request import Reply, Requests, request
from roah_rsbb.standby.standby_end import CannotPair, StandbyEnd, is_alive, is_open, pair, rejoin
from roah_rsbb.tools.preflight_checks import Severity, check_other_box
from roah_rsbb.wording import times

PROGRAM = "standby"
DEFAULT_PORT = 8083
LOG_DIR, LOG_DIR_OF_BOX = "~/.ros/roah_rsbb_standby", "~/.ros/roah_rsbb"
# In LOG_DIR: names the folder in which this computer keeps the copy, if it is another one.
KEPT_IN = "kept_in.txt"
# Arguments of roah_rsbb.launch, in the order of the files in configuration.json.
CONFIGURATION = "configuration"
# A box that has just been started makes its part for a standby last: for so long it is waited for (s).
STARTS_S, LOOK_S = 10.0, 0.2
# Instead of a code: ask for it.
ASK = "?"
# Locked by the program that keeps the copy.
LOCK = "standby_follow.lock"
ALIVE_S = 2.0
# Seconds without beacon, word and copy after which the program that keeps the copy allows a takeover. A box is heard
# several times a second.
SILENT_S = 3.0
# Seconds to wait until the program that keeps the copy has ended, with the box that is prepared.
END_S = 40.0
_DESCRIPTION = """\
A standby: a second computer that has a copy of the box's journal, and takes over when the box is lost.

  code      on the box: show a code with which one standby can be paired, for some minutes
  follow    pair with the box, once, and keep the copy
  status    show what this computer is: the box or the standby, how old the copy is, and what is set
  takeover  start the box here, with the copy. Refused while the box is heard
  rejoin    on the computer that was the box: become the standby of the box that took over
  rehearse  show a takeover on this computer, with the times. Needs no second computer, and changes nothing
"""
_EPILOG = """\
Start the box with standby_port:=8083. Settings NAME:=VALUE are passed to the box when the standby takes over;
bind_host:=ADDRESS is also used to listen. docs/standby.md explains everything else.
"""


class Denied(Exception):
    """The takeover is refused, or is not possible. The text has a reason in each line."""


def _parser() -> argparse.ArgumentParser:
    parser = Parser(called(PROGRAM), _DESCRIPTION, _EPILOG)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=_sub_parser)
    code = commands.add_parser("code", help="on the box: show a code with which one standby can be paired")
    follow = commands.add_parser("follow", help="pair with the box, once, and keep the copy")
    follow.add_argument("box", nargs="?", metavar="ADDRESS", help="the box's address; needed once")
    follow.add_argument("--port", type=read_by(_port), default=DEFAULT_PORT,
                        help="the box's standby_port (default: %(default)s)")
    follow.add_argument("--code", nargs="?", const=ASK, default="",
                        help="the code that 'standby code' shows on the box; needed once. Without CODE, the program "
                             "asks for it, so that other users of this computer do not see it in the list of processes")
    status = commands.add_parser("status", help="show what this computer is: the box or the standby")
    takeover = commands.add_parser("takeover", help="start the box here, with the copy")
    takeover.add_argument("--anyway", action="store_true", help="also while a box is heard: robots obey both")
    takeover.add_argument("--listen", type=number(0, 60), default=4.0, metavar="SECONDS",
                          help="time to listen for a box if 'standby follow' does not run; 0: do not listen (default: "
                               "%(default)s)")
    rejoin = commands.add_parser("rejoin", help="become the standby of the box that took over from this computer")
    rejoin.add_argument("old_log_dir", metavar="OLD_LOG_DIR", help="log_dir of the box on this computer")
    for command in (follow, rejoin):
        command.add_argument("--automatic", type=number(0, 3600), default=0.0, metavar="SECONDS",
                             help="take over without being asked when nothing is heard of the box for this long, at "
                                  "least 2 s (default: 0, never)")
        command.add_argument("--witness", metavar="ADDRESS", default="",
                             help="with --automatic: a third computer or access point that must answer a ping")
    for command in (follow, takeover, rejoin):
        command.add_argument("--take-address", action="store_true",
                             help="at a takeover, also take over the box's address, for robots that were given it. "
                                  "Needs root")
    commands.add_parser("rehearse", help="show a takeover on this computer, with the times")
    for command in (follow, status, takeover, rejoin):
        box = "; on the box: its log_dir" if command is status else ""
        command.add_argument("--log-dir", default="", metavar="DIR",
                             help=f"folder of the copy (default: where it was kept last, or {LOG_DIR}){box}")
    code.add_argument("--log-dir", default=LOG_DIR_OF_BOX, metavar="DIR",
                      help="log_dir of the box (default: %(default)s)")
    return parser


def _port(text: str) -> int:
    if not text.isdigit() or not 1 <= int(text) <= 65535:
        raise ValueError(f"{text!r} is not a port from 1 to 65535")
    return int(text)


def _sub_parser(prog: str, **options: Any) -> Parser:
    return Parser(prog, options.pop("description", ""), **options)


# -- pairing --------------------------------------------------------------------------------------------


def _code(_options: argparse.Namespace, folder: str) -> int:
    own = os.path.join(folder, FOLDER)
    deadline = time.monotonic() + STARTS_S
    while not os.path.isdir(own) and _runs_in(folder) and time.monotonic() < deadline:
        time.sleep(LOOK_S)
    if not os.path.isdir(own) or not _runs_in(folder):
        raise Denied(f"no box with a standby_port runs with the log_dir {folder}. Start it with standby_port:="
                     f"{DEFAULT_PORT}, or give its log_dir: --log-dir")
    standing = _standing(folder)
    if standing.is_superseded:
        raise Denied(f"this box is superseded: pair the standby with the box at {standing.by}")
    _check_owner(own)
    code, standby = pairing.make_code(folder), read_standby(folder)
    port = _network_of_box(own).get("standby_port", str(DEFAULT_PORT))
    print(f"The code is {code}, for one standby and for {pairing.VALID_S / 60:.0f} minutes. Enter on the second "
          f"computer, with the address of this one:\n{typed(PROGRAM)} follow ADDRESS --code"
          f"{'' if port == str(DEFAULT_PORT) else f' --port {port}'}", flush=True)
    if standby is not None:
        print(f"That computer replaces the present standby, which is {standby.described}", flush=True)
    return 0


def _runs_in(folder: str) -> bool:
    """Whether a box runs with this log_dir."""
    return linux.is_locked(os.path.join(folder, f"{JOURNAL}.lock"))


def _check_owner(folder: str) -> None:
    """Refuse to write what the user of the box could not read."""
    owner = os.stat(folder).st_uid
    if owner != os.geteuid():
        try:
            name = pwd.getpwuid(owner).pw_name
        except KeyError:
            name = str(owner)
        raise Denied(f"the box runs as user {name}, who alone can make a code: enter this command as that user")


# -- keeping the copy -----------------------------------------------------------------------------------


def _follow(options: argparse.Namespace, folder: str) -> int:
    automatic = _automatic(options)
    _check_unused(folder)  # before the pair in it is replaced
    box = read_box(folder)
    host = _address(options.box) if options.box else ""
    if options.code:
        if not host:
            raise Denied("give the address of the box, too")
        box = pair(folder, host, options.port, _asked_code() if options.code == ASK else options.code)
        print(f"Paired with the box at {box.host}", flush=True)
    elif box is None:
        raise Denied("this standby is not paired: enter 'standby code' on the box, and here give the box's address "
                     "and --code")
    elif read_standby(folder) is not None and not _standing(folder).is_superseded:
        raise Denied("this computer took over, and is the box. To start it again: standby takeover. To make it the "
                     "standby of another box: give that box's address and a new --code")
    elif host and (host, options.port) != (box.host, box.port):
        box = box._replace(host=host, port=options.port)
        write_box(folder, box)
    return _keep_copy(folder, box, options.arguments, automatic, options.take_address)


def _automatic(options: argparse.Namespace) -> Optional[Automatic]:
    """Return when to take over without being asked; None: never. Refuses what is not possible here, before anything is
    changed."""
    if 0.0 < options.automatic < 2.0:
        raise Denied("--automatic: give at least 2 s, as beacons come once a second; 0: never")
    if options.take_address and os.geteuid():
        raise Denied("--take-address needs root")
    if options.witness and not shutil.which(PING):
        raise Denied("--witness needs the program ping: install iputils-ping")
    return Automatic(options.automatic, options.witness) if options.automatic else None


def _asked_code() -> str:
    try:
        return input("The code that 'standby code' shows on the box: ")
    except EOFError:
        raise Denied("there is no terminal to ask for the code: give --code CODE") from None


def _address(host: str) -> str:
    """Return an address. A name would have to be looked up again by the new box, whose loop must not wait for that."""
    try:
        return sockets.resolve(host, "")
    except OSError:
        raise Denied(f"{host!r} is neither an IPv4 address nor a known host: give the box's address, such as "
                     "192.168.1.2") from None


def _has_journal(folder: str) -> bool:
    return bool(names_in(os.path.join(folder, JOURNAL)))


def _standing(folder: str) -> BoxEpoch:
    return epochs.standing_in(os.path.join(folder, JOURNAL))


def _rejoin(options: argparse.Namespace, folder: str) -> int:
    old = _full(options.old_log_dir)
    if old == folder:
        raise Denied("OLD_LOG_DIR must not be the folder of the new copy: give another --log-dir, or none")
    automatic = _automatic(options)
    _check_unused(old)
    _check_unused(folder)
    _give_back_address(old)
    box = rejoin(old, folder)
    print(f"This computer is the standby of the box at {box.host} now. {old} stays as it is: 'results' shows what only "
          "it has", flush=True)
    return _keep_copy(folder, box, options.arguments, automatic, options.take_address)


def _keep_copy(
    folder: str, box: PairedBox, arguments: Sequence[str], automatic: Optional[Automatic], takes_address: bool,
) -> int:
    """Keep the copy until the program is ended, or take over."""
    _check_unused(folder)
    _give_back_address(folder)
    forget_standby(folder)  # this computer may have been the box
    _note_folder(folder)
    _use_zone(folder)
    taking_over: List[str] = []  # why

    def take_over(why: str) -> None:
        taking_over.append(why)
        end.end()

    def on_ask(anyway: bool, given: List[str]) -> Reply:
        reasons = [] if anyway or ears.wait_silent(SILENT_S) else [f"The box at {box.host} is heard."]
        is_prepared = given in ([], list(arguments)) and prepared.is_for(launch_command(folder, arguments))
        return Reply(reasons, is_prepared)

    def on_hand_over() -> bool:
        try:
            launch_command(folder, arguments)
        except (Denied, OSError) as error:
            _show(f"the box hands over, but: {error}")
            return False
        return True

    prepared = Prepared(folder, lambda: launch_command(folder, arguments), Denied, _show)
    ears = Ears(box, lambda: _network(folder, arguments) if _network_of_box(folder) else {},
                lambda: _standing(folder).epoch, automatic,
                lambda: take_over(f"Nothing was heard of the box for {automatic.silence_s:g} s: taking over"), _show)
    end = StandbyEnd(folder, box, _show, ears.heard, _network(folder, arguments)["bind_host"], on_hand_over)
    for number_ in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number_, lambda *_: threading.Thread(target=end.end).start())
    with contextlib.ExitStack() as cleanup:
        # Until the prepared box has ended, too: the next one must not start beside it.
        lock = cleanup.enter_context(_locked(folder))
        requests = Requests(folder, on_ask, lambda: take_over("The organiser requested a takeover"))
        cleanup.callback(requests.close)
        cleanup.callback(prepared.end)
        ears.start()
        prepared.start()
        try:
            end.run()
        finally:
            ears.end()
        if end.was_handed_over:
            taking_over.append(
                f"The core of the box at {box.host} does not answer, and its computer hands over: taking over")
        if not taking_over:
            return 0
        print(taking_over[0], flush=True)
        if not prepared.is_for(launch_command(folder, arguments)):
            prepared.end()  # it would begin, too, and with other arguments
        if takes_address:
            _take_address(folder, box)
        command, lines = _become_box(folder, box, arguments)
        requests.report(lines)
        if prepared.is_for(command):
            lock.close()  # this program is the box, and not to be ended by the next takeover
            return prepared.run()
    os.execvp(command[0], command)
    return 0


def _take_address(folder: str, box: PairedBox) -> None:
    """Take the box's address in an automatic takeover. A failure does not end it: most robots need no address."""
    try:
        print(f"This computer has the address {box.host} now, on {take_address(box.host, folder)}", flush=True)
    except NoAddress as error:
        print(f"The box's address cannot be taken over: {error}", flush=True)


def _give_back_address(folder: str) -> None:
    """Remove the address that this computer took over, because it is not the box any more."""
    try:
        address = give_back_address(folder)
    except NoAddress as error:
        raise Denied(f"this computer still has the address that it took over: {error}") from None
    if address:
        print(f"This computer no longer has the address {address}, which it took over", flush=True)


def _check_unused(folder: str) -> None:
    for name in (LOCK, f"{JOURNAL}.lock"):
        lock = os.path.join(folder, name)
        if linux.is_locked(lock):
            raise Denied(f"another program uses {folder} (process {_noted_pid(lock) or 'unknown'}): end it first. If "
                         "it is the box, end that")


@contextlib.contextmanager
def _locked(folder: str) -> Iterator[TextIO]:
    """Note that this program keeps the copy, also while the box is not connected. Raises `Denied`."""
    with open(os.path.join(folder, LOCK), "a", encoding="ascii") as file:
        try:
            linux.lock(file.fileno())
        except BlockingIOError:
            raise Denied(f"another program keeps the copy in {folder}: end it first") from None
        with contextlib.suppress(OSError):  # a standby whose disk is full is one, too
            os.truncate(file.fileno(), 0)
            os.write(file.fileno(), f"{os.getpid()}\n".encode("ascii"))
        yield file


def _show(state: str) -> None:
    with contextlib.suppress(OSError):  # the output may be a file on a full disk
        print(f"{times.at_venue(time.time())} {state or 'The copy is kept'}", flush=True)


# -- status ---------------------------------------------------------------------------------------------


def status(folder: str) -> Iterator[str]:
    """Show what this computer is; yields sentences."""
    box, standby = read_box(folder), read_standby(folder)
    if not _has_journal(folder) and box is None:
        raise Denied(f"{folder} is neither the log_dir of a box nor the folder of a copy: give another --log-dir")
    _use_zone(folder)
    standing = _standing(folder)
    if standby is not None or box is None:
        yield from _status_of_box(standby, standing)
    else:
        yield from _status_of_standby(folder, box)
    yield f"Epoch {standing.epoch}"
    yield _durable_of(folder)


def _durable_of(folder: str) -> str:
    """Say what the schedule in force demands."""
    settings = _settings_of(folder)
    if settings is None:
        return "What 'durable' is set to is not known here"
    if settings.durable is Durable.TWO:
        return "Scores and sign-offs are confirmed when the standby has them, too (durable: two)"
    return "Scores and sign-offs are confirmed without waiting for the standby (durable: one)"


def _settings_of(folder: str) -> Optional[ScheduleSettings]:
    """Return the settings in the schedule in force; None: they are not known here."""
    kept = log_dirs.read_in_force(folder)
    text = None if kept is None else kept.versions[kept.present].texts[1]
    if text is None:
        return None
    with known({"schedule.yaml": text}):
        return settings_in("schedule.yaml")


def _use_zone(folder: str) -> None:
    """Show times in the time zone of the competition, or of this computer if that is not known here."""
    settings = _settings_of(folder)
    times.use_zone("" if settings is None else settings.time_zone)


def _status_of_box(standby: Optional[PairedStandby], standing: BoxEpoch) -> Iterator[str]:
    if standing.is_superseded:
        yield f"This computer was the box. The one at {standing.by} took over"
    if standby is None:
        yield "No standby is paired with this box"
    else:
        yield f"The standby of this box is {standby.name}" + (
            f", last connected from {standby.host}" if standby.host else ", which was never connected")
        if standby.replaced:
            paired = f"{times.day_of(standby.paired_utc)} at {times.at_venue(standby.paired_utc)}"
            yield f"It was paired on {paired}, and replaced {standby.replaced}"


def _status_of_standby(folder: str, box: PairedBox) -> Iterator[str]:
    answer = "answers" if is_alive(box, ALIVE_S) else "does not answer"
    yield f"This computer is the standby of the box at {box.host}, which {answer}"
    is_kept = linux.is_locked(os.path.join(folder, LOCK))
    yield "The copy is kept" if is_kept else "The copy is not kept: start 'standby follow'"
    if _has_journal(folder):
        yield last_moment(folder)


# -- taking over ----------------------------------------------------------------------------------------


def _takeover(options: argparse.Namespace, folder: str) -> int:
    box = read_box(folder)
    standby = read_standby(folder)
    if box is None and standby is not None:
        return _claim_again(folder, standby, options.anyway)
    standing = _standing(folder)
    if _is_running_box(folder, standby) and not standing.is_superseded:
        if options.take_address and box is not None:
            _take_address_or_refuse(folder, box)
        else:
            print("This computer is the box already, and it runs", flush=True)
        return 0
    launch_command(folder, options.arguments)  # refuses if there is nothing to start
    if standing.is_superseded and not options.anyway:
        raise Denied(f"this computer was the box, and the one at {standing.by} took over. If that one is lost, and "
                     "the runs should continue from the journal here: --anyway")
    with request(folder, options.anyway, options.arguments) as found:
        if found is not None:
            heard = found.answer.reasons
        elif options.anyway:
            heard = []
        else:
            heard = why_not(folder, _network(folder, options.arguments), options.listen)
        if heard:
            raise Denied("\n".join([*heard, "Robots obey both boxes. If the box must not continue, switch it off. "
                                    "To take over in any case: --anyway"]))
        is_prepared = found is not None and found.answer.is_prepared
        if options.take_address and box is not None:
            _take_address_or_refuse(folder, box)
        if not is_prepared:
            end_follower(folder)
        if is_prepared:
            print("\n".join([*found.go(), "The program that kept the copy is the box now"]), flush=True)
            return 0
    command, _ = _become_box(folder, box, options.arguments)
    os.execvp(command[0], command)
    return 0


def _is_running_box(folder: str, standby: Optional[PairedStandby]) -> bool:
    """Whether this computer took over before, and its box runs."""
    return standby is not None and linux.is_locked(os.path.join(folder, f"{JOURNAL}.lock"))


def _take_address_or_refuse(folder: str, box: PairedBox) -> None:
    try:
        print(f"This computer has the address {box.host} now, on {take_address(box.host, folder)}", flush=True)
    except NoAddress as error:
        raise Denied(
            f"the box's address cannot be taken over: {error}\nRobots that send to the box's address would not be "
            "heard by this computer. To take over without it, omit --take-address") from None


def _not_heard(folder: str, box: PairedBox) -> str:
    """Say which robots the new box does not hear, and what to do."""
    return (f"Robots that send to the box's address {box.host} instead of the broadcast address are not heard here: "
            "panels show them as silent. If there are such robots, take this address over. Enter as root:\n"
            f"{typed(PROGRAM)} takeover --take-address --log-dir {folder}")


def _become_box(folder: str, box: Optional[PairedBox], arguments: Sequence[str]) -> Tuple[List[str], List[str]]:
    """Make this computer the box, with a higher epoch than the box before. Returns the command that starts the box, and
    what was printed. A box that is prepared begins when this returns."""
    if not durable.has_space(folder):
        raise Denied(f"the disk is full: free space for {folder}, and take over again")
    command = launch_command(folder, arguments)
    lines = [last_moment(folder)]
    if drop_drafts(folder):
        lines.append("The disk of this computer failed to save a part of the copy, which was not written again yet: "
                     "compare the results with the referees' notes")
    standing = _standing(folder)
    is_box = read_standby(folder) is not None  # this computer took over before, and starts again
    if not is_box or standing.is_superseded:
        standing = epochs.raise_epoch(os.path.join(folder, JOURNAL), time.time(), socket.gethostname())
    if box is not None and not is_box:
        # The box before can become the standby of this one.
        write_standby(folder, PairedStandby("the box before", hashed(rejoin_key(hashed(box.key))), box.host, box.port,
                                            is_awaited=True))
    if set_aside_damaged_box(folder):
        lines.append("The key of the box before is damaged, so that box does not stop when it hears this one. Make "
                     "sure that it is off")
    if box is None:
        lines.append(f"Epoch {standing.epoch}")
    else:
        lines.append(f"Epoch {standing.epoch}: the box before stops when it hears this one")
    lines.append(" ".join(command))
    if box is not None and not is_own(box.host):
        lines.append(_not_heard(folder, box))
    print("\n".join(lines), flush=True)
    return command, lines


def _claim_again(folder: str, standby: PairedStandby, anyway: bool) -> int:
    """Let the box that was superseded be the box again, because the one that took over is lost."""
    _check_unused(folder)
    standing = _standing(folder)
    above = standing.epoch
    if not standing.is_superseded:  # it may have been off during the takeover
        copy = _noted_folder(_full(LOG_DIR))
        box = read_box(copy)
        if box is not None and box.key == rejoin_key(standby.key_sha256):  # this computer is the standby of that one
            above = _standing(copy).epoch
        elif anyway:
            above = standing.next_epoch
        else:
            raise Denied(f"the journal in {folder} has no takeover: start the box as before. If another computer took "
                         "over while this one was off, and must not continue: --anyway")
    if not anyway and is_open(standby.host, standby.port, ALIVE_S):
        raise Denied(f"The box at {standby.host} answers. If it must not continue, switch it off. To take over in any "
                     "case: --anyway")
    standing = epochs.raise_epoch(os.path.join(folder, JOURNAL), time.time(), socket.gethostname(), above)
    print(f"Epoch {standing.epoch}. Start the box as before. What the other box recorded is not here", flush=True)
    return 0


def why_not(folder: str, network: Dict[str, str], listen_s: float) -> List[str]:
    """Return why there must be no takeover: each way in which the box is heard."""
    reasons = []
    box: Optional[PairedBox] = read_box(folder)
    if box is not None and is_alive(box, ALIVE_S):
        reasons.append(f"The box at {box.host} answers.")
    if listen_s:
        found = check_other_box(network["rsbb_host"], int(network["rsbb_port"]), network["bind_host"], listen_s)
        if found.level is not Severity.OK:
            reasons.append(found.text)
    return reasons


def launch_command(folder: str, arguments: Sequence[str]) -> List[str]:
    """Return the command that starts the box with the copy; writes its files. Raises `Denied` or OSError."""
    if not _has_journal(folder):
        raise Denied(f"there is no copy in {folder}: 'standby follow' has not been connected to the box yet")
    given = {argument.partition(":=")[0] for argument in arguments}
    # A box that hears the one before must not give up: that one stops.
    own = {"log_dir": folder, "resume": "always", "take_over": "true", **_network_of_box(folder),
           **_write_files(folder)}
    start = without_ros("run", "--no-browser") if is_without_ros() else ["roslaunch", "roah_rsbb", "roah_rsbb.launch"]
    return [*start, *(f"{name}:={value}" for name, value in own.items() if name not in given), *arguments]


def _write_files(folder: str) -> Dict[str, str]:
    """Write the configuration files of the box; returns the arguments with their paths."""
    kept = log_dirs.kept_files(folder)
    if not kept:
        raise Denied(f"the copy in {folder} has no configuration: it is not complete. Use resume and the files of "
                     "the competition, see docs/standby.md")
    os.makedirs(os.path.join(folder, CONFIGURATION), exist_ok=True)
    found = {"standings_file": "none"}
    for name, text in kept.items():
        found[f"{name}_file"] = path = os.path.join(folder, CONFIGURATION, f"{name}.yaml")
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
    found["passwords_file"] = os.path.join(folder, PASSWORDS)
    modules = os.path.join(folder, CONFIGURATION, "modules")
    with contextlib.suppress(OSError):  # it must not prevent a takeover: only functionality benchmarks need them
        if unpack(os.path.join(folder, MODULES), modules):
            found["modules_dir"] = modules
    return found


def _network_of_box(folder: str) -> Dict[str, str]:
    try:
        with open(os.path.join(folder, NETWORK), encoding="utf-8") as file:
            return {name: str(value) for name, value in json.load(file).items()}
    except (OSError, ValueError, AttributeError):
        return {}


def _network(folder: str, arguments: Sequence[str]) -> Dict[str, str]:
    """Return where to listen for a box."""
    given = {name: value for name, _, value in (argument.partition(":=") for argument in arguments)}
    return {"rsbb_host": "10.255.255.255", "rsbb_port": "6666", "bind_host": "0.0.0.0",
            **_network_of_box(folder), **given}


def end_follower(folder: str) -> None:
    """End the program that keeps the copy. Raises `Denied`."""
    paths = [os.path.join(folder, name) for name in (LOCK, f"{JOURNAL}.lock")]
    deadline, asked = time.monotonic() + END_S, 0
    while any(map(linux.is_locked, paths)):
        pid = next(filter(None, map(_holder, paths)), 0)
        if not pid or time.monotonic() > deadline:
            raise Denied(f"another program uses the copy in {folder} (process {pid}): end it first")
        if pid != asked:
            asked = pid
            os.kill(pid, signal.SIGTERM)
        time.sleep(0.05)


def _noted_pid(path: str) -> int:
    """Return the process that noted itself in a lock; 0 if there is none."""
    with contextlib.suppress(OSError, ValueError), open(path, encoding="ascii") as file:
        return int(file.read())
    return 0


def _holder(path: str) -> int:
    """Return the process that keeps the copy; 0 if it is another program."""
    with contextlib.suppress(OSError):
        pid = _noted_pid(path)
        with open(f"/proc/{pid}/cmdline", "rb") as file:
            words = file.read().split(b"\0")
        if any(os.path.basename(word) == PROGRAM.encode("ascii") for word in words) and {b"follow", b"rejoin"} & {
                *words}:
            return pid
    return 0


def last_moment(folder: str) -> str:
    """Return what the newest entry of the copy is, as a sentence. A box without runs adds none."""
    utc = open_journal(os.path.join(folder, JOURNAL)).contents.utc
    if not utc:
        return "The copy is empty"
    _use_zone(folder)
    ago_s = max(0.0, time.time() - utc)
    return f"The newest entry of the copy is from {times.at_venue(utc)}, {ago_s:.0f} s ago"


def _folder_of(options: argparse.Namespace) -> str:
    """Return the folder that a command is about."""
    if options.log_dir:
        return _full(options.log_dir)
    usual = _full(LOG_DIR)
    if options.command != "rejoin":
        return _noted_folder(usual)
    # The copy needs another folder than that of the box that this computer was.
    names = (usual, *(f"{usual}_{number}" for number in range(2, 1000)))
    return next(name for name in names if not _has_journal(name))


def _full(path: str) -> str:
    return os.path.abspath(os.path.expanduser(path))


def _noted_folder(usual: str) -> str:
    with contextlib.suppress(OSError, ValueError), open(os.path.join(usual, KEPT_IN), encoding="utf-8") as file:
        noted = file.read().strip()
        return noted if os.path.isdir(noted) else usual
    return usual


def _note_folder(folder: str) -> None:
    """Let later commands find the copy without --log-dir."""
    usual = _full(LOG_DIR)
    with contextlib.suppress(OSError):  # a disk that is full: they need --log-dir
        os.makedirs(usual, exist_ok=True)
        durable.write_file(os.path.join(usual, KEPT_IN), folder.encode())


def _status(_options: argparse.Namespace, folder: str) -> int:
    for line in status(folder):
        print(line, flush=True)
    return 0


def _rehearse() -> int:
    try:
        for line in rehearse():
            print(line, flush=True)
    except Failed as error:
        print(f"{called(PROGRAM)}: {error}", file=sys.stderr)
        return 1
    return 0


def _options(words: Sequence[str]) -> argparse.Namespace:
    """Read the command line. Arguments of roah_rsbb.launch may stand anywhere in it."""
    options = _parser().parse_args([word for word in words if ":=" not in word])
    # roslaunch gives each node a name and a log, which are no arguments of a launch file.
    options.arguments = [word for word in words if ":=" in word and not word.startswith("__")]
    return options


def main(arguments: Optional[Sequence[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    durable.close_to_others()
    options = _options(sys.argv[1:] if arguments is None else arguments)
    if options.command == "rehearse":
        sys.exit(_rehearse())
    folder = _folder_of(options)
    try:
        if options.command not in ("status", "code"):
            os.makedirs(folder, exist_ok=True)
        acts = {"code": _code, "follow": _follow, "status": _status, "takeover": _takeover, "rejoin": _rejoin}
        sys.exit(acts[options.command](options, folder))
    except (Denied, CannotPair, Lost, OSError, NewerFormat) as error:
        for line in str(error).splitlines():
            print(f"{called(PROGRAM)}: {line}", file=sys.stderr)
        sys.exit(1)
