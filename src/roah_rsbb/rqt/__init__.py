"""Referees' panels and the public display (docs/referee.md, "The panels").

Each panel is a plain widget in its own file. It works in rqt (`with_ros.plugins`), in our own window (`app.window`) and
in a window for one panel (`app.standalone`). `with_ros.host` is what they need of ROS.
Panels hold no truth: they show what the core published, mark it as old while the core is silent, and send commands
(docs/architecture.md, "Panels hold no truth"). `model.client` holds what all panels of a process share.
"""
