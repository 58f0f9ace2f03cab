# SPDX-License-Identifier: Apache-2.0
"""Calls with arguments that a function doesn't take: one line with argument, expected, and got."""

from __future__ import annotations

import inspect
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from example_robots import UR10

from inverse_dynamics import Solver, UserError, _core, compare, diagnose, evaluate, identify, retime
from inverse_dynamics.arguments import _fits, check_call, checked, signature_of
from inverse_dynamics.contact import ContactDetector, EstimatorOptions
from inverse_dynamics.control import ComputedTorque, Gains, LawOptions
from inverse_dynamics.errors import ArgumentError, InvalidParameterError

Q = np.zeros(6)


WRONG = {
    "diagnose: argument evaluation: expected Evaluation, got {}": lambda s: diagnose({}),
    "compare: argument evaluations: expected Sequence[Evaluation], got ['urdf']": (
        lambda s: compare(["urdf"])
    ),
    "Solver: argument plugin: expected Robot | str | PathLike[str], got 3": lambda s: Solver(3),
    "Solver: argument tpi: unknown; did you mean tip?": lambda s: Solver(UR10, tpi="tool0"),
    "Solver: argument friction: expected bool | None, got 'no'": lambda s: Solver(
        UR10, friction="no"
    ),
    "Solver: argument parameters: expected dict[str, Any], got {3: 4}": lambda s: Solver(
        UR10, parameters={3: 4}
    ),
    "Solver: argument gravity: expected tuple[float, float, float] | None, got (0, -9.81)": (
        lambda s: Solver(UR10, gravity=(0, -9.81))
    ),
    "Solver: multiple values for argument 'root'; it takes plugin, urdf, root, tip, gravity": (
        lambda s: Solver(UR10, "", "", root="a")
    ),
    "Solver.torques: missing a required argument: 'qdd'; it takes q, qd, qdd": (
        lambda s: s.torques(Q, Q)
    ),
    "Solver.torques: too many positional arguments; it takes q, qd, qdd": (
        lambda s: s.torques(Q, Q, Q, Q)
    ),
    "Solver.gravity_vector: argument x: unknown; known: q, out": lambda s: s.gravity_vector(Q, x=Q),
    "Solver.gravity_vector: argument self: expected Solver, got 3": (
        lambda s: Solver.gravity_vector(3, Q)
    ),
    "low_pass: argument sampling_frequency: expected float, got 'a'": (
        lambda s: _core.low_pass(Q[:, None], "a", 2)
    ),
    "joint_errors: argument kept: expected array of bool | None, got an array of float64 (6,)": (
        lambda s: _core.joint_errors(["a"], ["b"], Q[:, None], Q[:, None], np.ones(6))
    ),
    "Gains: argument Kd: expected vector, got ['a']": lambda s: Gains(Q, ["a"]),
    "Gains.of: missing a required argument: 'damping_ratio'; it takes natural_frequency, damping_ratio": (
        lambda s: Gains.of(Q)
    ),
    "LawOptions: argument damping: expected vector, got an array of float64 (2, 6)": (
        lambda s: LawOptions(Q, damping=np.zeros((2, 6)))
    ),
    "ComputedTorque: argument gains: expected Gains, got 3": lambda s: ComputedTorque(s, 3, 4),
    "evaluate: argument bag: expected Path | str | JointLog | Mapping[str, Any] | DataFrame, got 3": (
        lambda s: evaluate(3, UR10)
    ),
    "evaluate: argument joints: expected Sequence[str] | None, got 'elbow'": (
        lambda s: evaluate("bag", UR10, joints="elbow")
    ),
    "evaluate: argument cutof: unknown; did you mean cutoff?": (
        lambda s: evaluate("bag", UR10, cutof=5)
    ),
    "identify: missing a required argument: 'recordings'; it takes recordings, robot": (
        lambda s: identify(urdf="arm.urdf")
    ),
    "Solver: argument robot: unknown; did you mean plugin?": lambda s: Solver(robot=UR10),
    "retime: argument limits: expected MotionLimits | None, got 3": (
        lambda s: retime([Q, Q], UR10, limits=3)
    ),
}


@pytest.fixture(scope="module")
def solver() -> Solver:
    return Solver(UR10)


def refusal(call, *positional) -> str:
    """The text of the error that a call ends in."""
    with pytest.raises(ArgumentError) as error:
        call(*positional)
    assert isinstance(error.value, UserError)
    assert isinstance(error.value, TypeError)
    return str(error.value)


@pytest.mark.parametrize("text", WRONG)
def test_argument_is_named(solver: Solver, text: str) -> None:
    assert refusal(WRONG[text], solver) == text


def test_other_errors_are_passed_on() -> None:
    with pytest.raises(TypeError, match="^argument solver: expected a Solver, got int$"):
        _core.GravityCompensation(3, LawOptions(Q, damping=Q))


@pytest.mark.parametrize(
    ("annotation", "right", "wrong"),
    [
        ("bool", [True, np.True_], [1, "no"]),
        ("typing.SupportsInt | typing.SupportsIndex", [3, np.int32(3)], [3.5, "3"]),
        ("float", [3, 0.5, np.float32(1)], ["3", None, Q]),
        ("Optional[float]", [3, None], ["3"]),
        ("list[str]", [["a"], ()], ["a", [3], 3, np.float64(3)]),
        ("Annotated[list[float], FixedSize(3)]", [(1, 2, 3)], [(1, 2), "abc"]),
        ("numpy.ndarray[numpy.float64[m, 1]]", [[1, 2], Q], ["a", [[1], [1, 2]], np.ones((2, 2))]),
        ("numpy.ndarray[bool]", [[True]], [[1.0]]),
        ("inverse_dynamics._core.Gains | None", [None, Gains(Q, Q)], [3]),
        ("std::vector<int>", [3, "a"], []),
    ],
)
def test_types_of_several_pybind11_releases(annotation: str, right: list, wrong: list) -> None:
    def function(): ...

    function.head = f"f(x: {annotation}, *, y: object = <a: b>) -> None"
    function.__signature__ = signature_of(function)
    assert function.__signature__.parameters["y"].default is ...
    for value in right:
        check_call(function, value)
    for value in wrong:
        assert ": argument x: expected " in refusal(check_call, function, value)


def test_what_fits_is_passed_on(solver: Solver) -> None:
    @checked
    def product(a: float, *, b: float = 1) -> float:
        return a * b

    assert product(3, b=4) == 12
    assert product.__name__ == "product"
    assert {"bag", "cutoff", "start"} <= inspect.signature(evaluate).parameters.keys()
    assert solver.gravity_vector(q=Q).shape == (6,)


def test_a_list_of_what_may_be_several_things_fits():
    fits = partial(_fits, expected="Path | Sequence[Path | str | Mapping[str, Any] | DataFrame]")
    assert fits(["a.csv", Path("b.csv"), {"q": [1.0]}])
    assert not fits(["a.csv", 1.0])


@pytest.mark.parametrize(
    "numbers", [["1", "2", "3", "4", "5", "6"], np.full(6, 1 + 2j), [None] * 6], ids=str
)
def test_what_isnt_a_number_is_no_vector(solver, numbers):
    """numpy would read texts, and drop imaginary parts."""
    for call in (
        lambda: EstimatorOptions(numbers),
        lambda: Gains(numbers, numbers),
        lambda: ContactDetector(np.ones(6), ["a"] * 6).update(numbers, 0.01),
        lambda: _core.residual_noise(np.arange(6.0), [numbers] * 6),
    ):
        with pytest.raises(TypeError):
            call()
    with pytest.raises(InvalidParameterError):
        solver.torques(numbers, Q, Q)
    with pytest.raises(InvalidParameterError):
        solver.set_gravity(numbers[:3])
    EstimatorOptions([60, 60])
