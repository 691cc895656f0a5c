"""Referees' panels (docs/referee.md, "The panels").

Each panel is a plain widget (`panels`). It works in rqt (`plugins`), in our own window and in a window for one panel
(`windows`). `node` is what they need of ROS. Panels hold no truth: they show what the core published, mark it as old
while the core is silent, and send commands (docs/architecture.md, "Panels hold no truth"). `client` holds what all
panels of a process share.
"""
