"""A second computer that has a copy of the box's journal, and takes over when the box is lost (docs/standby.md).

    rosrun roah_rsbb standby code --log-dir ~/competition/log
    rosrun roah_rsbb standby follow 192.168.1.2 --code
    rosrun roah_rsbb standby status
    rosrun roah_rsbb standby takeover
    rosrun roah_rsbb standby rejoin ~/competition/log
"""

import argparse
import os
import pwd
import shutil
import sys
import time
from typing import Any, Optional, Sequence

from roah_rsbb.comm import sockets
from roah_rsbb.ground import durable
from roah_rsbb.ground.arguments import Parser, called, number, read_by, typed
from roah_rsbb.journal.log import NewerFormat
from roah_rsbb.standby import pairing
from roah_rsbb.standby.channel import Lost
from roah_rsbb.standby.pair import rejoin_key
from roah_rsbb.standby.pairing import FOLDER, PairedBox, PairedStandby, read_box, read_standby, write_box
from roah_rsbb.standby.program.ears import PING, Automatic, NoAddress
from roah_rsbb.standby.program.keeping import LOG_DIR, CopyKeeper, Reply, full, noted_folder, request
from roah_rsbb.standby.program.rehearsal import Failed, rehearse
from roah_rsbb.standby.program.takeover import ALIVE_S, PROGRAM, Denied, StandbyFolder
from roah_rsbb.standby.standby_end import CannotPair, is_open, pair, rejoin

DEFAULT_PORT = 8083
LOG_DIR_OF_BOX = "~/.ros/roah_rsbb"
# A box that has just been started makes its part for a standby last: for so long it is waited for (s).
STARTS_S, LOOK_S = 10.0, 0.2
# Instead of a code: ask for it.
ASK = "?"
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


# -- on the box -----------------------------------------------------------------------------------------

def _code(_options: argparse.Namespace, folder: StandbyFolder) -> int:
    """Show a code."""
    own = StandbyFolder(os.path.join(folder.path, FOLDER))
    deadline = time.monotonic() + STARTS_S
    while not os.path.isdir(own.path) and folder.is_in_use and time.monotonic() < deadline:
        time.sleep(LOOK_S)
    if not os.path.isdir(own.path) or not folder.is_in_use:
        raise Denied(f"no box with a standby_port runs with the log_dir {folder.path}. Start it with standby_port:="
                     f"{DEFAULT_PORT}, or give its log_dir: --log-dir")
    if folder.standing.is_superseded:
        raise Denied(f"this box is superseded: pair the standby with the box at {folder.standing.by}")
    _check_owner(own.path)
    code, standby = pairing.make_code(folder.path), read_standby(folder.path)
    port = own.network_of_box().get("standby_port", str(DEFAULT_PORT))
    print(f"The code is {code}, for one standby and for {pairing.VALID_S / 60:.0f} minutes. Enter on the second "
          f"computer, with the address of this one:\n{typed(PROGRAM)} follow ADDRESS --code"
          f"{'' if port == str(DEFAULT_PORT) else f' --port {port}'}", flush=True)
    if standby is not None:
        print(f"That computer replaces the present standby, which is {standby.described}", flush=True)
    return 0


def _check_owner(folder: str) -> None:
    """Refuse to write what the user of the box could not read."""
    owner = os.stat(folder).st_uid
    if owner != os.geteuid():
        try:
            name = pwd.getpwuid(owner).pw_name
        except KeyError:
            name = str(owner)
        raise Denied(f"the box runs as user {name}, who alone can make a code: enter this command as that user")


def _claim_again(folder: StandbyFolder, standby: PairedStandby, anyway: bool) -> int:
    """Let the box that was superseded be the box again, because the one that took over is lost."""
    folder.check_unused()
    standing = folder.standing
    above = standing.epoch
    if not standing.is_superseded:  # it may have been off during the takeover
        copy = StandbyFolder(noted_folder())
        box = read_box(copy.path)
        if box is not None and box.key == rejoin_key(standby.key_sha256):  # this computer is the standby of that one
            above = copy.standing.epoch
        elif anyway:
            above = standing.next_epoch
        else:
            raise Denied(f"the journal in {folder.path} has no takeover: start the box as before. If another computer "
                         "took over while this one was off, and must not continue: --anyway")
    if not anyway and is_open(standby.host, standby.port, ALIVE_S):
        raise Denied(f"The box at {standby.host} answers. If it must not continue, switch it off. To take over in any "
                     "case: --anyway")
    standing = folder.raise_epoch(above)
    print(f"Epoch {standing.epoch}. Start the box as before. What the other box recorded is not here", flush=True)
    return 0


# -- on the standby -------------------------------------------------------------------------------------

def _follow(options: argparse.Namespace, folder: StandbyFolder) -> int:
    """Pair, and keep the copy."""
    automatic = _automatic(options)
    folder.check_unused()  # before the pair in it is replaced
    box = read_box(folder.path)
    host = _address(options.box) if options.box else ""
    if options.code:
        if not host:
            raise Denied("give the address of the box, too")
        box = pair(folder.path, host, options.port, _asked_code() if options.code == ASK else options.code)
        print(f"Paired with the box at {box.host}", flush=True)
    elif box is None:
        raise Denied("this standby is not paired: enter 'standby code' on the box, and here give the box's address "
                     "and --code")
    elif read_standby(folder.path) is not None and not folder.standing.is_superseded:
        raise Denied("this computer took over, and is the box. To start it again: standby takeover. To make it the "
                     "standby of another box: give that box's address and a new --code")
    elif host and (host, options.port) != (box.host, box.port):
        box = box._replace(host=host, port=options.port)
        write_box(folder.path, box)
    return CopyKeeper(folder, box, automatic, options.take_address).run()


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


def _rejoin(options: argparse.Namespace, folder: StandbyFolder) -> int:
    """Become the standby of the box that took over."""
    old = StandbyFolder(full(options.old_log_dir))
    if old.path == folder.path:
        raise Denied("OLD_LOG_DIR must not be the folder of the new copy: give another --log-dir, or none")
    automatic = _automatic(options)
    old.check_unused()
    folder.check_unused()
    old.give_back_address()
    box = rejoin(old.path, folder.path)
    print(f"This computer is the standby of the box at {box.host} now. {old.path} stays as it is: 'results' shows what "
          "only it has", flush=True)
    return CopyKeeper(folder, box, automatic, options.take_address).run()


def _takeover(options: argparse.Namespace, folder: StandbyFolder) -> int:
    """Start the box here."""
    box, standby = read_box(folder.path), read_standby(folder.path)
    if box is None and standby is not None:
        return _claim_again(folder, standby, options.anyway)
    standing = folder.standing
    if standby is not None and folder.is_in_use and not standing.is_superseded:
        if options.take_address and box is not None:
            _take_address(folder, box)
        else:
            print("This computer is the box already, and it runs", flush=True)
        return 0
    folder.launch_command()  # refuses if there is nothing to start
    if standing.is_superseded and not options.anyway:
        raise Denied(f"this computer was the box, and the one at {standing.by} took over. If that one is lost, and "
                     "the runs should continue from the journal here: --anyway")
    with request(folder.path, options.anyway, options.arguments) as found:
        answer = Reply([], False) if found is None else found.answer
        asks_here = found is None and not options.anyway
        heard = folder.why_not(options.listen) if asks_here else answer.reasons
        if heard:
            raise Denied("\n".join([*heard, "Robots obey both boxes. If the box must not continue, switch it off. "
                                    "To take over in any case: --anyway"]))
        if options.take_address and box is not None:
            _take_address(folder, box)
        if answer.is_prepared:
            print("\n".join([*found.go(), "The program that kept the copy is the box now"]), flush=True)
            return 0
        folder.end_follower()
    command, _ = folder.become_box(box)
    os.execvp(command[0], command)
    return 0


def _take_address(folder: StandbyFolder, box: PairedBox) -> None:
    try:
        folder.take_address(box)
    except NoAddress as error:
        raise Denied(
            f"the box's address cannot be taken over: {error}\nRobots that send to the box's address would not be "
            "heard by this computer. To take over without it, omit --take-address") from None


# -- the program ----------------------------------------------------------------------------------------

def _status(_options: argparse.Namespace, folder: StandbyFolder) -> int:
    """Show what this computer is."""
    for line in folder.status():
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


def _folder_of(options: argparse.Namespace) -> str:
    """Return the folder that a command is about."""
    if options.log_dir:
        return full(options.log_dir)
    if options.command != "rejoin":
        return noted_folder()
    # The copy needs another folder than that of the box that this computer was.
    usual = full(LOG_DIR)
    names = (usual, *(f"{usual}_{number}" for number in range(2, 1000)))
    return next(name for name in names if not StandbyFolder(name).has_journal)


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
    folder = StandbyFolder(_folder_of(options), options.arguments)
    try:
        if options.command not in ("status", "code"):
            os.makedirs(folder.path, exist_ok=True)
        acts = {"code": _code, "follow": _follow, "status": _status, "takeover": _takeover, "rejoin": _rejoin}
        sys.exit(acts[options.command](options, folder))
    except (Denied, CannotPair, Lost, OSError, NewerFormat) as error:
        for line in str(error).splitlines():
            print(f"{called(PROGRAM)}: {line}", file=sys.stderr)
        sys.exit(1)
