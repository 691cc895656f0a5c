"""How a replay of an earlier run is marked wherever it is shown, so that nobody takes it for a live box.

The messages of the core name its process in `box_uuid`. That of a replay begins with `PREFIX`.
"""

from roah_rsbb.model.document import REPLAY as PREFIX
from roah_rsbb.wording.language import tr_later

MARK = tr_later("REPLAY")
NOT_LIVE = tr_later("REPLAY: not live")
NO_COMMANDS = tr_later("This is a replay: commands have no effect")


def is_replay(box_uuid: str) -> bool:
    """Whether the messages with this identity are those of a replay."""
    return box_uuid.startswith(PREFIX)

