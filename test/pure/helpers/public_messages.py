"""The public messages of a core, as plain objects."""

from types import SimpleNamespace

NOW = 1_800_000_000.0  # 2027-01-15 08:00:00 UTC


class Time(float):
    """A ROS time or duration."""

    def to_sec(self):
        return float(self)


def event(zone="Home", team="Alpha", after_s=600.0):
    return SimpleNamespace(zone=zone, team=team, benchmark="Visitors", round=2, run=3, scheduled=Time(NOW + after_s))


def run(phase="running", counting=True, left=90.0, end_reason="", elapsed=None, activity="", clock=NOW, **of_event):
    """A run; with `elapsed` seconds it has no limit."""
    return SimpleNamespace(
        event=event(**of_event), teams=["Alpha"], phase=phase, end_reason=end_reason, counting=counting,
        ends=Time(clock + left if counting and elapsed is None else 0.0), left=Time(left if elapsed is None else 0.0),
        unlimited=elapsed is not None, elapsed=Time(elapsed or 0.0), activity=activity,
    )


def result(team="Alpha", value=3):
    group = SimpleNamespace(group_name="Achievements", types=b"\x01\x00", descriptions=["doors", "greeted"],
                            current_values=[value, 1])
    score = SimpleNamespace(group="", name="error", value="0.5", unit="m", desc="Distance")
    points = SimpleNamespace(total="4.5", groups=[SimpleNamespace(name="Achievements", points="4.5")])
    return SimpleNamespace(event=event(team=team), end_reason="completed", disconnected=Time(NOW - 60.0),
                           scoring=[group], not_attempted=[0], module_scores=[score], points=points)


def details(runs=(), following=(), clock=NOW, finished=()):
    return SimpleNamespace(clock=Time(clock), box_uuid="box", results="scores", runs=list(runs),
                           following=list(following), finished=list(finished))


def board(results=(), provisional=(), standings=()):
    return SimpleNamespace(box_uuid="box", results=list(results), provisional=list(provisional),
                           standings=list(standings))


def standing():
    return SimpleNamespace(benchmark="Visitors", criteria=["Achievements"],
                           ranks=[SimpleNamespace(rank="1", team="Alpha", numbers=["4.5"])])


def explanation(zone="Home", doing="executing", kind="task", **fields):
    said = SimpleNamespace(robot="", kind="visitor", text="Postman", received=Time(NOW - 5.0))
    made = {"languages": ["en", "de"], "about": ["Visitors ring.", "Besucher klingeln."], "phases": [], "phase": 0,
            "waypoints": False, "goals": 0, "goals_ended": 0, "goals_completed": 0, "said": [said], **fields}
    return SimpleNamespace(zone=zone, doing=doing, kind=kind, **made)


def explained(*runs):
    return SimpleNamespace(box_uuid="box", runs=list(runs))
