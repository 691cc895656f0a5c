"""Whether a run counts, and why or why not, in words.

The core and the programs of results decide it (`core.scoring.counting`) and name it by a word. Panels, terminals, pages
and exports show these texts.
"""

from roah_rsbb.wording.language import tr, tr_later

_TEXTS = {
    "counts": tr_later("counts"),
    "counts_as_zero": tr_later("counts as 0"),
    "not_over": tr_later("is not over"),
    "never_started": tr_later("does not count: never started"),
    "all_robots": tr_later("no score: all robots at once"),
    "excluded": tr_later("does not count: excluded"),
    "not_signed_off": tr_later("does not count: not signed off"),
    "not_last": tr_later("does not count: a later attempt counts"),
    "not_best": tr_later("does not count: a better attempt counts"),
    "ran": tr_later("does not count: a run of the team at this event counts"),
    "no_score": tr_later("no score"),
}


def counting_text(word: str) -> str:
    """Return whether a run counts, and why or why not; a word of a newer version is shown unchanged."""
    return tr(_TEXTS.get(word, word))


def with_counting(state: str, word: str, only_unusual: bool = False) -> str:
    """Return the state of a run, followed by whether it counts. The state alone says that a run is not over.
    `only_unusual`: only if the run does not count as it is."""
    silent = ("", "not_over", "never_started", *(("counts", "all_robots") if only_unusual else ()))
    return state if word in silent else f"{state}, {counting_text(word)}"
