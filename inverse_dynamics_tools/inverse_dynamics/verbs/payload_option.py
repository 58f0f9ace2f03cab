# SPDX-License-Identifier: Apache-2.0
"""The option --payload: a body at the tip, as parameters of the solver."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.base.decimals import decimal
from inverse_dynamics.errors import UserError

if TYPE_CHECKING:
    from inverse_dynamics._core import YamlMap
    from inverse_dynamics.base.arrays import Parameter

_FORMS = (
    "MASS, MASS,x,y,z or MASS,x,y,z,Ixx,Ixy,Ixz,Iyy,Iyz,Izz (1, 4 or 10 numbers), or a YAML file with "
    "mass, center_of_mass, inertia and frame"
)


def payload(text: str) -> dict[str, Parameter]:
    """A body of the option: its parameters, all of them, so that none of another body is left."""
    return {"payload.center_of_mass": [0.0, 0.0, 0.0], **stated_payload(text)}


def stated_payload(text: str) -> dict[str, Parameter]:
    """The same, without a center of mass where none is stated."""
    try:
        numbers = [decimal(part) for part in text.split(",")]
    except ValueError:
        return _of_file(text)
    if len(numbers) not in (1, 4, 10) or not all(map(math.isfinite, numbers)):
        raise argparse.ArgumentTypeError(f"expected {_FORMS}, got '{text}'")
    return _parameters(numbers[0], numbers[1:4], numbers[4:])


def _parameters(
    mass: float,
    center: list[float],
    inertia: list[float],
    xyz: list[float] | None = None,
    rpy: list[float] | None = None,
) -> dict[str, Parameter]:
    zeros = [0.0, 0.0, 0.0]
    return {
        "payload.mass": mass,
        **({"payload.center_of_mass": center} if center else {}),
        "payload.inertia": inertia or 2 * zeros,
        "payload.frame.xyz": xyz or zeros,
        "payload.frame.rpy": rpy or zeros,
    }


def _of_file(text: str) -> dict[str, Parameter]:
    from inverse_dynamics.base.located_yaml import read_mapping

    if not Path(text).is_file():
        raise argparse.ArgumentTypeError(f"expected {_FORMS}, got '{text}': there is no such file")
    try:
        body = read_mapping(Path(text), UserError)
        mass = body.required("mass").number()
        center, inertia = _numbers(body, "center_of_mass", 3), _numbers(body, "inertia", 6)
        frame = body.optional("frame")
        xyz, rpy = [], []
        if frame is not None:
            pose = frame.mapping()
            xyz, rpy = _numbers(pose, "xyz", 3), _numbers(pose, "rpy", 3)
            pose.reject_others()
        body.reject_others()
    except UserError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return _parameters(mass, center, inertia, xyz, rpy)


def _numbers(mapping: YamlMap, key: str, count: int) -> list[float]:
    value = mapping.optional(key)
    return [] if value is None else [entry.number() for entry in value.entries(count)]
