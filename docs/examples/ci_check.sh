#!/bin/bash
# Checks a robot's program in CI, on loopback: starts the program, runs the conformance check beside it, and ends both.
# The exit status is that of the check.
#
#   TEAM=MyTeam ROAH_RSBB_KEY=PASSWORD ./ci_check.sh python3 my_robot.py MyTeam 127.255.255.255 --bind 127.0.0.2
#
# The arguments start the program, with a loopback address of its own. Variables: TEAM, ROAH_RSBB_KEY (the password),
# LEVEL (basic or full), BENCHMARKS (codes separated by commas), REPORTS (a folder), CHECK (how to start the check).
set -u
[ $# -gt 0 ] && [ -n "${TEAM-}" ] && [ -n "${ROAH_RSBB_KEY-}" ] || {
  echo "usage: TEAM=NAME ROAH_RSBB_KEY=PASSWORD $0 COMMAND...; COMMAND starts the robot's program" >&2
  exit 2
}
reports=${REPORTS:-check_reports}
mkdir -p "$reports"

"$@" >"$reports/robot.log" 2>&1 &
robot=$!
trap 'kill "$robot" 2>/dev/null; wait "$robot" 2>/dev/null' EXIT

${CHECK:-roah-rsbb check-robot} --team "$TEAM" --host 127.255.255.255 --bind 127.0.0.1 --level "${LEVEL:-basic}" \
  --benchmarks "${BENCHMARKS:-HGTKMH}" --wait 30 \
  --junit "$reports/check.xml" --html "$reports/check.html" --json "$reports/check.json"
status=$?
[ "$status" -eq 0 ] || tail -n 40 "$reports/robot.log"
exit "$status"
