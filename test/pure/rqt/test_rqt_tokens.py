"""All faces have the colours of the pages (tokens.css), and each look of a phase its icon."""

import pathlib
import re

import pytest

from roah_rsbb.model.records import EndReason
from roah_rsbb.rqt import basic
from roah_rsbb.wording import sheets

ROOT = pathlib.Path(__file__).resolve().parents[3]
ASSETS = ROOT / "resource" / "web" / "assets"
TOKENS, DARK = (dict(re.findall(r"--([a-z-]+): ([^;]+);", (ASSETS / name).read_text(encoding="utf-8")))
                for name in ("tokens.css", "dark.css"))


def test_windows_have_the_colours_of_the_pages() -> None:
    tones = {f"state-{look}-band": (tone, "band-text") for look, tone in basic.PHASES.items()}
    tones.update({"achievement": (basic.YES, "achievement-text"), "stop": (basic.STOP, "stop-text"),
                  "warning-wash": (basic.OLD, "warning"), "warning": (basic.ALARM, "warning-wash")})
    for background, (tone, text) in tones.items():
        assert tone == (TOKENS[background], TOKENS[text]), background
    for name, (light, dark, _roles) in basic.SURFACES.items():
        assert (light, dark) == tuple(tokens[name.replace("_", "-")] for tokens in (TOKENS, DARK)), name


@pytest.mark.parametrize("path", [
    "resource/replay/replay.css", "resource/tablet/tablet.css", "src/roah_rsbb/results/page.py"])
def test_pages_without_the_gateway_have_the_colours_of_its_pages(path) -> None:
    own = re.findall(r"--([a-z-]+): ([^;]+);", (ROOT / path).read_text(encoding="utf-8"))
    assert own and all(value in (TOKENS[name], DARK[name]) for name, value in own)


def test_each_phase_has_a_look_with_an_icon() -> None:
    ends = ["", *(one.name.lower() for one in EndReason)]
    looks = {sheets.look(phase, end) for phase in sheets.PHASES for end in ends}
    icons = (ASSETS / "icons.svg").read_text(encoding="utf-8")
    assert looks == set(basic.PHASES)
    assert all(f'id="i-{look}"' in icons for look in looks)
