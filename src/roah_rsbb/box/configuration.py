"""The configuration of a box: read at the start, and read again when an organiser changes it.

Theory of operation. A changed file takes effect only when an organiser says so. Until then, and after a crash of the
core, the box uses the contents that it read, which `journal/log_dir.py` keeps. A new launch reads the files again.
The call `reload` changes the configuration while the box runs (docs/organiser.md, "Changes during the competition").
Passwords are kept nowhere but in their file, so each start of the core reads that file.
"""

import contextlib
import hashlib
import os
import threading
from dataclasses import replace
from typing import (
    Any,
    Callable,
    ContextManager,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
)

from roah_rsbb.box import calls
from roah_rsbb.core.box import Box
from roah_rsbb.document.calls import Caller, InThread
from roah_rsbb.ground import durable, installed
from roah_rsbb.journal.log_dir import InForce, Texts, read_in_force, write_in_force
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.rulebook import config, day, event_ids, schedule_text
from roah_rsbb.rulebook.benchmarks import Config, ZonePlan, teams_of
from roah_rsbb.rulebook.changes import changes, warnings
from roah_rsbb.rulebook.day import EventChange, PlannedSlot
from roah_rsbb.rulebook.decisions import beside
from roah_rsbb.rulebook.errors import CannotRead, ConfigErrors, known, read_bytes
from roah_rsbb.rulebook.event_ids import EventKey
from roah_rsbb.rulebook.standing_rules import StandingRules, read_rules

# The places of files among the files.
_SCHEDULE, _PASSWORDS, _STANDINGS, _DECISIONS = 1, 2, 3, 4
# An editor may write a file while it is read.
MAX_READINGS = 5
EDITED = ("The configuration files were changed since the box read them. It continues with what it read. To take the "
          "changes: 'rosrun roah_rsbb referee reload'")
# Edits that can be undone: more than a day has.
MAX_EDITS = 100
SHIPPED = say("{path} is a part of the program, and is not written: the edit is kept in log_dir")
BY_HAND = say("{path} was changed by hand, too. The edit is written there; what else was changed is in force after "
              "'reload'")
NOT_BY_HAND = say("{path} was changed by hand, and does not fit the edit, which is in force: it is not written. Enter "
                  "it there, or 'reload' takes it back")
NOT_WRITTEN = say("{path} cannot be written ({error}). The edit is in force, and is written with the next one or at "
                  "the next start")
# Seconds for the reload before, whose files may be on a disk that hangs.
WAIT_S = 5.0
BUSY = "another reload has not ended: its files do not answer. Check the disk or the network on which they are"
CHANGED_AGAIN = "the files were changed after they were listed: read the list again before you apply it"


class Content(NamedTuple):
    """What the files contain."""

    config: Config
    warnings: Tuple[str, ...]
    texts: Texts

    @property
    def digest(self) -> str:
        """Identifies the contents of the files."""
        return hashlib.sha256(repr(self.texts).encode("utf-8", "replace")).hexdigest()[:16]


class Configuration:
    """The files, and the contents of the versions in use."""

    def __init__(self, log_dir: str, launch: str, files: Sequence[str], standings_file: Optional[str]) -> None:
        """`files`: benchmarks, schedule and passwords. `launch` identifies the launch; empty: unknown. Raises
        ConfigErrors."""
        self._log_dir = log_dir
        self._launch = launch
        self._paths = (*files, *([standings_file] if standings_file else []))
        self.warnings: List[str] = []  # about the files, for the log
        self.notices: List[str] = []  # for every referee
        before = read_in_force(log_dir)
        self.before: Tuple[ZonePlan, ...] = ()  # the schedule in force before this start, if another one is now
        self._versions: Dict[int, Texts] = {} if before is None else dict(before.versions)
        self.version = 0 if before is None else before.present
        self.edits: Tuple[Mapping[str, Any], ...] = () if before is None else before.edits
        """Of the schedule, the newest last, as JSON: `Edit`."""
        self._unwritten = None if before is None else before.unwritten  # see `InForce`
        self._edits_before = self.edits, self._unwritten  # of the last version, for `put_back`
        self.content = self._begin(before)

    def _begin(self, before: Optional[InForce]) -> Content:
        kept = None if before is None else before.versions[before.present]
        is_same = kept is not None and tuple(filter(None, kept.paths[:_DECISIONS])) == self._paths
        if kept is not None and is_same:
            self.notices += filter(None, [self.write_schedule(kept.texts[_SCHEDULE], _schedule_of(kept))])
        is_ahead = self._unwritten is not None and is_same and _read(self._paths).texts[_SCHEDULE] == self._unwritten
        if is_ahead or (is_same and self._launch and before.launch == self._launch):
            content = _load_texts(kept)
            if content is not None:
                if not is_ahead and _without_passwords(_read(self._files())) != kept:
                    self.notices.append(EDITED)
                return content
        self._unwritten = None
        content = self.read()
        texts = _without_passwords(content.texts)
        if kept is not None and texts != kept:
            self.version = before.present + 1
            self.before = _schedule_of(kept)
        self._versions[self.version] = texts
        try:
            self._write()
        except OSError as error:
            self.notices.append(f"The configuration cannot be kept in {self._log_dir}: {error.strerror}. After a "
                                "crash, the box reads the files again")
        self.warnings += content.warnings
        return content

    def read(self) -> Content:
        """Read the files. Raises ConfigErrors with the errors of all of them."""
        for _ in range(MAX_READINGS):
            texts = _read(self._files())
            content = _load(self._paths, texts)
            if _read(self._files()) == texts:
                break
        return content

    def _files(self) -> Tuple[str, ...]:
        """Return the paths of the files that there are now: somebody may add decisions."""
        decisions = beside(self._paths[0])
        if not os.path.lexists(decisions):
            return self._paths
        return (*self._paths, *[""] * (_DECISIONS - len(self._paths)), decisions)

    @property
    def passwords(self) -> str:
        """The path of the passwords file."""
        return self._paths[_PASSWORDS]

    def read_next(self, ran: Sequence[EventKey] = ()) -> Content:
        """Read the files again. Events without an id are known from the schedule in force, and from the events of all
        runs (`ran`). Raises ConfigErrors."""
        return _known_from(self.read(), self.content.config, ran)

    def with_ids(self, content: Content) -> Content:
        """Return a content whose schedule has all ids in its text."""
        texts = list(content.texts.texts)
        text = texts[_SCHEDULE]
        if text is not None:
            texts[_SCHEDULE] = event_ids.written(text, content.config.zones)
        return content._replace(texts=content.texts._replace(texts=tuple(texts)))

    def edited(self, changes: Sequence[EventChange], passwords: Optional[str] = None) -> Content:
        """Return the content in force with changes of its schedule, and other `passwords`. Raises `Refused`, or
        ConfigErrors."""
        texts = self.content.texts if passwords is None else _with(self.content.texts, _PASSWORDS, passwords)
        texts = _with(texts, _SCHEDULE, _edited_text(texts, changes, self.content.config.zones))
        with _again(texts):
            return _load(texts.paths, texts)

    def write_schedule(self, text: Optional[str], zones: Sequence[ZonePlan]) -> str:
        """Write the schedule in force into its file, if edits made it; the version before is kept. Returns what an
        organiser must know; empty: nothing. If it is not possible, it is tried again with the next edit or start."""
        if self._unwritten is None or text is None:
            return ""
        path = os.path.realpath(self._paths[_SCHEDULE])  # a link stays one
        found, said = _read([path]).texts[0], ""
        if found != text:
            if installed.is_shipped(path):
                return SHIPPED(path=path)
            try:
                if found != self._unwritten:
                    changes = [change for edit in self.edits if not edit["written"] for change in changes_of(edit)]
                    text, said = _edited_text(_read(self._files()), changes, zones), BY_HAND(path=path)
                durable.replace_keeping(path, text.encode("utf-8"))
            except (Refused, ConfigErrors):
                return NOT_BY_HAND(path=path)
            except OSError as error:
                return NOT_WRITTEN(path=path, error=error.strerror)
        self._unwritten, self.edits = None, _all_written(self.edits)
        with contextlib.suppress(OSError):  # then it is written again
            self._write()
        return said

    def write_ids(self, before: Content, content: Content) -> str:
        """Write the schedule of a content with ids into its file. Returns why that is not possible; empty: done.

        `before`: the content as it was read. A file that was changed since then stays.
        """
        path, text = self._paths[_SCHEDULE], content.texts.texts[_SCHEDULE]
        if text is None or text == before.texts.texts[_SCHEDULE]:
            return ""
        if _read([path]).texts[0] != before.texts.texts[_SCHEDULE]:
            return f"{path}: the ids of the events were not written: the file was changed just now. Reload again"
        try:
            durable.replace_keeping(os.path.realpath(path), text.encode("utf-8"), 0)  # a link stays one
        except OSError as error:
            return (f"{path}: the ids of the events cannot be written ({error.strerror}). Make the file writable and "
                    "reload again, or an event that is changed in several ways may be taken for another one")
        return ""

    def changes(self, content: Content, ran: Sequence[EventKey] = ()) -> List[str]:
        """List what a content changes. `ran`: the events of all runs."""
        return changes(self.content.config, content.config, ran)

    def warnings_of(self, content: Content, ran: Sequence[EventKey]) -> List[str]:
        """Return what an organiser should know before a content is put into force. `ran`: the events of all runs."""
        return [*content.warnings, *warnings(self.content.config, content.config, ran)]

    def keep(self, content: Content, in_use: Iterable[int], edits: Optional[Sequence[Mapping[str, Any]]] = None) -> int:
        """Keep a content as the next version, before it is put into force; returns its number. Raises OSError.

        `in_use`: the versions that runs still need. `edits`: all, if the last one made this content of the one in
        force.
        """
        needed = {self.version, *in_use}
        before = self.version, self._versions
        self._edits_before = self.edits, self._unwritten
        if edits is None:  # the file has what is in force, whatever it lacked
            self._unwritten, self.edits = None, _all_written(self.edits)
        else:
            self.edits = tuple(edits[-MAX_EDITS:])
            if self._unwritten is None:
                self._unwritten = self.content.texts.texts[_SCHEDULE]
        self.version += 1
        self._versions = {number: texts for number, texts in self._versions.items() if number in needed}
        self._versions[self.version] = _without_passwords(content.texts)
        try:
            self._write()
        except OSError:
            self.version, self._versions = before
            self.edits, self._unwritten = self._edits_before
            raise
        return self.version

    def keep_edits(self, edits: Sequence[Mapping[str, Any]]) -> None:
        """Keep edits of which the last one changed no event. One that is lost changed none."""
        self.edits = tuple(edits[-MAX_EDITS:])
        with contextlib.suppress(OSError):
            self._write()

    def put_back(self, version: int) -> None:
        """Return to an earlier version, because the last one could not be put into force. Raises OSError."""
        del self._versions[self.version]
        self.version = version
        self.edits, self._unwritten = self._edits_before
        self._write()

    def earlier(self, numbers: Iterable[int]) -> Dict[int, Config]:
        """Return those of these versions that are no longer in force. A missing or unreadable one is omitted."""
        found = {number: _load_texts(self._versions[number]) for number in numbers
                 if number in self._versions and number != self.version}
        return {number: content.config for number, content in found.items() if content is not None}

    def _write(self) -> None:
        write_in_force(self._log_dir, InForce(
            self._launch, self.version, self._versions, self.edits, self._unwritten))


def _all_written(edits: Sequence[Mapping[str, Any]]) -> Tuple[Mapping[str, Any], ...]:
    return tuple({**edit, "written": True} for edit in edits)


def changes_of(edit: Mapping[str, Any]) -> List[EventChange]:
    """Return the changes of an edit."""
    return [EventChange(event, *(None if slot is None else PlannedSlot(*slot) for slot in slots))
            for event, *slots in edit["changes"]]


def _edited_text(texts: Texts, changes: Sequence[EventChange], before: Sequence[ZonePlan]) -> str:
    """Return the schedule in texts with changes. Events without an id have those that they have in `before`. Raises
    `Refused`, or ConfigErrors."""
    with _again(texts):
        zones = event_ids.adopted(config.load_schedule(*texts.paths[:_PASSWORDS])[1], before)
    found = schedule_text.changed(event_ids.written(texts.texts[_SCHEDULE] or "", zones), changes)
    after = _with(texts, _SCHEDULE, found)
    with _again(after):
        if day.slots(config.load_schedule(*after.paths[:_PASSWORDS])[1]) != day.applied(day.slots(zones), changes):
            raise Refused([schedule_text.NOT_BY_LINE])
    return found


def _with(texts: Texts, place: int, text: Optional[str]) -> Texts:
    return texts._replace(texts=(*texts.texts[:place], text, *texts.texts[place + 1:]))


def _read(paths: Sequence[str]) -> Texts:
    found: List[Optional[str]] = []
    for path in paths:
        try:
            found.append(read_bytes(path, "the configuration").decode("utf-8"))
        except (CannotRead, UnicodeDecodeError):
            found.append(None)
    return Texts(tuple(paths), tuple(found))


def _known_from(content: Content, before: Config, ran: Sequence[EventKey]) -> Content:
    """Return a content whose events without an id have those that they have in `before`, or had when they ran."""
    zones = event_ids.adopted(content.config.zones, before.zones, ran)
    return content._replace(config=replace(content.config, zones=zones))


def _without_passwords(texts: Texts) -> Texts:
    return _with(texts, _PASSWORDS, None)


def _load(paths: Sequence[str], texts: Texts) -> Content:
    """Read and check the files; raises ConfigErrors with the errors of all of them."""
    errors = []
    loaded: Optional[Config] = None
    rules = StandingRules()
    try:
        loaded, warnings = config.load(*paths[:3])
    except ConfigErrors as found:
        errors += found.errors
    try:
        known_names = () if loaded is None else (tuple(loaded.benchmarks), teams_of(loaded))
        rules = read_rules(paths[_STANDINGS], *known_names) if any(paths[_STANDINGS:_DECISIONS]) else rules
    except ConfigErrors as found:
        errors += found.errors
    if loaded is None or errors:
        raise ConfigErrors(errors)
    rules.decisions = tuple(dict.fromkeys((*loaded.decisions, *rules.decisions)))
    return Content(replace(loaded, ranking=rules, decisions=rules.decisions), tuple(warnings), texts)


def _load_texts(texts: Texts) -> Optional[Content]:
    """Load contents that were read before, with the present passwords; None: they cannot be read, or do not fit."""
    with _again(texts), contextlib.suppress(ConfigErrors):
        return _load(texts.paths, texts)._replace(warnings=())
    return None


def _schedule_of(texts: Texts) -> Tuple[ZonePlan, ...]:
    """Return the schedule in contents that were read before; empty: it cannot be read."""
    with _again(texts), contextlib.suppress(ConfigErrors):
        return config.load_schedule(*texts.paths[:_PASSWORDS])[1]
    return ()


def _again(texts: Texts) -> ContextManager[None]:
    return known({path: text for path, text in zip(texts.paths, texts.texts) if text is not None})


class Reloaded(NamedTuple):
    """What became of a reload."""

    digest: str = ""  # identifies what was read; empty: there are errors
    applied: bool = False
    errors: Sequence[str] = ()  # of all files, with file and line; or why the change is not possible now
    warnings: Sequence[str] = ()
    changes: Sequence[str] = ()  # empty: nothing differs from what is in force
    rescored: Sequence[str] = ()  # the runs whose points would change if all runs were scored by the new sheets


class Reloads:
    """Reads the files in other threads, and puts them into force in the loop's thread."""

    def __init__(
        self, box: Box, configuration: Configuration, in_loop: Callable[[Callable[[], Any]], Any],
        event: Callable[..., None], use: Callable[[Config, int], None],
    ) -> None:
        """`in_loop` calls a function in the loop's thread and returns its result. `use` prepares everything outside the
        box for a configuration and its version, in the loop's thread."""
        self._box = box
        self._configuration = configuration
        self._in_loop = in_loop
        self._event = event
        self._use = use
        self._lock = threading.Lock()  # one reload at a time

    def call(self, found: Mapping[str, Any], caller: Caller) -> InThread:
        """The call `reload` of the door."""
        digest, who, for_all = calls.text(found, "digest"), calls.who_of(found), found.get("for_all") is True
        return InThread(lambda: self.reload(digest, who, for_all)._asdict())

    def reload(self, digest: str, who: str, for_all: bool = False) -> Reloaded:
        """Check the files, or apply what was listed with this digest: for all runs, or from now on. Call it in another
        thread than the loop's."""
        try:
            with self.alone():
                return self._reload(digest, who, for_all)
        except Refused as busy:
            return Reloaded(errors=busy.reasons)

    @contextlib.contextmanager
    def alone(self) -> Iterator[None]:
        """Let no other reload or edit begin. Raises `Refused`."""
        if not self._lock.acquire(timeout=WAIT_S):
            raise Refused([BUSY])
        try:
            yield
        finally:
            self._lock.release()

    def _reload(self, digest: str, who: str, for_all: bool) -> Reloaded:
        ran = self._in_loop(self._box.reload.ran)
        try:
            content = self._configuration.read_next(ran)
        except ConfigErrors as errors:
            return Reloaded(errors=str(errors).splitlines())
        changes = self._configuration.changes(content, ran)
        runs = self._in_loop(lambda: self._box.reload.rescoring(content.config))()
        found = Reloaded(warnings=self._configuration.warnings_of(content, ran), changes=changes,
                         errors=self._in_loop(lambda: self._box.reload.off(content.config)),
                         rescored=[str(run) for run in runs if run.has_other_points])
        if found.errors:
            return found
        found = found._replace(digest=content.digest)
        if not digest or digest != content.digest:
            return found._replace(errors=[CHANGED_AGAIN] if digest else [])
        with_ids = self._configuration.with_ids(content)
        errors = self.apply(with_ids, changes, who, runs if for_all else None)
        trouble = "" if errors else self._configuration.write_ids(content, with_ids)
        return found._replace(errors=errors, applied=not errors,
                              warnings=[*found.warnings, *([trouble] if trouble else [])])

    def apply(
        self, content: Content, changes: List[str], who: str, runs: Optional[Sequence[Any]] = None,
        edits: Optional[Sequence[Mapping[str, Any]]] = None,
    ) -> List[str]:
        """Put a content into force; returns why that is not possible. `runs`: see `Reload.take`; `edits`: see
        `Configuration.keep`."""
        if not changes and runs is None:
            return []
        before, edit = self._configuration.version, None if edits is None else edits[-1]
        try:
            version = self._configuration.keep(content, self._in_loop(self._versions_in_use), edits)
        except OSError as error:
            return [f"the configuration cannot be kept in log_dir: {error.strerror}. Free or repair the disk"]

        def act() -> None:
            self._use(content.config, version)
            self._event(self._box.reload.take, content.config, version, changes, who, runs, edit)
            self._configuration.content = content

        try:
            self._in_loop(act)
        except Refused as refused:  # a run was connected in the meantime
            self._configuration.put_back(before)
            return refused.reasons
        return []

    def _versions_in_use(self) -> Tuple[int, ...]:
        return tuple(zone.version for zone in self._box.zones.values() if zone.run is not None)
