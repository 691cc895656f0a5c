"""Referees' panels and the public display (docs/referee.md, "The panels").

One file a panel; each panel is a plain widget, so that it works in rqt (`plugins`) and in our own window
(`window`) alike. Panels hold no truth: they show what the core published, marked as old when the core is
silent, and send commands (docs/architecture.md, "Panels hold no truth"). What all panels of a process share is in
`client`.
"""
