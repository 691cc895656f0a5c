"""What the box allows: parameters that are rules of the game (docs/ros_interface.md, "Parameters"), and how much a
sender may use."""

from typing import NamedTuple


class Settings(NamedTuple):
    """All durations in seconds."""

    rsbb_port: int = 6666
    robot_timeout: float = 30.0  # a robot is no longer active after this long without a beacon
    allowed_skew: float = 0.1  # a run can start if the skew is below it
    after_stop_duration: float = 120.0  # time left after a stop, shown to the referee
    display_log_size: int = 3000  # characters
    check_messages_saved: bool = True
    check_messages_saved_timeout: float = 5.0
    max_datagram: int = 1024  # bytes that every robot of the competition can read
    auto_next: bool = True  # after a run that was completed, the zone moves to its next event
    listen_duration: float = 5.0  # after the start, the box first only listens for another box
    take_over: bool = False  # send although another box was heard


class Budget:
    """A budget that refills with time."""

    def __init__(self, at_once: float, per_second: float) -> None:
        self._at_once = at_once
        self._per_second = per_second
        self._left = at_once
        self._mono = float("-inf")  # of the last call

    def take(self, now_mono: float, amount: float) -> bool:
        """Use up `amount` and return True, or return False if not enough is left."""
        passed = now_mono - self._mono
        self._left = min(self._at_once, self._left + passed * self._per_second)
        self._mono = now_mono
        if amount > self._left:
            return False
        self._left -= amount
        return True
