"""Limits how much a sender may use: an amount at once, and an amount per second."""


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
