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
mkdir -p "$reports" || exit 2

# The program has a process group, so that all that it starts ends with it.
set -m
"$@" >"$reports/robot.log" 2>&1 </dev/null &
robot=$!
set +m

end_robot() {
  kill -TERM -- "-$robot" 2>/dev/null
  for _ in {1..50}; do
    kill -0 -- "-$robot" 2>/dev/null || return
    sleep 0.2
  done
  kill -KILL -- "-$robot" 2>/dev/null
}
trap end_robot EXIT

${CHECK:-roah-rsbb check-robot} --team "$TEAM" --host 127.255.255.255 --bind 127.0.0.1 --level "${LEVEL:-basic}" \
  ${BENCHMARKS:+--benchmarks "$BENCHMARKS"} --wait 30 \
  --junit "$reports/check.xml" --html "$reports/check.html" --json "$reports/check.json"
status=$?
[ "$status" -eq 0 ] || { echo "The robot's last output ($reports/robot.log):"; tail -n 40 "$reports/robot.log"; }
exit "$status"
