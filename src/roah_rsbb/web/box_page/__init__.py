"""The page of the whole box (docs/web.md)."""
