"""How panels mark a box from which another one took over (docs/standby.md, "The old box")."""

from roah_rsbb.wording.language import tr_later

NOT_LIVE = tr_later("superseded: not live")
NO_COMMANDS = tr_later("Another box has taken over: commands have no effect here")
