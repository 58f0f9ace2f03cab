# SPDX-License-Identifier: Apache-2.0
"""Which causes `ids evaluate` names for recordings whose mistakes are known (known_mistakes.py).

    ./scripts/causes_study                       # prints what is wrong, and the table
    ./scripts/causes_study --seed 7 --keep DIR   # another set, left in DIR; or the one that is there
    ./scripts/causes_study --write               # replaces the table in docs/why_dont_my_torques_match.md

Right: each mistake is named, with its joints, alone or together with a rival that the recording can't tell
from it. Missed: nothing or friction alone is named, or one mistake of two. Wrong: any other cause, without the right
one. Undecided: nothing is named where two mistakes were made, which is as good as both.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections import Counter
from dataclasses import asdict, dataclass, replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from described_arms import ARMS
from known_mistakes import Mistake, Recording, real_recordings, recordings

from inverse_dynamics import evaluate
from inverse_dynamics.errors import BagError
from inverse_dynamics.evaluation.causes.compare import Cause
from inverse_dynamics.evaluation.effort import DATA
from inverse_dynamics.robot.robots import load_robot, robot_of_description

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from inverse_dynamics.evaluation.evaluation import Evaluation

PAGE = Path(__file__).parent.parent / "docs" / "why_dont_my_torques_match.md"
BEGIN, END = "<!-- scripts/causes_study: begin -->", "<!-- scripts/causes_study: end -->"
SEED, EACH = 201, 5
MOST_ANGLE = 20.0  # degrees, of a direction of gravity
MOST_RATIO = 1.25  # of a scale


@dataclass(frozen=True)
class Outcome:
    """What was named for a recording."""

    recording: str
    mistakes: tuple[Mistake, ...]
    named: tuple[Cause, ...]

    @property
    def verdict(self) -> str:
        """right, missed, undecided, wrong, false alarm.

        Undecided: nothing is named where two mistakes were made, which is as good as both.
        """
        accused = [cause for cause in self.named if cause.kind != "friction"]
        if not self.mistakes:
            return "false alarm" if accused else "right"
        if all(any(_means(cause, m) for cause in self.named) for m in self.mistakes):
            return "right"
        if not accused:
            return "missed" if len(self.mistakes) == 1 else "undecided"
        true = all(any(_means(cause, m) for m in self.mistakes) for cause in accused)
        return "missed" if true else "wrong"

    @property
    def kinds(self) -> str:
        """Those of the mistakes."""
        return " and ".join(mistake.kind for mistake in self.mistakes) or "none"


def _means(cause: Cause, mistake: Mistake) -> bool:
    """Whether a cause is the mistake, with its joints and about its number."""
    if cause.kind != mistake.kind:
        named = {cause.kind, *(f"{cause.kind} of {joint}" for joint in cause.joints)}
        return bool(named & set(mistake.alike))
    if mistake.joints and set(cause.joints) != set(mistake.joints):
        return False
    stated, true = (
        np.atleast_1d(np.array(x, float)) for x in (cause.value or 1, mistake.value or 1)
    )
    if cause.kind == "gravity":
        cosine = stated @ true / np.linalg.norm(stated) / np.linalg.norm(true)
        return bool(cosine > np.cos(np.radians(MOST_ANGLE)))
    if cause.kind == "effort_scale":
        return bool(abs(np.log(np.median(stated) / np.median(true))) < np.log(MOST_RATIO))
    return True


def make(directory: Path, made: Iterable[Recording]) -> None:
    """Writes a set: recordings, descriptions, truth.json."""
    truth = {}
    for recording in made:
        recording.write(directory)
        arm = recording.draft.arm
        truth[recording.name] = {
            "robot": recording.robot or {"root": arm.root, "tip": arm.tip},
            "mistakes": [asdict(mistake) for mistake in recording.mistakes],
        }
    (directory / "truth.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")


def outcomes_of(directory: Path) -> list[Outcome]:
    """Of a set, without recordings that reading refuses; prints those that aren't right."""
    outcomes = []
    for name, truth in json.loads((directory / "truth.json").read_text(encoding="utf-8")).items():
        given = truth["robot"]
        if isinstance(given, str):
            robot = load_robot(given)
        else:
            robot = replace(robot_of_description(directory / f"{name}.urdf"), **given)
        mistakes = tuple(
            Mistake(m["kind"], tuple(m["joints"]), m["value"], tuple(m["alike"]))
            for m in truth["mistakes"]
        )
        try:
            found = evaluate(directory / f"{name}.csv", robot)
        except BagError as error:  # stamps in ms: reading refuses them, so no cause is named
            print(f"{'refused':11} {name}: {error}", flush=True)
            continue
        outcome = Outcome(name, mistakes, _named(found))
        outcomes.append(outcome)
        if outcome.verdict != "right":
            print(f"{outcome.verdict:11} {name}: {_short(outcome)}", flush=True)
    return outcomes


def _named(result: Evaluation) -> tuple[Cause, ...]:
    """The causes, and what efforts were found to mean."""
    if result.effort.meaning == "torque_without_gravity" and result.effort.stated_by == DATA:
        found = Cause(
            "no_gravity", (), None, 0.0, 0.0, result.effort.summary, "gravity is left out"
        )
        return (found, *result.diagnosis)
    return result.diagnosis


def table_of(outcomes: Sequence[Outcome]) -> str:
    """One row for each kind of mistake: what was named, and what instead."""
    rows = [
        "| mistake | recordings | right | missed | undecided | wrong | named instead |",
        "|---|---|---|---|---|---|---|",
    ]
    for kinds in dict.fromkeys(outcome.kinds for outcome in outcomes):
        rows.append(_row(kinds, [o for o in outcomes if o.kinds == kinds]))
    return "\n".join([*rows, _row("all", outcomes)])


def _row(kinds: str, members: Sequence[Outcome]) -> str:
    count = Counter(outcome.verdict for outcome in members)
    wrong = [o for o in members if o.verdict in ("wrong", "false alarm")]
    instead = Counter(" and ".join(sorted({c.kind for c in o.named})) for o in wrong)
    named = ", ".join(f"{name} ({n})" for name, n in instead.most_common())
    cells = [kinds, len(members), *(count[v] for v in ("right", "missed", "undecided")), len(wrong)]
    return f"| {' | '.join(map(str, cells))} | {named} |"


def shares_of(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """Of recordings with mistakes: wrong causes; of one mistake: missed; without: accused."""

    def share(verdict: str, among: Sequence[Outcome]) -> float:
        return sum(o.verdict == verdict for o in among) / max(len(among), 1)

    return {
        "wrong": share("wrong", [o for o in outcomes if o.mistakes]),
        "missed": share("missed", [o for o in outcomes if len(o.mistakes) == 1]),
        "false alarm": share("false alarm", [o for o in outcomes if not o.mistakes]),
    }


def _short(outcome: Outcome) -> str:
    told = "; ".join(f"{c.kind} ({' '.join(c.joints)}) {c.text}" for c in outcome.named)
    truth = [f"{m.kind} {' '.join(m.joints)} {m.value or ''}".strip() for m in outcome.mistakes]
    return f"{' and '.join(truth) or 'none'} is called: {told or 'nothing'}"


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--each", type=int, default=EACH, help="recordings of each kind")
    parser.add_argument("--arms", nargs="+", choices=ARMS, default=tuple(ARMS))
    parser.add_argument("--wheels", type=Path, default=Path("out/wheels"), help="of descriptions")
    parser.add_argument("--keep", type=Path, help="directory of the set; made if it isn't there")
    parser.add_argument("--write", action="store_true", help="replace the table in docs")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        directory = arguments.keep or Path(temporary)
        for needed in (arguments.wheels, directory):
            needed.mkdir(parents=True, exist_ok=True)
        if not (directory / "truth.json").exists():
            simulated = recordings(arguments.seed, arguments.wheels, arguments.arms, arguments.each)
            bags = Path(os.environ["IDS_DATA_DIR"]) / "bags"
            make(directory, chain(simulated, real_recordings(bags, arguments.seed)))
        outcomes = outcomes_of(directory)
    shares = ", ".join(f"{name} {100 * share:.1f} %" for name, share in shares_of(outcomes).items())
    table = f"{table_of(outcomes)}\n\nOf all: {shares}."
    print(f"\n{table}")
    if arguments.write:
        before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
        PAGE.write_text(
            f"{before}{BEGIN}\n\n{table}\n\n{END}{rest.split(END)[1]}", encoding="utf-8"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
