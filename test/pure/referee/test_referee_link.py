"""The name that a terminal gives itself in the box's records."""

from roah_rsbb.referee.link import caller_name


def test_a_caller_has_a_name_that_ros_allows() -> None:
    assert caller_name("referee").startswith("/referee_")
    assert caller_name("référée")[1:].replace("_", "").isalnum() and caller_name("référée").isascii()
