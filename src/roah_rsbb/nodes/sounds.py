"""Node roah_rsbb_sounds: plays sounds for the bell and for timeouts of runs.

/devices/bell and /timeout each run a command. A failing player causes one warning.

Parameters (private): bell_ring_command, timeout_ring_command; empty: the included sounds.
"""

import logging
import sys

import rospy
from std_msgs.msg import Empty

from roah_rsbb.devices.sounds import BELL, TIMEOUT, Sound, command_of
from roah_rsbb.params import BadParams, Params
from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.params import NodeParams

# Parameter of the command: topic, included sound file.
RINGS = {
    "bell_ring_command": ("/devices/bell", BELL),
    "timeout_ring_command": ("/timeout", TIMEOUT),
}

_log = logging.getLogger(__name__)


def _sound(params: Params, name: str) -> Sound:
    topic, file = RINGS[name]
    return Sound(topic, command_of(params, name, file), lambda text: _log.warning("%s", text))


def main() -> None:
    """Entry point of the node."""
    explain(__doc__)
    connections.init_node("roah_rsbb_sounds")
    params = NodeParams()
    try:
        sounds = {name: _sound(params, name) for name in RINGS}
        params.done()
    except BadParams as error:
        for line in str(error).splitlines():
            _log.critical("%s", line)
        sys.exit(1)
    for name, sound in sounds.items():
        rospy.Subscriber(RINGS[name][0], Empty, lambda _message, ring=sound.ring: ring(), queue_size=10)
    rospy.spin()
    for sound in sounds.values():
        sound.close()
