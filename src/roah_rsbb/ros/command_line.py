"""The command line of programs whose settings are ROS parameters: `--help` is the only option."""

import os
import sys
from typing import Any, Callable, Tuple, Type

import rospy

from roah_rsbb.ground.arguments import Parser
from roah_rsbb.ground.params import BadParams
from roah_rsbb.ros import connections

_SETTINGS = """\
Settings are ROS parameters, of the node or given as _name:=value. The launch files set those that competitions need;
'roslaunch --ros-args roah_rsbb FILE.launch' explains them.
"""


def explain(doc: str, settings: str = _SETTINGS) -> None:
    """Print the help of a program and end it if --help was given; end it with status 2 for any other argument.

    `doc` is the docstring of the program's module. ROS handles name:=value before, so those are not arguments here.
    """
    parser = Parser(os.path.basename(sys.argv[0]), doc.strip(), settings)
    parser.parse_args(rospy.myargv()[1:])


def run_node(
    name: str, doc: str, make: Callable[[], Any], errors: Tuple[Type[Exception], ...] = (BadParams,),
    before: Callable[[], None] = lambda: None, **options: Any
) -> None:
    """Run a node: create it, call its `run`, and end with the exit status that `run` returns.

    `before` is called before the node is registered with the ROS master.
    An exception of `errors` at the start becomes a fatal log line. `options` are those of `rospy.init_node`.
    """
    explain(doc)
    before()
    connections.init_node(name, **options)
    try:
        status = make().run()
    except errors as error:
        for line in str(error).splitlines():
            rospy.logfatal("%s", line)
        status = 1
    sys.exit(status)
