"""The standby: a second computer that has a copy of the journal and can continue the runs (docs/standby.md)."""
