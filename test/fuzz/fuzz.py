#!/usr/bin/python3
"""Coverage-guided fuzzing of one target, or a measured replay of inputs: see README.md. `make fuzz` runs all."""

import argparse
import pathlib
import shutil
import sys
from typing import Any, List

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
FOUND = ROOT / "build" / "fuzz"
# One input that takes so long, instrumented as it is, is a fault even without a measurement.
HANG_S = 20
RSS_LIMIT_MB = 1500
MAX_BYTES = 66_000
# The others are likely the same fault.
MOST_REPORTED = 5

sys.path[:0] = [str(HERE), str(HERE.parent)]


def _targets() -> Any:
    import conftest  # noqa: F401  (where the package and its protobuf code are)
    from fuzzing.targets import TARGETS
    return TARGETS


def _options(arguments: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="fuzz.py", description=__doc__)
    parser.add_argument("what", choices=("list", "run", "check"))
    parser.add_argument("target", nargs="?")
    parser.add_argument("files", nargs="*", type=pathlib.Path, help="check: inputs; without: all that are stored")
    parser.add_argument("--seconds", type=int, default=60, help="run: for so long (default: %(default)s)")
    return parser.parse_args(arguments)


def _run(name: str, seconds: int) -> None:
    """Fuzz a target with atheris; ends the process."""
    import atheris

    with atheris.instrument_imports(include=["roah_rsbb", "yaml"]):
        target = _targets()[name]
    found, seeds = FOUND / name, FOUND / f"{name}.seeds"
    found.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(seeds, ignore_errors=True)
    seeds.mkdir()
    for number, seed in enumerate(target.all_seeds()):
        (seeds / str(number)).write_bytes(seed)
    words = FOUND / f"{name}.words"
    words.write_text("".join(f'"{_escaped(token)}"\n' for token in target.tokens), encoding="ascii")
    flags = [
        f"-timeout={HANG_S}", f"-rss_limit_mb={RSS_LIMIT_MB}", f"-max_len={MAX_BYTES}", f"-dict={words}",
        f"-artifact_prefix={FOUND / name}.fault-", f"-max_total_time={seconds}", "-print_final_stats=1",
    ]
    atheris.Setup([sys.argv[0], *flags, str(found), str(seeds)], target.play)
    atheris.Fuzz()


def _escaped(token: bytes) -> str:
    """A word in the format of libFuzzer's dictionaries."""
    return "".join(f"\\x{byte:02x}" for byte in token[:60])


def _check(name: str, files: List[pathlib.Path]) -> int:
    """Replay inputs with their cost measured; returns the number of faults."""
    target = _targets()[name]
    inputs = [(str(path), path.read_bytes()) for path in files]
    if not files:
        inputs = [(f"seed {number}", seed) for number, seed in enumerate(target.all_seeds())]
        inputs += [(str(path), path.read_bytes()) for path in sorted((FOUND / name).glob("*"))]
    faults, slowest, largest = 0, 0.0, 0
    for where, data in inputs:
        try:
            seconds, size = target.check(data)
        except Exception as error:
            faults += 1
            if faults <= MOST_REPORTED:
                print(f"{name}: {where}: {type(error).__name__}: {str(error)[:300]}", file=sys.stderr)
            if len(files) == 1:
                raise
            continue
        slowest, largest = max(slowest, seconds), max(largest, size)
    print(f"{name}: {len(inputs)} inputs, the dearest {slowest * 1000:.1f} ms, {largest / 1e6:.1f} MB; {faults} faults")
    return faults


def main() -> None:
    """See the module."""
    options = _options(sys.argv[1:])
    if options.what == "list":
        print("\n".join(_targets()))
    elif options.what == "check":
        sys.exit(min(1, _check(options.target, options.files)))
    else:
        _run(options.target, options.seconds)


if __name__ == "__main__":
    main()
