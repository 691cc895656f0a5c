"""The team's side of the protocol: what a robot does between the box and its own behaviour.

It needs protobuf and cryptography, but no ROS. `client.RobotClient` is the entry point; `session.Session` is the same
without sockets and clocks; `dummy` is a simulated robot.
"""
