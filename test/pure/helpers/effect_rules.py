"""Rules that the effects of a box obey in every test: the order of them, and what run logs may contain.

What must be on record comes before what leaves the box because of it (docs/architecture.md, "Write first, then act").
"""

from roah_rsbb.model import run_log
from roah_rsbb.model.run_log import KINDS, LogKind


def _fits(kind, value):
    if kind is LogKind.UINT8:
        return type(value) is int and 0 <= value <= 255
    if kind is LogKind.STRING:
        return isinstance(value, str)
    if kind is LogKind.SCORE:
        return [type(part) for part in value] == [str, str, int] and -2**31 <= value[2] < 2**31
    return value is None


class EffectRules:
    """Sees all effects of one box, in their order, and raises AssertionError at the first that breaks a rule."""

    def __init__(self):
        self._taken = set()  # ports on record
        self._opened = set()  # ports of channels
        self._bags = set()  # ports of run logs that are open
        self._resumed = set()  # ports of runs that continue after a restart
        self._ends = set()  # (zone, end reason) on record
        self._last = {}  # (port, topic) -> last value logged

    def see(self, effect):
        name = "_" + type(effect).__name__
        if hasattr(self, name):
            getattr(self, name)(effect)

    def _PortTaken(self, effect):
        assert effect.port not in self._taken, f"port {effect.port} is used twice"
        self._taken.add(effect.port)

    def _OpenChannel(self, effect):
        assert effect.port in self._taken, "a channel is opened before its port is on record"
        self._opened.add(effect.port)

    def _AimChannel(self, effect):
        assert effect.port in self._opened

    def _CloseChannel(self, effect):
        self._opened.remove(effect.port)

    def _RunOpened(self, effect):
        assert effect.port in self._taken
        self._bags.add(effect.port)

    def restart(self):
        """Note that the core was restarted: records stay."""
        self._taken, self._opened, self._bags = set(), set(), set()

    def _RunResumed(self, effect):
        assert effect.port in self._opened, "a run continues without its channel"
        self._bags.add(effect.port)
        self._resumed.add(effect.port)

    def _RunLogged(self, effect):
        assert effect.port in self._bags, "an entry for a run log that is not open"
        assert effect.topic in KINDS, effect.topic
        assert _fits(KINDS[effect.topic], effect.value), effect
        self._last[effect.port, effect.topic] = effect.value

    def _RunClosed(self, effect):
        assert self._last[effect.port, run_log.END] is None
        self._bags.remove(effect.port)

    def _SendState(self, effect):
        if effect.port in self._resumed and (effect.port, run_log.STATE) not in self._last:
            return  # it was on record before the restart
        state = effect.message.state
        topics = (run_log.STATE, run_log.BOX_STATE, run_log.STATE_NAME)
        logged = [self._last.get((effect.port, topic)) for topic in topics]
        assert logged == [state, state, state.name], "a state leaves before it is on record"

    def _SetDevice(self, effect):
        topic = run_log.device_topic(effect.device)
        assert effect.value in [value for (_, known), value in self._last.items() if known == topic]

    def _RecordChanged(self, effect):
        self._ends.add((effect.record.zone, effect.record.end_reason))

    def _TimeoutRung(self, effect):
        assert (effect.zone, "timeout") in self._ends, "the timeout rings before it is on record"
