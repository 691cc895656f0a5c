"""Node roah_rsbb_sounds: plays sounds for the bell and for timeouts of runs.

/devices/bell and /timeout each run a command. A failing player causes one warning.

Parameters (private): bell_ring_command, timeout_ring_command; empty: the included sounds, with aplay.
"""

import os
import shlex
import sys

import rospkg
import rospy
from std_msgs.msg import Empty

from roah_rsbb.devices.sounds import Sound
from roah_rsbb.params import BadParams, Params
from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.params import NodeParams

# In package alsa-utils of Debian and Ubuntu.
PLAYER = "aplay"
# Parameter of the command: topic, included sound file.
RINGS = {
    "bell_ring_command": ("/devices/bell", "bell.wav"),
    "timeout_ring_command": ("/timeout", "timeout.wav"),
}


def _default_command(file: str) -> str:
    path = os.path.join(rospkg.RosPack().get_path("roah_rsbb"), "resource", "sounds", file)
    return f"{PLAYER} -q {shlex.quote(path)}"


def _sound(params: Params, name: str) -> Sound:
    topic, file = RINGS[name]
    default = _default_command(file)
    # In launch files, an empty text means the default.
    command = params.text(name, default) if rospy.get_param("~" + name, default) != "" else default
    try:
        return Sound(topic, command, lambda text: rospy.logwarn("%s", text))
    except ValueError as error:
        where = rospy.resolve_name("~" + name)
        raise BadParams(f"parameter {where}: found {command!r}, expected a command ({error})") from None


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
            rospy.logfatal("%s", line)
        sys.exit(1)
    for name, sound in sounds.items():
        rospy.Subscriber(RINGS[name][0], Empty, lambda _message, ring=sound.ring: ring(), queue_size=10)
    rospy.spin()
    for sound in sounds.values():
        sound.close()
