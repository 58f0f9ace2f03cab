# SPDX-License-Identifier: Apache-2.0
"""A robot that is no chain: a torso, two arms, and a gripper whose second finger mimics the first."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics import Solver
    from inverse_dynamics.arrays import Floats

TIPS = ("left_tool", "left_finger", "left_other_finger", "right_tool")
JOINTS = (  # that mimic no other, in the order of the description
    *("chest_joint", "right_shoulder_joint", "right_elbow_joint", "right_hand_joint"),
    *("lift_joint", "left_shoulder_joint", "left_elbow_joint", "left_hand_joint"),
    "left_finger_joint",
)


def _moved(
    name: str, kind: str, parent: str, origin: str, axis: str, mass: float, more: str = ""
) -> str:
    """A link, and the joint that moves it."""
    return (
        f"<link name='{name}'><inertial><origin xyz='0.05 -0.02 0.1'/><mass value='{mass}'/><inertia ixx='0.03' "
        "ixy='0.002' ixz='-0.001' iyy='0.04' iyz='0.003' izz='0.02'/></inertial></link>"
        f"<joint name='{name}_joint' type='{kind}'><parent link='{parent}'/><child link='{name}'/><origin {origin}/>"
        f"<axis xyz='{axis}'/><limit lower='-2' upper='1.5' effort='300' velocity='2'/>{more}</joint>"
    )


def _arm(side: str, y: float) -> str:
    place = f"xyz='0 {y} 0.4' rpy='0.3 0 0.1'"
    return (
        _moved(f"{side}_shoulder", "revolute", "chest", place, "0 1 0", 2.0 + y)
        + _moved(
            f"{side}_elbow", "continuous", f"{side}_shoulder", "xyz='0.3 0 0.05'", "0.6 0 0.8", 1.5
        )
        + _moved(
            f"{side}_hand", "revolute", f"{side}_elbow", "xyz='0.25 0 0' rpy='0 0.4 0'", "1 0 0", 1
        )
        + f"<link name='{side}_tool'/><joint name='{side}_flange' type='fixed'><parent link='{side}_hand'/>"
        f"<child link='{side}_tool'/><origin xyz='0.1 0 0' rpy='0 1.2 0'/></joint>"
    )


_FOLLOWS = "<mimic joint='left_finger_joint' multiplier='-1.5' offset='0.1'/>"

URDF = (  # the chest before what carries it, the right arm before the left
    "<robot name='two_arms'><link name='base'/>"
    + _moved("chest", "revolute", "lift", "xyz='0 0 0.3'", "0 0 1", 5)
    + _arm("right", -0.2)
    + _moved("lift", "prismatic", "base", "xyz='0 0 0.2' rpy='0.1 0 0'", "0 0 1", 8)
    + _arm("left", 0.2)
    + _moved("left_finger", "prismatic", "left_hand", "xyz='0.1 0.02 0'", "0 1 0", 0.2)
    + _moved("left_other_finger", "prismatic", "left_hand", "xyz='0.1 -0.02 0'", "0 1 0", 0.3, _FOLLOWS)
    + "</robot>"
)  # fmt: skip

# Without fingers, which no tip needs: two arms on a torso.
ARMS = ("left_tool", "right_tool")


def written(directory: Path) -> Path:
    """The description as a file."""
    path = directory / "two_arms.urdf"
    path.write_text(URDF)
    return path


def states(count: int = 20, joints: int = len(JOINTS)) -> Floats:
    """q, qd, qdd: (3, N, n)."""
    return np.random.default_rng(3).uniform(-1.5, 1.5, (3, count, joints))


def motion(solver: Solver, still: tuple[str, ...] = (), seconds: float = 20.0) -> dict[str, Floats]:
    """A motion of all joints at 200 Hz but those that stand `still`, as a table with exact torques."""
    time = np.arange(0.0, seconds, 0.005)
    rates = 0.7 + 0.13 * np.arange(len(solver.joint_names))
    size = np.array([0.0 if name in still else 0.5 for name in solver.joint_names])
    phase = time[:, None] * rates
    q, qd = size * np.sin(phase), size * rates * np.cos(phase)
    effort = solver.torques(q, qd, -size * rates**2 * np.sin(phase))
    return {"time": time, "q": q, "qd": qd, "effort": effort}
