"""The scenarios of the check, as tables. Each one is a coroutine of a `Play`."""
