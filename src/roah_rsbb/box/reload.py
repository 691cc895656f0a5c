"""The call `reload`: an organiser changes the configuration while the box runs (docs/organiser.md, "Changes
during the competition")."""

import threading
from typing import Any, Callable, List, Mapping, NamedTuple, Sequence, Tuple

from roah_rsbb.box import calls
from roah_rsbb.box.configuration import Configuration, Content
from roah_rsbb.core.box import Box
from roah_rsbb.document.calls import Caller, InThread
from roah_rsbb.model.reason import Refused
from roah_rsbb.rulebook.errors import ConfigErrors

# Seconds for the reload before, whose files may be on a disk that hangs.
WAIT_S = 5.0
BUSY = "another reload has not ended: its files do not answer. Check the disk or the network on which they are"
CHANGED_AGAIN = "the files were changed after they were listed: read the list again before you apply it"


class Reloaded(NamedTuple):
    """What became of a reload."""

    digest: str = ""  # identifies what was read; empty: there are errors
    applied: bool = False
    errors: Sequence[str] = ()  # of all files, with file and line; or why the change is not possible now
    warnings: Sequence[str] = ()
    changes: Sequence[str] = ()  # empty: nothing differs from what is in force


class Reloads:
    """Reads the files in other threads, and puts them into force in the loop's thread."""

    def __init__(
        self, box: Box, configuration: Configuration, in_loop: Callable[[Callable[[], Any]], Any],
        event: Callable[..., None], use: Callable[[Content, int], None],
    ) -> None:
        """`in_loop` calls a function in the loop's thread and returns its result. `use` prepares everything outside the
        box for a content and its version, in the loop's thread."""
        self._box = box
        self._configuration = configuration
        self._in_loop = in_loop
        self._event = event
        self._use = use
        self._lock = threading.Lock()  # one reload at a time

    def call(self, found: Mapping[str, Any], caller: Caller) -> InThread:
        """The call `reload` of the door."""
        digest, who = calls.text(found, "digest"), calls.who_of(found)
        return InThread(lambda: self.reload(digest, who)._asdict())

    def reload(self, digest: str, who: str) -> Reloaded:
        """Check the files, or apply what was listed with this digest. Call it in another thread than the loop's."""
        if not self._lock.acquire(timeout=WAIT_S):
            return Reloaded(errors=[BUSY])
        try:
            return self._reload(digest, who)
        finally:
            self._lock.release()

    def _reload(self, digest: str, who: str) -> Reloaded:
        ran = self._in_loop(self._box.ran)
        try:
            content = self._configuration.read_next(ran)
        except ConfigErrors as errors:
            return Reloaded(errors=str(errors).splitlines())
        changes = self._configuration.changes(content, ran)
        found = Reloaded(warnings=self._configuration.warnings_of(content, ran), changes=changes,
                         errors=self._in_loop(lambda: self._box.reload_off(content.config)))
        if found.errors:
            return found
        found = found._replace(digest=content.digest)
        if not digest or digest != content.digest:
            return found._replace(errors=[CHANGED_AGAIN] if digest else [])
        with_ids = self._configuration.with_ids(content)
        errors = self._apply(with_ids, changes, who)
        trouble = "" if errors else self._configuration.write_ids(content, with_ids)
        return found._replace(errors=errors, applied=not errors,
                              warnings=[*found.warnings, *([trouble] if trouble else [])])

    def _apply(self, content: Content, changes: List[str], who: str) -> List[str]:
        """Put a content into force; returns why that is not possible."""
        if not changes:
            return []
        before = self._configuration.version
        try:
            version = self._configuration.keep(content, self._in_loop(self._versions_in_use))
        except OSError as error:
            return [f"the configuration cannot be kept in log_dir: {error.strerror}. Free or repair the disk"]

        def act() -> None:
            self._use(content, version)
            self._event(self._box.reload, content.config, version, changes, who)
            self._configuration.content = content

        try:
            self._in_loop(act)
        except Refused as refused:  # a run was connected in the meantime
            self._configuration.put_back(before)
            return refused.reasons
        return []

    def _versions_in_use(self) -> Tuple[int, ...]:
        return tuple(zone.version for zone in self._box.zones.values() if zone.run is not None)
