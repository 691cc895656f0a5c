"""Parameters of the core node that are rules of the game (docs/ros_interface.md, "Parameters")."""

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
