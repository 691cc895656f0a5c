"""Builds the message with results and standings for the public."""

from typing import List, Mapping, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.scoring.counting import Choice
from roah_rsbb.core.views.public import PublicResults, PublicView
from roah_rsbb.model.clock import Now
from roah_rsbb.msg import PublicBoard, PublicRank, PublicStanding
from roah_rsbb.nodes.core.public_convert import result_message
from roah_rsbb.results.standings import Standing, criteria_of, number_cells, rank_text, standings


class PublicBoardMaker:
    """Makes the message /core/public_board of a box when its content has changed."""

    def __init__(self, box: Box, box_uuid: str, titles: Mapping[str, str]) -> None:
        """`titles`: what the benchmarks are called, by their codes."""
        self._box = box
        self._box_uuid = box_uuid
        self._titles = titles
        self._shown: Optional[Tuple[object, ...]] = None

    def use(self, titles: Mapping[str, str]) -> None:
        """Take other titles. The rules of the standings may be others, too."""
        self._titles, self._shown = titles, None

    def take(self, now: Now, view: PublicView) -> Optional[PublicBoard]:
        """Return the message if it differs from that of the last call; None: it does not."""
        ruled = self._box.scores.rulings(now)
        # A signed-off run never changes, so its identity is enough.
        counting = tuple(r.record.identity for r in ruled if r.counts and r.record.sign_off is not None)
        shown = (view.finished, view.provisional, counting)
        if shown == self._shown:
            return None
        self._shown = shown
        ranked: List[Standing] = []
        if view.results is PublicResults.SCORES:
            choice = Choice(signed_off=True, events=self._box.finished.event_rules())
            records = [ruling.record for ruling in ruled]
            ranked = standings(records, self._box.finished.ranking, choice, self._titles)
        return PublicBoard(
            box_uuid=self._box_uuid,
            results=[result_message(result) for result in view.finished],
            provisional=[result_message(result) for result in view.provisional],
            standings=[_standing(standing) for standing in ranked if standing.lines],
        )


def _standing(standing: Standing) -> PublicStanding:
    ranks = [PublicRank(rank_text(team), team.team, number_cells(standing, team)) for team in standing.lines]
    return PublicStanding(standing.title or standing.benchmark, criteria_of(standing), ranks)
