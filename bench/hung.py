"""Measures how long a core that hangs is missed: SIGSTOP in each phase of a run, as in test/ros/core/test_hung.py."""

import os
import unittest
from typing import Dict


def measure() -> Dict[str, float]:
    """Seconds from SIGSTOP until the next core is heard, by phase. Exits if anything that was acknowledged is lost."""
    os.environ["ROAH_TEST_ALL"] = "yes"
    from core.test_hung import TestHungCore  # reads that

    done = unittest.TextTestRunner(verbosity=0).run(unittest.defaultTestLoader.loadTestsFromTestCase(TestHungCore))
    if not done.wasSuccessful():
        raise SystemExit("bench: a core that hung was not replaced as it should be: see above")
    return TestHungCore.took_s
