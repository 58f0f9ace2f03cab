# SPDX-License-Identifier: Apache-2.0
"""Real recordings whose gravity a robot has subtracted, by a model with other masses than the description's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from inverse_dynamics import FastModel, evaluate, identify, load_robot, read_joint_log
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.knowledge import DOUBT
from inverse_dynamics.recordings.bags import write_joint_logs

ROBOTS = pytest.mark.parametrize("name", ["ur10", "panda"])
DOWN = (0.0, 0.0, -9.81)


def without_gravity(recordings, name, factors, gravity=DOWN):
    """The recording, less the gravity torques of the description with its masses times the factors."""
    robot = load_robot(f"{name}_real")
    log = read_joint_log(recordings / f"{name}_exciting_trajectory", robot.joints)
    own = FastModel.from_urdf(
        robot.urdf.read_text(), root=robot.root, tip=robot.tip, gravity=gravity
    )
    links = own.parameters.reshape(-1, 10) * np.broadcast_to(factors, len(robot.joints))[:, None]
    still = np.zeros_like(log.q)
    return replace(log, effort=log.effort - own.regressor(log.q, still, still) @ links.ravel())


def friction(found, qd):
    """(3, n) at a slow, a medium and a fast velocity of each joint; N m."""
    return np.array(
        [
            [
                law["fv"] * v + law["fc"] * np.tanh((v + law["shift"]) / law["width"])
                for v in np.quantile(np.abs(speeds), (0.3, 0.5, 0.8))
            ]
            for law, speeds in zip(found.model.friction, qd.T, strict=True)
        ]
    )


@ROBOTS
def test_masses_that_are_wrong_by_a_tenth_cost_little(recordings, identified, tmp_path, name):
    log = without_gravity(recordings, name, 1.1)
    write_joint_logs(tmp_path / "bag", {log.topic: log})
    meant = replace(load_robot(f"{name}_real"), effort="torque_without_gravity")
    found, full = identify([tmp_path / "bag"], meant), identified(name)
    assert found.rmse("identified") <= 1.10 * full.rmse("identified")
    np.testing.assert_allclose(friction(found, log.qd), friction(full, log.qd), rtol=0.05)
    assert 0.90 <= found.coverage.mean() <= 0.98

    # what is assumed is said, and counts: masses are less certain than with gravity
    (gravity,) = (finding for finding in found.findings if finding.kind == "gravity")
    assert f"the robot is taken to subtract that of {name}.urdf" in gravity.text
    assert found.factor.shape[1] >= full.factor.shape[1] + len(found.joints) - 3
    first = found.factor[: 10 * len(found.joints), -len(found.joints) :]
    masses = np.abs(first).max(axis=1)[::10]
    assert masses[2] > 0.2 * DOUBT * found.prior[2, 0]

    files = write_identification(found, tmp_path / "arm.yaml")
    again = evaluate(tmp_path / "bag", files.robot)
    assert again.effort.meaning == "torque_without_gravity"
    assert np.mean([e.rmse for e in again.errors_of_kept]) <= found.rmse("identified")


@ROBOTS
@pytest.mark.parametrize("mistake", ["none", "turned base", "masses twice"])
def test_a_wrong_model_of_gravity_is_reported(recordings, name, mistake):
    """Of masses that are 10 % off none is; also from a model identified under one direction of gravity."""
    for seed, model in enumerate(["simulated", "real"] * 2):
        robot = load_robot(f"{name}_{model}")
        robot = replace(robot, effort="torque_without_gravity", joints=())
        random = np.random.default_rng(seed)
        factors, angle = random.uniform(0.9, 1.1, 7)[: 6 + (name == "panda")], random.uniform(0, 6)
        gravity = DOWN
        if mistake == "turned base":  # by 30 degrees
            gravity = (4.905 * np.cos(angle), 4.905 * np.sin(angle), -8.496)
        if mistake == "masses twice":
            factors = 2 * factors
        log = without_gravity(recordings, name, factors, gravity)
        arrays = {"time": log.time, "q": log.q, "qd": log.qd, "effort": log.effort}
        found = evaluate(arrays, robot)
        reported = [cause.reason for cause in found.diagnosis if cause.kind == "gravity"]
        assert len(reported) == (mistake != "none"), (seed, found.notes[-1])
        assert all("if the robot subtracts gravity along" in reason for reason in reported)
