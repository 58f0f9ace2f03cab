# SPDX-License-Identifier: Apache-2.0
"""How good estimates of payloads are: simulated loads on the real residuals of a real arm.

The arm's model is fitted to other parts of the recording than those that the load is estimated from, and its
residuals, of blocks that it hasn't seen, stay in the torques: either those of the window itself, or those of
another part of the recording.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics import Solver, _core, evaluate, load_robot
from inverse_dynamics.identification.payload import samples_of
from inverse_dynamics.robot.descriptions import parse_description, read_description

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from payload_truth import Arm, part, torques, trials

RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
BLOCKS = 5
TRIALS = 200
TIP = {"panda": [0, 0, 0.107]}  # m, flange in the frame of the last link
EDGE = 10  # samples at either end of the recording, where accelerations are poor

# Medians: relative error of the mass, distance of the centre of mass [m].
MOST = {
    ("panda", 1.0): (0.015, 0.010),  # 30 Hz
}


def make_arm(recordings: Path, name: str, directory: Path) -> Arm:
    evaluation = evaluate(recordings / f"{name}_exciting_trajectory", f"{name}_real")
    samples = part(samples_of(evaluation), slice(EDGE, -EDGE))
    robot = load_robot(f"{name}_real")
    description = read_description(robot.urdf)
    fitter = _core.ArmFitter.from_urdf(description, root=robot.root, tip=robot.tip)
    edges = np.linspace(0, len(samples.time), BLOCKS + 1).astype(int)
    blocks = tuple(slice(int(a), int(b)) for a, b in pairwise(edges))
    solvers, residuals = [], np.empty_like(samples.measured)
    for k, block in enumerate(blocks):
        others = [part(samples, other) for other in blocks if other != block]
        fit = fitter.fit(
            [(s.q, s.qd, s.qdd, s.measured) for s in others],
            law="step",
            prior_strength=100.0,
        )
        file = directory / f"{name}_{k}.yaml"
        file.write_text(model_text(name, description, robot, fit))
        solver = Solver(RIGID_BODY, model=str(file))
        held_out = part(samples, block)
        residuals[block] = held_out.measured - torques(solver, held_out)
        solvers.append(solver)
    return Arm(samples, blocks, tuple(solvers), residuals)


def model_text(name, description, robot, fit) -> str:
    """A model file of a chain whose joints turn about the z axes of their frames."""
    lines = [
        f"schema: 1\nname: {name}\nsource: a test\nvalidity: a test\nunits: SI\ngeometry: placements",
        "gravity: [0, 0, -9.81]\nparameters: about_origin",
        f"tip: {{xyz: {TIP[name]}, rpy: [0, 0, 0]}}\njoints:",
    ]
    for j, (joint, placement) in enumerate(placements(description, robot.joints)):
        lines.append(
            f"  - name: {joint}\n    type: revolute\n    placement: {{{placement}, axis: [0, 0, 1]}}\n"
            f"    rotor_inertia: {float(fit.rotor_inertia[j])!r}\n"
            f"    friction: {{{sigmoid(fit.friction[j])}}}\n    link: {fit.parameters[j].tolist()}"
        )
    return "\n".join(lines) + "\n"


def placements(description: str, names):
    """Of joints with no fixed one between them, as the description states them."""
    joints = {joint.get("name"): joint for joint in parse_description(description).iter("joint")}
    for name in names:
        origin = joints[name].find("origin")
        xyz, rpy = ([float(n) for n in origin.get(key, "0 0 0").split()] for key in ("xyz", "rpy"))
        assert joints[name].find("axis").get("xyz").split() == ["0", "0", "1"]
        yield name, f"xyz: {xyz}, rpy: {rpy}"


def sigmoid(law) -> str:
    """fv qd + fo + fc tanh((qd + shift) / width), as a logistic step."""
    figures = {
        "fv": law["fv"],
        "fo": law.get("fo", 0.0) - law["fc"],
        "fc": 2 * law["fc"],
    }
    figures |= {"alpha": 2 / law["width"], "nu": law.get("shift", 0.0)}
    return "law: viscous_offset_sigmoid, " + ", ".join(f"{k}: {v!r}" for k, v in figures.items())


@pytest.mark.parametrize(("name", "mass"), MOST)
def test_simulated_loads_on_real_residuals(recordings, tmp_path, name, mass):
    found = trials(make_arm(recordings, name, tmp_path), mass, TRIALS)
    most_mass, most_center = MOST[name, mass]
    assert found.mass <= most_mass, found
    assert found.center <= most_center, found
    assert 0.90 <= found.coverage <= 0.99, found
    assert found.ratio_of_mass <= 4.0, found
    assert found.ratio_of_center <= 4.0, found


def test_five_kilograms_on_a_ur10_whose_friction_grows_with_load(recordings, tmp_path):
    """With the law, prior strength and delay that `ids identify` chooses."""
    arm = Arm.of(recordings / "ur10_exciting_trajectory", "ur10_real", tmp_path)
    assert arm.solvers[0].friction_depends_on_position
    found = trials(arm, 5.0, 100)
    assert found.mass <= 0.012, found
    assert found.center <= 0.010, found
    assert 0.90 <= found.coverage <= 0.99, found
    assert found.ratio_of_center <= 4.0, found
