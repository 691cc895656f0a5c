"""Runs the test cases of a rostest, and reports what failed in a `subTest`.

rosunit's result class counts failures of subtests, but writes nothing about them.
"""

import unittest
from typing import Any

import rostest
from rosunit import xmlrunner


def _add_sub_test(result: Any, test: Any, subtest: Any, error: Any) -> None:
    """Report a failed subtest as a case of its own."""
    unittest.TestResult.addSubTest(result, test, subtest, error)
    if error is None:
        return
    is_failure = issubclass(error[0], test.failureException)
    create = xmlrunner._TestInfo.create_failure if is_failure else xmlrunner._TestInfo.create_error
    info = create(test, 0.0, error)
    info._method = f"{info._method} {subtest._subDescription()}"
    result._tests.append(info)


def rosrun(package: str, name: str, cases: Any) -> None:
    """`rostest.rosrun`, with failures of subtests in the result file."""
    xmlrunner._XMLTestResult.addSubTest = _add_sub_test
    rostest.rosrun(package, name, cases)
