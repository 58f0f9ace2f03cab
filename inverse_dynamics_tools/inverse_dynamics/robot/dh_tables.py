# SPDX-License-Identifier: Apache-2.0
"""A robot description from Denavit-Hartenberg parameters.

    convention: modified        # Craig's, as of Franka; or standard, as of Universal Robots
    degrees: true               # of alpha, theta and limits; default: false
    joints:
      - {a: 0, alpha: 0, d: 0.333}
      - {a: 0, alpha: -90, d: 0, theta: 0, mass: 4, limits: [-100, 100], velocity: 2, effort: 87}

modified: the frame of joint i is Rx(alpha) Tx(a) Rz(theta + q) Tz(d) of the one before; standard:
Rz(theta + q) Tz(d) Tx(a) Rx(alpha). `type: prismatic` adds q to d. [Craig, Introduction to robotics, 3.4]

Masses that aren't stated are guesses, 2 kg each, and so are centers of mass, halfway to the next joint, and moments
of inertia. `ids identify` finds what torques tell of them; torques of the description alone mean nothing.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from inverse_dynamics.base.located_yaml import parse_mapping
from inverse_dynamics.errors import RobotError
from inverse_dynamics.robot.chain_geometry import roll_pitch_yaw

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.located_yaml import Mapping

GUESSED_MASS = 2.0  # kg, of each link
_GUESSED_RADIUS = 0.1  # m, of gyration


def urdf_of_dh(text: str, file: str) -> str:
    """URDF text of a table; links `base`, `link1`, ..., `tip`. Raises RobotError."""
    table = parse_mapping(text, file, RobotError)
    modified = table.required("convention").text(["modified", "standard"]) == "modified"
    degrees = table.optional("degrees")
    unit = math.pi / 180 if degrees and degrees.truth() else 1.0
    rows = [entry.mapping() for entry in table.required("joints").entries()]
    table.reject_others()
    if not rows:
        raise RobotError(f"{file}: joints: expected one or more, got none")
    # origins of joints in the link before; the last one is that of the tip
    origins = [np.eye(4)]
    for row in rows:
        a, alpha, d, theta = (_number(row, name) for name in ("a", "alpha", "d", "theta"))
        across = _pose("x", unit * alpha, (a, 0.0, 0.0))
        along = _pose("z", unit * theta, (0.0, 0.0, d))
        if modified:
            origins[-1] = origins[-1] @ across @ along
            origins.append(np.eye(4))
        else:
            origins[-1] = origins[-1] @ _pose("z", unit * theta)
            origins.append(_pose("z", 0.0, (0.0, 0.0, d)) @ across)
    lines = ['<robot name="dh">', '  <link name="base"/>']
    for number, (row, origin, following) in enumerate(
        zip(rows, origins, origins[1:], strict=False), 1
    ):
        mass = row.optional("mass")
        lines += _link(number, following, mass.number() if mass else GUESSED_MASS)
        lines += _joint(row, number, origin, unit)
    lines += [
        '  <link name="tip"/>',
        f'  <joint name="tip" type="fixed"><parent link="link{len(rows)}"/><child link="tip"/>'
        f"{_origin(origins[-1])}</joint>",
        "</robot>",
    ]
    return "\n".join(lines)


def _number(row: Mapping, name: str) -> float:
    value = row.optional(name)
    return 0.0 if value is None else value.number()


def _pose(axis: str, angle: float, xyz: Sequence[float] = (0.0, 0.0, 0.0)) -> Floats:
    """A turn about x or z, and a position."""
    c, s = math.cos(angle), math.sin(angle)
    pose = np.eye(4)
    i, j = (1, 2) if axis == "x" else (0, 1)
    pose[[i, i, j, j], [i, j, i, j]] = c, -s, s, c
    pose[:3, 3] = xyz
    return pose


def _origin(pose: Floats) -> str:
    xyz, rpy = (
        " ".join(map(repr, map(float, numbers)))
        for numbers in (pose[:3, 3], roll_pitch_yaw(pose[:3, :3]))
    )
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>'


def _joint(row: Mapping, number: int, origin: Floats, unit: float) -> list[str]:
    kind, name, limits = (row.optional(key) for key in ("type", "name", "limits"))
    stated = kind.text(["revolute", "prismatic"]) if kind else "revolute"
    unlimited = limits is None and stated == "revolute"
    factor = unit if stated == "revolute" else 1.0
    ends = [factor * entry.number() for entry in limits.entries(2)] if limits else [-1e3, 1e3]
    velocity, effort = (_number(row, key) for key in ("velocity", "effort"))
    row.reject_others()
    called = quoteattr(name.text() if name else f"joint{number}")
    parent = "base" if number == 1 else f"link{number - 1}"
    return [
        f'  <joint name={called} type="{"continuous" if unlimited else stated}">',
        f'    <parent link="{parent}"/><child link="link{number}"/>{_origin(origin)}<axis xyz="0 0 1"/>',
        f'    <limit lower="{ends[0]!r}" upper="{ends[1]!r}" velocity="{velocity!r}" effort="{effort!r}"/>',
        "  </joint>",
    ]


def _link(number: int, following: Floats, mass: float) -> list[str]:
    center = " ".join(map(repr, map(float, following[:3, 3] / 2)))
    inertia = mass * _GUESSED_RADIUS**2
    moments = " ".join(f'{name}="{inertia!r}"' for name in ("ixx", "iyy", "izz"))
    return [
        f'  <link name="link{number}"><inertial><origin xyz="{center}"/><mass value="{mass!r}"/>',
        f'    <inertia {moments} ixy="0" ixz="0" iyz="0"/></inertial></link>',
    ]
