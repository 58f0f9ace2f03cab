# SPDX-License-Identifier: Apache-2.0
import copy

import numpy as np
import pytest
from example_robots import FRANKA, KDL, PENDULUM, RIGID_BODY, UR10
from scipy import signal

from inverse_dynamics import Solver, UserError, _core, available_solvers, errors


@pytest.fixture(scope="module")
def ur10():
    return Solver(UR10)


def test_installed_solvers_are_listed():
    assert {UR10, FRANKA, RIGID_BODY, KDL} <= set(available_solvers())


def test_an_empty_batch_gives_an_empty_result(ur10):
    nothing = np.zeros((0, 6))
    assert ur10.torques(nothing, nothing, nothing).shape == (0, 6)
    assert ur10.inertia_matrix(nothing).shape == (0, 6, 6)


# Errors: of the C++ exceptions' kinds, with their texts.


def test_unknown_plugin_lists_what_there_is():
    with pytest.raises(errors.PluginNotFoundError) as caught:
        Solver("ur11/Solver")
    assert "'ur11/Solver': not found: expected one of" in str(caught.value)
    assert UR10 in str(caught.value)


def test_parameter_of_the_wrong_type_is_an_error():
    with pytest.raises(errors.InvalidParameterError, match="attached"):
        Solver(RIGID_BODY, urdf=PENDULUM, parameters={"attached": 3})
    with pytest.raises(errors.InvalidParameterError, match="friction"):
        Solver(RIGID_BODY, urdf=PENDULUM, parameters={"friction": "no"})
    with pytest.raises(TypeError, match=r"parameter 'x': expected bool, int, .* got complex"):
        Solver(RIGID_BODY, urdf=PENDULUM, parameters={"x": 1j})


def test_parameter_given_twice_is_an_error():
    with pytest.raises(errors.InvalidParameterError, match="argument tip and parameters"):
        Solver(RIGID_BODY, urdf=PENDULUM, tip="hand", parameters={"tip": "hand"})
    with pytest.raises(errors.InvalidParameterError, match="argument friction and parameters"):
        Solver(RIGID_BODY, urdf=PENDULUM, friction=False, parameters={"friction": True})


@pytest.mark.parametrize(
    ("arguments", "unknown", "remedy"),
    [
        ({"gravty": [0.0, 0.0, 1.0]}, "gravty", "did you mean 'gravity'?"),
        ({"x": True}, "x", "correct or remove it"),
        ({"locked_joints.wrist": 1.0}, "locked_joints.wrist", "correct or remove it"),
    ],
)
def test_unknown_parameter_is_an_error(arguments, unknown, remedy):
    with pytest.raises(errors.InvalidParameterError) as caught:
        Solver(RIGID_BODY, urdf=PENDULUM, parameters=arguments)
    text = str(caught.value)
    assert text.startswith(f"parameter '{unknown}': the solver doesn't know it: expected one of ")
    assert "batch_threads, friction, gravity, " in text
    assert text.endswith(f"; {remedy}")


@pytest.mark.parametrize(
    "call",
    [
        lambda solver: solver.torques(*3 * [np.zeros(6)]),
        lambda solver: Solver.gravity_vector(solver, np.zeros(6)),
        lambda solver: solver.joint_names,
        lambda solver: solver.drive_gains,
        repr,
        copy.copy,
    ],
)
def test_object_without_init_is_an_error(call):
    solver = Solver.__new__(Solver)
    message = "^an object without __init__; make it by calling its class$"
    with pytest.raises(TypeError, match=message):
        call(solver)


def test_argument_without_init_is_an_error():
    none = _core.Compensated.__new__(_core.Compensated)
    with pytest.raises(TypeError, match="^an object without __init__"):
        _core.LawOptions(effort_limit=np.ones(6), damping=np.ones(6), compensated=none)


def test_errors_of_solvers_are_user_errors():
    assert issubclass(errors.PluginNotFoundError, UserError)
    assert issubclass(errors.InvalidRobotDescriptionError, errors.InvalidParameterError)


# Filters and metrics: against scipy and numpy.


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("cutoff", [0.7, 5.0, 40.0])
@pytest.mark.parametrize("padding", [0, 9, 150])
def test_low_pass_is_that_of_scipy(order, cutoff, padding):
    rate = 125.0
    samples = np.cumsum(np.random.default_rng(1).normal(size=(800, 3)), axis=0)
    sections = signal.butter(order, cutoff, fs=rate, output="sos")
    kind = "odd" if padding else None
    expected = signal.sosfiltfilt(sections, samples, axis=0, padtype=kind, padlen=padding)
    result = _core.low_pass(samples, rate, cutoff, order, padding)
    scale = np.abs(samples).max()
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-9 * scale)


def test_samples_that_can_not_be_evaluated_are_an_error():
    with pytest.raises(errors.EvaluationError):
        _core.joint_errors(("a", "b"), ("N m", "N"), np.zeros((3, 2)), np.zeros((4, 2)))
    with pytest.raises(errors.EvaluationError):
        _core.backward_difference(np.zeros(4), np.zeros((3, 2)))


@pytest.mark.parametrize(
    "rows",
    [
        [],
        [(np.zeros(2, np.int64), np.zeros(1, np.int64), *[np.zeros((2, 1))] * 3)],
        [(np.zeros(2, np.int64), np.zeros(2, np.int64), *[np.zeros((2, 2))] * 3)],
        [(np.zeros(2, np.int64), np.zeros(2, np.int64), *[np.zeros(2)] * 3)],
    ],
)
def test_rows_that_do_not_fit_a_topic_are_an_error(tmp_path, rows):
    writer = _core.JointStateWriter(str(tmp_path / "bag"), "mcap", [("/torques", ["a"], "")])
    with pytest.raises(ValueError, match=r"^(JointStateWriter\.write|joint states): expected "):
        writer.write(rows)
