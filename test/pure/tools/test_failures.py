"""tools/failures.py: what failed, from result files of pytest and of rostest."""

import pathlib
import subprocess
import sys

import pytest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"


@pytest.fixture
def failures(monkeypatch):
    monkeypatch.syspath_prepend(str(TOOLS))
    import failures

    return failures


def test_pytests_own_result_file(tmp_path, failures):
    (tmp_path / "test").mkdir()
    (tmp_path / "test" / "test_some.py").write_text(
        "def check(a):\n    assert a == 2, 'the state'\n\n\ndef test_good():\n    check(2)\n\n\n"
        "class TestSome:\n    def test_bad(self):\n        check(1)\n"
    )
    result = tmp_path / "result.xml"
    subprocess.run(
        [sys.executable, "-m", "pytest", "-q", f"--junitxml={result}", "-p", "no:cacheprovider", "test"],
        cwd=str(tmp_path), stdout=subprocess.DEVNULL, check=False,
    )
    failure, = failures.failures(result)
    assert failure.case == "TestSome.test_bad"
    assert failure.why.startswith("AssertionError: the state\nassert 1 == 2")
    assert failure.place == "test/test_some.py:2"
    assert failures.listed(failure).splitlines()[0] == "  TestSome.test_bad (test/test_some.py:2)"


def test_a_failure_without_a_place(tmp_path, failures):
    result = tmp_path / "result.xml"
    result.write_text("<testsuite><testcase name='some'><error>it left no result</error></testcase></testsuite>")
    failure, = failures.failures(result)
    assert failure == ("some", "it left no result", "")
