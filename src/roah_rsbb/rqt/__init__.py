"""Referees' panels and the public display (manual, section 5).

One file a panel; each panel is a plain widget, so that it works in rqt (`plugins`) and in our own window
(`window`) alike. Panels hold no truth: they show what the core published, marked as old when the core is
silent, and send commands (architecture, rule 6). What all panels of a process share is in `client`.
"""
