"""Where programs find the door of a box, and the token that opens it: in a file on the box's computer, or in a
parameter of a ROS master.

Only its owner may read a file: it is for programs of the same user. A box without ROS has one in the user's folder, and
its master has none. A box with ROS has one for its master, and the parameter, which is for all computers of a ROS
network.
"""

import errno
import json
import os
import socket
import urllib.parse
from typing import Any, Callable, NamedTuple, Optional

_FULL = (errno.ENOSPC, errno.EDQUOT)


class NotFound(Exception):
    """Nobody knows where the door is. The text names the remedy."""


class OnlyStops(NotFound):
    """The box has no door, because it only sends STOP. The text says why."""


class DoorPlace(NamedTuple):
    """The address of a door (ws://…), and its token."""

    url: str
    token: str


def new_token() -> str:
    """Return a random token."""
    import secrets  # late, as below: a STOP that begins only reads a place

    return secrets.token_urlsafe(32)


def write_place(path: str, url: str, token: str, why: str = "") -> None:
    """Write the file of a door; `why`: why there is none. Raises OSError.

    On a full disk, the file of the door before is written over, which has as many bytes."""
    from roah_rsbb.ground.durable import write_file

    os.makedirs(os.path.dirname(path), exist_ok=True)
    content = json.dumps({"url": url, "token": token, **({"why": why} if why else {})}).encode()
    try:
        write_file(path, content)
    except OSError as error:
        size = os.path.getsize(path) if os.path.exists(path) else 0
        if error.errno not in _FULL or size < len(content):
            raise
        with open(path, "r+b", buffering=0) as file:
            file.write(content.ljust(size))


def read_place(path: str) -> DoorPlace:
    """Return the place in a file. Raises `NotFound`."""
    try:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        if "why" in found:
            raise OnlyStops(str(found["why"]))
        return DoorPlace(str(found["url"]), str(found["token"]))
    except OSError as error:
        raise NotFound(f"{path}: {error.strerror}: start the box on this computer as the same user") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise NotFound(f"{path} is damaged: start the box again, which writes it") from None


PARAM = "/roah_rsbb_door"
# ROS's default, for a shell in which no setup file is sourced.
MASTER_URI = "http://localhost:11311"
ANSWER_S = 3.0
DOOR_ANSWER_S = 1.0
START = "start the box with 'roslaunch roah_rsbb roah_rsbb.launch', or without ROS with 'roah-rsbb run FOLDER'"
START_HERE = "start it with 'roah-rsbb run FOLDER'"
# Names the file of the door of a box without ROS, if several run on this computer.
OWN_VARIABLE = "ROAH_RSBB_DOOR"


def local_door_file() -> str:
    """Return the path of the file in which the box without ROS on this computer says where its door is."""
    return os.environ.get(OWN_VARIABLE) or door_file_in(user_folder())


def user_folder() -> str:
    """Return the folder in which boxes without ROS of this user find each other."""
    return os.path.join(os.path.expanduser("~"), ".roah_rsbb")


def door_file_in(log_dir: str) -> str:
    """Return the path of the file in which a box without ROS says to what belongs to it where its door is."""
    return os.path.join(log_dir, "door.json")


def is_answering(path: str) -> bool:
    """Whether there is a door on this computer at the place in a file."""
    try:
        host, port = urllib.parse.urlsplit(read_place(path).url).netloc.split(":")
        with socket.create_connection((host, int(port)), DOOR_ANSWER_S):
            return True
    except (NotFound, OSError, ValueError):
        return False


def file_of(master_uri: str) -> str:
    """Return the path of the file in which the box of a ROS master on this computer says where its door is; empty: the
    master is on another computer, whose box is another one. Looks the master's name up, which may take seconds."""
    master = urllib.parse.urlsplit(master_uri)
    if not _is_here(master.hostname or ""):
        return ""
    home = os.environ.get("ROS_HOME") or os.path.join(os.path.expanduser("~"), ".ros")
    return os.path.join(home, f"roah_rsbb_door_{master.port or 80}.json")


def _is_here(host: str) -> bool:
    """Whether an address is one of this computer: only those can be bound."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as trial:
        try:
            trial.bind((host, 0))
        except (OSError, UnicodeError):
            return False
    return host != ""


class DoorPlaces:
    """Finds the door of a box: of the one without ROS, if there is one and no ROS master is named; else of the box of a
    master, in the file and in the parameter by turns. It never changes from one box to the other.

    `roah-rsbb` prefers a box without ROS that answers to the master of the shell, which many people set for all shells.
    """

    def __init__(self, master_uri: Optional[str] = None, without_ros: bool = False) -> None:
        """`master_uri`: None: that of ROS_MASTER_URI. `without_ros`: nobody expects a box with ROS, unless a master is
        named."""
        named = master_uri or os.environ.get("ROS_MASTER_URI", "")
        self.master_uri = named or MASTER_URI
        self._is_own: Optional[bool] = None  # whether it is the box without ROS; None: none was found yet
        self._has_own: Callable[[str], bool] = os.path.exists
        if OWN_VARIABLE in os.environ and not master_uri:
            self._is_own = True
        elif without_ros and named and not master_uri:
            self._has_own = is_answering
        elif named or without_ros:
            self._is_own = not named
        self._tried: Optional[DoorPlace] = None  # the last one
        self._of_master: Optional[DoorPlace] = None  # where the master said last that it is

    def find(self) -> DoorPlace:
        """Return where to try next; a place that was tried last only if there is no other. Raises `NotFound`."""
        found = self._own()
        if found is None:
            found, self._is_own = self._of_box_with_ros(), False
        return found

    def near(self) -> Optional[DoorPlace]:
        """Return what a file says, without asking anybody; None: nothing. Raises `NotFound`."""
        host = urllib.parse.urlsplit(self.master_uri).hostname or ""
        is_plain = host in ("localhost", socket.gethostname()) or host.replace(".", "").isdigit()
        return self._own() or (self._of_file() if is_plain else None)

    def _own(self) -> Optional[DoorPlace]:
        if self._is_own or (self._is_own is None and self._has_own(local_door_file())):
            self._is_own = True
            if not os.path.exists(local_door_file()):
                raise NotFound(f"no box of this user runs on this computer: {START_HERE}")
            return read_place(local_door_file())
        return None

    def _of_file(self) -> Optional[DoorPlace]:
        try:
            path = file_of(self.master_uri)
        except ValueError as error:
            raise NotFound(f"ROS_MASTER_URI is {self.master_uri!r} ({error}): set it to http://ADDRESS:11311 of the "
                           "box's computer, or unset it") from None
        try:
            return read_place(path) if path else None
        except OnlyStops:
            raise
        except NotFound:
            return None

    def _of_box_with_ros(self) -> DoorPlace:
        of_file = self._of_file()
        if of_file is not None and of_file != self._tried:
            self._tried = of_file
            return of_file
        why = self._ask()
        found = self._of_master if self._of_master not in (None, self._tried) else of_file or self._of_master
        self._tried = found
        if found is None:
            raise NotFound(why)
        return found

    def _ask(self) -> str:
        """Ask the master; returns why nothing was found."""
        # Late: a STOP at its start needs none of it.
        import xmlrpc.client
        from http.client import HTTPException
        from xml.parsers.expat import ExpatError

        class Impatient(xmlrpc.client.Transport):
            """Calls time out."""

            def make_connection(self, host: Any) -> Any:
                connection = super().make_connection(host)
                connection.timeout = ANSWER_S
                return connection

        try:
            answer: Any = xmlrpc.client.ServerProxy(self.master_uri, Impatient()).getParam("/roah_rsbb", PARAM)
            code, _, value = answer
        except (OSError, HTTPException, xmlrpc.client.Error, ExpatError, ValueError, TypeError) as error:
            why = "does not answer" if isinstance(error, socket.timeout) else f"cannot be reached ({error})"
            return f"ROS master at {self.master_uri} {why}: {START}, or set ROS_MASTER_URI to the box's computer"
        if code == 1 and isinstance(value, dict) and {"url", "token"} <= value.keys():
            self._of_master = DoorPlace(str(value["url"]), str(value["token"]))
        else:
            self._of_master = None
        return (f"no box at the ROS master {self.master_uri}: {START}; or, if a box runs, start the launch again "
                "after its runs, because the master has forgotten it")
