"""Builds HTML pages in which every text is escaped.

The pages contain unchecked strings of robots, so `tag` escapes everything that is not `Markup`. A page has no
external parts, and its content security policy forbids the browser to load, run or send anything. Only the scripts that
are given to `page` run, by their checksums.
"""

import base64
import functools
import hashlib
import html
import json
import os
import pathlib
import re
from typing import Callable, Iterable, List, NamedTuple, Sequence, Union

from roah_rsbb.wording.texts import visible

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
# JSON in a page: without these signs, no text ends the element or begins a comment.
_JSON_ESCAPES = {ord(sign): f"\\u{ord(sign):04x}" for sign in "<>&"}

# Elements without an end tag.
_VOID = frozenset(("br", "img", "meta", "wbr"))
# Elements that contain nothing but text.
_TEXT_ONLY = frozenset(("title", "text"))
# No word is broken, except a longer one, which would be wider than its column. Names have signs where they may break.
LONGEST_WORD = 22
_LONG_WORD = re.compile(rf"[^\s]{{{LONGEST_WORD + 1},}}")
_PIECE, _PIECE_OF_WIDE = (re.compile(rf"[^\W_]{{1,{most}}}[\W_]{{0,3}}|[\W_]{{1,{most}}}") for most in (
    LONGEST_WORD, LONGEST_WORD * 3 // 5))
_WIDE = re.compile("[A-ZmwÄÖÜ]")

# Tokens of the web pages, for paper: a test compares them.
_STYLE = """
:root { --surface-page: #eceff2; --text: #14191f; --text-quiet: #4b5661; --line: #d6dbe1; --line-control: #78838f; }
@page { size: A4; margin: 14mm 13mm; }
* { box-sizing: border-box; }
body { font: 10pt/1.35 "IBM Plex Sans", "DejaVu Sans", Verdana, sans-serif; color: var(--text); max-width: 190mm;
  margin: 6mm auto; padding: 0 4mm; }
h1 { font-size: 17pt; margin: 0 0 1mm; } h2 { font-size: 11.5pt; margin: 6mm 0 1.5mm; break-after: avoid; }
h3 { font-size: 10pt; margin: 3mm 0 1mm; break-after: avoid; }
p { margin: 1mm 0; } .small { font-size: 8pt; color: var(--text-quiet); }
table { border-collapse: collapse; width: 100%; } thead { display: table-header-group; } tr { break-inside: avoid; }
th, td { text-align: left; vertical-align: top; padding: .7mm 1.6mm; border-bottom: .2mm solid var(--line);
  white-space: pre-wrap; min-width: 15mm; }
th { font-size: 8pt; color: var(--text-quiet); white-space: normal; }
.number { text-align: right; min-width: 9mm; } .time { min-width: 18mm; width: 18mm; }
td.number, td.time { white-space: nowrap; } td.time { font-size: 8.5pt; }
table.facts { width: auto; } table.facts th { width: 30mm; font-size: 10pt; }
td.value { min-width: 28mm; width: 28mm; font-weight: bold; } .who { min-width: 34mm; width: 34mm; }
.team, .change { min-width: 26mm; } .what { min-width: 34mm; }
td.when { min-width: 23mm; width: 23mm; white-space: normal; font-size: 8.5pt; }
.mark { font-size: 8pt; border: .2mm solid var(--text); border-radius: .8mm; padding: 0 1mm; }
.bad { font-weight: bold; } del { color: var(--text-quiet); }
.front { display: flex; flex-direction: column; min-height: 262mm; margin-bottom: 8mm; }
.content { flex: 1 1 auto; min-height: 0; } .front + .front, .annex { break-before: page; }
.front table.facts { width: 100%; } .front table.facts th { width: 24mm; font-size: 8pt; } .front tr { height: 5.6mm; }
.front table.facts td { width: 68mm; } .front h2 { margin-top: 4mm; }
.scores table { margin: 0 0 2.5mm; } .scores th.title { font-size: 10pt; color: var(--text); }
.scores td.value { width: 25mm; min-width: 25mm; text-align: right; white-space: normal; }
.scores tr:first-child { break-after: avoid; } .scores tr:last-child { break-before: avoid; }
.scores .number { width: 14mm; } .scores.two, .scores.three { column-gap: 6mm; font-size: 8.5pt; }
.scores.two { columns: 2; } .scores.three { columns: 3; font-size: 7pt; }
.scores.two tr { height: 4.6mm; } .scores.three tr { height: 3.6mm; }
.scores.two td, .scores.two th, .scores.three td, .scores.three th { padding: .3mm .8mm; min-width: 0; }
.scores.two th.title { font-size: 9pt; } .scores.three th.title { font-size: 8pt; }
.scores.two td.value { width: 19mm; min-width: 19mm; } .scores.three td.value { width: 15mm; min-width: 15mm; }
.scores.two .number, .scores.three .number { width: 10mm; }
.competition { display: flex; align-items: center; gap: 5mm; height: 14mm; margin-bottom: 3mm; }
.competition img { max-height: 14mm; max-width: 50mm; }
.competition p { font-size: 13pt; font-weight: bold; margin: 0; }
table.totals { width: 100%; margin-top: 1mm; border-top: .4mm solid var(--text); }
table.totals th { font-size: 10pt; color: var(--text); } table.totals td { font-weight: bold; }
.line { border-bottom: .2mm solid var(--line-control); height: 7mm; margin: 0; }
.remark { font-size: 9pt; max-height: 2.7em; overflow: hidden; }
.signatures { display: flex; gap: 10mm; flex: none; padding-top: 16mm; break-inside: avoid; }
.signatures svg { position: absolute; bottom: 100%; width: 38mm; }
.signatures div { position: relative; flex: 1; border-top: .3mm solid var(--text); padding-top: 1mm; font-size: 8pt; }
svg { width: 100%; height: auto; display: block; break-inside: avoid; }
@media screen and (max-width: 150mm) { .scores.two, .scores.three { columns: 1; }
  .annex > table { display: block; overflow-x: auto; } }
@media print { .front { height: 262mm; margin: 0; } .content { overflow: hidden; }
  body { margin: 0; padding: 0; max-width: none; } a { color: inherit; text-decoration: none; } }
"""


class Markup(str):
    """HTML that `tag` or `joined` built."""

    __slots__ = ()


Child = Union[str, Markup]


def tag(name: str, /, *children: Child, **attributes: object) -> Markup:
    """Build an element. The attribute `class_` becomes class, `text_anchor` text-anchor; None omits an attribute."""
    parts = [f"<{name}"]
    for key, value in attributes.items():
        if value is not None:
            text = str(value) if value.__class__ in (int, float) else html.escape(visible(str(value)))
            parts.append(f' {key.rstrip("_").replace("_", "-")}="{text}"')
    if name in _VOID:
        return Markup("".join(parts) + ">")
    escape = html_escaped if name in _TEXT_ONLY else breakable
    return Markup("".join(parts) + ">" + joined(children, escape) + f"</{name}>")


def html_escaped(text: str) -> Markup:
    """Escape a text."""
    return Markup(html.escape(visible(text)))


@functools.lru_cache(maxsize=4096)  # most texts on a page recur
def breakable(text: str) -> Markup:
    """Escape a text, and mark where words of excessive length may break."""
    if len(text) <= LONGEST_WORD and text.isprintable():
        return Markup(html.escape(text))
    return Markup("".join(
        "<wbr>".join(map(html.escape, _pieces(part))) if _LONG_WORD.fullmatch(part)
        else html.escape(part)
        for part in re.split(r"(\s+)", visible(text))
    ))


def _pieces(word: str) -> Sequence[str]:
    """Return the pieces of a long word, none wider than its column."""
    is_wide = 4 * len(_WIDE.findall(word)) > len(word)
    return (_PIECE_OF_WIDE if is_wide else _PIECE).findall(word)


def joined(children: Iterable[Child], escape: Callable[[str], Markup] = breakable) -> Markup:
    """Concatenate texts and markup; texts are escaped."""
    return Markup("".join(c if isinstance(c, Markup) else escape(c) for c in children))


def table(headings: Sequence[Child], rows: Iterable[Sequence[Child]], classes: Sequence[str] = ()) -> Markup:
    """Build a table; `classes` are the CSS classes of the columns, empty for none."""
    classes = [*classes, *[""] * (len(headings) - len(classes))]
    begins = [f'<td class="{html.escape(class_)}">' if class_ else "<td>" for class_ in classes]

    def row(cells: Sequence[Child]) -> Markup:  # most of a page are rows, so this takes less time than `tag`
        return Markup("<tr>" + "".join([
            f"{begin}{cell if cell.__class__ is Markup else breakable(cell)}</td>"
            for begin, cell in zip(begins, cells)]) + "</tr>")

    heads = (tag("th", cell, class_=class_ or None) for cell, class_ in zip(headings, classes))
    return tag("table", tag("thead", tag("tr", *heads)), tag("tbody", *map(row, rows)))


def facts_table(facts: Iterable[Sequence[Child]]) -> Markup:
    """Build a table of names and values."""
    return tag("table", *(tag("tr", tag("th", name), tag("td", value)) for name, value in facts), class_="facts")


class Competition(NamedTuple):
    """What stands at the top of each sheet and standing."""

    title: str = ""
    logo: str = ""  # a picture as a data: address

    def markup(self) -> Markup:
        """Build the line; it is empty without title and logo."""
        parts = [tag("img", src=self.logo, alt="")] if self.logo else []
        if self.title:
            parts.append(tag("p", self.title))
        return tag("div", *parts, class_="competition") if parts else Markup("")


NO_COMPETITION = Competition()
# The pictures that a browser shows, by the ends of their files' names, with their first bytes.
_PICTURES = {
    ".png": ("image/png", b"\x89PNG"), ".jpg": ("image/jpeg", b"\xff\xd8"), ".jpeg": ("image/jpeg", b"\xff\xd8"),
    ".svg": ("image/svg+xml", b"<"),
}


def picture_address(path: str) -> str:
    """Read a picture as a data: address, which is part of the page. Raises OSError, and ValueError for other files."""
    kind, begin = _PICTURES.get(os.path.splitext(path)[1].lower(), ("", b""))
    with open(path, "rb") as file:
        data = file.read()
    if not kind or not data.lstrip().startswith(begin):
        raise ValueError(f"{path} is not a picture: give a PNG, JPEG or SVG file")
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def resource_texts(folder: str, *names: str) -> List[str]:
    """Read files that become part of a page. Raises OSError."""
    return [pathlib.Path(folder, name).read_text(encoding="utf-8") for name in names]


def json_text(value: object) -> str:
    """Return JSON that can stand in an element of a page, whatever texts it contains."""
    return json.dumps(value, separators=(",", ":"), sort_keys=True).translate(_JSON_ESCAPES)


def json_block(identity: str, value: object) -> Markup:
    """Build an element with data for a script of the page; the browser does not run it."""
    return Markup(f'<script type="application/json" id="{html.escape(identity)}">{json_text(value)}</script>')


def checksum(text: str) -> str:
    """Return what a content security policy calls a script or style that it allows."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def page(title: str, *body: Child, scripts: Sequence[str] = (), style: str = "") -> str:
    """Build a complete page. It runs these `scripts` and nothing else, whatever texts it shows."""
    policy = f"{_POLICY}; script-src {' '.join(map(checksum, scripts))}" if scripts else _POLICY
    head = tag(
        "head", tag("meta", charset="utf-8"), tag("meta", http_equiv="Content-Security-Policy", content=policy),
        tag("meta", name="viewport", content="width=device-width"), tag("title", title),
        tag("style", Markup(_STYLE + style)),
    )
    ends = (Markup(f"<script>{text}</script>") for text in scripts)
    return "<!DOCTYPE html>\n" + tag("html", head, tag("body", tag("main", *body), *ends), lang="en") + "\n"
