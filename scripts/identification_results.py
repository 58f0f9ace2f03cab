# SPDX-License-Identifier: Apache-2.0
"""Identifies the real robots whose recordings are public, and writes docs/identification_results.md.

    ./scripts/identification_results                          # prints the page; ten minutes
    ./scripts/identification_results --write                  # replaces it
    ./scripts/identification_results --write --only payloads  # replaces these sections alone

The recordings are those of `ids data`, or of $IDS_DATA_DIR. All is what `ids identify` does by default.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from known_truth import LEAST_DELAY_ERROR, MOST_ERROR, Truth
from payload_truth import STEP, Arm, least_errors, trials

from inverse_dynamics import identify
from inverse_dynamics.data.public_recordings import data_directory
from inverse_dynamics.identification.summary import headings, held_out_rows

if TYPE_CHECKING:
    from payload_truth import Figures

PAGE = Path(__file__).resolve().parents[1] / "docs" / "identification_results.md"
ROBOTS = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}
SEEDS = 10
# Robot, kg, s; whether everything is chosen without the window, too; which of the two also with an uncertain arm.
LOADS: tuple[tuple[str, float, float, bool, tuple[bool, ...]], ...] = (
    ("panda", 1.0, 4.0, True, (False,)),
    ("panda", 1.0, 6.0, False, ()),
    ("panda", 1.0, 8.0, True, (False, True)),
    ("ur10", 5.0, 4.0, True, (False,)),
    ("ur10", 5.0, 8.0, True, (False,)),
)
TRIALS = 100

_HEAD = """\
<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Written by scripts/identification_results.py. -->
# Identified from recordings of real robots

Root mean square errors [N m] on held-out blocks: each of five contiguous blocks is predicted by models fitted to the
other four, with everything chosen inside those four ([identification](identification.md)).
`./scripts/identification_results --write` makes this page.
"""


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true", help=f"replace docs/{PAGE.name}")
    parser.add_argument(
        "--only",
        choices=SECTIONS,
        action="append",
        help="write only these sections, and take the others from the page",
    )
    given = parser.parse_args()
    bags = data_directory() / "bags"
    stored = _stored(PAGE.read_text(encoding="utf-8")) if given.only else {}
    with TemporaryDirectory() as directory:
        sections = [
            stored[name] if given.only and name not in given.only else write(bags, Path(directory))
            for name, write in SECTIONS.items()
        ]
    text = "\n".join([_HEAD, *sections])
    print(text, end="")
    if given.write:
        PAGE.write_text(text, encoding="utf-8")
    return 0


def _stored(page: str) -> dict[str, str]:
    """The sections of a page that was written before."""
    first = page.index("## ")
    known, payloads = page.index(_KNOWN.split("\n")[0]), page.index(_PAYLOADS.split("\n")[0])
    return {
        "identified": page[first : known - 1],
        "known": page[known : payloads - 1],
        "payloads": page[payloads:],
    }


def _identified(bags: Path, _: Path) -> str:
    return "\n".join(_section(robot, bags / bag) for robot, bag in ROBOTS.items())


def _section(robot: str, bag: Path) -> str:
    begin = time.process_time()
    found = identify([bag], robot)
    seconds = time.process_time() - begin
    rows = [
        (row.joint, *(f"{value:.3g}" for value in row.rmse), f"{100 * row.coverage:.1f} %")
        for row in held_out_rows(found)
    ]
    findings = [f"- {finding.text}" for finding in found.findings]
    lines = [
        f"## {robot}: {bag.name}",
        "",
        _row("joint", *headings(found), "in 95 % band"),
        _row(*["---"] * (len(headings(found)) + 2)),
        *(_row(*row) for row in rows),
        "",
        f"{seconds:.0f} s of CPU." + (" Found:" if findings else ""),
        *(["", *findings] if findings else []),
        "",
    ]
    return "\n".join(lines)


_KNOWN = f"""\
## Robots that are known

Simulated arms with the links, rotor inertias, friction and delay found above. MuJoCo moves them as in the recordings,
with as many messages and quantised encoders; stretches of the real residuals, in random order, are the noise. They are
identified from the description alone. Medians of {SEEDS} seeds: the error of the identified torques on states that are
uniform in the recorded ranges, mean over joints; the error of the delay; the share of 95 % intervals of inertial
combinations that hold the truth. inverse_dynamics_tools/test/identification/test_known_truth.py holds the bounds.
"""

_PAYLOADS = f"""\
## Payloads

Simulated loads up to 15 cm in front of the flange on the torques of the real arms, {TRIALS} loads per row, in
overlapping windows of the recording, one every {STEP:g} s. The arm's model is fitted to the rest of the recording, so
its errors stay in the torques. Law, prior strength and delay are chosen on the whole recording, or outside of the
window (*nested*).
*Uncertain arm*: the arm's errors are estimated too, as `ids payload` does where `ids identify` has stored them; other
rows take the model as exact. Medians. The last two columns are the bound of Cramér and Rao for an exact model of the
arm, Gaussian stationary noise correlated as the residuals are, and a known inertia about the center.
"""


def _known_truth(bags: Path, directory: Path) -> str:
    rows = []
    for name, most in MOST_ERROR.items():
        recording = bags / ROBOTS[f"{name}_real"]
        truth = Truth.of(recording, name, directory, identify([recording], f"{name}_real"))
        results = [truth.identified_again(seed) for seed in range(SEEDS)]
        errors = [result.mean for result in results]
        delays = [1e3 * abs(result.delay_error) for result in results]
        inside = np.mean([result.inside for result in results])
        rows.append(
            _row(
                name,
                f"{np.median(errors):.3g} N m ({min(errors):.3g} to {max(errors):.3g})",
                f"{most:g} N m",
                f"{np.median(delays):.2g} ms, at most {max(delays):.2g} ms",
                f"{1e3 * max(LEAST_DELAY_ERROR, truth.period / 2):.3g} ms",
                f"{100 * inside:.1f} %",
            )
        )
    return "\n".join(
        [
            _KNOWN,
            _row(
                "robot",
                "error (range)",
                "bound",
                "error of the delay",
                "bound",
                "intervals that hold",
            ),
            _row(*["---"] * 6),
            *rows,
            "",
        ]
    )


def _payloads(bags: Path, directory: Path) -> str:
    found = {
        name: identify([bags / ROBOTS[f"{name}_real"]], f"{name}_real")
        for name in dict.fromkeys(load[0] for load in LOADS)
    }
    arms: dict[tuple[str, float, bool], Arm] = {}
    rows = []
    for name, mass, seconds, also_nested, uncertain in LOADS:
        for nested in (False, True) if also_nested else (False,):
            key = name, seconds, nested
            if key not in arms:
                arms[key] = Arm.of(found[name], directory, seconds=seconds, nested=nested)
            label = f"{name}, {mass:g} kg, {seconds:g} s{', nested' if nested else ''}"
            least = ("", "") if nested else least_errors(arms[key], mass)
            exact = arms[key].taken_for_exact()
            rows.append(_row(label, *_told(trials(exact, mass, TRIALS)), *least))
            if nested in uncertain:
                told = _told(trials(arms[key], mass, TRIALS))
                rows.append(_row(f"{label}, uncertain arm", *told, "", ""))
    names = ("load", "mass", "center", "intervals that hold", "half width by error: mass", "center")
    return "\n".join(
        [
            _PAYLOADS,
            _row(*names, "least: mass", "center"),
            _row(*["---"] * 8),
            *rows,
            "",
        ]
    )


def _told(found: Figures) -> tuple[str, ...]:
    return (
        f"{100 * found.mass:.2g} %",
        f"{1e3 * found.center:.2g} mm",
        f"{100 * found.coverage:.0f} %",
        f"{found.ratio_of_mass:.2g}",
        f"{found.ratio_of_center:.2g}",
    )


SECTIONS = {"identified": _identified, "known": _known_truth, "payloads": _payloads}


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
