"""Converts between the values of core and benchmarking modules and ROS messages, for both sides.

No message causes an exception: the data of modules is limited (`limits.py`), both before sending and on arrival.
`HostedModule` limits the progress of its module before sending, so that an invalid value ends only that run.

ZoneScoreGroup, which original panels read, only knows yes-or-no items and counts. There, other numbers appear as counts
without their decimals, and 0 if they are negative; choices and ratings do not appear.
"""

from typing import Dict, Iterable, List, Optional, Sequence, Tuple

from roah_rsbb.bmbox.host.limits import MAX_LIST, MAX_SCORES, checked_info, checked_state
from roah_rsbb.model.modules import (
    ModuleInfo,
    ModulesState,
    OutcomeKind,
    Progress,
    Request,
    RequestKind,
    RequestOutcome,
    RunForModule,
    ScoreValue,
    Step,
)
from roah_rsbb.model.scoring import ScoreGroup, ScoreKind, ScoringItem
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.msg import ModuleInfo as ModuleInfoMsg
from roah_rsbb.msg import (
    ModuleOutcome,
    ModuleProgress,
    ModuleRequest,
    ModuleRun,
    ModuleRuns,
    ModuleScore,
    ModuleStep,
    ZoneScoreGroup,
)
from roah_rsbb.msg import ModulesState as ModulesStateMsg

_REQUEST_KINDS = {int(kind): kind for kind in RequestKind}
_OUTCOME_KINDS = {int(kind): kind for kind in OutcomeKind}


# -- from the modules -------------------------------------------------------------------------------
_KINDS = {kind.word: kind for kind in ScoreKind}
# How ZoneScoreGroup shows the types that it can show.
_OLD_TYPES = {
    ScoreKind.BOOL: ZoneScoreGroup.SCORING_BOOL, ScoreKind.UINT: ZoneScoreGroup.SCORING_UINT,
    ScoreKind.INT: ZoneScoreGroup.SCORING_UINT, ScoreKind.DECIMAL: ZoneScoreGroup.SCORING_UINT,
}


def modules_state_message(state: ModulesState) -> ModulesStateMsg:
    """Convert the state of a node with modules. The progress of each module is within the limits already."""
    return ModulesStateMsg(
        node=state.node,
        modules=[_info_message(checked_info(info)) for info in state.modules],
        progress=[_progress_message(progress) for progress in state.progress],
    )


def modules_state_of(message: ModulesStateMsg) -> ModulesState:
    """Convert the state of a node with modules."""
    return checked_state(ModulesState(
        message.node,
        tuple(map(_info_of, message.modules[:MAX_LIST])),
        tuple(_progress_of(progress) for progress in message.progress[:MAX_LIST]),
    ))


def _info_message(info: ModuleInfo) -> ModuleInfoMsg:
    """Convert a benchmark. The message has no field for the zone, so the zone follows the code, after a blank."""
    return ModuleInfoMsg(f"{info.benchmark} {info.zone}" if info.zone else info.benchmark, info.problems, info.warnings)


def _info_of(message: ModuleInfoMsg) -> ModuleInfo:
    code, _, zone = message.benchmark.partition(" ")
    return ModuleInfo(code, tuple(message.problems[:MAX_LIST]), tuple(message.warnings[:MAX_LIST]), zone)


def _progress_message(progress: Progress) -> ModuleProgress:
    return ModuleProgress(
        run=progress.run,
        attempt=progress.attempt,
        request=ModuleRequest() if progress.request is None else _request_message(progress.request),
        scores=[score_message(score) for score in progress.scores],
        status=progress.status,
        warnings=list(progress.warnings),
        kept=progress.kept,
        finished=progress.finished,
        failed=progress.failed,
    )


def _progress_of(message: ModuleProgress) -> Progress:
    request, failed = None, message.failed
    if message.request.number:
        request = _request_of(message.request)
        if request is None:
            failed = failed or (f"its request has the unknown kind {message.request.kind}: check that core and "
                                "module have the same version")
    return Progress(
        message.run, message.attempt, request, tuple(score_of(score) for score in message.scores[:MAX_SCORES]),
        message.status, tuple(message.warnings[:MAX_LIST]), message.kept, message.finished, failed,
    )


# -- from the core ----------------------------------------------------------------------------------


def runs_message(box_uuid: str, runs: Iterable[RunForModule]) -> ModuleRuns:
    """Convert the runs with modules."""
    return ModuleRuns(box_uuid, [_run_message(run) for run in runs])


def runs_of(message: ModuleRuns) -> Tuple[RunForModule, ...]:
    """Convert the runs with modules. Unreadable runs, from another version of the core, are omitted."""
    return tuple(run for run in map(_run_of, message.runs) if run is not None)


def _run_message(run: RunForModule) -> ModuleRun:
    return ModuleRun(
        **{name: value for name, value in zip(run._fields, run) if name not in ("sheet", "steps")},
        sheet=[group_message(group) for group in run.sheet],
        steps=[ModuleStep(_request_message(step.request), _outcome_message(step.outcome)) for step in run.steps],
    )


def _run_of(message: ModuleRun) -> Optional[RunForModule]:
    steps = [_step_of(step) for step in message.steps]
    if None in steps:
        return None
    plain = {name: getattr(message, name) for name in RunForModule._fields if name not in ("sheet", "steps")}
    return RunForModule(**plain, sheet=tuple(map(group_of, message.sheet)), steps=tuple(steps))


def _step_of(message: ModuleStep) -> Optional[Step]:
    request = _request_of(message.request)
    if request is None:
        return None
    if message.outcome.kind == ModuleOutcome.PENDING:
        return Step(request)
    kind = _OUTCOME_KINDS.get(message.outcome.kind)
    return None if kind is None else Step(request, _outcome_of(kind, message.outcome))


# -- requests and outcomes --------------------------------------------------------------------------


def _request_message(request: Request) -> ModuleRequest:
    return ModuleRequest(**{**request._asdict(), "kind": int(request.kind), "pose": request.pose or ()})


def _request_of(message: ModuleRequest) -> Optional[Request]:
    """Convert a request; None if its kind is unknown."""
    kind = _REQUEST_KINDS.get(message.kind)
    if kind is None:
        return None
    return Request(
        message.number, kind, message.text, message.form, message.goal,
        tuple(message.pose) or None, tuple(map(bool, message.initial_state)), tuple(message.switches), message.timeout,
        message.note,
    )


def _outcome_message(outcome: Optional[RequestOutcome]) -> ModuleOutcome:
    return ModuleOutcome() if outcome is None else ModuleOutcome(**{**outcome._asdict(), "kind": int(outcome.kind)})


def _outcome_of(kind: OutcomeKind, message: ModuleOutcome) -> RequestOutcome:
    return RequestOutcome(
        kind, message.values, message.result, message.executing_s, message.ended_utc, tuple(message.changed),
        message.damaged,
    )


def group_message(group: ScoreGroup) -> ZoneScoreGroup:
    """A group of the referee's scoring items."""
    return _old_group(group.name, [(item.kind, item.desc, value) for item, value in group.items])


def old_groups(items: Iterable[SheetItem]) -> List[ZoneScoreGroup]:
    """A score sheet, group by group."""
    groups: Dict[str, List[Tuple[ScoreKind, str, int]]] = {}
    for item in items:
        groups.setdefault(item.group, []).append((_KINDS[item.type], item.desc, item.value))
    return [_old_group(name, group) for name, group in groups.items()]


def _old_group(name: str, items: Sequence[Tuple[ScoreKind, str, int]]) -> ZoneScoreGroup:
    shown = [item for item in items if item[0] in _OLD_TYPES]
    return ZoneScoreGroup(
        group_name=name,
        types=bytes(_OLD_TYPES[kind] for kind, _, _ in shown),
        descriptions=[desc for _, desc, _ in shown],
        current_values=[max(0, value) for _, _, value in shown],
    )


def group_of(message: ZoneScoreGroup) -> ScoreGroup:
    """A group of the referee's scoring items; items of unknown type are counts."""
    kinds = {int(kind): kind for kind in ScoreKind}
    return ScoreGroup(message.group_name, tuple(
        (ScoringItem(message.group_name, desc, kinds.get(kind, ScoreKind.UINT)), value)
        for kind, desc, value in zip(message.types, message.descriptions, message.current_values)
    ))


def score_message(score: ScoreValue) -> ModuleScore:
    """A line of a module's score."""
    return ModuleScore(*score)


def score_of(message: ModuleScore) -> ScoreValue:
    """A line of a module's score."""
    return ScoreValue(message.group, message.name, message.value, message.unit, message.desc)
