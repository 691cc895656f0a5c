"""The public display: the clock, the current runs with their countdowns, the next events, and results.

It has no controls. Colours are dim, for a hall in the evening; colour is never the only sign.
"""

import time
from typing import List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.box_clock import BoxClock
from roah_rsbb.rqt.public import layout
from roah_rsbb.rqt.public.layout import Rect, Screen
from roah_rsbb.rqt.qt import QColor, QFont, QFontMetricsF, QPainter, QPixmap, QRectF, QSizeF, Qt, QWidget
from roah_rsbb.rqt.widgets.marked_title import MarkedTitle
from roah_rsbb.wording import public as content
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.public import ListLine, PublicContent, RunCard
from roah_rsbb.wording.replay import MARK

# A long text shrinks to at most this share of its size. If it is still too long, it is shortened: it must stay legible.
SMALLEST = 0.7


class Written(NamedTuple):
    """A text on the screen."""

    text: str
    shown: str  # the same, or shortened
    place: Rect  # the space given to it
    ink: Rect  # the space that it takes
    pixels: int  # size of the letters


class Writer:
    """Writes texts with a painter and records their places."""

    def __init__(self, painter: QPainter) -> None:
        self._painter = painter
        self.written: List[Written] = []

    def write(
        self, place: Rect, text: str, colour: QColor, fill: float = 0.7, side=Qt.AlignLeft, bold: bool = False
    ) -> None:
        """Write one line. Its letters fill the share `fill` of the height of `place`."""
        if not text or place.w <= 0:
            return
        pixels = int(fill * place.h)
        smallest = max(1, int(SMALLEST * pixels))
        # Font sizes are whole pixels: the width is not exactly proportional.
        while pixels > smallest and width(text, pixels, bold) > place.w:
            pixels -= 1
        font = _font(pixels, bold)
        metrics = QFontMetricsF(font)
        shown = text
        if metrics.horizontalAdvance(text) > place.w:
            # Leave a margin: kerning makes the elided text slightly wider than calculated.
            shown = metrics.elidedText(text, Qt.ElideRight, place.w - 0.2 * pixels)
        area = QRectF(*place)
        self._painter.setFont(font)
        self._painter.setPen(colour)
        flags = int(side | Qt.AlignVCenter | Qt.TextSingleLine)
        self._painter.drawText(area, flags, shown)
        ink = metrics.boundingRect(area, flags, shown)
        self.written.append(Written(text, shown, place, Rect(ink.x(), ink.y(), ink.width(), ink.height()), pixels))


def width(text: str, pixels: float, bold: bool = False) -> float:
    """Return the width of a text at this font size."""
    return QFontMetricsF(_font(pixels, bold)).horizontalAdvance(text)


def _font(pixels: float, bold: bool) -> QFont:
    font = QFont()
    font.setPixelSize(max(1, int(pixels)))
    font.setBold(bold)
    return font


TOPIC = "/core/public_details"
BOARD_TOPIC = "/core/public_board"
# The core publishes twice a second, with its clock in every message. A repeated message may be the latched one of a
# core that hangs.
SILENT_S = 1.5
PAGE_S = 8.0
# Letters fill this share of the height of a row.
LETTERS = 0.64
# … but they are smaller than the teams of the runs, by this factor at least.
BELOW_TEAMS = 0.92
# Share of the height of the scores' rows.
SCORES_LETTERS = 0.72

BACKGROUND = QColor("#0b1220")
TEXT = QColor("#e8ecf4")
FAINT = QColor("#9fb0c8")
RUNNING = QColor("#f2c94c")
CARD_BACKGROUND = QColor("#1b2a44")
OLD_BACKGROUND = QColor("#7a1020")


class _Look(NamedTuple):
    """Colours of a card."""

    stripe: QColor
    team: QColor
    big: QColor


LOOKS = {
    "connected": _Look(FAINT, TEXT, FAINT),
    "running": _Look(RUNNING, TEXT, RUNNING),
    "ended": _Look(CARD_BACKGROUND.lighter(150), FAINT, TEXT),
}
# Scores begin to the right of their row, by this share of the screen's height.
SCORES_INDENT = 0.06

# The title of a page, its list, and the rows that are on it.
_Page = Tuple[str, Sequence[ListLine], Sequence[layout.Block]]

OLD_LOOK = _Look(CARD_BACKGROUND, FAINT, FAINT)


class PublicDisplay(QWidget):
    """A full-screen widget. `feed` is a `roah_rsbb.ros.feed.Feed` of TOPIC and BOARD_TOPIC."""

    def __init__(self, feed, page_s: float = PAGE_S, title: str = "", logo: Optional[QPixmap] = None) -> None:
        """`page_s`: how long each page is shown if there are several, seconds. `title`, `logo`: of the competition."""
        super().__init__()
        self.setWindowTitle(tr("RoAH RSBB – public display"))
        self._marked_title = MarkedTitle(self)
        self.setCursor(Qt.BlankCursor)
        self.setFocusPolicy(Qt.NoFocus)
        self.written: List[Written] = []  # everything on the screen
        self.content: PublicContent = content.NOTHING
        self._feed = feed
        self._page_s = page_s
        self._page = 0
        self._title = title
        self._logo = logo
        self._details = None
        self._board = None
        self._clock = BoxClock()
        self._heard: Optional[float] = None

    def look(self) -> None:
        """Show the newest message at the current time. Call it several times a second."""
        received = self._feed.take(TOPIC)
        if received is not None and received.message != self._details:
            self._details, self._heard = received.message, received.mono
            self._clock.sample(received.mono, received.message.clock.to_sec())
        board = self._feed.take(BOARD_TOPIC)
        if board is not None:
            self._board = board.message
        is_old, now = self.is_old, time.monotonic()
        utc_s = self._details.clock.to_sec() if is_old and self._details else self._clock.now(now)
        shown = (content.content(self._details, utc_s, is_old, self._board), int(now / self._page_s))
        if shown != (self.content, self._page):
            self.content, self._page = shown
            self._marked_title.show(self.content.is_replay)
            self.update()

    @property
    def is_old(self) -> bool:
        """Whether the core has been silent for too long."""
        return self._heard is None or time.monotonic() - self._heard > SILENT_S

    # -- painting -----------------------------------------------------------------------------------

    def paintEvent(self, event) -> None:
        painter = QPainter(self)
        painter.setRenderHints(QPainter.TextAntialiasing | QPainter.Antialiasing)
        painter.fillRect(self.rect(), BACKGROUND)
        writer = Writer(painter)
        screen = Screen(self.width(), self.height())
        if self.content.is_known:
            self._paint_all(painter, writer, screen)
        else:
            middle = Rect(screen.edge, 0.4 * screen.height, screen.width - 2 * screen.edge, 0.2 * screen.height)
            writer.write(middle, tr(content.WAITING), FAINT, 0.4, Qt.AlignHCenter)
        self.written = writer.written

    def _paint_all(self, painter: QPainter, writer: Writer, screen: Screen) -> None:
        shown = layout.pages(self.content.cards, layout.CARDS_ON_A_PAGE)
        number = self._page % len(shown)
        self._paint_head(painter, writer, screen, _page_mark(tr(content.RUNS), number, len(shown)))
        places = screen.cards(len(shown[number]))
        for card, place in zip(shown[number], places):
            self._paint_card(painter, writer, card, place)
        if not self.content.cards:
            writer.write(places[0], tr(content.NOTHING_RUNS), TEXT)
        self._paint_below(writer, screen, screen.below(places))

    def _paint_head(self, painter: QPainter, writer: Writer, screen: Screen, page: str) -> None:
        head = screen.head()
        if self.content.trouble:
            painter.fillRect(QRectF(0, 0, screen.width, head.h - screen.edge / 2), OLD_BACKGROUND)
            writer.write(head._replace(h=head.h - screen.edge / 2), self.content.trouble, TEXT, 0.5, Qt.AlignHCenter)
            return
        if self._logo is not None:
            head = self._paint_logo(painter, head, screen)
        date_wide, middle_wide = (0.6, 0.12) if self._title else (0.5, 0.2)
        date, middle, clock = head.columns(screen.edge, date_wide * head.w, middle_wide * head.w)
        if self._title:
            title, date = date.rows(0.6, 0.4)
            writer.write(title, self._title, TEXT, 0.68, bold=True)
            writer.write(date, self.content.date, FAINT, 0.62)
        else:
            writer.write(date, self.content.date, FAINT, 0.4)
        if self.content.is_replay:
            painter.fillRect(QRectF(*middle), OLD_BACKGROUND)
            writer.write(middle, tr(MARK), TEXT, 0.5, Qt.AlignHCenter, bold=True)
        else:
            writer.write(middle, page, FAINT, 0.4, Qt.AlignHCenter)
        writer.write(clock, self.content.clock, TEXT, 0.7, Qt.AlignRight)

    def _paint_logo(self, painter: QPainter, head: Rect, screen: Screen) -> Rect:
        """Paint the logo at the left, as high as the head; returns the rest of the head."""
        edge = 0.15 * head.h
        shown = QSizeF(self._logo.size()).scaled(0.2 * head.w, head.h - 2 * edge, Qt.KeepAspectRatio)
        area = QRectF(head.x, head.y + (head.h - shown.height()) / 2, shown.width(), shown.height())
        painter.setRenderHint(QPainter.SmoothPixmapTransform)
        painter.drawPixmap(area, self._logo, QRectF(self._logo.rect()))
        gone = shown.width() + screen.edge / 2
        return head._replace(x=head.x + gone, w=head.w - gone)

    def _paint_card(self, painter: QPainter, writer: Writer, card: RunCard, place: Rect) -> None:
        look = OLD_LOOK if self.content.trouble else LOOKS.get(card.phase, OLD_LOOK)
        edge = 0.12 * place.h
        painter.setPen(Qt.NoPen)
        painter.setBrush(CARD_BACKGROUND)
        painter.drawRoundedRect(QRectF(*place), edge / 2, edge / 2)
        painter.setBrush(look.stripe)
        painter.drawRoundedRect(QRectF(place.x, place.y, edge, place.h), edge / 2, edge / 2)
        inside = Rect(place.x + 2 * edge, place.y + edge / 3, place.w - 3 * edge, place.h - 2 * edge / 3)
        parts = layout.card_parts(place, inside, Screen(self.width(), self.height()))
        writer.write(parts.team, card.team, look.team, bold=True)
        writer.write(parts.benchmark, card.benchmark, look.team)
        writer.write(parts.place, card.place, FAINT)
        writer.write(parts.big, card.big, look.big, 0.8, Qt.AlignRight, bold=True)
        if card.is_paused:
            band = QRectF(*parts.word)
            painter.fillRect(band, look.big)
            writer.write(parts.word, card.word, CARD_BACKGROUND, side=Qt.AlignHCenter, bold=True)
        else:
            writer.write(parts.word, card.word, look.big, side=Qt.AlignRight)

    def _paint_below(self, writer: Writer, screen: Screen, area: Rect) -> None:
        """Paint the next events, standings and pages of results in turns."""
        unit = screen.unit
        teams = [one.pixels for one in writer.written if one.text in {card.team for card in self.content.cards}]
        fill = min([LETTERS, *(BELOW_TEAMS * pixels / (layout.ROW * unit) for pixels in teams)])
        rest = Rect(area.x, area.y + layout.TITLE * unit, area.w, area.h - layout.TITLE * unit)
        pages = self._pages(area, rest, unit)
        title, lines, blocks = pages[self._page % len(pages)]
        writer.write(area._replace(h=layout.TITLE * unit), title, FAINT, 0.72)
        if blocks:
            self._paint_lines(writer, lines, blocks, rest, unit, fill)
        else:
            writer.write(rest._replace(h=layout.ROW * unit), tr(content.SCHEDULE_IS_DONE), TEXT, fill)

    def _pages(self, area: Rect, rest: Rect, unit: float) -> List[_Page]:
        shown = self.content
        following = shown.following[:layout.rows_that_fit(area, unit)]
        blocks = tuple(layout.Block(row, ()) for row in range(len(following)))
        found: List[_Page] = [(tr(content.NEXT), following, blocks)]
        lists = [
            *((content.standing_title(standing.title), standing.lines) for standing in shown.standings),
            (tr(content.RESULTS), shown.results), (tr(content.PROVISIONAL), shown.provisional),
        ]
        for title, lines in lists:
            if not lines:
                continue
            parts = layout.filled(self._blocks(lines, rest, unit), rest.h / unit)
            found += [(_page_mark(title, i, len(parts)) or title, lines, part) for i, part in enumerate(parts)]
        return found

    def _blocks(self, lines: Sequence[ListLine], rest: Rect, unit: float) -> List[layout.Block]:
        """Return the rows of a list with their scores, in as many lines as they need."""
        pixels = int(SCORES_LETTERS * layout.SCORES_ROW * unit)
        wide = rest.w - SCORES_INDENT * unit - 0.2 * pixels
        return [
            layout.Block(row, layout.wrapped(line.scores, lambda text: width(text, pixels) <= wide))
            for row, line in enumerate(lines)
        ]

    def _paint_lines(
        self, writer: Writer, lines: Sequence[ListLine], blocks: Sequence[layout.Block], area: Rect, unit: float,
        fill: float,
    ) -> None:
        gap = 0.03 * unit
        fill, times, teams, benchmarks = _columns(
            [lines[block.row] for block in blocks], fill, layout.ROW * unit, area.w - 3 * gap)
        colour = FAINT if self.content.trouble else TEXT
        top = area.y
        for block in blocks:
            line = lines[block.row]
            row = Rect(area.x, top, area.w, layout.ROW * unit)
            when, team, benchmark, last = row.columns(gap, times, teams, benchmarks)
            writer.write(when, line.time, FAINT, fill)
            writer.write(team, line.team, colour, fill, bold=True)
            writer.write(benchmark, line.benchmark, colour, fill)
            writer.write(last, line.last, FAINT, fill, Qt.AlignRight)
            top = row.bottom
            for text in block.lines:
                indent = SCORES_INDENT * unit
                scores = Rect(row.x + indent, top, row.w - indent, layout.SCORES_ROW * unit)
                writer.write(scores, text, FAINT, SCORES_LETTERS)
                top = scores.bottom


def _columns(lines: Sequence[ListLine], fill: float, high: float, wide: float) -> Tuple[float, float, float, float]:
    """Return the share of a row's height that its letters fill, and the widths of time, team and benchmark.

    Where a row needs more than `wide`, all of its letters are made smaller, down to `SMALLEST`. Only then are the
    other columns limited to a share of the row, so that the benchmark's title has the rest.
    """
    letters = fill * high
    needed = (
        1.02 * max(width(line.time, letters) for line in lines),
        1.02 * max(width(line.team, letters, bold=True) for line in lines),
        1.02 * max(width(line.benchmark, letters) for line in lines),
        1.02 * max(width(line.last, letters) for line in lines),
    )
    scale = max(SMALLEST, min(1.0, wide / sum(needed)))
    times, teams, benchmarks, lasts = (scale * each for each in needed)
    if times + teams + benchmarks + lasts > wide:
        times, teams, lasts = min(times, 0.2 * wide), min(teams, 0.3 * wide), min(lasts, 0.22 * wide)
    return scale * fill, times, teams, wide - times - teams - lasts


def _page_mark(title: str, number: int, count: int) -> str:
    """Return which page of several is shown; empty if there is only one."""
    return f"{title} {number + 1}/{count}" if count > 1 else ""
