"""The replay of a run as one HTML file, which needs neither a network nor a server (docs/results.md, "Replay").

The page's own script is the only one that its content security policy lets the browser run. The strings of robots are
in a block of JSON, where `<` is escaped, and the script sets them as text only.
"""

import html
import os
import re
import urllib.parse
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.events import SectionLine
from roah_rsbb.results.page import checksum, json_text
from roah_rsbb.results.replay import NOT_SHOWN, replay_data
from roah_rsbb.results.runs import RunResult, file_name, run_moments
from roah_rsbb.wording.texts import visible

_PART = re.compile("@([A-Z]+)@")


class PageParts(NamedTuple):
    """The files of which each page is made."""

    page: str
    style: str
    script: str


def page_parts(folder: str) -> PageParts:
    """Read the files in the package's folder resource/replay. Raises OSError."""
    texts = []
    for suffix in ("html", "css", "js"):
        with open(os.path.join(folder, f"replay.{suffix}"), encoding="utf-8") as file:
            texts.append(file.read())
    return PageParts(*texts)


def replay_name(number: int, record: RunRecord) -> str:
    """Return the file name of a run's replay. `number`: in the list of all runs."""
    return f"{file_name(number, record)}_replay.html"


def replay_of(
    reader: JournalReader, result: RunResult, parts: PageParts, in_utc: bool, warn: Callable[[str], None],
    video: str = "", events: Optional[Sequence[Tuple[str, SectionLine]]] = None,
) -> str:
    """Return the page of a run. `video`: address of the video that it shows, if any; `events`: what `in_order` returns
    with the scores, if the caller has it."""
    moments = run_moments(reader, result.record.identity, warn, NOT_SHOWN)
    return replay_page(replay_data(result, moments, in_utc, events), parts, video)


def replay_page(data: Dict[str, Any], parts: PageParts, video: str = "") -> str:
    """Return the page with the data that `replay.replay_data` returns."""
    if video:
        data = {**data, "video": video if _is_address(video) else urllib.parse.quote(video)}
    values = {
        "POLICY": html.escape(_policy(parts, video)), "TITLE": html.escape(f"Replay: {visible(str(data['title']))}"),
        "STYLE": parts.style, "SCRIPT": parts.script, "DATA": json_text(data),
    }
    return _PART.sub(lambda match: values.get(match.group(1), match.group()), parts.page)


def _policy(parts: PageParts, video: str) -> str:
    return "; ".join((
        "default-src 'none'", f"script-src {checksum(parts.script)}", f"style-src {checksum(parts.style)}",
        f"media-src blob:{_source(video)}", "base-uri 'none'", "form-action 'none'",
    ))


def _is_address(video: str) -> bool:
    """Whether this is a web address, and not the path of a file, in which # and % have no meaning."""
    return video.startswith(("http://", "https://", "file:"))


def _source(video: str) -> str:
    """Return where the video may come from: its own site, or the place of the page."""
    if not video:
        return ""
    address = urllib.parse.urlsplit(video)
    if address.scheme not in ("http", "https") or not re.fullmatch(r"[A-Za-z0-9.:\[\]-]+", address.netloc):
        return " 'self' file:"
    return f" {address.scheme}://{address.netloc}"
