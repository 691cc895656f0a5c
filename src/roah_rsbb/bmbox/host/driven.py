"""A benchmark that a host drives: its rules and their parameters, which may change between runs."""

import os
from types import SimpleNamespace
from typing import Callable, Dict, List, Optional, Type

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.own_rules import load_rules
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.zone_folders import file_in, zone_folders
from roah_rsbb.bmbox.host.watched_file import WatchedFile
from roah_rsbb.model.modules import RunForModule
from roah_rsbb.rulebook.errors import ConfigErrors


class Driven:
    """The rules of the package, or those of the competition in `own_file`, and the files with their parameters.

    A zone may have parameters of its own. The zone "" stands for all other zones.
    """

    def __init__(self, code: str, folder: str, kind: Optional[Type[Module]], own_file: Optional[str],
                 load: Callable[[str], Type[Module]] = load_rules) -> None:
        """`load` loads the rules of a file, or raises ConfigErrors."""
        self.code = code
        self.own_file = own_file
        self._folder = folder
        self._kind = kind
        self._rules = None if own_file is None else WatchedFile(own_file, lambda: load(own_file))
        self._parameters: Dict[str, WatchedFile] = {}  # by path
        self._in_zone("")

    def kind(self) -> Type[Module]:
        """Return the rules; raises ConfigErrors."""
        return self._kind if self._rules is None else self._rules.content()

    def make(self, run: RunForModule, parameters: SimpleNamespace, truth: GroundTruth) -> Module:
        """Make the module of an attempt; raises ConfigErrors."""
        return self.kind()(run, parameters, truth)

    def parameters(self, zone: str = "") -> SimpleNamespace:
        """Return the parameters in a zone; raises ConfigErrors."""
        self.reload()
        return self._in_zone(zone).content()

    def has_parameters(self) -> bool:
        """Whether there is a file with parameters, for all zones or for one."""
        zones = ["", *zone_folders(self._folder)]
        return any(os.path.lexists(file_in(self._folder, zone, f"{self.code}.yaml")) for zone in zones)

    def reload(self) -> None:
        """Read the changed files again. If the rules changed, read their parameters again, too."""
        is_changed = self._rules is not None and self._rules.reload()
        for path, file in list(self._parameters.items()):
            if is_changed:
                file.forget()
            if not os.path.lexists(path) and len(self._parameters) > 1:
                del self._parameters[path]  # read again when a zone asks for it
            else:
                file.reload()

    def problems(self, zone: str = "") -> List[str]:
        """Return all errors in the rules or, if they have none, in the parameters of a zone, one per line."""
        rules = [] if self._rules is None else self._rules.problems
        return rules or self._in_zone(zone).problems

    def _in_zone(self, zone: str) -> WatchedFile:
        path = file_in(self._folder, zone, f"{self.code}.yaml")
        if path not in self._parameters:
            self._parameters[path] = WatchedFile(
                path, lambda: read_parameters(path, self.code, self.kind().PARAMETERS))
        return self._parameters[path]

    @property
    def subjects(self) -> List[str]:
        """Whose poses the rules need."""
        try:
            return list(self.kind().SUBJECTS)
        except ConfigErrors:
            return []
