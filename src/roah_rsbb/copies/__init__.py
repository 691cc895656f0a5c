"""Copies the journal, continuously, to a second place (docs/backup.md)."""
