# SPDX-License-Identifier: Apache-2.0
"""A link: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz, the moments about the origin of its frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.arrays import Floats


def turned(parameters: Floats, rotation: Floats) -> Floats:
    """(10,) of a body, about the same origin, in other axes: v = R v'."""
    if np.array_equal(rotation, np.eye(3)):
        return np.array(parameters)
    turned_inertia = rotation @ inertia_matrix(parameters[4:]) @ rotation.T
    return np.concatenate(
        [parameters[:1], rotation @ parameters[1:4], turned_inertia[np.triu_indices(3)]]
    )


def inertia_matrix(six: Floats) -> Floats:
    """(3, 3) of xx, xy, xz, yy, yz, zz."""
    xx, xy, xz, yy, yz, zz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def about_center(parameters: Floats) -> tuple[Floats, Floats]:
    """Center of mass (3,) and inertia (3, 3) about it, along the axes of the frame."""
    center = parameters[1:4] / parameters[0]
    to_center = parameters[0] * (center @ center * np.eye(3) - np.outer(center, center))
    return center, inertia_matrix(parameters[4:]) - to_center


def inertial_elements(
    parameters: Floats, written: Callable[[float], str] = repr
) -> dict[str, dict[str, str]]:
    """Attributes of the elements of a URDF's <inertial>, by element. written: of numbers."""
    center, tensor = about_center(parameters)
    six = map(written, tensor[np.triu_indices(3)].tolist())
    return {
        "origin": {"xyz": " ".join(map(written, center.tolist())), "rpy": "0 0 0"},
        "mass": {"value": written(float(parameters[0]))},
        "inertia": dict(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), six, strict=True)),
    }


def pseudo_inertia(parameters: Floats) -> Floats:
    """(4, 4): positive definite if a body can have these numbers [Wensing, Kim, Slotine 2018]."""
    about_origin, first = inertia_matrix(parameters[4:]), parameters[1:4]
    second = 0.5 * np.trace(about_origin) * np.eye(3) - about_origin
    return np.block([[second, first[:, None]], [first[None], parameters[0]]])
