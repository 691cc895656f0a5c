"""test/ros/support/run_cases.py: the result file of a rostest with subtests."""

import pathlib
import unittest
import xml.etree.ElementTree as ElementTree

import pytest

pytest.importorskip("rosunit")

HERE = pathlib.Path(__file__).resolve()


class TestSome(unittest.TestCase):
    """Collected by name only, with cases that fail."""

    def runTest(self):
        for number in range(3):
            with self.subTest(number=number):
                self.assertEqual(number, 1, "the state")
        with self.subTest("an error"):
            raise KeyError("missing")


TestSome.__test__ = False  # pytest leaves it alone


def test_failed_subtests_are_in_the_result_file(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(HERE.parents[2] / "ros"))
    from support.run_cases import runner

    result_file = tmp_path / "result.xml"
    runner("some", str(result_file)).run(TestSome())
    found = {
        case.get("name"): "".join(problem.text for problem in [*case.iter("failure"), *case.iter("error")])
        for case in ElementTree.parse(str(result_file)).getroot().iter("testcase")
    }
    failed = {name: text for name, text in found.items() if text}
    assert list(failed) == ["runTest (number=0)", "runTest (number=2)", "runTest [an error]"]
    for text, why in zip(failed.values(), ("0 != 1 : the state", "2 != 1 : the state", "missing")):
        assert why in text
        assert HERE.name in text
