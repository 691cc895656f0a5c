"""Checks that the motion-capture system sees all markers: `rosrun roah_rsbb check_ground_truth`.

Prints a line for each marker of the ground truth's configuration, with the remedy for invisible ones.
"""

import argparse
import sys
from typing import List, Optional, Tuple

import rosgraph
import rospy

from roah_rsbb.bmbox.framework.ground_truth import Source
from roah_rsbb.bmbox.host.ground_truth_of_frames import FramesGroundTruth, FrameState, GroundTruthConfig, load
from roah_rsbb.ground.arguments import Parser, number
from roah_rsbb.ros import connections
from roah_rsbb.ros.modules.dummy_ground_truth import default_file
from roah_rsbb.ros.modules.tf_frames import TfFrames
from roah_rsbb.rulebook.errors import ConfigErrors

PROGRAM = "check_ground_truth"
_DESCRIPTION = "Check for each marker of the ground truth's configuration whether it is visible, and print its pose."
_EPILOG = "The exit status is 0 if all markers are visible, else 1."
_POLL_S = 0.1


def _arguments(given: List[str]) -> argparse.Namespace:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    parser.add_argument("file", nargs="?", help="the configuration (default: the package's ground_truth.yaml)")
    parser.add_argument("--wait", type=number(0.0, 3600.0), default=3.0, metavar="S",
                        help="seconds to wait for invisible markers (default: %(default)s)")
    return parser.parse_args(rospy.myargv(given))


def line(state: FrameState) -> str:
    """Format the line of a marker."""
    owner = f" of {state.team}" if state.team else ""
    if state.pose is None:
        return f"MISSING  {state.subject}{owner}: {state.trouble.split(': ', 1)[1]}"
    x, y, z, theta = state.pose
    return f"seen     {state.subject}{owner}: {state.frame} at x {x:.3f} y {y:.3f} z {z:.3f} m, theta {theta:.3f} rad"


def look(config: GroundTruthConfig, wait_s: float) -> Optional[Tuple[FrameState, ...]]:
    """Return the state of all markers, once they are visible or `wait_s` is over; None: there is no ROS master."""
    if not rosgraph.is_master_online():
        return None
    if not rospy.core.is_initialized():
        connections.init_node(PROGRAM, anonymous=True, disable_signals=True)
    ground_truth = FramesGroundTruth(config, TfFrames())
    until = rospy.get_time() + wait_s
    states = ground_truth.states()
    while rospy.get_time() < until and any(state.pose is None for state in states):
        rospy.rostime.wallsleep(_POLL_S)
        states = ground_truth.states()
    return states


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    options = _arguments(sys.argv[1:] if arguments is None else arguments)
    try:
        config = load(options.file or default_file())
    except ConfigErrors as errors:
        sys.exit(f"{PROGRAM}: the configuration is invalid\n{errors}")
    if config.source is not Source.MOTION_CAPTURE:
        print(f"Nothing to check: the configuration has the source '{config.source.value}', not motion capture.")
        sys.exit(0)
    states = look(config, options.wait)
    if states is None:
        sys.exit(f"{PROGRAM}: no ROS master: start roscore or the launch file, or set ROS_MASTER_URI")
    print(f"In reference frame {config.reference_frame}; poses older than {config.maximum_age_s:g} s count as missing.")
    for state in states:
        print(line(state))
    sys.exit(0 if all(state.pose is not None for state in states) else 1)
