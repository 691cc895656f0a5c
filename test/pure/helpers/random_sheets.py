"""Random score sheets with every kind of rule, and marks on them."""

from decimal import Decimal

from roah_rsbb.model.rules import ItemChoice, JuryResult
from roah_rsbb.model.scoring import GroupLimits, ScoreKind, ScoringItem, SheetForm, SheetRules, TimeLeft
from roah_rsbb.scoring.points import text_of
from roah_rsbb.scoring.sheet import Mark

TIME_LIMIT_S = 300.0


def decimal(chance, low, high):
    """A random number with up to three decimals."""
    decimals = chance.randint(0, 3)
    return Decimal(chance.randint(low * 10**decimals, high * 10**decimals)).scaleb(-decimals)


def maybe(chance, value):
    """The value, or None."""
    return value if chance.random() < 0.5 else None


def _item(chance, group, number, earlier):
    kind = chance.choice(list(ScoreKind))
    points = decimal(chance, -50, 100) if chance.random() < 0.8 else None
    fields = {}
    if kind is ScoreKind.CHOICE:
        given = chance.random() < 0.8
        fields["choices"] = tuple(
            ItemChoice(f"answer {n}", decimal(chance, -20, 50) if given else None) for n in range(chance.randint(2, 4)))
        points = None
    elif kind is ScoreKind.RATING:
        fields.update(judges=tuple(f"judge {n}" for n in range(chance.randint(1, 5))), least=Decimal(0),
                      most=Decimal(10), jury=chance.choice(list(JuryResult)))
    elif kind is not ScoreKind.BOOL:
        fields["most"] = maybe(chance, Decimal(chance.randint(5, 20)))
    needs = tuple(chance.sample(earlier, min(len(earlier), chance.choice([0, 0, 0, 1, 2]))))
    return ScoringItem(group, f"item {number}", kind, points, needs=needs, **fields)


def _limits(chance):
    low = maybe(chance, Decimal(chance.randint(-60, 0)))
    return low, maybe(chance, Decimal(chance.randint(1, 150)))


def random_form(chance):
    """A score sheet that gives points."""
    items = [ScoringItem("group 0", "always", ScoreKind.BOOL, decimal(chance, 1, 50))]
    for number in range(chance.randint(1, 12)):
        group = f"group {chance.randint(0, 3)}"
        items.append(_item(chance, group, number, [item.key for item in items]))
    with_points = sorted({item.group for item in items if item.has_points})
    groups = tuple(GroupLimits(name, *_limits(chance)) for name in with_points if chance.random() < 0.5)
    bonus = maybe(chance, TimeLeft(decimal(chance, 0, 3), Decimal(chance.randint(1, 20)),
                                   maybe(chance, Decimal(chance.randint(1, 100))),
                                   tuple(chance.sample([item.key for item in items], chance.randint(0, 1)))))
    return SheetForm(tuple(items), SheetRules(groups, *_limits(chance), bonus), TIME_LIMIT_S)


def random_mark(chance, form):
    """A valid mark of an item."""
    item = chance.choice(form.items)
    if chance.random() < 0.1:
        return Mark(*item.key, not_attempted=True)
    if item.kind is ScoreKind.BOOL:
        return Mark(*item.key, chance.randint(0, 1))
    if item.kind in (ScoreKind.UINT, ScoreKind.INT):
        return Mark(*item.key, chance.randint(0 if item.kind is ScoreKind.UINT else -5, 5))
    if item.kind is ScoreKind.DECIMAL:
        return Mark(*item.key, text=text_of(decimal(chance, -5, 5)))
    if item.kind is ScoreKind.CHOICE:
        return Mark(*item.key, text=chance.choice(["", *(choice.name for choice in item.choices)]))
    rating = str(decimal(chance, 0, 10)) if chance.random() < 0.9 else ""
    return Mark(*item.key, text=rating, judge=chance.choice(item.judges))
