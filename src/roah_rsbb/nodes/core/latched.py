"""A latched topic whose messages are only made while somebody subscribes."""

from typing import Any, Callable

import rospy


class LatchedTopic(rospy.SubscribeListener):
    """A topic of the original interface. A new subscriber gets a message at once, as a latched topic promises: a new
    one, and never an old one of a time when nobody subscribed."""

    def __init__(self, name: str, kind: type, on_subscribed: Callable[[], object]) -> None:
        """`on_subscribed` is called in a thread of rospy."""
        super().__init__()
        self._on_subscribed = on_subscribed
        self._publisher = rospy.Publisher(name, kind, self, queue_size=1, latch=True)

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._publisher.name)

    @property
    def is_wanted(self) -> bool:
        """Whether anybody subscribes."""
        return self._publisher.get_num_connections() > 0

    def publish(self, message: Any) -> None:
        """Publish a message. Raises rospy.ROSException."""
        self._publisher.publish(message)

    def peer_subscribe(self, _topic: str, _publish: Any, _publish_to_it: Any) -> None:
        """rospy calls it before it sends what was published last."""
        self._publisher.impl.latch = None
        self._on_subscribed()
