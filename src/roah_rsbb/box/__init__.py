"""The program around the core: the loop, the radio, the journal, the run logs. No ROS.

`assembly.CoreAssembly` puts the parts together, for the core node and for the tests' simulator alike.
"""
