"""The scenarios about datagrams: bad networks, invalid and old datagrams, large beacons, bursts, drifting clocks."""

import random
from typing import List, Tuple

from roah_rsbb.check.bad_network import BAD, PERFECT
from roah_rsbb.check.box import BEACON_HOST
from roah_rsbb.check.findings import Cause, Verdict
from roah_rsbb.check.play import EXECUTING_S, GaveUp, Play, goals_of
from roah_rsbb.check.scenarios.scenario import Scenario
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.model.messages import BenchmarkingRobot, BoxMessage, DevicesState, TabletState
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.radio import beacon_size

BURST_S, BURST_PERIOD_S = 2.0, 0.05
ALIVE_S = 4.0
STALE_COPIES, STALE_PERIOD_S = 4, 0.2
MAX_DATAGRAM, MANY = 1024, 40
DRIFT_S, WINDOW_S = 60.0, 5.0
# Seconds per second. NTP slews a clock by at most 5e-4. A clock that drifts by 1e-3 reaches the allowed skew in 100 s.
NOTED_DRIFT, MOST_DRIFT = 6e-4, 1e-3
CLOCK_SET_S = 0.02


async def bad_network(play: Play, code: str) -> None:
    """A whole run while the network loses, duplicates, delays and reorders datagrams."""
    await play.connect(code, goals_of(code, 1))
    play.network.out = play.network.back = BAD
    await play.start()
    if not await play.until(lambda: play.over, 2 * play.options.patience) or (
            not await play.until(lambda: play.state is RobotState.STOP, 2 * ALIVE_S)):
        play.give_up(Cause.BAD_NETWORK, "a complete run on a bad network", play.state_name)
    play.network.out = play.network.back = PERFECT


async def stale(play: Play, code: str) -> None:
    """Copies of old datagrams of the box arrive after a STOP."""
    play.network.sent, play.network.keep = [], True
    try:
        await play.connect(code, goals_of(code, 1))
        await play.start()
        await play.executing()
        await play.rest(EXECUTING_S)
    finally:
        play.network.keep = False
    old = play.network.sent[:]
    if play.over:
        await play.after_stop("at the end of the run")
    else:
        await play.stop("in EXECUTING")
    since, run = len(play.record.reports), play.box.run_in(code)
    # The robot has received all of these by now, so each one is a copy.
    chosen = [old[len(old) * part // 4] for part in range(1, 4)]
    for _ in range(STALE_COPIES):
        for datagram in chosen:
            play.network.resend(run.port, datagram, run.link.host)
        await play.rest(STALE_PERIOD_S)
    if play.seen(frozenset(RobotState) - {RobotState.STOP}, since):
        came = "the robot obeyed a copy of an old message"
        if await play.until(lambda: play.state is RobotState.STOP, ALIVE_S):
            play.find(Verdict.QUIRK, Cause.STALE_OBEYED, "old messages of the box change nothing",
                      f"{came}, and stopped again. The original clients do that, too")
            raise GaveUp
        play.give_up(Cause.STALE_OBEYED, "old messages of the box change nothing", came)
    await play.leave()


def invalid_datagrams(seed: int, code: str, password: str) -> List[bytes]:
    """Datagrams that no participant of the protocol sends."""
    rng = random.Random(seed)
    noise = [bytes(rng.getrandbits(8) for _ in range(size)) for size in (1, 7, 8, 24, 200, 1024, 1400)]
    state = wire_convert.state_message(BoxMessage(code, BoxState.PREPARE))
    key, other = Key(password), Key(f"not {password}")
    good = frame.encode(state, Cipher.AES_128_CBC, key)
    return [
        *noise, b"", b"\x1a\x0a\x00\x14" + bytes(8),  # the latter: version 1
        frame.encode(state, Cipher.AES_128_CBC, other),  # another password
        good[:-16], good[:20], good[:1] + b"\x09" + good[2:],  # cut, too short, unknown cipher
        good[:4] + b"\xff\xff\xff\xff" + good[8:],  # a wrong size
        b"\x02\x00\x00\x00\x00\x00\x00\x06\x1a\x0a\x00\x0a\x0a\xff",  # a beacon that ends within a field
        b"\x02\x00\x00\x00\x00\x00\x00\x04\x1a\x0a\x00\x0a",  # a beacon without required fields
    ]


async def garbage(play: Play, code: str) -> None:
    """Invalid datagrams arrive on both channels."""
    await play.connect(code, goals_of(code, 1))
    await play.start()
    await play.executing()
    run, options = play.box.run_in(code), play.options
    for datagram in invalid_datagrams(options.seed, code, options.password):
        play.network.resend(run.port, datagram, run.link.host)
        play.network.resend(options.rsbb_port, datagram, options.rsbb_host)
        await play.rest(0.02)
    since = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > since, ALIVE_S):
        play.give_up(Cause.DIES_OF_GARBAGE, "the robot ignores invalid datagrams", "no more messages of the robot")
    if play.state is RobotState.EXECUTING:
        await play.stop("after invalid datagrams")
    await play.leave()


async def large_beacon(play: Play, code: str) -> None:
    """The beacon lists as many robots as an original robot can read, and then 40."""
    box = play.box.box
    invented = tuple(BenchmarkingRobot(f"Team{n:02}", f"Robot{n:02}", 20_000 + n) for n in range(MANY))
    own = BenchmarkingRobot(play.options.team, play.robot, 65535)
    fits = max(n for n in range(MANY) if beacon_size(
        box.beacon()._replace(robots=(*invented[:n], own))) <= MAX_DATAGRAM)
    box.extra = invented[:fits]
    await play.connect(code, missing=Cause.LARGE_BEACON)
    box.extra = invented
    await play.rest(ALIVE_S)
    since = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > since, ALIVE_S):
        play.give_up(Cause.LARGE_BEACON, f"the robot survives a beacon with {MANY} robots", "no more messages")
    box.extra = ()
    await play.leave()


async def burst(play: Play, code: str) -> None:
    """Devices and tablet change twenty times a second."""
    await play.connect(code, goals_of(code, 1))
    await play.start()
    await play.executing()
    box, utc = play.box.box, play.box.now().utc
    for number in range(int(BURST_S / BURST_PERIOD_S)):
        moment = (int(utc) + number, 0)
        play.box.event(box.on_devices, DevicesState(moment, bool(number % 2), True, False, number % 101, 50, False))
        play.box.event(box.on_tablet, BEACON_HOST, TabletState(False, moment, moment, 0.1 * number, 1.0))
        await play.rest(BURST_PERIOD_S)
    if not play.over and play.state is RobotState.EXECUTING:
        await play.stop("after a burst of beacons", Cause.BURST)
    since = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > since, ALIVE_S):
        play.give_up(Cause.BURST, "the robot continues after twenty beacons a second", "no more messages of the robot")
    await play.leave()


async def drift(play: Play, _code: str) -> None:
    """The robot's clock keeps its distance to the checker's clock for a minute."""
    record, loop = play.record, play.loop
    if play.now < DRIFT_S:
        await play.rest(DRIFT_S - play.now)
    samples = sorted([*record.skews, *((b.mono, b.skew) for b in record.beacons if b.robot == play.robot)])
    first = [skew for mono, skew in samples if mono <= samples[0][0] + WINDOW_S]
    last = [skew for mono, skew in samples if mono >= samples[-1][0] - WINDOW_S]
    seconds = samples[-1][0] - samples[0][0] - WINDOW_S
    if seconds < DRIFT_S / 2 or loop.time() - samples[-1][0] > WINDOW_S:
        play.give_up(Cause.BEACON_PERIOD, "messages of the robot for a minute", f"messages for {seconds:.0f} s")
    if abs(play.clock_step()) > CLOCK_SET_S:
        play.skip(f"The checker's own clock was set by {play.clock_step():.3f} s")
    speed = (max(last) - max(first)) / seconds
    play.result.measured.append(f"drift: {speed * 1e3:+.3f} ms each second")
    if abs(speed) > NOTED_DRIFT:
        play.find(Verdict.FAILED if abs(speed) > MOST_DRIFT else Verdict.QUIRK, Cause.CLOCK_DRIFT,
                  "a drift of at most 0.5 ms each second", f"{speed * 1e3:+.2f} ms each second")


SCENARIOS: Tuple[Scenario, ...] = (
    Scenario("bad-network", "A bad network", bad_network, bad_network=True),
    Scenario("stale", "Old datagrams", stale),
    Scenario("garbage", "Invalid datagrams", garbage),
    Scenario("large-beacon", "A beacon with many robots", large_beacon),
    Scenario("burst", "A burst of events", burst, code="HCFGAC"),
    Scenario("drift", "The robot's clock over a minute", drift),
)
