#!/usr/bin/python3
"""A silent player: it appends its argument as a line to a file in ROS_HOME, for the test."""

import os
import sys

with open(os.path.join(os.environ["ROS_HOME"], "played"), "a", encoding="utf-8") as file:
    file.write(sys.argv[1] + "\n")
