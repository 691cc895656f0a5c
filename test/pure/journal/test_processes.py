"""Work that several processes share."""

import os
import signal

import pytest

from roah_rsbb.journal.processes import ProcessEnded, shared_out


def shared(work, items, processes):
    with shared_out(work, items, processes) as results:
        yield from results


def no_child_is_left():
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


@pytest.mark.parametrize("processes", [1, 2, 3, 9])
def test_results_come_in_the_order_of_the_items(processes):
    assert list(shared(lambda item: item * item, range(7), processes)) == [item * item for item in range(7)]
    assert list(shared(lambda item: item, [], processes)) == []
    no_child_is_left()


def test_the_work_is_in_other_processes():
    pids = set(shared(lambda _: os.getpid(), range(6), 3))
    assert len(pids) == 3
    assert os.getpid() not in pids
    assert set(shared(lambda _: os.getpid(), range(6), 1)) == {os.getpid()}


@pytest.mark.parametrize("processes", [1, 2])
def test_an_error_comes_in_the_place_of_its_item(processes):
    results = shared(lambda item: 1 // (3 - item), range(6), processes)
    assert [next(results) for _ in range(3)] == [0, 0, 1]
    with pytest.raises(ZeroDivisionError):
        next(results)
    no_child_is_left()


def test_a_process_that_is_killed_is_reported():
    with pytest.raises(ProcessEnded, match="free memory"):
        list(shared(lambda item: os.kill(os.getpid(), signal.SIGKILL) if item == 3 else item, range(6), 2))
    no_child_is_left()


def test_results_that_nobody_takes():
    results = shared(lambda item: "x" * 1_000_000, range(6), 2)
    assert len(next(results)) == 1_000_000
    results.close()
    no_child_is_left()
