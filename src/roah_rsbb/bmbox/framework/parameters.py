"""Parameters of a benchmarking module, declared in the module and read from one YAML file per benchmark.

Errors are reported as for all configuration files: all at once, with file, line, what was found and what was expected
(`roah_rsbb.rulebook.errors`).
"""

import math
import os
from types import SimpleNamespace
from typing import Any, Dict, List, Optional

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3
from roah_rsbb.model.fields import FARTHEST_M
from roah_rsbb.rulebook import yaml_fields
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.yaml_lines import Node, read_yaml

MAX_SECONDS = 86400.0


class Parameter:
    """One parameter. `example` appears in error messages. With a `default`, the file may omit the parameter."""

    def __init__(self, example: str, default: Any = None) -> None:
        self.example = example
        self.default = default

    @property
    def is_optional(self) -> bool:
        """Whether the file may omit it. Its value is then the default."""
        return self.default is not None

    def read(self, report: Report, node: Optional[Node], what: str) -> Any:
        """Return the value; None, with an error in the report, if it is invalid."""
        raise NotImplementedError


class Amount(Parameter):
    """A number with a unit, greater than `above` or at least `least`, and at most `most`."""

    def __init__(self, unit: str, example: str, above: Optional[float] = None, least: Optional[float] = None,
                 most: Optional[float] = None, default: Optional[float] = None) -> None:
        super().__init__(example, default)
        self._range = {"unit": unit, "above": above, "least": least, "most": most}

    def read(self, report: Report, node: Optional[Node], what: str) -> Optional[float]:
        return yaml_fields.number(report, node, what, **self._range)


class Seconds(Amount):
    """A duration greater than 0."""

    def __init__(self, example: str = "120", default: Optional[float] = None) -> None:
        super().__init__("seconds", example, above=0.0, most=MAX_SECONDS, default=default)


class GoalTimeout(Seconds):
    """Seconds for each goal. Without it, a goal ends by the `timeout` of the benchmarks file."""

    is_optional = True


class Whole(Parameter):
    """A whole number from `least` to `most`."""

    def __init__(self, example: str, least: int, most: int, default: Optional[int] = None) -> None:
        super().__init__(example, default)
        self._least, self._most = least, most

    def read(self, report: Report, node: Optional[Node], what: str) -> Optional[int]:
        return yaml_fields.integer(report, node, what, self._least, self._most)


class Text(Parameter):
    """A text in one line."""

    def read(self, report: Report, node: Optional[Node], what: str) -> Optional[str]:
        return yaml_fields.text(report, node, what)


class YesNo(Parameter):
    """true or false."""

    def read(self, report: Report, node: Optional[Node], what: str) -> Optional[bool]:
        word = yaml_fields.choice(report, node, what, ("true", "false"), "true or false")
        return None if word is None else word == "true"


class ListOf(Parameter):
    """A list of at least one `item`."""

    def __init__(self, item: Parameter, at_most: int = 1000) -> None:
        super().__init__(f"[{item.example}]")
        self._item, self._at_most = item, at_most

    def read(self, report: Report, node: Optional[Node], what: str) -> Optional[List[Any]]:
        nodes = yaml_fields.sequence(report, node, what, f"at least one, such as {self._item.example}")
        if nodes is None:
            return None
        if len(nodes) > self._at_most:
            extra = nodes[self._at_most]
            return report.error(extra.place, f"{len(nodes)} of them as {what}", f"at most {self._at_most}")
        found = [self._item.read(report, each, f"item {i} of {what}") for i, each in enumerate(nodes, 1)]
        return None if None in found else found


class _Coordinates(Parameter):
    """A list of coordinates in metres; the last one is an angle in radians."""

    def __init__(self, example: str, kind: type, default: Any = None) -> None:
        super().__init__(example, default)
        self._kind = kind

    def read(self, report: Report, node: Optional[Node], what: str) -> Any:
        names = self._kind._fields
        nodes = yaml_fields.sequence(report, node, what, f"{len(names)} numbers, such as {self.example}")
        if nodes is None:
            return None
        if len(nodes) != len(names):
            expected = f"{', '.join(names)}, such as {self.example}"
            return report.error(node.place, f"{len(nodes)} numbers as {what}", expected)
        found = [_coordinate(report, each, f"{name} of {what}", name) for name, each in zip(names, nodes)]
        return None if None in found else self._kind(*found)


def _coordinate(report: Report, node: Node, what: str, name: str) -> Optional[float]:
    if name == "theta":
        return yaml_fields.number(report, node, what, "radians", least=-2 * math.pi, most=2 * math.pi)
    return yaml_fields.number(report, node, what, "metres", least=-FARTHEST_M, most=FARTHEST_M)


class PlanePose(_Coordinates):
    """A pose in the plane, [x, y, theta]: metres and radians."""

    def __init__(self, example: str = "[1.5, 2.0, 1.57]", default: Optional[Pose2D] = None) -> None:
        super().__init__(example, Pose2D, default)


class Transform(_Coordinates):
    """A pose with a height, [x, y, z, theta]: metres and radians."""

    def __init__(self, example: str = "[0.1, 0.0, 0.05, 0.0]", default: Optional[Pose3] = None) -> None:
        super().__init__(example, Pose3, default)


class Record(Parameter):
    """A map with these fields. They become attributes of its value."""

    def __init__(self, fields: Dict[str, Parameter]) -> None:
        super().__init__("{" + ", ".join(f"{name}: {field.example}" for name, field in fields.items()) + "}")
        self._fields = fields

    def read(self, report: Report, node: Optional[Node], what: str) -> Optional[SimpleNamespace]:
        required = {name: field.example for name, field in self._fields.items() if not field.is_optional}
        optional = {name: field.example for name, field in self._fields.items() if field.is_optional}
        got = yaml_fields.fields(report, node, what, required, optional)
        if got is None:
            return None
        omitted = {name: self._fields[name].default for name in optional if name not in got}
        found = {name: field.read(report, got.get(name), name) for name, field in self._fields.items()
                 if name not in omitted}
        return None if None in found.values() else SimpleNamespace(**found, **omitted)


def read_parameters(path: str, code: str, fields: Dict[str, Parameter]) -> SimpleNamespace:
    """Read the parameters of a benchmark's module as attributes; raises ConfigErrors with all errors.

    If all parameters are optional, the file may be missing.
    """
    if all(field.is_optional for field in fields.values()) and not os.path.lexists(path):
        return SimpleNamespace(**{name: field.default for name, field in fields.items()})
    report = Report()
    record = Record(fields)
    what = f"the parameters of {code}"
    root = read_yaml(path, report, what, f"a map of {what}, such as {record.example}")
    found = record.read(report, root, what)
    report.raise_errors()
    return found if found is not None else SimpleNamespace()
