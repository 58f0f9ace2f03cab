# SPDX-License-Identifier: Apache-2.0
"""Robots for the tests of the simulator: the project's own two, and small ones to work out by hand."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from example_robots import RIGID_BODY

from inverse_dynamics.simulation.model import SimulatedRobot

CHAINS = {"ur10": ("base_link", "tool0"), "panda": ("fer_link0", "fer_link8")}
HOME = {  # rad, away from singularities
    "ur10": np.array([0, -1.6, 1.4, -1.2, -1.4, 0.3]),
    "panda": np.array([0, -0.5, 0.2, -2.0, 0.1, 1.8, 0.6]),
}


def robots_package() -> Path:
    """Files of inverse_dynamics_robots: as installed, or beside this package."""
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        share = Path(prefix) / "share/inverse_dynamics_robots"
        if prefix and share.is_dir():
            return share
    return Path(__file__).resolve().parents[2] / "core" / "inverse_dynamics_robots"


def urdf_of(name: str) -> str:
    return (robots_package() / "urdf" / f"{name}.urdf").read_text()


def simulated(name: str, **options: object) -> SimulatedRobot:
    """One of the project's robots."""
    return SimulatedRobot.from_urdf(urdf_of(name), *CHAINS[name], **options)


def link(name: str, mass: float = 0.0, center: str = "0 0 0", shapes: str = "") -> str:
    """A link; with a mass: one of a rod-like inertia about its center."""
    inertial = (
        f'<inertial><origin xyz="{center}"/><mass value="{mass}"/>'
        '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>'
    )
    return f'<link name="{name}">{inertial if mass else ""}{shapes}</link>'


def joint(
    name: str,
    parent: str,
    child: str,
    kind: str = "revolute",
    xyz: str = "0 0 0",
    axis: str = "0 1 0",
    inner: str = "",
    limit: str = '<limit lower="-3" upper="3" velocity="2" effort="100"/>',
    rpy: str = "0 0 0",
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>'
        f"{limit if kind != 'fixed' else ''}{inner}</joint>"
    )


def robot(*parts: str) -> str:
    return f'<robot name="arm">{"".join(parts)}</robot>'


def pendulum(**options: str) -> str:
    """A mass of 2 kg, 0.5 m beyond a joint about y: at q = 0 it lies along x."""
    return robot(
        link("base"), link("arm", 2.0, "0.5 0 0"), joint("swing", "base", "arm", **options)
    )


def box(size: str, xyz: str) -> str:
    return f'<collision><origin xyz="{xyz}"/><geometry><box size="{size}"/></geometry></collision>'


def two_links(height: float = 1.0, middle: str = "") -> str:
    """Two bars of 0.5 m along x, joints about z, at a height above the table; the second folds back onto the base.

    A short link between the bars keeps them from being neighbours, so that they are compared.
    """
    return robot(
        link("base"),
        link("upper", 2.0, "0.25 0 0", box("0.4 0.04 0.04", "0.2 0 0")),
        link("elbow", 0.1),
        link("lower", 1.0, "0.25 0 0", box("0.4 0.04 0.04", "0.25 0 0")),
        link("tip"),
        joint("shoulder", "base", "upper", axis="0 0 1", xyz=f"0 0 {height}"),
        joint("lift", "upper", "elbow", axis="0 1 0", xyz="0.5 0 0"),
        joint("fold", "elbow", "lower", axis="0 0 1"),
        joint("end", "lower", "tip", kind="fixed", xyz="0.5 0 0"),
        middle,
    )


def write_robot(directory: Path, urdf: str, more: str = "", plugin: str = RIGID_BODY) -> Path:
    """A run configuration with its URDF; more: lines of it."""
    (directory / "arm.urdf").write_text(urdf)
    file = directory / "arm.yaml"
    file.write_text(
        f"schema: 1\nname: arm\ndescription: an arm\nplugin: {plugin}\nurdf: arm.urdf\n{more}"
    )
    return file
