"""The box of the tests without ROS: `box_without_ros.py FOLDER RSBB_HOST`. A simulated motion-capture system sees what
the rules of functionality benchmarks ask for."""

import asyncio
import sys

from roah_rsbb.box.program.main import log_to_terminal, serve
from roah_rsbb.box.program.program import BoxProgram
from roah_rsbb.box.settings import BoxSettings, defaults


async def _work(program: BoxProgram) -> int:
    await program.start(f"{sys.argv[1]}/door.json")
    await asyncio.get_event_loop().create_future()
    return 0


def main() -> int:
    """Run the box until a signal; returns the exit status."""
    folder, host = sys.argv[1:]
    log_to_terminal()
    settings = BoxSettings({
        **defaults(), "rsbb_host": host, "schedule_file": f"{folder}/schedule.yaml",
        "passwords_file": f"{folder}/passwords.yaml", "log_dir": f"{folder}/logs", "modules_dir": f"{folder}/modules",
        "tablet": "false", "web": "false", "devices": "false", "bell_ring_command": "true",
        "timeout_ring_command": "true", "listen_duration": "0.2"})
    return serve(lambda loop: BoxProgram(loop, settings, "", is_dummy=True), _work)


if __name__ == "__main__":
    sys.exit(main())
