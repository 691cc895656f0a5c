"""Reading run logs."""

import itertools
import pathlib
from typing import Any, Dict, List, Optional, Tuple

import rosbag


class RunLog:
    """The contents of a run's bag: `entries` are (topic, message), in order."""

    def __init__(self, path: pathlib.Path, entries: List[Tuple[str, Any]]) -> None:
        self.path = path
        self.entries = entries

    @classmethod
    def complete(cls, path: pathlib.Path) -> Optional["RunLog"]:
        """The log at `path`; None while it is still to be made."""
        try:
            with rosbag.Bag(str(path)) as bag:
                return cls(path, [(topic, message) for topic, message, _ in bag.read_messages()])
        except (OSError, rosbag.ROSBagException):
            return None

    @property
    def types(self) -> Dict[str, str]:
        """The type of each topic."""
        return {topic: message._type for topic, message in self.entries}

    def messages(self, topic: str) -> List[Any]:
        """All messages on a topic."""
        return [message for name, message in self.entries if name == topic]

    def values(self, topic: str) -> List[Any]:
        """The `data` of all messages on a topic."""
        return [message.data for message in self.messages(topic)]

    def changes(self, topic: str) -> List[Any]:
        """The same, without consecutive repetitions."""
        return [value for value, _ in itertools.groupby(self.values(topic))]
