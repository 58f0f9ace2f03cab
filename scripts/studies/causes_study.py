# SPDX-License-Identifier: Apache-2.0
"""Which causes `ids evaluate` names for recordings whose mistakes are known (known_mistakes.py).

Right: each mistake is named, with its joints, alone or together with a rival that the recording can't tell
from it. Missed: nothing or friction alone is named, or one mistake of two. Wrong: any other cause, without the right
one. Undecided: nothing is named where two mistakes were made, which is as good as both.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from known_mistakes import Mistake, real_recordings, recordings
from studies import show, table

from inverse_dynamics import evaluate
from inverse_dynamics.diagnosis.compare import Cause
from inverse_dynamics.errors import BagError
from inverse_dynamics.public_recordings.public_recordings import data_directory

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from known_mistakes import Recording

    from inverse_dynamics.evaluation.evaluation import Evaluation

WHEELS = Path("out/wheels")  # of descriptions
EACH = 5  # recordings of each kind
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
        """right, missed, undecided, wrong, false alarm."""
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

    def __str__(self) -> str:
        told = "; ".join(f"{c.kind} ({' '.join(c.joints)}) {c.text}" for c in self.named)
        truth = [f"{m.kind} {' '.join(m.joints)} {m.value or ''}".strip() for m in self.mistakes]
        return f"{' and '.join(truth) or 'none'} is called: {told or 'nothing'}"


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


def outcomes_of(made: Iterable[Recording], directory: Path) -> list[Outcome]:
    """Of recordings that are written to a directory, if reading accepts them; prints those that aren't right."""
    outcomes = []
    for recording in made:
        bag, robot = recording.write(directory)
        try:
            named = _named(evaluate(bag, robot))
        except BagError as error:  # stamps in ms: reading refuses them, so no cause is named
            print(f"{'refused':11} {recording.name}: {error}", flush=True)
            continue
        outcomes.append(Outcome(recording.name, recording.mistakes, named))
        if outcomes[-1].verdict != "right":
            print(f"{outcomes[-1].verdict:11} {recording.name}: {outcomes[-1]}", flush=True)
    return outcomes


def _named(result: Evaluation) -> tuple[Cause, ...]:
    """The causes, and what efforts were found to mean."""
    by_data = result.effort.stated_by == "found from the data"
    if result.effort.meaning == "torque_without_gravity" and by_data:
        found = Cause(
            "no_gravity", (), None, 0.0, 0.0, result.effort.summary, "gravity is left out"
        )
        return (found, *result.diagnosis)
    return result.diagnosis


def table_of(outcomes: Sequence[Outcome]) -> str:
    """One row for each kind of mistake that isn't always named; one for the others, for none and for all."""
    names = ("mistake", "recordings", "right", "missed", "undecided", "wrong", "named instead")
    poor = dict.fromkeys(o.kinds for o in outcomes if o.verdict != "right" and o.mistakes)
    rows = {kind: [o for o in outcomes if o.kinds == kind] for kind in poor}
    rows["others"] = [o for o in outcomes if o.mistakes and o.kinds not in poor]
    rows["none"] = [o for o in outcomes if not o.mistakes]
    rows["all"] = list(outcomes)
    return table(names, [_cells(name, members) for name, members in rows.items()])


def _cells(kinds: str, members: Sequence[Outcome]) -> tuple[object, ...]:
    count = Counter(outcome.verdict for outcome in members)
    wrong = [o for o in members if o.verdict in ("wrong", "false alarm")]
    instead = Counter(" and ".join(sorted({c.kind for c in o.named})) for o in wrong)
    named = ", ".join(f"{name} ({n})" for name, n in instead.most_common())
    others = (count[verdict] for verdict in ("right", "missed", "undecided"))
    return (kinds, len(members), *others, len(wrong), named)


def shares_of(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """Of recordings with mistakes: wrong causes; of one mistake: missed; without: accused."""

    def share(verdict: str, among: Sequence[Outcome]) -> float:
        return sum(o.verdict == verdict for o in among) / max(len(among), 1)

    return {
        "wrong": share("wrong", [o for o in outcomes if o.mistakes]),
        "missed": share("missed", [o for o in outcomes if len(o.mistakes) == 1]),
        "false alarm": share("false alarm", [o for o in outcomes if not o.mistakes]),
    }


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=201)
    parser.add_argument("--keep", type=Path, help="directory for the set")
    parser.add_argument("--write", action="store_true", help="replace the table in docs")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        directory = arguments.keep or Path(temporary)
        for needed in (WHEELS, directory):
            needed.mkdir(parents=True, exist_ok=True)
        simulated = recordings(arguments.seed, WHEELS, each=EACH)
        real = real_recordings(data_directory() / "bags", arguments.seed)
        outcomes = outcomes_of(chain(simulated, real), directory)
    shares = ", ".join(f"{name} {100 * share:.1f} %" for name, share in shares_of(outcomes).items())
    text = f"{table_of(outcomes)}\n\nOf all: {shares}."
    show(text, "why_dont_my_torques_match.md", "causes_study")


if __name__ == "__main__":
    main()
