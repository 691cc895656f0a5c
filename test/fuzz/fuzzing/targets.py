"""All targets by name."""

from typing import Dict

from fuzzing import capture, configuration, core, frames, journal, results, robot, smartif, words
from fuzzing.target import Target

TARGETS: Dict[str, Target] = {
    target.name: target for target in (
        frames.PUBLIC, frames.PRIVATE, core.BOX, results.RESULTS, smartif.SMARTIF, smartif.HOME,
        configuration.CONFIGURATION, configuration.GROUND_TRUTH, configuration.PARAMETERS,
        configuration.MAP, configuration.SHEET, words.LINES, words.TYPED, words.PAGES, robot.SESSION, robot.GOALS,
        capture.PACKETS, capture.DATAGRAMS, capture.RECORDING,
        journal.START, journal.READ, journal.PORTS, journal.NAMES,
    )
}
