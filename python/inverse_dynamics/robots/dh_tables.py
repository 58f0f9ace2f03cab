# SPDX-License-Identifier: Apache-2.0
"""A robot description from Denavit-Hartenberg parameters.

    convention: modified        # Craig's, as of Franka; or standard, as of Universal Robots
    degrees: true               # of alpha, theta and limits; default: false
    joints:
      - {a: 0, alpha: 0, d: 0.333}
      - {a: 0, alpha: -90, d: 0, theta: 0, mass: 4, limits: [-100, 100], velocity: 2, effort: 87}
    mass: 17                    # kg, of the whole arm, if it is known

modified: the frame of joint i is Rx(alpha) Tx(a) Rz(theta + q) Tz(d) of the one before; standard:
Rz(theta + q) Tz(d) Tx(a) Rx(alpha). `type: prismatic` adds q to d. [Craig, Introduction to robotics, 3.4]

Masses that aren't stated are guesses: equal parts of what is left of the arm's mass, else 2 kg each; and so are
centers of mass, halfway to the next joint, and moments of inertia. `ids identify` finds what torques tell of them.
What is guessed is no evidence against a recording: whoever judges asks Arm.guess.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from inverse_dynamics.errors import RobotError
from inverse_dynamics.robots.located_yaml import parse_mapping
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.robots.located_yaml import Mapping

SUFFIXES = (".yaml", ".yml")
GUESSED_MASS = 2.0  # kg, of each link
_GUESSED_RADIUS = 0.1  # m, of gyration, of a link without length


def urdf_of_dh(text: str, file: str) -> str:
    """URDF text of a table; links `base`, `link1`, ..., `tip`. Raises RobotError."""
    table = parse_mapping(text, file, RobotError)
    convention = table.optional("convention")
    if convention is None:
        raise RobotError(
            f"{file}: expected a URDF, or Denavit-Hartenberg parameters, which have the key convention; a run "
            "configuration is given as --robot"
        )
    modified = convention.text(["modified", "standard"]) == "modified"
    degrees = table.optional("degrees")
    unit = math.pi / 180 if degrees and degrees.truth() else 1.0
    rows = [entry.mapping() for entry in table.required("joints").entries()]
    if not rows:
        raise RobotError(f"{file}: joints: expected one or more, got none")
    guessed = _guessed_mass(table, rows, file)
    table.reject_others()
    lines = ['<robot name="dh">', '  <link name="base"/>']
    parent = "base"
    for number, row in enumerate(rows, 1):
        a, alpha, d, theta = (_number(row, name) for name in ("a", "alpha", "d", "theta"))
        link, frame = f"link{number}", f"frame{number}"
        mass = _number(row, "mass", guessed)
        if modified:
            lines += _fixed(parent, frame, (a, 0.0, 0.0), unit * alpha)
            lines += _joint(row, number, (frame, link), (d, theta), unit)
            lines += _link(link, mass, (0.0, 0.0, d / 2))
            parent = link
        else:
            lines += _joint(row, number, (parent, link), (0.0, theta), unit)
            lines += _link(link, mass, (a / 2, 0.0, d / 2))
            lines += _fixed(link, frame, (a, 0.0, d), unit * alpha)
            parent = frame
    return "\n".join([*lines, *_fixed(parent, "tip", (0.0, 0.0, 0.0), 0.0), "</robot>"])


def guess_of(file: Path | None) -> str:
    """What the table of a robot lacks, in a sentence; "": nothing, or it's a URDF. Raises RobotError."""
    if file is None or file.suffix not in SUFFIXES:
        return ""
    table = parse_mapping(file.read_text(encoding="utf-8-sig"), f"{file}", RobotError)
    rows = [entry.mapping() for entry in table.required("joints").entries()]
    unknown = [f"link{k}" for k, row in enumerate(rows, 1) if row.optional("mass") is None]
    masses = ""
    if unknown:
        mass = _guessed_mass(table, rows, f"{file}")
        masses = f"the mass of {listed(unknown, 20)} ({mass:.3g} kg each is a guess), nor "
    return (
        f"{file} doesn't state {masses}centers of mass and moments of inertia, which are guesses: the scale of torques "
        "rests on the efforts, so masses, loads and scales aren't judged; `ids identify` finds what a recording tells"
    )


def _guessed_mass(table: Mapping, rows: Sequence[Mapping], file: str) -> float:
    """kg, of each link whose mass isn't stated. Raises RobotError."""
    masses = [row.optional("mass") for row in rows]
    unknown = sum(mass is None for mass in masses)
    left = _number(table, "mass", math.nan) - sum(mass.number() for mass in masses if mass)
    if unknown and left <= 0.0:
        raise RobotError(
            f"{file}: mass: expected more than the stated links have, got {-left:.3g} kg less"
        )
    return left / unknown if unknown and left > 0.0 else GUESSED_MASS


def _number(row: Mapping, name: str, absent: float = 0.0) -> float:
    value = row.optional(name)
    return absent if value is None else value.number()


def _origin(xyz: tuple[float, ...], rpy: tuple[float, ...]) -> str:
    texts = [" ".join(map(repr, numbers)) for numbers in (xyz, rpy)]
    return f'<origin xyz="{texts[0]}" rpy="{texts[1]}"/>'


def _fixed(parent: str, child: str, xyz: tuple[float, ...], alpha: float) -> list[str]:
    """A link without mass, turned about x."""
    return [
        f'  <link name="{child}"/><joint name="to_{child}" type="fixed"><parent link="{parent}"/>',
        f'    <child link="{child}"/>{_origin(xyz, (alpha, 0.0, 0.0))}</joint>',
    ]


def _joint(
    row: Mapping, number: int, links: tuple[str, str], place: tuple[float, float], unit: float
) -> list[str]:
    """A joint about or along z, at `place`: d, theta. unit: of angles, rad."""
    d, theta = place
    kind, name, limits = (row.optional(key) for key in ("type", "name", "limits"))
    stated = kind.text(["revolute", "prismatic"]) if kind else "revolute"
    factor = unit if stated == "revolute" else 1.0
    ends = [factor * entry.number() for entry in limits.entries(2)] if limits else [-1e3, 1e3]
    velocity, effort = (_number(row, key) for key in ("velocity", "effort"))
    row.reject_others()
    from xml.sax.saxutils import quoteattr  # imports urllib

    called = quoteattr(name.text() if name else f"joint{number}")
    unlimited = limits is None and stated == "revolute"
    return [
        f'  <joint name={called} type="{"continuous" if unlimited else stated}">',
        f'    <parent link="{links[0]}"/><child link="{links[1]}"/>',
        f'    {_origin((0.0, 0.0, d), (0.0, 0.0, unit * theta))}<axis xyz="0 0 1"/>',
        f'    <limit lower="{ends[0]!r}" upper="{ends[1]!r}" velocity="{velocity!r}" effort="{effort!r}"/>',
        "  </joint>",
    ]


def _link(name: str, mass: float, center: tuple[float, ...]) -> list[str]:
    inertia = mass * (_GUESSED_RADIUS**2 + math.hypot(*center) ** 2 / 3)  # a rod about its middle
    moments = " ".join(f'{key}="{inertia!r}"' for key in ("ixx", "iyy", "izz"))
    return [
        f'  <link name="{name}"><inertial>{_origin(center, (0.0, 0.0, 0.0))}<mass value="{mass!r}"/>',
        f'    <inertia {moments} ixy="0" ixz="0" iyz="0"/></inertial></link>',
    ]
