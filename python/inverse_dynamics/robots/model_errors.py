# SPDX-License-Identifier: Apache-2.0
"""The file of `ids identify` beside a model: the uncertainty of the model.

arm_model.yaml   the model
arm_model.json   SHA-256 of the model's file, its friction; independent deviations of the fit's
                 unknowns, of one standard deviation each: the covariance is factor factor'; torques
                 that models fitted to the other data left of held-out data, as an estimator of
                 external torques has them: its gain [1/s], their period [s], one row per sample;
                 the samples that the model was fitted to, as recordings/sketch.py has them
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import ArmUncertainty
from inverse_dynamics.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats

LEAST_GAIN = 10.0
"""1/s, of estimators of external torques, and of held-out errors in the file: contacts end 0.2 s after a force."""

SCHEMA = 4
_KEYS = {"schema", "model_sha256", "friction", "deviations", "held_out"}
_MORE = {"friction_at", "coupling", "springs"}  # optional
_BAND = {"noise", "level", "share"}
_NUMBERS = {"fv", "fc", "width"}  # of smooth_coulomb
_OPTIONAL_NUMBERS = {"shift", "fo", "fl", "fs", "vs", "fm", "distance"}


@dataclass(frozen=True)
class MoreFriction:
    """What a model has beside a law of each joint: optional keys of the file."""

    others: Sequence[dict[str, float]] = ()  # laws of further places
    coupling: Sequence[Sequence[float]] | None = (
        None  # (r, n): laws act at the velocities `coupling qd`
    )
    springs: Sequence[int] = ()  # of each joint 0, 1 of a linear spring, 2 of a lever

    @staticmethod
    def read(content: Mapping[str, Any]) -> MoreFriction:
        """From the content of a file."""
        return MoreFriction(
            content.get("friction_at", ()),
            content.get("coupling"),
            [int(x) for x in content.get("springs", ())],
        )

    def written(self) -> dict[str, Any]:
        """Keys of a file."""
        keys = {
            "friction_at": [*self.others],
            "coupling": self.coupling,
            "springs": [*self.springs],
        }
        return {key: value for key, value in keys.items() if value}

    def uncertainty(self, friction: Sequence[dict[str, float]], factor: Floats) -> ArmUncertainty:
        """With the laws of the joints."""
        coupling = None if self.coupling is None else np.array(self.coupling)
        return ArmUncertainty([*friction, *self.others], factor, coupling, [*self.springs])


def model_errors_file(model: Path) -> Path:
    """The file beside a model."""
    return model.with_suffix(".json")


def read_model_errors(model: Path) -> tuple[dict[str, Any] | None, str]:
    """Its content; or None, and why.

    Raises RobotError: a file that isn't one of `ids identify`.
    """
    file = model_errors_file(model)
    if not file.is_file():
        return None, f"{file}: there is none"
    content = _content(file)
    if content["model_sha256"] != sha256(model.read_bytes()):
        return None, f"{file}: it is another model's, or {model.name} has changed since"
    return content, ""


def read_uncertainty(model: Path) -> tuple[ArmUncertainty | None, str]:
    """Uncertainty of the model; or None, and why.

    Raises RobotError: a file that isn't one of `ids identify`.
    """
    content, why = read_model_errors(model)
    if content is None:
        return None, why
    factor = np.array(content["deviations"], dtype=float).T
    return MoreFriction.read(content).uncertainty(content["friction"], factor), ""


def _content(file: Path) -> dict[str, Any]:
    try:
        # integers as floats, of which the largest are infinite
        content = json.loads(file.read_text(encoding="utf-8"), parse_int=float)
    except (OSError, ValueError, RecursionError) as error:
        raise _error(file, "JSON of `ids identify`", str(error)) from error
    schemas: dict[Any, set[str]] = {
        2: _KEYS,
        3: _KEYS | {"band"},
        SCHEMA: _KEYS | {"band", "fitted_to"},
    }
    if not isinstance(content, dict) or schemas.get(content.get("schema")) != (
        content.keys() - _MORE
    ):
        keys = ", ".join(sorted(schemas[SCHEMA]))
        raise _error(file, f"schema {SCHEMA} with the keys {keys}", "others")
    laws, held_out = content["friction"], content["held_out"]
    if not _columns(content["deviations"]):
        raise _error(file, "deviations: rows of as many finite numbers each", "others")
    _check_more(file, content)
    if not (isinstance(laws, list) and laws and all(map(_is_law, laws))):
        raise _error(file, "friction: numbers of each joint", "others")
    if not (
        isinstance(held_out, dict)
        and held_out.keys() == {"gain", "period", "torques"}
        and all(_columns([[held_out[key]]]) and held_out[key] > 0 for key in ("gain", "period"))
        and _columns(held_out["torques"]) == len(laws)
    ):
        raise _error(file, "held_out: gain, period, and rows of torques of each joint", "others")
    band = content.get("band", {key: [0.0] * len(laws) for key in _BAND})
    if not (
        isinstance(band, dict)
        and band.keys() == _BAND
        and _columns([*band.values()]) == len(laws)
        and min(min(band.values())) >= 0
    ):
        raise _error(file, "band: noise, level and share of each joint, not below zero", "others")
    sketch = content.setdefault("fitted_to", [])
    if not (isinstance(sketch, list) and all(map(_is_hash, sketch))):
        raise _error(file, "fitted_to: hexadecimal numbers of 16 digits", "others")
    return content


def _check_more(file: Path, content: Mapping[str, Any]) -> None:
    others, springs = content.get("friction_at", []), content.get("springs", [])
    if not (isinstance(others, list) and all(map(_is_law, others))):
        raise _error(file, "friction_at: laws of places", "others")
    if "coupling" in content and not _columns(content["coupling"]):
        raise _error(file, "coupling: rows of as many finite numbers each", "others")
    if not (isinstance(springs, list) and all(x in (0, 1, 2) for x in springs)):
        raise _error(file, "springs: 0, 1 or 2 of each joint", "others")


def _is_hash(text: Any) -> bool:
    return isinstance(text, str) and re.fullmatch("[0-9a-f]{16}", text) is not None


def _columns(rows: Any) -> int:
    """How many finite numbers each row of a table has; 0: it is none."""
    if not (isinstance(rows, list) and rows and all(isinstance(row, list) for row in rows)):
        return 0
    lengths = {len(row) for row in rows}
    finite = all(isinstance(x, float) and math.isfinite(x) for row in rows for x in row)
    return lengths.pop() if len(lengths) == 1 and finite else 0


def _is_law(law: Any) -> bool:
    if not isinstance(law, dict) or not _NUMBERS <= law.keys() <= _NUMBERS | _OPTIONAL_NUMBERS:
        return False
    return bool(_columns([list(law.values())]))


def _error(file: Path, expected: str, got: str) -> RobotError:
    return RobotError(
        f"{file}: expected {expected}, got {got}; identify the arm again, or remove it"
    )


def sha256(content: bytes) -> str:
    """As the file states the model's."""
    return hashlib.sha256(content).hexdigest()
