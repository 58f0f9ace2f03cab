# SPDX-License-Identifier: Apache-2.0
"""What an identified model may be wrong by, in a file beside it.

arm_model.yaml   the model
arm_model.json   SHA-256 of the model's file, its friction, and independent deviations of the fit's
                 unknowns, of one standard deviation each: the covariance is factor factor'

The covariance is that of the posterior: samples whose errors are correlated in time, and the prior.
"""

from __future__ import annotations

import hashlib
import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.base.plain import plain
from inverse_dynamics.errors import RobotError
from inverse_dynamics.identification.cross_validation import errors_of

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics._core import ArmFit, ArmFitter, ArmUncertainty
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.identification.blocks import Block
    from inverse_dynamics.identification.knowledge import Knowledge
    from inverse_dynamics.identification.result import Identification

_SCHEMA = 1
_KEYS = ("schema", "model_sha256", "friction", "deviations")
_FIGURES = {"fv", "fc", "width"}  # of smooth_coulomb
_OPTIONAL_FIGURES = {"shift", "fo", "fl", "fs", "vs"}
_DIGITS = 7
_LEAST = 1e-6  # variance of the torques by the noise's, of deviations that are written
_RIDGE = 1e-12  # by the information: rounding, of directions that change no torque
_APART = 10.0  # s between blocks: many correlation times


def factor_of(
    fitter: ArmFitter, fit: ArmFit, blocks: Sequence[Block], known: Knowledge, *, law: str
) -> Floats:
    """(m, K): independent deviations of the m unknowns of a fit to blocks.

    Those come first that change torques most; those that change none are left out.
    """
    errors = np.concatenate([errors_of(fitter, fit, block) for block in blocks])
    times = [block.time[block.counts] for block in blocks]
    noise = _core.residual_noise(_in_a_row(times), errors - errors.mean(axis=0))
    data = fitter.whitened_information(
        fit, [block.fitted for block in blocks], times, law=law, noise=noise
    )
    information = data + known.prior
    scale = 1 / np.sqrt(np.diag(information))
    scaled = information * np.outer(scale, scale) + _RIDGE * np.eye(len(scale))
    root = np.linalg.cholesky(scaled)
    any_factor = scale[:, None] * np.linalg.inv(root).T
    variances, turn = np.linalg.eigh(any_factor.T @ known.data @ any_factor)
    kept = np.flatnonzero(variances > _LEAST * len(errors))[::-1]
    factor: Floats = any_factor @ turn[:, kept]
    return factor


def _in_a_row(times: Sequence[Floats]) -> Floats:
    """One time for all blocks, those of several recordings too."""
    rows, end = [], 0.0
    for time in times:
        rows.append(time - time[0] + end)
        end = float(rows[-1][-1]) + _APART
    return np.concatenate(rows)


def uncertainty_file(model: Path) -> Path:
    """The file beside a model."""
    return model.with_suffix(".json")


def uncertainty_text(found: Identification, model_text: str) -> str:
    """The text of that file, for the text of the model."""
    content = {
        "schema": _SCHEMA,
        "model_sha256": _sha256(model_text.encode()),
        "friction": plain(found.model.friction),
        "deviations": [[float(f"{x:.{_DIGITS}g}") for x in row] for row in found.factor.T],
    }
    return json.dumps(content, allow_nan=False) + "\n"


def read_uncertainty(model: Path) -> tuple[ArmUncertainty | None, str]:
    """What the model may be wrong by; or None, and why.

    Raises RobotError: a file that isn't one of `ids identify`.
    """
    file = uncertainty_file(model)
    if not file.is_file():
        return None, f"{file}: there is none"
    content = _content(file)
    if content["model_sha256"] != _sha256(model.read_bytes()):
        return None, f"{file}: it is another model's, or {model.name} has changed since"
    factor = np.array(content["deviations"], dtype=float).T
    return _core.ArmUncertainty(content["friction"], factor), ""


def _content(file: Path) -> dict[str, Any]:
    try:
        # integers as floats, of which the largest are infinite
        content = json.loads(file.read_text(encoding="utf-8"), parse_int=float)
    except (OSError, ValueError, RecursionError) as error:
        raise _error(file, "JSON of `ids identify`", str(error)) from error
    if not isinstance(content, dict) or set(content) != set(_KEYS) or content["schema"] != _SCHEMA:
        raise _error(file, f"schema {_SCHEMA} with the keys {', '.join(_KEYS)}", "others")
    rows, laws = content["deviations"], content["friction"]
    if not (
        _is_list_of(list, rows) and len({len(row) for row in rows}) == 1 and all(map(_is_row, rows))
    ):
        raise _error(file, "deviations: rows of as many finite numbers each", "others")
    if not (_is_list_of(dict, laws) and all(map(_is_law, laws))):
        raise _error(file, "friction: figures of each joint", "others")
    return content


def _is_list_of(kind: type, values: object) -> bool:
    return isinstance(values, list) and all(isinstance(value, kind) for value in values)


def _is_row(row: Collection[object]) -> bool:
    return len(row) > 0 and all(isinstance(x, float) and math.isfinite(x) for x in row)


def _is_law(law: Mapping[str, object]) -> bool:
    return _FIGURES <= law.keys() <= _FIGURES | _OPTIONAL_FIGURES and _is_row(law.values())


def _error(file: Path, expected: str, got: str) -> RobotError:
    return RobotError(
        f"{file}: expected {expected}, got {got}; identify the arm again, or remove it"
    )


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
