"""The message types of each generation of the original package roah_rsbb_comm_ros.

The constants of Benchmark and some fields changed over the years, and their MD5 sums with them. ROS connects a
publisher only to subscribers with the same sum, so the comm node publishes the types that the team's code was built
with. The types of 2020 are those of roah_rsbb. For another generation, the types that differ are generated when the
node starts.
"""

import functools
import pathlib
from typing import Any, Callable, Dict, List, NamedTuple, Set, Tuple, Type

import genpy
import genpy.dynamic
import rospkg
from rospy.impl import tcpros_base

from roah_rsbb import msg

GENERATIONS = ("2015", "2018", "2019", "2020")
DEFAULT = "2020"
PACKAGE = "roah_rsbb_comm_ros"
# Refused subscribers are remembered, so that each is reported once.
MAX_KNOWN = 100


class Types(NamedTuple):
    """The types that differ between generations."""

    Benchmark: Type[genpy.Message] = msg.Benchmark
    DevicesState: Type[genpy.Message] = msg.DevicesState
    GoalHGMF: Type[genpy.Message] = msg.GoalHGMF

    def devices_state(self, **fields: object) -> genpy.Message:
        """Return a DevicesState with those fields that this generation has."""
        return self.DevicesState(**{name: value for name, value in fields.items() if name in
                                    self.DevicesState.__slots__})


def types_of(generation: str) -> Types:
    """Return the types of a generation. Raises OSError if the package roah_rsbb_comm_ros is missing."""
    if generation == DEFAULT:
        return Types()
    folder = _definitions() / generation
    made = {path.stem: _made(path.stem, path.read_text()) for path in folder.glob("*.msg")}
    return Types(**made)


def _definitions() -> pathlib.Path:
    try:
        return pathlib.Path(rospkg.RosPack().get_path(PACKAGE)) / "generations"
    except rospkg.ResourceNotFound:
        raise OSError(f"package {PACKAGE} is missing: build this package again, and source build/devel/setup.bash") \
            from None


def _made(name: str, text: str) -> Type[genpy.Message]:
    """Generate a message class of roah_rsbb_comm_ros from its definition."""
    if "geometry_msgs/Pose2D" in text:
        text += f"\n{'=' * 80}\nMSG: geometry_msgs/Pose2D\nfloat64 x\nfloat64 y\nfloat64 theta\n"
    return genpy.dynamic.generate_dynamic(f"{PACKAGE}/{name}", text)[f"{PACKAGE}/{name}"]


def report_refused(generation: str, warn: Callable[[str], None]) -> None:
    """Warn of each program that subscribes with the types of another generation. Call it after rospy.init_node.

    rospy refuses such a program, and its own warning shows only MD5 sums.
    """
    server = tcpros_base._tcpros_server
    accept = server.topic_connection_handler
    seen: Set[Tuple[str, str, str]] = set()

    def handle(sock: Any, address: Any, header: Dict[str, str]) -> Any:
        error = accept(sock, address, header)
        topic, node, md5 = (header.get(name, "") for name in ("topic", "callerid", "md5sum"))
        who = (topic, node, md5)
        if error and topic.startswith("/roah_rsbb/") and who not in seen and len(seen) < MAX_KNOWN:
            seen.add(who)
            warn(_refusal(generation, topic, node, _generations_with(md5)))
        return error

    server.topic_connection_handler = handle


def _generations_with(md5: str) -> List[str]:
    """Return the generations that have a type with this MD5 sum. Only a refused program needs them: they cost time."""
    try:
        return [generation for generation in GENERATIONS if md5 in _md5_sums(generation)]
    except OSError:
        return []


@functools.lru_cache(maxsize=None)
def _md5_sums(generation: str) -> Set[str]:
    """Return the MD5 sums of a generation's types, of those that differ between generations."""
    return {kind._md5sum for kind in types_of(generation)}


def _refusal(generation: str, topic: str, node: str, generations: List[str]) -> str:
    text = f"{node} receives nothing from {topic}: it was built with other types than those of {generation}, which " \
           "this node publishes."
    if not generations:
        return f"{text} They do not belong to a known generation of {PACKAGE}"
    return f"{text} Set this node's parameter generation to {' or '.join(generations)}"
