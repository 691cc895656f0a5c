"""Reads and writes the files of resource/languages, in the format of Qt Linguist."""

import pathlib
from typing import Dict, List, NamedTuple, Tuple
from xml.etree import ElementTree
from xml.sax.saxutils import escape

from helpers.texts_in_code import ROOT

FOLDER = ROOT / "resource" / "languages"
CONTEXT = "roah_rsbb"
SOURCES = "../../src/roah_rsbb/"  # from the folder of these files


class Entry(NamedTuple):
    """A text and its translation."""

    text: str
    place: str  # the first file that shows it
    forms: Tuple[str, ...]  # one, or several for a text with a count; empty texts: not translated


def has_count(text: str) -> bool:
    """Whether a text has the place for a count, and so may have several forms."""
    return "{n}" in text


def read(path: pathlib.Path) -> Dict[str, List[Entry]]:
    """Return the entries by context."""
    return {
        context.findtext("name", ""): [_entry(message) for message in context.iter("message")]
        for context in ElementTree.parse(str(path)).getroot().iter("context")
    }


def _entry(message: ElementTree.Element) -> Entry:
    translation, location = message.find("translation"), message.find("location")
    forms = tuple(form.text or "" for form in translation.iter("numerusform")) or (translation.text or "",)
    if translation.get("type") in ("unfinished", "vanished", "obsolete"):
        forms = tuple("" for _ in forms)
    place = "" if location is None else location.get("filename", "")[len(SOURCES):]
    return Entry(message.findtext("source", ""), place, forms)


def updated(entries: List[Entry], texts: Dict[str, str]) -> List[Entry]:
    """Return an entry for each of these texts; translations that exist are kept."""
    known = {entry.text: entry.forms for entry in entries}
    return [Entry(text, place, known.get(text, ("", "") if has_count(text) else ("",)))
            for text, place in texts.items()]


def write(path: pathlib.Path, contexts: Dict[str, List[Entry]]) -> None:
    """Write a file as Qt Linguist does."""
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<!DOCTYPE TS>",
             f'<TS version="2.1" language="{path.stem}" sourcelanguage="en">']
    for name, entries in contexts.items():
        lines += ["<context>", f"    <name>{name}</name>"]
        for entry in entries:
            lines += _message(entry)
        lines.append("</context>")
    path.write_text("\n".join([*lines, "</TS>", ""]), encoding="utf-8")


def _message(entry: Entry) -> List[str]:
    counted = has_count(entry.text)
    state = "" if all(entry.forms) else ' type="unfinished"'
    lines = ['    <message numerus="yes">' if counted else "    <message>"]
    if entry.place:
        lines.append(f'        <location filename="{SOURCES}{entry.place}"/>')
    lines.append(f"        <source>{_escaped(entry.text)}</source>")
    if counted:
        lines.append(f"        <translation{state}>")
        lines += [f"            <numerusform>{_escaped(form)}</numerusform>" for form in entry.forms]
        lines.append("        </translation>")
    else:
        lines.append(f"        <translation{state}>{_escaped(entry.forms[0])}</translation>")
    return [*lines, "    </message>"]


def _escaped(text: str) -> str:
    return escape(text, {"'": "&apos;", '"': "&quot;"})
