# SPDX-License-Identifier: Apache-2.0
"""Types for annotations: arrays, parameters of solvers."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Mask = NDArray[np.bool_]
    Parameter = (
        bool | int | float | str | Sequence[bool] | Sequence[int] | Sequence[float] | Sequence[str]
    )
    DataFrame = Any  # of pandas or polars, which needn't be installed
