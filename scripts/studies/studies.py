# SPDX-License-Identifier: Apache-2.0
"""What studies share: models of the real robots, tables in Markdown and their place in the pages of docs/."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import identify
from inverse_dynamics.public_recordings.public_recordings import data_directory

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import Identification

ROBOTS = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}
"""Real robots, and their recordings."""

MOST_SAMPLES = 12_000  # of a recording, that least squares take
_RANK = 1e-7  # of the greatest singular value

DOCS = Path(__file__).resolve().parents[2] / "docs"


def recording_of(name: str) -> Path:
    """That of one of ROBOTS."""
    return data_directory() / "bags" / ROBOTS[name]


@cache
def identified(name: str) -> Identification:
    """One of ROBOTS, by what `ids identify` does."""
    return identify([recording_of(name)], name)


def solved(Y: Floats, tau: Floats, noise: Floats) -> Floats:
    """(m,) least squares of `Y x = tau`, (N, n, m) and (N, n), weighted by the joints' noise (n,)."""
    rows = (Y / noise[:, None]).reshape(-1, Y.shape[2])
    scale = np.linalg.norm(rows, axis=0) + 1e-9
    found: Floats = np.linalg.lstsq(rows / scale, (tau / noise).ravel(), rcond=_RANK)[0] / scale
    return found


def table(names: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """A table with these names of columns."""
    head, *lines = (f"| {' | '.join(map(str, cells))} |" for cells in (names, *rows))
    return "\n".join([head, "|" + "---|" * len(names), *lines])


def show(text: str, page: str, study: str) -> None:
    """Print a study's text; with the option --write, put it between the study's comments in a page."""
    print(text)
    if "--write" not in sys.argv:
        return
    begin, end = (f"<!-- scripts/{study}: {place} -->" for place in ("begin", "end"))
    file = DOCS / page
    before, rest = file.read_text(encoding="utf-8").split(begin)
    file.write_text(f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}", encoding="utf-8")
