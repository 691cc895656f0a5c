"""The results with their targets, as a table and as a file."""

import json
import math
import pathlib
from typing import Dict, List, NamedTuple, Optional, Sequence


class Number(NamedTuple):
    """A measured number. `target` is the highest value allowed, or None."""

    name: str
    unit: str
    value: float
    target: Optional[float] = None

    @property
    def ok(self) -> bool:
        """Whether the number meets its target."""
        return self.target is None or self.value <= self.target

    def entry(self) -> Dict[str, object]:
        """The entry for build/bench.json. A number that could not be measured is null."""
        value = self.value if math.isfinite(self.value) else None
        return {"name": self.name, "unit": self.unit, "value": value, "target": self.target, "ok": self.ok}

    def line(self) -> str:
        """A line of the table."""
        target = "" if self.target is None else f"≤ {self.target:g}"
        return f"{self.name:<66} {self.value:>10.4g} {self.unit:<14} {target:<8} {'' if self.ok else 'MISSED'}".rstrip()


class Results:
    """All numbers. Each is printed as soon as it is added."""

    def __init__(self) -> None:
        self.numbers: List[Number] = []

    def add(self, name: str, unit: str, value: float, target: Optional[float] = None) -> None:
        """Add a number. A number that is not finite could not be measured and misses its target."""
        self.numbers.append(Number(name, unit, value, target))
        print(self.numbers[-1].line(), flush=True)

    def add_spread(self, name: str, unit: str, values: Sequence[float], targets: Dict[float, float]) -> None:
        """Add the median and the 95 % and 99 % quantiles of many values. `targets` are by share, such as 0.99."""
        for label, share in (("median", 0.5), ("95 %", 0.95), ("99 %", 0.99)):
            self.add(f"{name}, {label}", unit, quantile(values, share), targets.get(share))

    def write(self, path: pathlib.Path) -> None:
        """Write build/bench.json."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps([number.entry() for number in self.numbers], indent=1) + "\n", encoding="utf-8")

    @property
    def missed(self) -> List[Number]:
        """The numbers that miss their targets."""
        return [number for number in self.numbers if not number.ok]


def quantile(values: Sequence[float], share: float) -> float:
    """The value that this share of all values does not exceed, or NaN without values."""
    if not values:
        return math.nan
    return sorted(values)[min(len(values), max(1, math.ceil(share * len(values)))) - 1]
