"""The local time of this process."""

import contextlib
import os
import time
from unittest import mock


@contextlib.contextmanager
def local_time(zone):
    """Meanwhile, local time is that of `zone`, a value of TZ."""
    try:
        with mock.patch.dict(os.environ, {"TZ": zone}):
            time.tzset()
            yield
    finally:
        time.tzset()
