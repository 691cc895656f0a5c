"""The shipped configuration files with something changed, loaded from a directory of the test's own."""

import os
import pathlib
from typing import Dict, List, Tuple

from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Config

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "config"
NAMES = ("benchmarks", "schedule", "passwords")
TEXTS: Dict[str, str] = {name: (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8") for name in NAMES}


def changed(name: str, old: str, new: str) -> str:
    """The text of a shipped file with the first `old` replaced; it must be there."""
    assert old in TEXTS[name], old
    return TEXTS[name].replace(old, new, 1)


def line_of(text: str, part: str) -> int:
    """The number, from 1, of the first line that contains `part`."""
    return text[: text.index(part)].count("\n") + 1


class ConfigDir:
    """A directory with the three files; those not given are the shipped ones."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path = path

    def file(self, name: str) -> str:
        return str(self.path / f"{name}.yaml")

    def load(self, **texts: object) -> Tuple[Config, List[str]]:
        """Write the files (str or bytes; None: no such file) and load them."""
        for name in NAMES:
            text = texts.get(name, TEXTS[name])
            if text is None:
                continue
            data = text if isinstance(text, bytes) else text.encode("utf-8")
            descriptor = os.open(self.file(name), os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
            with open(descriptor, "wb") as file:
                file.write(data)
        return config.load(*(self.file(name) for name in NAMES))

    def errors(self, **texts: object) -> List[Tuple[str, int, str]]:
        """All errors as (which file, line, "found ...; expected ..."); there must be some."""
        try:
            self.load(**texts)
        except config.ConfigErrors as errors:
            assert str(errors).splitlines() == [str(error) for error in errors.errors]
            return [
                (pathlib.Path(e.file).stem, e.line, f"found {e.found}; expected {e.expected}")
                for e in errors.errors
            ]
        raise AssertionError("no errors")

    def error(self, **texts: object) -> Tuple[str, int, str]:
        """The only error."""
        found = self.errors(**texts)
        assert len(found) == 1, found
        return found[0]
