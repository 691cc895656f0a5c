"""How much somebody may use: so much at once, and so much a second."""


class Budget:
    """What is left of a budget that refills with time."""

    def __init__(self, at_once: float, per_second: float) -> None:
        self._at_once = at_once
        self._per_second = per_second
        self._left = at_once
        self._mono = float("-inf")  # of the last look

    def take(self, now_mono: float, amount: float) -> bool:
        """Whether there is enough left; then it is used up."""
        passed = now_mono - self._mono
        self._left = min(self._at_once, self._left + passed * self._per_second)
        self._mono = now_mono
        if amount > self._left:
            return False
        self._left -= amount
        return True
