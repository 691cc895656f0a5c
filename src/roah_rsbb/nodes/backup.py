"""Node roah_rsbb_backup: copies the journal, continuously, to a second folder, such as a USB stick (docs/backup.md),
and to a standby, which is a second computer (docs/standby.md).

It reads the journal in log_dir, which the core writes. The core never waits for it.

Parameters (private): log_dir; backup_dir: an existing folder, on another disk (none: no folder); standby_port: TCP port
for a standby (0: no standby); bind_host: own address for it; passwords_file, rsbb_host, rsbb_port, modules_dir: what
the standby needs to continue.
"""

import rosgraph
import rospy

from roah_rsbb.box.standing_by import wait_for_takeover
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.copies.settings import copy_settings
from roah_rsbb.durable import close_to_others
from roah_rsbb.log_lines import LogLines
from roah_rsbb.params import BadParams
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.standby.program.copying import NAME, PERIOD_S, Copying


class BackupNode:
    """The node. Raises `BadParams` or OSError at the start."""

    def __init__(self) -> None:
        settings = copy_settings(NodeParams())
        if not settings.words:
            raise BadParams(f"{rospy.get_name()}: set backup_dir, standby_port or both")
        wait_for_takeover(settings.log_dir, rospy.is_shutdown)
        self._log_lines = LogLines()  # a handover must not wait for the terminal
        self._copying = Copying(settings, rospy.get_name(), DoorPlaces(rosgraph.get_master_uri()).find)

    def run(self) -> int:
        """Run until shut down."""
        while not rospy.core.is_shutdown():
            self._copying.report()
            try:
                rospy.sleep(PERIOD_S)
            except rospy.ROSInterruptException:
                break
        self._copying.close()
        self._log_lines.close()
        return 0


def main() -> None:
    """Entry point of the node."""
    close_to_others()
    run_node(NAME, __doc__, BackupNode, (BadParams, OSError))
