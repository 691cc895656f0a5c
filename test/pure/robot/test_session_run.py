"""The session in simulated time: a robot's way through its goals."""

import pytest

from helpers.robot_bench import BOX, PORT, UTC0, executing
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Goal

# The run.


def test_a_whole_goal(linked):
    linked.box_says(BoxState.STOP)
    assert linked.take_news() == [fx.BenchmarkIs("HGTKMH")]
    linked.box_says(BoxState.PREPARE)
    assert linked.take_news() == [fx.StateIs(RobotState.PREPARING), fx.Prepare("HGTKMH")]
    linked.box_says(BoxState.PREPARE)
    assert linked.take_news() == []
    linked.do("end_prepare")
    assert linked.last.robot_state == RobotState.WAITING_GOAL, "the box hears of it at once"
    linked.box_says(BoxState.WAITING_RESULT)
    assert linked.take_news() == [
        fx.StateIs(RobotState.WAITING_GOAL), fx.StateIs(RobotState.EXECUTING), fx.Execute("HGTKMH", None)
    ]
    linked.do("end_execute")
    assert linked.last.robot_state == RobotState.RESULT_TX
    linked.take_news()
    linked.box_says(BoxState.STOP)
    state, stop = linked.take_news()
    assert state == fx.StateIs(RobotState.STOP) and isinstance(stop, fx.Stop)


def test_a_goal_and_the_next_one(linked):
    executing(linked, "STB", generic_goal="goal: 1\n")
    assert linked.session.progress.goal == Goal(text="goal: 1\n")
    linked.do("end_execute", "SOME RESULT")
    linked.run(1)
    assert linked.last.generic_result == "SOME RESULT"
    assert linked.session.progress.goal is None
    linked.box_says(BoxState.PREPARE, "STB")
    assert linked.take_news(fx.Prepare) == [fx.Prepare("STB")]
    assert not linked.last.HasField("generic_result"), "a result belongs to its own goal"
    linked.do("end_prepare")
    linked.box_says(BoxState.GOAL_TX, "STB", generic_goal="goal: 2\n")
    assert linked.take_news(fx.Execute) == [fx.Execute("STB", Goal(text="goal: 2\n"))]
    linked.do("end_execute")
    assert not linked.last.HasField("generic_result")


def test_a_goal_that_cannot_be_read_is_reported_once_and_the_robot_waits(linked):
    linked.box_says(BoxState.PREPARE, "HNF")
    linked.do("end_prepare")
    linked.take_news()
    for _ in range(5):
        linked.box_says(BoxState.GOAL_TX, "HNF", generic_goal="north")
    assert [report.problem for report in linked.take_news()] == [fx.Problem.BAD_GOAL]
    assert linked.state is RobotState.WAITING_GOAL
    linked.box_says(BoxState.GOAL_TX, "HNF", generic_goal="[1, 2, 3]")
    assert linked.state is RobotState.EXECUTING


@pytest.mark.parametrize("prepared", [False, True])
def test_what_cannot_follow_stops_the_robot_and_is_reported_once(linked, prepared):
    if prepared:
        linked.box_says(BoxState.PREPARE)
    linked.run(2)
    linked.take_news()
    linked.take_sent()
    for _ in range(5):
        linked.box_says(BoxState.WAITING_RESULT)
    news = linked.take_news(fx.ProblemIs, fx.Stop)
    assert [type(effect) for effect in news] == ([fx.Stop, fx.ProblemIs] if prepared else [fx.ProblemIs])
    assert news[-1].problem is fx.Problem.UNEXPECTED_STATE
    assert linked.state is RobotState.STOP
    assert linked.sent[0][0] == linked.now, "the box hears at once that it has to begin again"
    linked.box_says(BoxState.PREPARE)
    assert linked.state is RobotState.PREPARING
    linked.take_news()
    linked.box_says(BoxState.WAITING_RESULT)
    assert len(linked.take_news(fx.ProblemIs)) == 1, "it passed, so it is news again"


def test_a_straggler_moves_nothing(linked):
    executing(linked, "HNF", generic_goal="[1, 2, 3]")
    older = linked.sent[0][1].time
    assert older != linked.last.time
    linked.box_says(BoxState.WAITING_RESULT, "HNF")
    for state in BoxState:
        linked.box_says(state, "HNF", acknowledge=older)
    # Also when the box has been saying the same for long.
    for _ in range(5):
        linked.run(1)
        linked.beacon()
        linked.box_says(BoxState.WAITING_RESULT, "HNF")
    for state in BoxState:
        linked.box_says(state, "HNF", acknowledge=older)
    assert linked.state is RobotState.EXECUTING
    assert linked.take_news() == []


def test_a_box_that_starts_again_is_obeyed(linked):
    executing(linked)
    # It has heard of no message of this robot, and none arrives.
    for _ in range(5):
        linked.run(0.5)
        linked.box_says(BoxState.STOP, acknowledge=pb.Time(sec=0, nsec=0))
    assert linked.state is RobotState.STOP


@pytest.mark.parametrize("before_run", [{"sec": int(UTC0) + 500, "nsec": 7}, {"sec": 0, "nsec": 0}])
def test_a_robot_obeys_once_the_box_acknowledges_a_message_of_this_run(bench, before_run):
    """A recorded PREPARE acknowledges a message of another run, or from before the robot's restart."""
    bench.beacon()
    bench.box_says(BoxState.STOP, acknowledge=pb.Time(**before_run))
    for _ in range(5):
        bench.box_says(BoxState.PREPARE, acknowledge=pb.Time(**before_run))
        bench.run(1)
    assert bench.state is RobotState.STOP
    bench.box_says(BoxState.PREPARE)
    assert bench.state is RobotState.PREPARING


def test_after_a_silence_of_the_box_no_recorded_state_moves_the_robot(linked):
    executing(linked, "HNF", generic_goal="[1, 2, 3]")
    older = linked.sent[0][1].time
    linked.box_says(BoxState.WAITING_RESULT, "HNF")
    linked.run(3)
    linked.take_news()
    for state in (BoxState.PREPARE, BoxState.GOAL_TX, BoxState.WAITING_RESULT):
        linked.box_says(state, "HNF", acknowledge=older)
    assert linked.state is RobotState.EXECUTING
    assert linked.take_news() == []


def test_the_benchmark_changes_within_a_channel(linked):
    executing(linked)
    linked.box_says(BoxState.PREPARE, "HWV")
    news = linked.take_news()
    assert [type(effect) for effect in news] == [fx.StateIs, fx.Stop, fx.BenchmarkIs, fx.StateIs, fx.Prepare]
    assert news[-1] == fx.Prepare("HWV")


@pytest.mark.parametrize("ask", [BoxState.PREPARE, BoxState.STOP])
@pytest.mark.parametrize("late", [BoxState.WAITING_RESULT, BoxState.GOAL_TX])
def test_the_last_goal_is_not_an_error_after_a_request_of_the_referee_or_a_module(linked, ask, late):
    """Both acknowledge the same message, for the robot said nothing new in between."""
    executing(linked, "HNF", target_pose_x=1.0, target_pose_y=2.0, target_pose_theta=3.0)
    linked.do("end_execute", None)
    linked.run(5)
    linked.box_says(BoxState.WAITING_RESULT, "HNF")
    newest = linked.last.time
    linked.box_says(ask, "HNF", acknowledge=newest)
    asked = linked.state
    linked.take_news()
    linked.box_says(late, "HNF", acknowledge=newest)
    assert linked.state is asked and linked.take_news() == []
    linked.run(2)
    linked.box_says(late, "HNF", acknowledge=newest)
    assert linked.take_news(fx.ProblemIs), "after so long it is no delayed message: report the robot's state to the box"


def test_the_result_waits_for_strings_that_no_message_carried_yet(linked):
    """The box may end the run at the first RESULT_TX, and a repeated text needs a round trip before that."""
    executing(linked, "STB", generic_goal="1")
    for text in ("on my way", "on my way"):
        linked.do("add_string", "notifications", text)
    begun = len(linked.sent)
    linked.do("end_execute", "done")
    linked.run(10)
    assert {message.robot_state for _, message in linked.sent[begun:]} == {RobotState.EXECUTING}
    linked.box_says(BoxState.WAITING_RESULT, "STB")
    assert not linked.last.notifications and linked.last.robot_state == RobotState.EXECUTING
    assert not linked.last.HasField("generic_result")
    linked.box_says(BoxState.WAITING_RESULT, "STB")
    assert list(linked.last.notifications) == ["on my way"]
    assert linked.last.robot_state == RobotState.RESULT_TX and linked.last.generic_result


# The owner plays the box.


def _by_hand(bench, state, code="HGTKMH", acknowledge=(0, 0), **fields):
    message = pb.BenchmarkState(benchmark_type=code, benchmark_state=int(state), **fields)
    message.acknowledgement.sec, message.acknowledgement.nsec = acknowledge
    bench.session.override(bench.now, message)
    bench.poll()


def test_an_override_runs_through_a_benchmark_and_sends_nothing(bench):
    beacons = len(bench.beacons)
    for state, expected in (
        (BoxState.STOP, RobotState.STOP), (BoxState.PREPARE, RobotState.PREPARING),
        (None, RobotState.WAITING_GOAL), (BoxState.GOAL_TX, RobotState.EXECUTING),
        (BoxState.WAITING_RESULT, RobotState.EXECUTING),
    ):
        if state is None:
            bench.do("end_prepare")
        else:
            _by_hand(bench, state, "HNF")
        assert bench.state is expected
        bench.run(2)
    assert fx.Execute("HNF", None) in bench.take_news()
    assert len(bench.beacons) == beacons
    assert bench.last.robot_state == RobotState.EXECUTING, "what would be sent can be seen"


def test_an_override_closes_the_channel_and_ignores_the_box(linked):
    executing(linked)
    _by_hand(linked, BoxState.PREPARE, "HWV")
    assert fx.CloseChannel in map(type, linked.take_news())
    linked.beacon()
    linked.box_says(BoxState.STOP)
    linked.run(20)
    assert linked.state is RobotState.PREPARING
    assert linked.take_news(fx.OpenChannel, fx.ProblemIs) == []
    linked.session.override(linked.now, None)
    linked.poll()
    assert linked.state is RobotState.STOP and linked.session.progress.benchmark is None
    linked.beacon()
    assert fx.OpenChannel(BOX, PORT) in linked.take_news()


def test_an_acknowledgement_typed_by_hand_ends_strings(bench):
    _by_hand(bench, BoxState.PREPARE, "HWV")
    bench.do("add_string", "visitor", "Deli Man")
    bench.run(1)
    assert list(bench.last.visitor) == ["Deli Man"]
    _by_hand(bench, BoxState.PREPARE, "HWV", acknowledge=(int(UTC0) + 100, 0))
    _by_hand(bench, BoxState.PREPARE, "HWV")
    bench.run(2)
    assert list(bench.last.visitor) == []
    # The owner may leave the time out afterwards: by hand nothing is ever overtaken.
    _by_hand(bench, BoxState.STOP, "HWV", acknowledge=(int(UTC0) + 100, 0))
    _by_hand(bench, BoxState.PREPARE, "HWV")
    assert bench.state is RobotState.PREPARING


def test_an_override_that_was_not_ends_nothing(linked):
    executing(linked)
    linked.session.override(linked.now, None)
    linked.poll()
    assert linked.state is RobotState.EXECUTING


def test_a_result_that_leaves_no_room_for_strings_waits_until_the_box_has_them(linked):
    executing(linked, "FetchMug", generic_goal="{}")
    linked.do("add_string", "notifications", "x" * 400)
    linked.run(0.1)
    linked.do("end_execute", "y" * 890)
    linked.run(1)
    assert linked.session.progress.state is RobotState.RESULT_TX
    assert linked.last.robot_state == RobotState.EXECUTING, "the box may end the run at the first RESULT_TX"
    assert not linked.last.HasField("generic_result")
    linked.box_says(BoxState.WAITING_RESULT, "FetchMug")  # it acknowledges the string
    assert linked.last.robot_state == RobotState.RESULT_TX
    assert (linked.last.generic_result, list(linked.last.notifications)) == ("y" * 890, [])
