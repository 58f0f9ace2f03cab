# SPDX-License-Identifier: Apache-2.0
"""Which external torques are a contact, from the torque bands of an identified model alone.

    thresholds = band_thresholds(solver.torque_deviation, false_alarms_per_hour=1.0)

A band holds 95 % of the differences between measured and computed torques on data that the model wasn't fitted to. They
are taken for Gaussian noise that forgets within 0.1 s: 18000 independent samples an hour, of which as many exceed the
threshold as false alarms are stated. Thresholds from a part without contact assume less and are better.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import InvalidParameterError

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats

_CORRELATION_TIME = 0.1  # s
_FEWEST = 1e-6  # false alarms per hour
_COVERAGE = 0.95
_ON_ANOTHER_DAY = 0.8  # of the same bands: docs/identification.md


@dataclass(frozen=True)
class BandThresholds:
    """As ContactThresholds, (n,) each; there are no peaks that a distribution was fitted to."""

    torques: Floats  # N m (prismatic N)
    noise: Floats
    correlation_time: Floats
    independent: Floats
    peaks: Floats
    level: Floats
    scale: Floats
    shape: Floats
    low: Floats
    high: Floats  # what they would have to be on another day than the model's
    false_alarms_per_hour: float


def band_thresholds(bands: Floats, false_alarms_per_hour: float) -> BandThresholds:
    """Thresholds of bands (n,). Raises InvalidParameterError."""
    independent = 3600.0 / (2.0 * _CORRELATION_TIME)  # an hour's
    most = (1.0 - _COVERAGE) * independent * len(bands)
    if not _FEWEST <= false_alarms_per_hour <= most:
        raise InvalidParameterError(
            f"false alarms per hour: expected {_FEWEST:g} to {most:g}, which exceed the model's bands, got "
            f"{false_alarms_per_hour:g}"
        )
    height = _half_width(1.0 - false_alarms_per_hour / (independent * len(bands)))
    nothing = np.zeros_like(bands)
    noise = bands / _half_width(_COVERAGE)
    return BandThresholds(
        torques=height * noise,
        noise=noise,
        correlation_time=np.full_like(bands, _CORRELATION_TIME),
        independent=nothing,
        peaks=nothing,
        level=bands,
        scale=nothing,
        shape=nothing,
        low=height * noise,
        high=height * bands / _half_width(_ON_ANOTHER_DAY),
        false_alarms_per_hour=false_alarms_per_hour,
    )


def _half_width(share: float) -> float:
    """Of the interval that holds this share of normal numbers."""
    return NormalDist().inv_cdf(0.5 + 0.5 * share)
