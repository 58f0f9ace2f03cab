# SPDX-License-Identifier: Apache-2.0
"""Recordings of real robots: figures that the reference implementation's method gives on them."""

from dataclasses import replace

import numpy as np
import pytest

from inverse_dynamics import evaluate, load_robot, read_joint_log, write_joint_logs
from inverse_dynamics.robots.choices import EFFORT_MEANINGS
from inverse_dynamics.robots.solvers import open_solver

BACKWARD_DIFFERENCE = {
    "ur10": "4.257 4.710 1.772 0.756 0.748 1.317",
    "panda": "1.083 0.738 0.860 1.070 0.173 0.242 0.078",
}

# Mean absolute errors, which the reference implementation's plots name: docs/accuracy.md.
MEAN_ABSOLUTE = {
    "ur10": "3.662 4.126 1.271 0.555 0.478 0.799",
    "panda": "0.810 0.499 0.649 0.723 0.133 0.190 0.059",
}

# The reference implementation's own test allows 1e-6 N m [docs/accuracy.md].
GROUND_TRUTH = 1e-10

# What the default filter must not exceed: mean over the joints [N m].
MOST_BY_DEFAULT = {"ur10": 2.27, "panda": 0.49}

ROBOTS = pytest.mark.parametrize("name", ["ur10", "panda"])


@ROBOTS
def test_backward_differences_give_the_published_errors_to_all_digits(recordings, name):
    bag = recordings / f"{name}_exciting_trajectory"
    result = evaluate(bag, f"{name}_real", accelerations="backward-difference")
    assert " ".join(f"{e.rmse:.3f}" for e in result.errors) == BACKWARD_DIFFERENCE[name]
    assert " ".join(f"{e.mae:.3f}" for e in result.errors) == MEAN_ABSOLUTE[name]


def test_the_ground_truth_of_the_reference_implementation_is_reproduced(recordings):
    """ur10_inverse_dynamics_solver/test/bagfiles of unisa-acg/inverse-dynamics-solver: its own torques."""
    file = recordings / "validation_trajectory" / "validation_trajectory.db3"
    if not file.is_file():
        pytest.skip(f"no {file}: it is in the reference implementation's repository")
    result = evaluate(file, "ur10_real")
    assert len(result.log) == 3441
    np.testing.assert_allclose(result.computed, result.measured, rtol=0, atol=GROUND_TRUTH)


@ROBOTS
def test_the_default_filter_is_at_least_as_good_as_promised(recordings, name):
    result = evaluate(recordings / f"{name}_exciting_trajectory", f"{name}_real")
    assert result.accelerations.chosen
    assert result.mean_rmse <= MOST_BY_DEFAULT[name]


def test_faults_of_the_panda_recording_are_said(recordings):
    result = evaluate(recordings / "panda_exciting_trajectory", "panda_real")
    assert int(result.samples.repeated.sum()) == 14
    assert result.samples.start_transient[:3].all()
    assert result.accelerations.time_base != "stamps"
    assert 1e3 * result.samples.period == pytest.approx(34, abs=0.1)


def test_rigid_bodies_without_friction_fit_the_real_ur10_less(recordings):
    result = evaluate(
        recordings / "ur10_exciting_trajectory",
        "ur10_real",
        plugin="kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL",
        accelerations="backward-difference",
    )
    published = [21.4, 21.7, 16.3, 5.9, 4.1, 5.7]  # the last digit may be rounded twice
    assert [e.rmse for e in result.errors] == pytest.approx(published, abs=0.055)


@ROBOTS
@pytest.mark.parametrize("meaning", EFFORT_MEANINGS)
def test_what_efforts_mean_is_found_and_the_table_stays_the_same(
    recordings, tmp_path, name, meaning
):
    bag, robot = recordings / f"{name}_exciting_trajectory", load_robot(f"{name}_real")
    solver = open_solver(robot)
    if solver.drive_gains is None:
        robot = replace(robot, drive_gains=(10.0,) * len(robot.joints))
    log = read_joint_log(bag, robot.joints)
    efforts = {
        "torque": log.effort,
        "current": log.effort / (robot.drive_gains or solver.drive_gains),
        "torque_without_gravity": log.effort - solver.gravity_vector(log.q),
    }
    write_joint_logs(tmp_path / "bag", {log.topic: replace(log, effort=efforts[meaning])})
    result = evaluate(tmp_path / "bag", robot, effort_is="auto")
    assert (result.effort.meaning, result.effort.verdict.sure) == (meaning, True)
    expected = evaluate(bag, robot)
    assert [e.rmse for e in result.errors] == pytest.approx([e.rmse for e in expected.errors])
    kept = [e.rmse for e in expected.errors_of_kept]
    assert [e.rmse for e in result.errors_of_kept] == pytest.approx(kept)


def test_currents_whose_drive_gains_arent_known_end_in_no_confident_answer(recordings, tmp_path):
    robot = load_robot("panda_real")
    log = read_joint_log(recordings / "panda_exciting_trajectory", robot.joints)
    write_joint_logs(tmp_path / "bag", {log.topic: replace(log, effort=log.effort / 10)})
    result = evaluate(tmp_path / "bag", robot, effort_is="auto")
    assert (result.effort.meaning, result.effort.verdict.sure) == ("torque", False)
    assert [cause.kind for cause in result.diagnosis] == ["effort_scale"]
