# SPDX-License-Identifier: Apache-2.0
"""Identifies the real robots whose recordings are public, and writes docs/identification_results.md.

    ./scripts/study identification            # prints the page; ten minutes
    ./scripts/study identification --write    # replaces it

All is what `ids identify` does by default.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from known_truth import MOST_ERROR, Truth
from payload_truth import STEP, Arm, trials
from studies import DOCS, ROBOTS, table

from inverse_dynamics import identify
from inverse_dynamics.data.public_recordings import data_directory
from inverse_dynamics.identification.summary import headings, held_out_rows

if TYPE_CHECKING:
    from inverse_dynamics.identification.result import Identification

SEEDS = 10
TRIALS = 100
# Robot, kg, s; whether everything is chosen without the window, too; whether also with an uncertain arm.
LOADS = (
    ("panda", 1.0, 4.0, False, True),
    ("panda", 1.0, 4.0, True, False),
    ("panda", 1.0, 8.0, False, True),
    ("panda", 1.0, 8.0, True, False),
    ("ur10", 5.0, 4.0, False, True),
    ("ur10", 5.0, 8.0, False, True),
)

HEAD = """\
<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Written by scripts/identification_study.py. -->
# Identified from recordings of real robots

## Fit here, tested there

Root mean square error [N m], of all samples and of moving ones; in brackets that of the best of ordinary, weighted
and consistent least squares with viscous friction, step, offset and rotor inertia. Share in the [95 %
band](identification.md#on-another-day), of all joints and of the worst, and its mean width by that of the constant
one that would hold 95 %. The constant band of the fit holds 68 to 92 % on the UR10e.

| fitted to | tested on | error | moving | in band | worst | width |
|---|---|---|---|---|---|---|
| UR10e, 12 Feb | 19 Feb | 1.90 (2.10) | 1.51 (1.83) | 99 % | 98 % | 1.14 |
| | 17 Jan, point to point | 2.63 (2.70) | 1.66 (1.97) | 100 % | 99 % | 1.12 |
| | 5 Feb | 2.60 (2.78) | 2.56 (2.75) | 98 % | 97 % | 1.24 |
| UR10e, 12 and 19 Feb | 17 Jan, point to point | 2.59 (2.68) | 1.64 (1.95) | 99 % | 99 % | 1.04 |
| | 6 Feb | 2.22 (2.23) | 2.16 (2.31) | 98 % | 97 % | 1.34 |
| | 10 Feb | 2.25 (2.41) | 2.44 (2.59) | 98 % | 97 % | 1.42 |
| KUKA KR300, A and B | C | 466 (525) | 389 (423) | 99 % | 99 % | 1.23 |
| Panda | another Panda | 0.406 (0.401) | 0.406 (0.401) | 88 % | 60 % | 1.02 |
| another Panda | Panda | 0.398 (0.388) | 0.398 (0.388) | 89 % | 65 % | 1.06 |

Recordings: [UR10e](https://github.com/shamilmamedov/dynamic_calibration),
[KR300](https://github.com/JonasWeigand/Robot_Identification), [another
Panda](https://github.com/marcocognetti/FrankaEmikaPandaDynModel). At rest, 10 to 40 % of the UR10e's time, friction
is anything up to its step, and no law predicts it. Friction of two Pandas differs by factors of 2 to 5: identify your
own.

## On held-out blocks

Root mean square errors [N m]: models fitted to, and chosen on, four of five contiguous blocks predict the fifth. The
UR10's wrist 3 stands twice, with the same friction: a step off zero velocity would have 1.37 and a mean of 1.08, but
be a constant force at rest. `./scripts/study identification --write` makes these tables.
"""

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

identified = cache(lambda name: identify([recording_of(name)], name))


def recording_of(name: str) -> Path:
    """That of a real robot."""
    return data_directory() / "bags" / ROBOTS[name]


def real_robot(name: str) -> str:
    """The section of a robot."""
    found: Identification = identified(name)
    rows = [
        (row.joint, *(f"{value:.3g}" for value in row.rmse), f"{100 * row.coverage:.1f} %")
        for row in held_out_rows(found)
    ]
    return f"### {name}: {ROBOTS[name]}\n\n{table(('joint', *headings(found), 'in 95 % band'), rows)}\n"


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


def main() -> None:
    """Command line."""
    with TemporaryDirectory() as folder:
        directory = Path(folder)
        sections = [*map(real_robot, ROBOTS), known_robots(directory), payloads(directory)]
    text = "\n".join([HEAD, *sections])
    print(text, end="")
    if "--write" in sys.argv:
        (DOCS / "identification_results.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
