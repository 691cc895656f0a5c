"""A benchmark that a node drives: its rules and their parameters, which may change between runs. No ROS."""

import os
from types import SimpleNamespace
from typing import List, Optional, Type

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.own_rules import load_rules
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.core.modules.messages import RunForModule
from roah_rsbb.nodes.modules.watched_file import WatchedFile
from roah_rsbb.rulebook.errors import ConfigErrors


class Driven:
    """The rules of the package, or those of the competition in `own_file`, and the file with their parameters."""

    def __init__(self, code: str, folder: str, kind: Optional[Type[Module]], own_file: Optional[str]) -> None:
        self.code = code
        self._kind = kind
        self._rules = None if own_file is None else WatchedFile(own_file, lambda: load_rules(own_file))
        path = os.path.join(folder, f"{code}.yaml")
        self._parameters = WatchedFile(path, lambda: read_parameters(path, code, self.kind().PARAMETERS))

    def kind(self) -> Type[Module]:
        """Return the rules; raises ConfigErrors."""
        return self._kind if self._rules is None else self._rules.content()

    def make(self, run: RunForModule, parameters: SimpleNamespace, truth: GroundTruth) -> Module:
        """Make the module of an attempt; raises ConfigErrors."""
        return self.kind()(run, parameters, truth)

    def parameters(self) -> SimpleNamespace:
        """Return the parameters; raises ConfigErrors."""
        self.reload()
        return self._parameters.content()

    def reload(self) -> None:
        """Read again what has changed. Other rules may have other parameters."""
        if self._rules is not None and self._rules.reload():
            self._parameters.forget()
        self._parameters.reload()

    @property
    def problems(self) -> List[str]:
        """All errors in the rules or, if they have none, in the parameters, one per line."""
        rules = [] if self._rules is None else self._rules.problems
        return rules or self._parameters.problems

    @property
    def subjects(self) -> List[str]:
        """Whose poses the rules need."""
        try:
            return list(self.kind().SUBJECTS)
        except ConfigErrors:
            return []
