"""Node roah_rsbb_backup: copies the journal, continuously, to a second folder, such as a USB stick (docs/backup.md),
and to a standby, which is a second computer (docs/standby.md).

It reads the journal in log_dir, which the core writes. The core never waits for it. /copies/state (latched, once a
second) says how complete each copy is, and the core warns the referees if one is behind.

Parameters (private): log_dir; backup_dir: an existing folder, on another disk (none: no folder); standby_port: TCP port
for a standby (0: no standby); bind_host: own address for it; passwords_file, rsbb_host, rsbb_port: what the standby
needs to continue.
"""

import json
import os
from typing import Callable, List, Optional

import rospy

from roah_rsbb.box.standing_by import wait_for_takeover
from roah_rsbb.copies.folder import Stick
from roah_rsbb.copies.follower import Follower
from roah_rsbb.copies.reported import ReportedCopy
from roah_rsbb.core.copies import STANDBY
from roah_rsbb.durable import close_to_others
from roah_rsbb.log_lines import LogLines
from roah_rsbb.model import shown
from roah_rsbb.model.reason import is_made
from roah_rsbb.msg import CopyQuestion, CopyState
from roah_rsbb.nodes.handover import Handover
from roah_rsbb.params import BadParams
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.standby import codes
from roah_rsbb.standby.box_end import BoxEnd
from roah_rsbb.standby.herald import Herald
from roah_rsbb.standby.messages import NETWORK, PASSWORDS
from roah_rsbb.standby.partners import read_standby

PERIOD_S = 1.0
# A stick that hangs must not keep the node from ending.
END_S = 5.0
NO_FOLDER = "none"


def own_address(bind_host: str) -> str:
    """Return the address at which the core of this computer hears datagrams from this computer."""
    return "127.0.0.1" if bind_host == "0.0.0.0" else bind_host


def _message(copy: ReportedCopy) -> CopyState:
    news = copy.news()
    return CopyState(*news, shown.said(filter(is_made, (news.trouble, news.notice))))


class BackupNode:
    """The node. Raises `BadParams` or OSError at the start."""

    def __init__(self) -> None:
        params = NodeParams()
        self._log_dir = params.path("log_dir", "~/.ros/roah_rsbb")
        backup_dir = params.path("backup_dir") if params.text("backup_dir", NO_FOLDER) != NO_FOLDER else ""
        port = params.whole("standby_port", 0, 0, 65535)
        bind_host = params.text("bind_host", "0.0.0.0")
        passwords = params.path("passwords_file", "none")
        network = {"rsbb_host": params.text("rsbb_host", "10.255.255.255"),
                   "rsbb_port": params.whole("rsbb_port", 6666, 1, 65000), "standby_port": port}
        params.done()
        if not backup_dir and not port:
            raise BadParams(f"{rospy.get_name()}: set backup_dir, standby_port or both")
        wait_for_takeover(self._log_dir, rospy.is_shutdown)
        self._log_lines = LogLines()  # a handover must not wait for the terminal
        self._publisher = rospy.Publisher("/copies/state", CopyState, queue_size=10, latch=True)
        self._copies: List[ReportedCopy] = []
        if backup_dir:
            rospy.loginfo("Copying the journal to %s", backup_dir)
            self._add(backup_dir, Follower(self._log_dir, Stick(backup_dir, self._log_dir).open))
        self._box_end: Optional[BoxEnd] = None
        if port:
            self._handover = Handover(self._log_dir, lambda: self._box_end.is_connected,
                                      lambda question: self._copies[-1].follower.ask(question), self._standby_host)
            self._herald = Herald(self._log_dir, (own_address(bind_host), port),
                                  lambda: self._handover.state().is_alive)
            self._box_end = BoxEnd(self._log_dir, bind_host, port, lambda text: rospy.logwarn("%s", text),
                                   self._herald.answer, self._handover.state, self._handover.taken)
            self._herald.start()
            network_file = os.path.join(self._box_end.folder, NETWORK)
            with open(network_file, "w", encoding="utf-8") as file:
                json.dump(network, file)
            follower = Follower(self._log_dir, self._box_end.open_copy, {PASSWORDS: passwords, NETWORK: network_file},
                                on_answer=self._confirm)
            self._add(STANDBY, follower, lambda: self._box_end.notice)
            self._handover.start()
            self._confirmed = rospy.Publisher("/copies/confirmed", CopyQuestion, queue_size=10)
            rospy.Subscriber("/copies/asked", CopyQuestion, follower.ask, queue_size=10, tcp_nodelay=True)
            # Everybody on this computer can read the log, so the code is not in it.
            known = f"The standby is {self._box_end.name}. Another one" if self._box_end.is_paired else "A standby"
            rospy.logwarn("%s can be paired on TCP port %d. For a code, enter on this computer: %s",
                          known, self._box_end.port, codes.command(self._log_dir))

    def run(self) -> int:
        """Run until shut down."""
        while not rospy.core.is_shutdown():
            for copy in self._copies:
                self._publisher.publish(_message(copy))
            try:
                rospy.sleep(PERIOD_S)
            except rospy.ROSInterruptException:
                break
        if self._box_end is not None:
            self._handover.end()
            self._herald.end()
            self._box_end.close()
        for copy in self._copies:
            copy.follower.end(END_S)
        self._log_lines.close()
        return 0

    def _add(self, place: str, follower: Follower, notice: Callable[[], str] = lambda: "") -> None:
        self._copies.append(ReportedCopy(place, follower, notice))

    def _standby_host(self) -> str:
        standby = read_standby(self._log_dir)
        return "" if standby is None else standby.host

    def _confirm(self, question: CopyQuestion) -> None:
        """Answer the core that the standby has everything. Another core may also ask, but its journal is not copied."""
        if self._handover.complete(question):
            return
        if question.journal == self._copies[-1].follower.progress.journal:
            self._confirmed.publish(question)


def main() -> None:
    """Entry point of the node."""
    close_to_others()
    run_node("roah_rsbb_backup", __doc__, BackupNode, (BadParams, OSError))
