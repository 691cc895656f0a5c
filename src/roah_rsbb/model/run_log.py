"""Topics of a run's log and the kind of value each takes (docs/ros_interface.md, "Run log")."""

import enum
from typing import Dict


class LogKind(enum.Enum):
    """The kind of an entry's value. The node maps each to a ROS type."""

    UINT8 = "uint8"
    STRING = "string"
    SCORE = "score"  # (group, desc, value)
    EMPTY = "empty"  # None


STATE = "/rsbb_log/rsbb_state"
STATE_NAME = "/rsbb_log/rsbb_state_str"
STATE_DESC = "/rsbb_log/rsbb_state_desc"
SCORE = "/rsbb_log/score"
SCORE_TEXT = "/rsbb_log/score_text"
DISPLAY_MAP = "/rsbb_log/tablet/display_map"
CLIENT_STATE = "/rsbb_log/client_state"
CLIENT_PAYLOAD = "/rsbb_log/client_state_payload"
BOX_STATE = "/rsbb_log/refbox_state"
BOX_PAYLOAD = "/rsbb_log/refbox_state_payload"
END = "/rsbb_log/end"
NOTIFICATION = "/notification"
ACTIVATION_EVENT = "/activation_event"
VISITOR = "/visitor"
COMMAND = "/command"
GOAL = "/rsbb_log/bmbox/goal"
MODULE_SCORE = "/rsbb_log/bmbox/score"
MANUAL_OPERATION = "/rsbb_log/manual_operation"
HOPF_RESULT = "/rsbb_log/opf_result"
RESULT = "/rsbb_log/result"
SWITCHES = "/rsbb_log/omf_switches"
# The original's topics for the same: each single entry, and all of them after the confirmation.
OMF_BUTTON = "/rsbb_log/omf_button"
OMF_DAMAGED = "/rsbb_log/omf_damaged"
OMF_COMPLETE = "/rsbb_log/omf_complete"
DEVICES = ("switch_1", "switch_2", "switch_3", "blinds", "dimmer")


def device_topic(device: str) -> str:
    """The topic of a device's commands; `device` is switch_1 … 3, blinds or dimmer."""
    return f"/rsbb_log/devices/{device}"


# Messages of a robot, and their direct consequences.
FROM_ROBOT = frozenset((
    CLIENT_STATE, CLIENT_PAYLOAD, NOTIFICATION, ACTIVATION_EVENT, VISITOR, COMMAND, HOPF_RESULT, RESULT, DISPLAY_MAP,
    *(device_topic(device) for device in DEVICES),
))

KINDS: Dict[str, LogKind] = {
    STATE: LogKind.UINT8,
    STATE_NAME: LogKind.STRING,
    STATE_DESC: LogKind.STRING,
    SCORE: LogKind.SCORE,
    SCORE_TEXT: LogKind.STRING,
    DISPLAY_MAP: LogKind.UINT8,
    CLIENT_STATE: LogKind.UINT8,
    CLIENT_PAYLOAD: LogKind.STRING,
    BOX_STATE: LogKind.UINT8,
    BOX_PAYLOAD: LogKind.STRING,
    END: LogKind.EMPTY,
    NOTIFICATION: LogKind.STRING,
    ACTIVATION_EVENT: LogKind.STRING,
    VISITOR: LogKind.STRING,
    COMMAND: LogKind.STRING,
    **dict.fromkeys((GOAL, MODULE_SCORE, MANUAL_OPERATION, HOPF_RESULT, RESULT, SWITCHES), LogKind.STRING),
    OMF_COMPLETE: LogKind.STRING,
    **dict.fromkeys((OMF_BUTTON, OMF_DAMAGED), LogKind.UINT8),
    **{device_topic(device): LogKind.UINT8 for device in DEVICES},
}
