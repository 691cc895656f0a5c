"""Simulates the whole box with random troubles, until something is wrong (test/simulator/README.md).

make simulate SIMULATE="--seconds 600", make simulate SIMULATE="--seed 17"
"""

import argparse
import pathlib
import random
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "test"))

import conftest  # noqa: E402, F401  (prepares what the tests need, also in a fresh clone)
import roah_rsbb  # noqa: E402  (only now can it be found)

SEEDS = 2**31


def _options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, help="only this seed; shows what happens in it")
    parser.add_argument("--first", type=int, help="the first of the seeds (default: random)")
    parser.add_argument("--count", type=int, default=SEEDS, help="how many seeds (default: until Ctrl-C)")
    parser.add_argument("--zones", type=int, default=20, help="with --minutes (default: %(default)s)")
    parser.add_argument("--minutes", type=float, help="with --seed: a larger competition, of so many minutes")
    parser.add_argument("--source", default=str(ROOT / "src" / "roah_rsbb"), help="the package (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="processor time (default: until Ctrl-C)")
    return parser.parse_args()


def _show(seed, size):
    from simulation.shorten import failure_of, shortened
    from simulation.world import Size, simulate

    failure = None if size else failure_of(seed)
    if failure is not None:
        print(shortened(failure))
        return 1
    began = time.process_time()
    world = simulate(seed, size=Size(*size) if size else None)
    print("\n".join(world.trace.lines))
    print(f"{world.scheduler.now:.1f} s, {world.scheduler.steps} steps, digest {world.trace.digest}, "
          f"{time.process_time() - began:.1f} s of processor time")
    return 0


def _search(options):
    from simulation.shorten import failure_of, shortened

    first = random.SystemRandom().randrange(SEEDS) if options.first is None else options.first
    began, simulated = time.process_time(), 0.0
    for seed in range(first, first + options.count):
        used = time.process_time() - began
        if used > options.seconds:
            break
        failure = failure_of(seed)
        if failure is not None:
            print(shortened(failure))
            print(f"{simulated + 1:.0f} seeds from {first} on")
            return 1
        simulated += 1
        if sys.stdout.isatty():
            print(f"\r{simulated:.0f} seeds", end="", flush=True)
    print(f"\r{simulated:.0f} seeds from {first} on, nothing wrong")
    return 0


def main():
    """Run the program."""
    options = _options()
    roah_rsbb.__path__[0] = options.source
    try:
        size = (options.zones, 60.0 * options.minutes) if options.minutes else None
        sys.exit(_search(options) if options.seed is None else _show(options.seed, size))
    except KeyboardInterrupt:
        sys.exit("")


main()
