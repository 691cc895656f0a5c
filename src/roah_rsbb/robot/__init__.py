"""The team's side of the protocol: what a robot does between the box and its own behaviours.

Needs protobuf and cryptography, no ROS. `client.RobotClient` is the way in; `session.Session` is the
same without sockets and clocks; `dummy` is a robot that only pretends.
"""
