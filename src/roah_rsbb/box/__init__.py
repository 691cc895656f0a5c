"""The program around the core: the loop, the radio, the journal, the run logs. No ROS.

`game.Game` puts the parts together, for the program of the box and for the tests' simulator alike.
"""
