"""Node roah_rsbb_backup: copies the journal, continuously, to a second folder, such as a USB stick (docs/backup.md).

It reads the journal in log_dir, which the core writes. The core never waits for it. /copies/state (latched, once a
second) says how complete the copy is, and the core warns the referees if it is behind.

Parameters (private): log_dir; backup_dir: an existing folder, on another disk.
"""

import time

import rospy

from roah_rsbb.copies.follower import Follower
from roah_rsbb.msg import CopyState
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.params import Params

PERIOD_S = 1.0
# A stick that hangs must not keep the node from ending.
END_S = 5.0


class BackupNode:
    """The node. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        params = Params()
        log_dir = params.path("log_dir", "~/.ros/roah_rsbb")
        self._follower = Follower(log_dir, params.path("backup_dir"))
        params.done()
        self._began_mono = time.monotonic()
        self._publisher = rospy.Publisher("/copies/state", CopyState, queue_size=10, latch=True)
        self._trouble = self._aside = ""

    def run(self) -> int:
        """Run until shut down."""
        rospy.loginfo("Copying the journal to %s", self._follower.folder)
        self._follower.start()
        while not rospy.core.is_shutdown():
            self._report()
            try:
                rospy.sleep(PERIOD_S)
            except rospy.ROSInterruptException:
                break
        self._follower.end(END_S)
        return 0

    def _report(self) -> None:
        progress = self._follower.progress
        complete = self._began_mono if progress.complete_mono is None else progress.complete_mono
        behind = time.monotonic() - complete
        if progress.trouble != self._trouble:
            if progress.trouble:
                rospy.logwarn("%s: %s", self._follower.folder, progress.trouble)
            self._trouble = progress.trouble
        if progress.aside and progress.aside != self._aside:
            rospy.logwarn("The earlier copy in %s is not of this journal, or is damaged. It is kept as %s",
                          self._follower.folder, progress.aside)
            self._aside = progress.aside
        self._publisher.publish(CopyState(self._follower.folder, progress.box_uuid, behind, progress.missing_entries,
                                          progress.trouble))


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_backup", __doc__, BackupNode)
