# SPDX-License-Identifier: Apache-2.0
"""How many intervals of loads and drive gains hold the truth: table of docs/payload.md."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from load_coverage import trial
from studies import identified, show, table

TRIALS = 60
_UNITS = {"mass": ("kg", 1.0), "center": ("mm", 1e3), "gain": ("%", 1e2)}


def rows() -> list[tuple[str, ...]]:
    """A row for each model and quantity: medians, and the share of intervals that hold."""
    found = identified("ur10_real")
    with TemporaryDirectory() as folder:
        trials = [trial(found, seed, Path(folder)) for seed in range(TRIALS)]
    cells: list[tuple[str, ...]] = []
    for model in trials[0]:
        results = [one for results in trials for one in results[model]]
        for quantity in dict.fromkeys(one.quantity for one in results):
            of_it = [one for one in results if one.quantity == quantity]
            unit, scale = _UNITS[quantity]
            errors, widths = (
                scale * np.median(values)
                for values in zip(*((abs(x.error), x.half_width) for x in of_it), strict=True)
            )
            holds = 100 * np.mean([one.holds for one in of_it])
            cells.append(
                (model, quantity, f"{errors:.2g} {unit}", f"{widths:.2g} {unit}", f"{holds:.0f} %")
            )
    return cells


if __name__ == "__main__":
    names = ("model", "quantity", "error", "half width", "intervals that hold")
    show(table(names, rows()), "payload.md", "loads_study")
