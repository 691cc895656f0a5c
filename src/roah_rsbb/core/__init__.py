"""What the box *is*: configuration, schedule, zones, runs, countdowns, scoring, active robots.

Nothing in this folder talks to a network, asks a clock or knows ROS: objects take `now` and an event,
and return or emit effects (docs/architecture.md, "The core does no I/O"). Only `config` reads files, once, at the
start. It imports the standard library, PyYAML, `roah_rsbb.protocol`, and nothing else.
"""
