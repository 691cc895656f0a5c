"""What a link record says in a few lines."""

from typing import List, Sequence

from roah_rsbb.results.run_result import LinkSecond
from roah_rsbb.wording.result_texts import line

# A silence that is more than a single datagram that was lost.
GAP_S = 2.5


def link_lines(link: Sequence[LinkSecond]) -> List[str]:
    """The whole record of a robot's link in words; none if there is no record."""
    if not link:
        return []
    samples = [second.sample for second in link]
    received, lost = sum(s.received for s in samples), sum(s.lost for s in samples)
    due = received + lost
    share = f" ({lost / due:.1%})" if due else ""
    lines = [
        f"{received} messages in {sum(s.seconds for s in samples):.0f} s; {lost} lost on the way to the box{share}, "
        f"{sum(s.duplicates for s in samples)} twice, {sum(s.stale for s in samples)} overtaken, "
        f"{sum(s.unreadable for s in samples)} unreadable",
        f"longest silence {max(s.gap_s for s in samples):.1f} s; seconds with a silence over {GAP_S:g} s: "
        f"{sum(1 for s in samples if s.gap_s > GAP_S)}; latest message {max(s.late_s for s in samples):.3f} s behind",
        f"{sum(s.answers for s in samples)} reactions to the box, {sum(s.unanswered for s in samples)} datagrams of "
        "the box that the robot knew nothing of half a second later",
    ]
    trips = [s.round_trip_s for s in samples if s.round_trip_s is not None]
    longest = [s.round_trip_max_s for s in samples if s.round_trip_max_s is not None]
    if trips:
        lines.append(
            f"round trip with the robot's own delay: {min(trips):.3f} s at best, {max(longest):.3f} s at worst")
    skews = [s.skew_s for s in samples if s.skew_s is not None]
    if skews:
        lines.append(f"clock skew {min(skews):+.3f} s to {max(skews):+.3f} s")
    hosts = list(dict.fromkeys(s.host for s in samples if s.host))
    if hosts:
        lines.append(f"robot's address: {', '.join(line(host) for host in hosts)}")
    return lines
