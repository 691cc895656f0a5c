"""The layout of the public display: rectangles and pages. Qt is not imported.

The display is read from ten metres, so sizes are shares of the screen's height rather than of the desktop's font. A
capital letter of 1/25 of the height of a 55 inch screen is 27 mm high, which is legible from ten metres. What does not
fit continues on further pages, which take turns.
"""

from typing import Callable, List, NamedTuple, Sequence, Tuple, TypeVar

T = TypeVar("T")

# Shares of the screen's height.
HEAD = 0.13
EDGE = 0.03
GAP = 0.02
TITLE = 0.065
ROW = 0.085
SCORES_ROW = 0.065  # under a row
# Height of a run's card, by the number of cards in a column.
CARD = (0.3, 0.235, 0.19)
# Limits of a page; more than one column of cards stands side by side.
CARDS_IN_A_COLUMN = 3
CARDS_ON_A_PAGE = 6
# A countdown's share of the width of a card in one column, and in two.
COUNTDOWN, NARROW_COUNTDOWN = 0.28, 0.42


class Rect(NamedTuple):
    """In pixels."""

    x: float
    y: float
    w: float
    h: float

    @property
    def bottom(self) -> float:
        """The lower edge."""
        return self.y + self.h

    @property
    def right(self) -> float:
        """The right edge."""
        return self.x + self.w

    def rows(self, *shares: float) -> List["Rect"]:
        """Return rectangles below each other, each with its share of the height."""
        tops = [self.y + self.h * sum(shares[:i]) for i in range(len(shares))]
        return [Rect(self.x, top, self.w, self.h * share) for top, share in zip(tops, shares)]

    def columns(self, gap: float, *widths: float) -> List["Rect"]:
        """Return rectangles side by side with these widths and gaps; one more takes the rest."""
        found, x = [], self.x
        for width in widths:
            found.append(Rect(x, self.y, max(0.0, min(width, self.right - x)), self.h))
            x += width + gap
        return [*found, Rect(x, self.y, max(0.0, self.right - x), self.h)]


class Screen(NamedTuple):
    """The parts of a screen of this size."""

    width: float
    height: float

    @property
    def unit(self) -> float:
        """The unit of all sizes: the height, or less on a screen narrower than 16:9."""
        return min(self.height, self.width * 9 / 16)

    @property
    def edge(self) -> float:
        """The margin at the sides."""
        return EDGE * self.unit

    def head(self) -> Rect:
        """The place of date, clock and warnings."""
        return Rect(self.edge, 0, self.width - 2 * self.edge, HEAD * self.unit)

    def cards(self, count: int) -> List[Rect]:
        """Return the places of a page's runs; without runs, the place of the line that says so."""
        top, wide = HEAD * self.unit, self.width - 2 * self.edge
        if count == 0:
            return [Rect(self.edge, top, wide, ROW * self.unit)]
        columns = 1 if count <= CARDS_IN_A_COLUMN else 2
        in_a_column = -(-count // columns)
        gap = GAP * self.unit
        high = CARD[in_a_column - 1] * self.unit
        each = (wide - gap * (columns - 1)) / columns
        return [
            Rect(self.edge + (i % columns) * (each + gap), top + (i // columns) * high, each, high - gap)
            for i in range(count)
        ]

    def below(self, cards: Sequence[Rect]) -> Rect:
        """Return the place of the next events or results."""
        top = max(card.bottom for card in cards) + GAP * self.unit / 2
        return Rect(self.edge, top, self.width - 2 * self.edge, self.height - top)


class CardParts(NamedTuple):
    """The places of a card's texts."""

    team: Rect
    benchmark: Rect
    place: Rect
    big: Rect
    word: Rect


def wide_card(inside: Rect) -> CardParts:
    """Return the parts of a card in one column: the countdown stands at the right."""
    gap = 0.1 * inside.h
    left, right = inside.columns(gap, (1 - COUNTDOWN) * inside.w)
    return CardParts(*left.rows(0.44, 0.32, 0.24), *right.rows(0.66, 0.34))


def flat_card(inside: Rect) -> CardParts:
    """Return the parts of one of three cards in a column: two lines of large letters."""
    gap = 0.1 * inside.h
    left, right = inside.columns(gap, (1 - COUNTDOWN) * inside.w)
    upper, benchmark = left.rows(0.53, 0.47)
    team, place = upper.columns(gap, 0.55 * upper.w)
    return CardParts(team, benchmark, place, *right.rows(0.66, 0.34))


def card_parts(place: Rect, inside: Rect, screen: Screen) -> CardParts:
    """Return the parts of a card at `place`, with its texts `inside`."""
    if place.w < 0.6 * screen.width:
        return narrow_card(inside)
    return flat_card(inside) if place.h < CARD[-1] * screen.unit else wide_card(inside)


def narrow_card(inside: Rect) -> CardParts:
    """Return the parts of a card in two columns: the benchmark's name has the whole width."""
    gap = 0.1 * inside.h
    upper, benchmark, lower = inside.rows(0.5, 0.28, 0.22)
    team, big = upper.columns(gap, (1 - NARROW_COUNTDOWN) * inside.w)
    place, word = lower.columns(gap, (1 - NARROW_COUNTDOWN) * inside.w)
    return CardParts(team, benchmark, place, big, word)


def rows_that_fit(area: Rect, unit: float) -> int:
    """Return how many rows without scores fit below the title in an area."""
    return max(1, int((area.h - TITLE * unit) / (ROW * unit) + 1e-6))


def wrapped(parts: Sequence[str], fits: Callable[[str], bool]) -> Tuple[str, ...]:
    """Distributes parts over lines of limited width, so that nothing is cut.

    A line breaks between parts, or else between the words of a part that is too long, or else within a word.
    """
    lines: List[str] = []
    for part in parts:
        joined = f"{lines[-1]} · {part}" if lines else part
        if lines and fits(joined):
            lines[-1] = joined
        else:
            lines += _broken(part, fits)
    return tuple(lines)


def _broken(text: str, fits: Callable[[str], bool]) -> List[str]:
    """Breaks a text that is too long."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".lstrip()
        if fits(longer):
            lines[-1] = longer
            continue
        if lines[-1]:
            lines.append("")
        while not fits(word) and len(word) > 1:
            end = max((n for n in range(1, len(word)) if fits(word[:n])), default=1)
            lines[-1:] = [word[:end], ""]
            word = word[end:]
        lines[-1] = word
    return lines if lines != [""] else []


class Block(NamedTuple):
    """A row of a list with the lines below it. `row` is its index in the list."""

    row: int
    lines: Tuple[str, ...]

    @property
    def height(self) -> float:
        """In shares of the screen's height."""
        return ROW + SCORES_ROW * len(self.lines)


def filled(blocks: Sequence[Block], high: float) -> List[Tuple[Block, ...]]:
    """Distributes blocks over pages of this height; a block that is higher continues on further pages.

    `high` is a share of the screen's height. Each page has one line of a block at least.
    """
    found: List[List[Block]] = [[]]
    left = high
    most = max(1, int((high - ROW) / SCORES_ROW + 1e-6))
    for block in blocks:
        pieces = [block.lines[n:n + most] for n in range(0, len(block.lines), most)] or [()]
        for piece in pieces:
            part = block._replace(lines=piece)
            if part.height > left + 1e-6 and found[-1]:
                found.append([])
                left = high
            found[-1].append(part)
            left -= part.height
    return [tuple(page) for page in found]


def pages(items: Sequence[T], on_a_page: int) -> List[Tuple[T, ...]]:
    """Distributes items evenly over pages of limited size; without items there is one empty page."""
    count = max(1, -(-len(items) // on_a_page))
    each, more = divmod(len(items), count)
    found, begin = [], 0
    for number in range(count):
        end = begin + each + (number < more)
        found.append(tuple(items[begin:end]))
        begin = end
    return found
