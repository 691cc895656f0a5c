"""docs/examples/my_ros2_robot.py, with an executor that has the methods of rclpy's."""

import asyncio
import importlib.util
import pathlib
import threading
from typing import Any, Callable, List

import pytest

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "docs" / "examples" / "my_ros2_robot.py"


def _example():
    spec = importlib.util.spec_from_file_location("my_ros2_robot", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Task:
    """Like rclpy.task.Task: callbacks come from the executor's thread, after a cancellation, too."""

    def __init__(self, method: Callable[..., Any], arguments: Any) -> None:
        self._method, self._arguments = method, arguments
        self._result = self._exception = None
        self._callbacks: List[Callable[[Any], None]] = []
        self.is_cancelled = False

    def __call__(self) -> None:
        try:
            result = self._method(*self._arguments)
            self._result = asyncio.run(result) if asyncio.iscoroutine(result) else result
        except Exception as error:
            self._exception = error
        for callback in self._callbacks:
            callback(self)

    def add_done_callback(self, callback: Callable[[Any], None]) -> None:
        self._callbacks.append(callback)

    def cancel(self) -> None:
        self.is_cancelled = True

    def result(self) -> Any:
        return self._result

    def exception(self) -> Any:
        return self._exception


class Executor:
    """Runs each task in a thread once `spin` is called."""

    def __init__(self) -> None:
        self.tasks: List[Task] = []
        self.created = asyncio.Event()

    def create_task(self, method: Callable[..., Any], *arguments: Any) -> Task:
        self.tasks.append(Task(method, arguments))
        self.created.set()
        return self.tasks[-1]

    def spin(self) -> threading.Thread:
        thread = threading.Thread(target=self.tasks[-1])
        thread.start()
        return thread


class Robot:
    def __init__(self) -> None:
        self.calls: List[Any] = []
        self.threads: List[int] = []

    def prepare(self, benchmark: str) -> None:
        self.calls.append(("prepare", benchmark))
        self.threads.append(threading.get_ident())

    async def execute(self, benchmark: str, goal: Any) -> str:
        if goal == "cliff":
            raise RuntimeError("too steep")
        return f"{benchmark} {goal}"

    def stop(self, why: str) -> None:
        self.calls.append(("stop", why))


def _story(story: Callable[[Any, Executor, Robot], Any]) -> None:
    async def played() -> None:
        robot, executor = Robot(), Executor()
        await story(_example().InExecutor(executor, robot), executor, robot)

    asyncio.run(played())


async def _through(behaviour: Any, executor: Executor, method: str, *arguments: Any) -> Any:
    running = asyncio.ensure_future(getattr(behaviour, method)(*arguments))
    await executor.created.wait()
    thread = executor.spin()
    try:
        return await running
    finally:
        thread.join()


def test_prepare_runs_in_the_executor() -> None:
    async def story(behaviour: Any, executor: Executor, robot: Robot) -> None:
        assert await _through(behaviour, executor, "prepare", "HNF") is None
        assert robot.calls == [("prepare", "HNF")]
        assert robot.threads != [threading.get_ident()]

    _story(story)


def test_execute_returns_the_result_of_the_robots_coroutine() -> None:
    async def story(behaviour: Any, executor: Executor, robot: Robot) -> None:
        assert await _through(behaviour, executor, "execute", "HNF", "door") == "HNF door"

    _story(story)


def test_an_exception_of_the_robot_reaches_the_client() -> None:
    async def story(behaviour: Any, executor: Executor, robot: Robot) -> None:
        with pytest.raises(RuntimeError, match="too steep"):
            await _through(behaviour, executor, "execute", "HNF", "cliff")

    _story(story)


def test_a_cancelled_phase_cancels_the_executors_task() -> None:
    async def story(behaviour: Any, executor: Executor, robot: Robot) -> None:
        running = asyncio.ensure_future(behaviour.execute("HNF", "door"))
        await executor.created.wait()
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
        assert executor.tasks[-1].is_cancelled
        # The task's end comes later, and harms nobody.
        executor.spin().join()

    _story(story)


def test_a_stop_reaches_the_robot_while_its_task_runs() -> None:
    async def story(behaviour: Any, executor: Executor, robot: Robot) -> None:
        running = asyncio.ensure_future(behaviour.execute("HNF", "door"))
        await executor.created.wait()
        behaviour.stop("the referee stopped the run")
        assert robot.calls == [("stop", "the referee stopped the run")]
        executor.spin().join()
        assert await running == "HNF door"

    _story(story)
