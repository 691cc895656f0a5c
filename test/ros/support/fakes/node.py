"""A node that tests play: its topics and services stay registered from one test case to the next.

To register the core's topics and services takes longer than most cases do.
"""

import threading
from typing import Any, Callable, Dict, List, Optional

import rospy

Answers = Dict[str, Callable[[Any], Any]]  # by the service's name


class FakeNode:
    """Latched topics, and services that one player at a time answers."""

    def __init__(self, topics: Dict[str, type], services: Dict[str, type]) -> None:
        self._topics = topics
        self._services = services
        self._lock = threading.Lock()
        self._player: Optional[object] = None
        self._answers: Answers = {}
        self._publishers: Dict[str, rospy.Publisher] = {}
        self._registered: List[rospy.Service] = []

    def begin(self, player: object, answers: Answers) -> None:
        """From now on this player publishes, and answers the services."""
        with self._lock:
            assert self._player is None, f"{self._player} still plays the node: close it first"
            self._player, self._answers = player, answers
            if not self._publishers:
                self._register()

    def publish(self, player: object, topic: str, message: Any) -> None:
        """Publish for a player; a player that has ended publishes nothing."""
        with self._lock:
            if self._player is player:
                self._publishers[topic].publish(message)

    def end(self, player: object) -> None:
        """End this player, and forget its last message."""
        with self._lock:
            if self._player is player:
                self._player, self._answers = None, {}
                for publisher in self._publishers.values():
                    publisher.impl.latch = None

    def leave(self) -> None:
        """The node is gone, as if its process had ended; the next player registers it again."""
        for service in self._registered:
            service.shutdown()
        for publisher in self._publishers.values():
            publisher.unregister()
        self._registered, self._publishers = [], {}

    def _register(self) -> None:
        self._publishers = {
            name: rospy.Publisher(name, kind, queue_size=10, latch=True) for name, kind in self._topics.items()
        }
        self._registered = [
            rospy.Service(name, kind, lambda request, name=name: self._answer(name, request))
            for name, kind in self._services.items()
        ]

    def _answer(self, service: str, request: Any) -> Any:
        answer = self._answers.get(service)
        if answer is None:
            raise rospy.ServiceException("nobody plays this node now")
        return answer(request)
