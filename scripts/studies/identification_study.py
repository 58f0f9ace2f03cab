# SPDX-License-Identifier: Apache-2.0
"""Models of real robots, known robots and payloads: tables of docs/identification_results.md.

All is what `ids identify` does by default.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from known_truth import MOST_ERROR, Truth
from payload_truth import STEP, Arm, trials
from studies import ROBOTS, identified, recording_of, show, table

from inverse_dynamics.identification.tables import held_out_table

SEEDS = 10
TRIALS = 100
# Robot, kg, s; whether everything is chosen without the window, too; whether also with an uncertain arm.
LOADS = (
    ("panda", 1.0, 4.0, False, True),
    ("panda", 1.0, 4.0, True, False),
    ("panda", 1.0, 8.0, False, True),
    ("panda", 1.0, 8.0, True, True),
    ("ur10", 5.0, 4.0, False, True),
    ("ur10", 5.0, 8.0, False, True),
)

KNOWN = f"""\
## Robots that are known

[Rehearsals](identification.md#rehearsal-would-my-motion-be-enough) of the models found above, identified from the
description alone. Medians of {SEEDS} seeds: mean error of torques on states uniform in the recorded ranges; error of
the delay; share of 95 % intervals that hold the truth.
"""

PAYLOADS = f"""\
## Payloads

{TRIALS} simulated loads per row, up to 15 cm in front of the flange, on torques of the real arms, in windows that the
arm's model isn't fitted to, one every {STEP:g} s. *Nested*: law, prior strength and delay are chosen outside of the
window, too. *Uncertain arm*: the arm's errors are estimated. Medians.
"""


def real_robot(name: str) -> str:
    """The section of a robot."""
    errors = held_out_table(identified(name))
    headings = ("joint", *errors.headings[2:-1], "in 95 % band")
    rows = [
        (joint, *(f"{value:.3g}" for value in rmse), f"{percent:.1f} %")
        for joint, _, *rmse, percent in errors.rows
    ]
    return f"### {name}: {ROBOTS[name]}\n\n{table(headings, rows)}\n"


def known_robots(directory: Path) -> str:
    """The section of simulated robots."""
    rows = []
    for arm, most in MOST_ERROR.items():
        name = f"{arm}_real"
        truth = Truth.of(recording_of(name), arm, directory, identified(name))
        results = [truth.identified_again(seed) for seed in range(SEEDS)]
        errors = [result.mean for result in results]
        delays = [1e3 * abs(result.delay_error) for result in results]
        inside = np.mean([result.inside for result in results])
        rows.append(
            (
                arm,
                f"{np.median(errors):.3g} N m ({min(errors):.3g} to {max(errors):.3g})",
                f"{most:g} N m",
                f"{np.median(delays):.2g} ms, at most {max(delays):.2g} ms",
                f"{1e3 * truth.most_delay_error:.3g} ms",
                f"{100 * inside:.1f} %",
            )
        )
    names = (
        "robot",
        "error (range)",
        "bound",
        "error of the delay",
        "bound",
        "intervals that hold",
    )
    return f"{KNOWN}\n{table(names, rows)}\n"


def payloads(directory: Path) -> str:
    """The section of simulated loads."""
    rows = []
    for name, mass, seconds, nested, uncertain in LOADS:
        found = identified(f"{name}_real")
        arm = Arm.of(found, directory, seconds=seconds, nested=nested)
        label = f"{name}, {mass:g} kg, {seconds:g} s{', nested' if nested else ''}"
        rows.append(_cells(label, arm.taken_for_exact(), mass))
        if uncertain:
            rows.append(_cells(f"{label}, uncertain arm", arm, mass))
    names = ("load", "mass", "center", "intervals that hold", "half width by error: mass", "center")
    return f"{PAYLOADS}\n{table(names, rows)}\n"


def _cells(label: str, arm: Arm, mass: float) -> tuple[str, ...]:
    found = trials(arm, mass, TRIALS)
    return (
        label,
        f"{100 * found.mass:.2g} %",
        f"{1e3 * found.center:.2g} mm",
        f"{100 * found.coverage:.0f} %",
        f"{found.ratio_of_mass:.2g}",
        f"{found.ratio_of_center:.2g}",
    )


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        directory = Path(folder)
        sections = [*map(real_robot, ROBOTS), known_robots(directory), payloads(directory)]
    show("\n".join(sections).rstrip(), "identification_results.md", "identification_study")
