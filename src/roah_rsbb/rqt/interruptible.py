"""The first import of each program with windows: SIGINT ends it at once, until it has its own handler.

Python would raise a KeyboardInterrupt. That gets lost in a callback, such as those of Python's imports, and the program
starts nevertheless.
"""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)
