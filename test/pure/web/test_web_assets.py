"""The files of the pages: kept libraries are unchanged, and nothing comes from elsewhere."""

import gzip
import hashlib
import pathlib
import re

import pytest

from roah_rsbb.web.server import _STYLES

ROOT = pathlib.Path(__file__).resolve().parents[3]
WEB = ROOT / "resource" / "web"
KEPT = [
    (WEB / "assets" / "vendor" / "preact-htm.js", WEB / "assets" / "vendor" / "README.md"),
    (ROOT / "test" / "data" / "axe" / "axe.min.js", ROOT / "test" / "data" / "axe" / "README.md"),
]
OURS = sorted(path for path in (*WEB.glob("*.*"), *(WEB / "assets").glob("*.*")) if path.suffix != ".png")
MOST_FIRST_BYTES, MOST_BYTES = 12_000, 32_000


@pytest.mark.parametrize("file, page", KEPT, ids=lambda path: path.name)
def test_a_kept_library_is_unchanged_and_has_its_licence(file, page):
    said = page.read_text(encoding="utf-8")
    assert hashlib.sha256(file.read_bytes()).hexdigest() in said
    assert file.name in said and re.search(r"\d+\.\d+\.\d+", said)
    for licence in re.findall(r"`(LICENSE[\w.]*)`", said):
        assert "ermi" in (file.parent / licence).read_text(encoding="utf-8") or "Licen" in licence
    assert re.findall(r"`(LICENSE[\w.]*)`", said)


@pytest.mark.parametrize("path", OURS, ids=lambda path: path.name)
def test_a_page_needs_nothing_from_elsewhere(path):
    text = path.read_text(encoding="utf-8").replace("http://www.w3.org/2000/svg", "")
    assert "http:" not in text and "https://" not in text and "//cdn" not in text
    for name in re.findall(r'"/assets/([^"{]+)"', text):
        assert (WEB / "assets" / name).is_file(), name


@pytest.mark.parametrize("path", sorted(WEB.glob("*.html")), ids=lambda path: path.name)
def test_a_page_has_no_script_or_style_within_it(path):
    text = path.read_text(encoding="utf-8").replace("<script>{again}</script>", "")
    assert re.findall(r"<script(?![^>]*\bsrc=)", text) == []
    assert "<style" not in text and "style=" not in text and not re.search(r"\son\w+=", text)


@pytest.mark.parametrize("path", sorted((WEB / "assets").glob("*.js")), ids=lambda path: path.name)
def test_texts_of_others_never_become_html_or_scripts(path):
    """Robots, teams and visitors write some of the texts. Templates of htm make text of them."""
    wrong = re.findall(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|javascript:",
                       path.read_text(encoding="utf-8"))
    assert wrong == []


@pytest.mark.parametrize("page", ["display", "index", "overlay", "pair", "team"])
def test_a_slow_network_is_no_reason_for_an_empty_page(page):
    """What is sent, without the typeface, for which no page waits: first what shows its first frame."""
    def sent(*names):
        return sum(len(gzip.compress((WEB / name).read_bytes(), 6)) for name in names)

    first = sent("page.html", *(f"assets/{style}.css" for style in _STYLES[page]))
    assert first < MOST_FIRST_BYTES
    assert first + sent("assets/icons.svg", *_scripts(f"assets/{page}.js")) < MOST_BYTES


def _scripts(name):
    """A script with all that it imports."""
    text = (WEB / name).read_text(encoding="utf-8")
    return {name}.union(*(_scripts(one) for one in re.findall(r'from "/(assets/[^"]+)"', text)))
