# SPDX-License-Identifier: Apache-2.0
"""Identifies the real robots whose recordings are public, and writes docs/identification_results.md.

    ./scripts/identification_results            # prints the page; some minutes
    ./scripts/identification_results --write    # replaces it

The recordings are those of `ids data`, or of $IDS_DATA_DIR. All is what `ids identify` does by default.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics import identify
from inverse_dynamics.data.public_recordings import data_directory
from inverse_dynamics.identification.summary import choices_told, headings, held_out_rows

if TYPE_CHECKING:
    from inverse_dynamics import Identification

PAGE = Path(__file__).resolve().parents[1] / "docs" / "identification_results.md"
ROBOTS = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}

_HEAD = """\
<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Written by scripts/identification_results.py. -->
# Identified from recordings of real robots

Root mean square errors [N m] on blocks that were held out: each of five contiguous blocks is predicted by models
fitted to the other four, with everything chosen inside those four. What each column is, and how it is done:
[identification](identification.md). The page is written by `./scripts/identification_results --write`.
"""


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true", help=f"replace docs/{PAGE.name}")
    given = parser.parse_args()
    bags = data_directory() / "bags"
    text = "\n".join([_HEAD, *(_section(robot, bags / bag) for robot, bag in ROBOTS.items())])
    print(text, end="")
    if given.write:
        PAGE.write_text(text, encoding="utf-8")
    return 0


def _section(robot: str, bag: Path) -> str:
    begin = time.process_time()
    found = identify([bag], robot)
    seconds = time.process_time() - begin
    rows = [
        (row.joint, *(f"{value:.3g}" for value in row.rmse), f"{100 * row.coverage:.1f} %")
        for row in held_out_rows(found)
    ]
    choices = [f"- **{name}**: {text}" for name, text in choices_told(found)]
    findings = [f"- {finding.text}" for finding in found.findings]
    lines = [
        f"## {robot}: {bag.name}",
        "",
        _row("joint", *headings(found), "in 95 % band"),
        _row(*["---"] * (len(headings(found)) + 2)),
        *(_row(*row) for row in rows),
        "",
        f"{seconds:.0f} s of CPU. Chosen for the model of all data:",
        "",
        *choices,
        *(["", "Found:", "", *findings] if findings else []),
        "",
        "Friction [SI units]:",
        "",
        *_friction(found),
        "",
    ]
    return "\n".join(lines)


def _friction(found: Identification) -> list[str]:
    keys = list(dict.fromkeys(key for figures in found.model.friction for key in figures))
    return [
        _row("joint", *keys, "rotor inertia", "95 % band"),
        _row(*["---"] * (len(keys) + 3)),
        *(
            _row(
                joint,
                *(f"{figures[key]:.3g}" if key in figures else "" for key in keys),
                f"{found.model.rotor_inertia[j]:.3g}",
                f"{found.model.torque_deviation[j]:.3g}",
            )
            for j, (joint, figures) in enumerate(
                zip(found.joints, found.model.friction, strict=True)
            )
        ),
    ]


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
