# SPDX-License-Identifier: Apache-2.0
"""Held-out errors of models as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.identification.result import COLUMNS
from inverse_dynamics.show.tables import IN_BAND, ReportTable, of_joints

if TYPE_CHECKING:
    from collections.abc import Mapping

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.hold_out import HoldOut
    from inverse_dynamics.identification.result import Identification


def held_out_table(
    found: Identification,
    title: str = "Held-out error",
    note: str = "",
    *,
    rmse: Mapping[str, Floats] | None = None,
    coverage: Floats | None = None,
) -> ReportTable:
    """Errors of each joint by each model, and the share within the band. rmse, coverage: of other data."""
    rmse = found.held_out if rmse is None else rmse
    none = np.full(len(found.joints), np.nan)
    columns = {
        heading: rmse.get(column, none)
        for column, heading in COLUMNS.items()
        if column in found.held_out
    }
    columns[IN_BAND] = 100 * (found.coverage if coverage is None else coverage)
    return of_joints(title, found.joints, found.units, columns, note, means=columns)


def hold_out_table(found: Identification, test: HoldOut, title: str, note: str = "") -> ReportTable:
    """The same on a recording that was held out."""
    return held_out_table(found, title, note, rmse=test.rmse, coverage=test.coverage)
