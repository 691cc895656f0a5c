"""The calls that the web gateway offers through the door of the box (docs/door.md, "Calls of the web pages")."""

PAIR, PAIRED, REVOKE, TEAM_CODES = WEB_CALLS = ("pair", "paired", "revoke", "team_codes")
