"""Limits for whoever reaches the gateway. Without sockets and without time."""

import pytest

from roah_rsbb.web import limits
from roah_rsbb.web.limits import MAX_ADDRESSES, MAX_CONNECTIONS, MAX_KNOWN, ConnectionPlaces, Places, Rates, is_own_host

NAMES = frozenset({"localhost", "box", "box.local", "box.example.org"})


@pytest.mark.parametrize("host", [
    "127.0.0.1", "192.168.1.10:8081", "localhost:8081", "box", "BOX.local:80", "box.example.org.", "[::1]:8081",
])
def test_names_and_addresses_of_this_computer(host):
    assert is_own_host(host, NAMES)


@pytest.mark.parametrize("host", [
    "", "evil.example", "evil.example:8081", "127.0.0.1.evil.example", "box.evil.example", "127.0.0.1@evil.example",
    "1270.0.0.1", "[::1", "a:b:c", "[::1].evil.com", "[::1].evil.com:8081", "[::1]evil:1",
])
def test_other_names_are_refused(host):
    assert not is_own_host(host, NAMES)


def test_own_names_have_the_further_ones():
    assert {"localhost", "results.example.org"} <= limits.own_names(["results.example.org"])


def test_an_address_may_ask_a_burst_and_then_so_many_a_second():
    rates = Rates(a_second=10.0, at_once=5.0)
    assert [rates.allows(0.0, "a") for _ in range(7)] == [True] * 5 + [False] * 2
    assert rates.allows(0.0, "b"), "other addresses are not affected"
    assert [rates.allows(0.2, "a") for _ in range(4)] == [True, True, False, False]


def test_asking_on_does_not_keep_an_address_out():
    rates = Rates(a_second=10.0, at_once=5.0)
    answered = sum(rates.allows(step / 100, "a") for step in range(1000))
    assert 100 <= answered <= 110


def test_the_list_of_addresses_is_limited():
    rates = Rates()
    for n in range(2 * MAX_ADDRESSES):
        rates.allows(0.0, str(n))
    assert len(rates._buckets) == MAX_ADDRESSES


def test_the_address_with_most_viewers_loses_its_oldest():
    closed = []
    places = Places(closed.append, most=4)
    for n in range(3):
        places.add(f"greedy {n}", "10.0.0.1")
    places.add("one", "10.0.0.2")
    places.add("two", "10.0.0.3")
    places.add("three", "10.0.0.4")
    assert closed == ["greedy 0", "greedy 1"]
    assert set(places) == {"greedy 2", "one", "two", "three"}
    places.remove("one")
    places.remove("one")
    places.add("four", "10.0.0.5")
    assert len(places) == 4 and closed == ["greedy 0", "greedy 1"]


def test_one_address_that_takes_all_places_loses_its_own():
    closed = []
    connections = ConnectionPlaces(closed.append)
    for n in range(MAX_CONNECTIONS):
        connections.add(f"attacker {n}", "10.0.0.1")
    for n in range(6):
        connections.add(f"browser {n}", "10.0.0.2")
    assert closed == [f"attacker {n}" for n in range(6)]


def test_no_number_of_addresses_takes_the_places_of_paired_devices():
    closed = []
    connections = ConnectionPlaces(closed.append)
    connections.add("first", "10.0.0.1")
    connections.know("first", "10.0.0.1")
    for n in range(5 * MAX_CONNECTIONS):
        connections.add(f"attacker {n}", f"10.1.{n // 250}.{n % 250}")
        if n == MAX_CONNECTIONS:
            connections.add("second", "10.0.0.1")
    assert {"first", "second"} <= set(connections)
    assert len(closed) == 4 * MAX_CONNECTIONS and len(set(connections)) == MAX_CONNECTIONS + 2
    connections.remove("second")
    assert "second" not in set(connections)


def test_the_list_of_paired_devices_addresses_is_limited():
    connections = ConnectionPlaces(lambda connection: None)
    for n in range(2 * MAX_KNOWN):
        connections.know(None, str(n))
        connections.know(None, "10.0.0.1")
    assert len(connections._known) == MAX_KNOWN and "10.0.0.1" in connections._known
