"""A team's own password: from the argument, a file or the environment."""

import pytest

from roah_rsbb.comm.passwords import own_password


def test_ones_own_password(tmp_path, monkeypatch):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    assert own_password(None, None) is None
    monkeypatch.setenv("ROAH_RSBB_KEY", "e")
    assert own_password(None, None) == "e"
    (tmp_path / "f").write_text("p q\nx\n", encoding="utf-8")
    assert own_password(None, str(tmp_path / "f")) == "p q"
    assert own_password("o", None) == "o"
    with pytest.raises(ValueError, match="No such file"):
        own_password(None, str(tmp_path / "none"))
