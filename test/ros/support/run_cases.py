#!/usr/bin/python3
"""Runs the test cases of files in one process and one ROS node: `run_cases.py core/test_kill.py core/test_disk.py`.

The files' paths start at test/ros. A failure in a `subTest` is a case of its own in the result file: rosunit's
result class counts such failures, but writes nothing about them.
"""

import importlib.util
import pathlib
import sys
import types
import unittest
from typing import Any, List

import rospy
import rosunit
from rosunit import xmlrunner

from roah_rsbb.ros import connections

FOLDER = pathlib.Path(__file__).resolve().parent.parent  # test/ros
RESULT_FILE = "--gtest_output=xml:"
AS_TEXT = "--text"


def _add_sub_test(result: Any, test: Any, subtest: Any, error: Any) -> None:
    """Report a failed subtest as a separate case."""
    unittest.TestResult.addSubTest(result, test, subtest, error)
    if error is None:
        return
    is_failure = issubclass(error[0], test.failureException)
    create = xmlrunner._TestInfo.create_failure if is_failure else xmlrunner._TestInfo.create_error
    info = create(test, 0.0, error)
    info._method = f"{info._method} {subtest._subDescription()}"
    result._tests.append(info)


def runner(name: str, result_file: str) -> Any:
    """rosunit's runner, with failures of subtests in the result file."""
    xmlrunner._XMLTestResult.addSubTest = _add_sub_test
    return rosunit.create_xml_runner("roah_rsbb", name, result_file)


def load(path: str) -> types.ModuleType:
    """The module in that file: "core/test_kill.py" becomes `core.test_kill`."""
    name = path[:-len(".py")].replace("/", ".")
    spec = importlib.util.spec_from_file_location(name, str(FOLDER / path))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def main(arguments: List[str]) -> int:
    """Run the cases in the order of the files; returns the exit status."""
    sys.path[:1] = [str(FOLDER), str(FOLDER.parent / "pure")]  # for `support` and the pure tests' `helpers`
    result_files = [one[len(RESULT_FILE):] for one in arguments if one.startswith(RESULT_FILE)]
    load_cases = unittest.TestLoader().loadTestsFromModule
    suite = unittest.TestSuite(load_cases(load(one)) for one in arguments if one.endswith(".py"))
    connections.init_node("run_cases", disable_signals=True)  # the launch file gives another name
    if AS_TEXT in arguments:
        result = unittest.TextTestRunner(verbosity=2).run(suite)
    else:
        name = rospy.get_name().strip("/")
        result = runner(name, result_files[0] if result_files else None).run(suite)
    rosunit.print_unittest_summary(result)
    rospy.signal_shutdown("the test is complete")
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main(rospy.myargv(sys.argv)[1:]))
