"""Shares work out among processes, because threads of Python do not compute at the same time.

Each process does every n-th item, and the results come in the order of the items. A program must have no other threads
when it starts processes.
"""

import contextlib
import os
import pickle
import signal
from typing import BinaryIO, Callable, Iterator, List, NamedTuple, Sequence, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

# More processes take more memory than a report may take.
MOST_PROCESSES = 3


class ProcessEnded(Exception):
    """A process ended before its work was done, for example because memory was short."""


class _Worker(NamedTuple):
    pid: int
    results: BinaryIO


def usable_processors() -> int:
    """Return how many processes work at the same time on this computer."""
    return min(MOST_PROCESSES, len(os.sched_getaffinity(0)))


@contextlib.contextmanager
def shared_out(
    work: Callable[[Item], Result], items: Sequence[Item], processes: int
) -> Iterator[Iterator[Result]]:
    """Return what the work makes of each item, in order. Errors are raised at the item at which they occurred.

    The work begins at once, in other processes if these are more than one. Results must be of types that `pickle`
    knows. Raises ProcessEnded.
    """
    count = min(processes, len(items))
    if count < 2:
        yield map(work, items)
        return
    workers: List[_Worker] = []
    try:
        for number in range(count):
            workers.append(_start(work, items[number::count], workers))
        yield (_result(workers[place % count]) for place in range(len(items)))
    finally:
        for worker in workers:
            worker.results.close()
            with contextlib.suppress(ProcessLookupError):
                os.kill(worker.pid, signal.SIGKILL)
            os.waitpid(worker.pid, 0)


def _start(work: Callable[[Item], Result], items: Sequence[Item], others: Sequence[_Worker]) -> _Worker:
    reading, writing = os.pipe()
    pid = os.fork()
    if pid == 0:
        try:
            os.close(reading)
            for worker in others:  # a pipe breaks, and its worker ends, when the only reader is gone
                worker.results.close()
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends the others
            with open(writing, "wb") as results:
                _serve(work, items, results)
        finally:
            os._exit(0)  # nothing of the first process is cleaned up here
    os.close(writing)
    return _Worker(pid, open(reading, "rb"))


def _serve(work: Callable[[Item], Result], items: Sequence[Item], results: BinaryIO) -> None:
    """Do items in a worker; the last result may be an error."""
    with contextlib.suppress(BrokenPipeError):
        try:
            for item in items:
                pickle.dump((work(item), None), results)
                results.flush()
        except BrokenPipeError:
            raise
        except Exception as error:
            pickle.dump((None, error), results)
            results.flush()


def _result(worker: _Worker) -> Result:
    try:
        value, error = pickle.load(worker.results)
    except (EOFError, pickle.UnpicklingError):
        raise ProcessEnded("a process of this program ended early: free memory, and repeat the command") from None
    if error is not None:
        raise error
    return value
