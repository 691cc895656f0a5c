"""The box itself: zones, runs, countdowns, scoring, active robots.

Nothing in this folder uses a network, a clock or ROS. Objects take `now` and an event, and return or emit effects
(docs/architecture.md, "The core does no I/O"). docs/architecture.md, "Imports", lists what it may import.
"""
