"""Writes a competition's journal and exports its logs as MCAP: mcap_export.py FOLDER. Prints all entries as JSON.

It is a program of its own, because the packages of ROS 2 contain only the robot's part of roah_rsbb.
"""

import json
import pathlib
import sys

from helpers.competition import run_record
from helpers.journals import Writer
from helpers.results_of import write_competition
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.run_log import KINDS
from roah_rsbb.results.program import main as results

# Values that do not fit into their messages, and one that does.
UNFIT = (("/rsbb_log/client_state", 300), ("/rsbb_log/score", ["group", "item"]),
         ("/rsbb_log/score", ["group", "item", 1 << 40]), ("/notification", "last"))


def export(journal, folder):
    try:
        results.main(["--journal", journal, "export", "--mcap", str(folder)])
    except SystemExit as end:
        assert not end.code


def logged(journal):
    """The entries of the log of each robot in each run, with run number and port."""
    reader = JournalReader(journal)
    return [
        (number, member.port, [(KINDS[e.kind].value, e.kind, e.utc, e.value)
                               for e in reader.entries(identity) if e.port == member.port and e.kind in KINDS])
        for number, identity in enumerate(reader.identities(), 1) for member in reader.members(identity)
    ]


def main():
    folder = pathlib.Path(sys.argv[1])
    journal = write_competition(folder / "log")
    export(journal, folder / "mcap")
    unfit = Writer(folder / "unfit")
    record = run_record()
    unfit.run(record)
    for kind, value in UNFIT:
        unfit.entry(kind, value, record.identity)
    unfit.close()
    export(unfit.path, folder / "mcap_unfit")
    print(json.dumps(logged(journal)))


if __name__ == "__main__":
    main()
