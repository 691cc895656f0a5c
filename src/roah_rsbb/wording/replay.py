"""How a replay of an earlier run is marked wherever it is shown, so that nobody takes it for a live box."""

from roah_rsbb.wording.language import tr_later

MARK = tr_later("REPLAY")
NOT_LIVE = tr_later("REPLAY: not live")
NO_COMMANDS = tr_later("This is a replay: commands have no effect")
