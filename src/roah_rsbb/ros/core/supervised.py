"""Program roah_rsbb_core: it starts the node of that name, and starts it again when it hangs or is killed.

The node is a process of its own, and gets the same arguments: name, namespace, remappings, parameters. Everything is
as if it was this one. If this process is killed, the node ends, too, and roslaunch starts both again. With
--unsupervised, the node is this process, and nothing watches it.
"""

import gc
import json
import os
import sys
from typing import Mapping, Optional

from roah_rsbb.ground.arguments import WITH_ROS
from roah_rsbb.ground.params import KnownParams
from roah_rsbb.ground.signs_of_life import LIFELINE, ROS_START
from roah_rsbb.journal.copy_follower import CopySettings, copy_settings


def main() -> None:
    """Run the program, or in its child the node. The program imports no rospy."""
    from roah_rsbb.box.program.main import ALONE, log_to_terminal

    is_alone = ALONE in sys.argv
    os.environ[WITH_ROS] = "1"
    if LIFELINE in os.environ or is_alone:
        gc.disable()  # what is imported is no garbage, and to search it again and again takes a fifth of the start
        from roah_rsbb.ground.linux import end_with_parent
        from roah_rsbb.ros.core.node import main as run_node

        gc.freeze()
        gc.enable()
        if is_alone:
            sys.argv.remove(ALONE)
        else:
            end_with_parent()
        run_node()
        return
    from roah_rsbb.box.program.supervisor import supervise
    from roah_rsbb.ground.durable import close_to_others

    close_to_others()
    log_to_terminal()
    command = [sys.executable, *sys.argv]
    # The first one may wait for a master as long as it likes.
    sys.exit(supervise(command, command, _copies, float("inf")))


def _copies(memory: Mapping[str, str]) -> Optional[CopySettings]:
    """Return what is to be copied, once the node knows its parameters."""
    if ROS_START not in memory:
        return None
    return copy_settings(KnownParams(json.loads(memory[ROS_START])[0]))
