"""The targets of links and pictures exist, and blocks contain what they claim."""

import ast
import pathlib
import re
from xml.etree import ElementTree

import pages
import pytest
import yaml
from pages import ROOT

# Blocks in other "languages" are bytes or texts that a test of their own reads (test/pure).
LANGUAGES = {"sh", "text", "python", "yaml", "xml", "csv", "json", "mermaid", "beacon", "key", "plain", "frame"}


@pytest.mark.parametrize("page", pages.NAMES)
def test_links_lead_somewhere(page):
    for target in pages.links(page):
        if re.match(r"https?://", target):
            continue
        name, _, anchor = target.partition("#")
        path = ((ROOT / page).parent / name).resolve() if name else ROOT / page
        assert path.exists(), f"{page}: {target}"
        assert ROOT in path.parents or path == ROOT, f"{page}: {target} is outside of the repository"
        if anchor:
            assert anchor in pages.anchors(str(path.relative_to(ROOT))), f"{page}: {target}"


@pytest.mark.parametrize("page", pages.NAMES)
def test_every_block_says_what_it_is(page):
    for block in pages.blocks(page):
        assert block.language in LANGUAGES, f"{block.where}: language {block.language!r}"


@pytest.mark.parametrize("page", pages.NAMES)
def test_blocks_can_be_read(page):
    for block in pages.blocks(page):
        if block.language == "yaml" and block.mark != "file":  # files may be wrong on purpose: they are run
            yaml.safe_load(block.text)
        elif block.language == "xml":
            ElementTree.fromstring(block.text)
        elif block.language == "python":
            ast.parse(block.text)


def test_every_page_can_be_found_from_the_first_one():
    found, left = set(), ["README.md"]
    while left:
        page = left.pop()
        found.add(page)
        for target in pages.links(page):
            path = ((ROOT / page).parent / target.partition("#")[0]).resolve()
            name = str(path.relative_to(ROOT)) if ROOT in path.parents else ""
            if name.endswith(".md") and name not in found and path.exists():
                left.append(name)
    assert set(pages.NAMES) - found == set()


def test_every_picture_is_shown_or_said_to_be_there():
    text = "".join(pathlib.Path(ROOT / page).read_text("utf-8") for page in pages.NAMES)
    for picture in (ROOT / "docs" / "images").glob("*.png"):
        light = picture.name.replace("_dark", "_light").replace("3840x2160", "1280x720")
        assert light in text, picture.name


def test_every_example_stands_in_a_page_as_it_is():
    shown = {block.text for page in pages.NAMES for block in pages.blocks(page) if block.language == "python"}
    for example in (ROOT / "docs" / "examples").glob("*.py"):
        assert example.read_text("utf-8") in shown, example.name


@pytest.mark.parametrize("page", pages.NAMES)
def test_files_that_are_named_exist(page):
    """Files that a page names, such as `core/run.py`, `docs/team.md` or `msg/Benchmark.msg`, exist."""
    folders = "bench|config|core|comm|docs|journal|launch|modules|msg|nodes|proto|robot|rqt|scripts|srv|test|tools"
    for name in re.findall(rf"`((?:src/roah_rsbb/)?(?:{folders})/[\w/.-]+\.\w+)`", pages.prose(page)):
        assert any((ROOT / folder / name).exists() for folder in ("", "src/roah_rsbb", "config")), f"{page}: {name}"
