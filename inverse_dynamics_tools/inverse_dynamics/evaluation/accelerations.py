# SPDX-License-Identifier: Apache-2.0
"""Joint accelerations of a recording, estimated in C++, and what was found in its samples.

The rules are those of inverse_dynamics_evaluation/samples.hpp. What they find is said in words in
any case; they are acted upon unless they are switched off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from inverse_dynamics._core import FilterChoice, SampleReport
    from inverse_dynamics.base.arrays import Floats, Mask
    from inverse_dynamics.data.joint_log import JointLog

# What each rule does, as --help says it.
RULES = {
    "repeated": "samples that repeat the one before are left out of the differentiation",
    "non-increasing": "so are those whose stamp isn't later than all before it",
    "time-base": "stamps that positions and velocities contradict give way to equal distances",
    "start-transient": "efforts that jump at the very start don't count in the second metrics",
}


@dataclass(frozen=True)
class Accelerations:
    """How accelerations were estimated."""

    method: str  # low-pass, given or backward-difference
    cutoff: float | None = None  # Hz; gain one half there
    chosen: bool = False  # whether the cut-off was chosen from the data
    order: int | None = None  # of the Butterworth filter that runs forwards and backwards
    time_base: str = "stamps"  # when samples were taken: stamps, regular, regular_fresh

    @property
    def summary(self) -> str:
        """In words, as titles and tables show it."""
        if self.method == "given":
            return "given by the recording"
        if self.cutoff is None:
            return f"{self.method}, no filter"
        how = "chosen from the data" if self.chosen else "given"
        return f"zero-phase low-pass, cut-off {self.cutoff:.3g} Hz ({how}), then derivative"


# Names of the masks of Samples, as files have them.
MASKS = ("repeated", "non_increasing", "start_transient", "isolated", "kept")


@dataclass(frozen=True)
class Samples:
    """What was found in N samples."""

    repeated: Mask  # (N,) repeats the sample before
    non_increasing: Mask  # (N,) not later than all before it
    start_transient: Mask  # (N,) efforts jump as a controller takes over
    isolated: Mask  # (N,) between gaps, in a piece too short to be filtered
    kept: Mask  # (N,) counts in the second metrics
    period: float  # s, mean distance
    jitter: float  # s, root mean square of the stamps' deviation from it

    @property
    def left_out(self) -> int:
        """How many samples don't count in the second metrics."""
        return int((~self.kept).sum())


def estimate_accelerations(
    log: JointLog,
    method: str = "auto",
    cutoff: float | None = None,
    without_rules: Collection[str] = (),
) -> tuple[Floats, Accelerations, Samples, list[str]]:
    """Accelerations (N, n) of a recorded motion, how they came about, what was found, in words too.

    method: one of METHODS. cutoff: Hz, of a low-pass; None: chosen from the data. without_rules:
    those of RULES that aren't to be acted upon.

    Raises EvaluationError.
    """
    from inverse_dynamics import _core
    from inverse_dynamics.errors import EvaluationError
    from inverse_dynamics.robot.choices import METHODS

    if method not in METHODS:
        raise EvaluationError(
            f"accelerations: expected one of {', '.join(METHODS)}, got '{method}'"
        )
    for rule in without_rules:
        if rule not in RULES:
            raise EvaluationError(f"rules: expected some of {', '.join(RULES)}, got '{rule}'")
    rules = _core.SampleRules(
        **{rule.replace("-", "_"): rule not in without_rules for rule in RULES}
    )
    time = log.time
    if method == "auto":
        method = "low-pass" if log.qdd is None or cutoff is not None else "given"
    if method in ("given", "backward-difference"):
        if cutoff is not None:
            raise EvaluationError(
                f"accelerations: {method} has no cut-off, got {cutoff:g} Hz; use low-pass"
            )
        report = _core.examine_samples(time, log.q, log.qd, log.effort, rules)
        qdd = _core.backward_difference(time, log.qd) if method != "given" else log.qdd
        if qdd is None:
            raise EvaluationError(
                "accelerations: the recording gives none; expected another method, such as auto"
            )
        return qdd, Accelerations(method), _samples(report), _findings(log, report, None)
    qdd, choice, report = _core.low_pass_accelerations(
        time, log.q, log.qd, log.effort, cutoff or 0.0, rules
    )
    how = Accelerations("low-pass", choice.cutoff, choice.chosen, choice.order, choice.time_base)
    return qdd, how, _samples(report), _findings(log, report, choice)


def _findings(log: JointLog, report: SampleReport, choice: FilterChoice | None) -> list[str]:
    """What is odd about the samples and what follows, one sentence each."""
    from inverse_dynamics import _core

    return _core.sample_findings(log.stamps, log.clock, report, choice)


def _samples(report: SampleReport) -> Samples:
    names = ("repeated", "non_increasing", "start_transient", "isolated", "kept")
    masks = {name: getattr(report, name) for name in names}
    return Samples(**masks, period=report.period, jitter=report.jitter)
