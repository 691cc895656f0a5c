"""`results try`: what rules give for cases that somebody wrote down."""

import argparse
import json
import os
from typing import Any, Dict, Mapping

from roah_rsbb.results.cases import CaseAnswer, CaseRules, answer, differences, read_cases, read_folder
from roah_rsbb.results.league_tables import case_of
from roah_rsbb.results.runs import NotPossible
from roah_rsbb.scoring.tree import number_text
from roah_rsbb.wording.texts import did_you_mean, visible

# Of cases that name none.
DEFAULT = "athome2026"


def try_cases(options: argparse.Namespace) -> int:
    """Print what the cases of a file give."""
    cases = [case_of(options.file)] if options.file.endswith(".csv") else read_cases(options.file)
    rules: Dict[str, CaseRules] = {}
    answers = [_answer(options, case, rules) for case in cases]
    wrong = [differences(case, found) for case, found in zip(cases, answers)]
    if options.json:
        found = [{"id": case.get("id", ""), **own.as_json()} for case, own in zip(cases, answers)]
        print(json.dumps(answers[0].as_json() if len(found) == 1 else found, ensure_ascii=False, indent=1))
    else:
        for case, own, differs in zip(cases, answers, wrong):
            _show(case, own)
            for each in differs:
                print(f"  WRONG: {each}")
    return 1 if any(wrong) else 0


def _answer(options: argparse.Namespace, case: Mapping[str, Any], known: Dict[str, CaseRules]) -> CaseAnswer:
    """Return what the rules give for a case. Errors name it, and its rules where it names none."""
    try:
        return answer(case, _rules(options, case, known))
    except NotPossible as error:
        by = "" if options.rulebook or case.get("rulebook") else (
            f" (it names no rulebook, so it is of {DEFAULT}; others with --rulebook)")
        raise NotPossible(f"case {_name(case)!r}{by}: {error}") from None


def _name(case: Mapping[str, Any]) -> str:
    return str(case.get("id") or case.get("sheet") or "case")


def _rules(options: argparse.Namespace, case: Mapping[str, Any], known: Dict[str, CaseRules]) -> CaseRules:
    """Return the rules of a case. `known`: those that were read before."""
    folder, decisions = _folder(options, case), case.get("decisions", {})
    key = json.dumps([folder, decisions], sort_keys=True)
    if key not in known:
        known[key] = read_folder(folder, options.config_dir, decisions)
    return known[key]


def _folder(options: argparse.Namespace, case: Mapping[str, Any]) -> str:
    name = str(options.rulebook or case.get("rulebook") or DEFAULT)
    included = os.path.join(options.config_dir, "rulebooks")
    names = sorted(os.listdir(included)) if os.path.isdir(included) else []
    found = os.path.join(included, name) if name in names else name
    if not os.path.isdir(found):
        raise NotPossible(f"no rulebook {name!r} (a folder is given by its path){did_you_mean(name, names)}")
    return found


def _show(case: Mapping[str, Any], found: CaseAnswer) -> None:
    name = visible(_name(case))
    if found.standings is None:
        print(f"{name}: {number_text(found.points)}")
    else:
        places = [", ".join(place) for place in found.standings["ranking"]]
        print(f"{name}: {' > '.join(map(visible, places))}")
    for step in found.steps:
        print(f"  {visible(step)}")
