# SPDX-License-Identifier: Apache-2.0
"""Arrays: types for annotations, and what several modules do with them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Mask = NDArray[np.bool_]
    Parameter = (
        bool | int | float | str | Sequence[bool] | Sequence[int] | Sequence[float] | Sequence[str]
    )
    DataFrame = Any  # of pandas or polars, which needn't be installed


def stretches(flags: Mask) -> tuple[Integers, Integers]:
    """Where flags (N,) are set in succession: the first samples, and those after the last ones."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return edges[::2], edges[1::2]


def whole_turns(way: Floats) -> Floats:
    """The whole turns [rad] that are nearest to ways [rad]."""
    return np.asarray(2 * np.pi * np.round(way / (2 * np.pi)))
