# SPDX-License-Identifier: Apache-2.0
"""Calls with arguments that a function doesn't take: one line with argument, expected, and got."""

from __future__ import annotations

import math

import numpy as np
import pytest
from example_robots import UR10

from inverse_dynamics import Solver, UserError, _core, evaluate
from inverse_dynamics.arguments import checked, refused
from inverse_dynamics.contact import ContactDetector, EstimatorOptions
from inverse_dynamics.control import Gains
from inverse_dynamics.errors import ArgumentError, InvalidParameterError

Q = np.zeros(6)


@pytest.fixture(scope="module")
def solver() -> Solver:
    return Solver(UR10)


def refusal(call) -> str:
    """The text of the error that a call ends in."""
    with pytest.raises(ArgumentError) as error:
        call()
    assert isinstance(error.value, UserError)
    assert isinstance(error.value, TypeError)
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize(
    ("positional", "named", "text"),
    [
        ((3,), {}, "Solver: argument plugin: expected a Robot or a text or a path, got 3"),
        ((UR10,), {"tip": 3.5}, "Solver: argument tip: expected a text, got 3.5"),
        (
            (UR10,),
            {"tpi": "tool0"},
            "Solver: argument tpi: unknown; did you mean tip? known: plugin, urdf, root, tip, "
            "gravity, friction, attached, model, parameters",
        ),
        ((UR10, "", ""), {"root": "a"}, "Solver: argument root: expected once, got twice"),
        (
            (UR10,),
            {"gravity": (0, -9.81)},
            "Solver: argument gravity: expected three numbers or None, got a tuple of 2",
        ),
        (
            (UR10,),
            {"gravity": "down"},
            "Solver: argument gravity: expected three numbers or None, got 'down'",
        ),
        (
            (UR10,),
            {"parameters": {3: 4}},
            "Solver: argument parameters: expected a dictionary whose keys are texts, got an object "
            "of type dict",
        ),
        ((UR10,) * 12, {}, "Solver: expected at most 5 arguments without a name, got 12"),
    ],
)
def test_constructor_names_the_argument(positional: tuple, named: dict, text: str) -> None:
    assert refusal(lambda: Solver(*positional, **named)) == text


def test_methods_name_the_argument(solver: Solver) -> None:
    assert (
        refusal(lambda: solver.torques(Q, Q))
        == "Solver.torques: argument qdd: expected an array of real numbers, got none"
    )
    assert (
        refusal(lambda: solver.torques(Q, Q, Q, Q))
        == "Solver.torques: expected at most 3 arguments without a name, got 4"
    )
    assert refusal(lambda: solver.gravity_vector(Q, ou=Q)) == (
        "Solver.gravity_vector: argument ou: unknown; did you mean out? known: q, out"
    )
    assert refusal(lambda: Solver.gravity_vector(3, Q)) == (
        "Solver.gravity_vector: argument self: expected a Solver, got 3"
    )


def test_functions_and_laws_name_the_argument(solver: Solver) -> None:
    assert refusal(lambda: _core.low_pass(Q[:, None], "a", 2)) == (
        "low_pass: argument sampling_frequency: expected a number, got 'a'"
    )
    assert refusal(lambda: _core.Gains(Q, ["a"])) == (
        "Gains: argument Kd: expected an array of real numbers, got an object of type list"
    )
    assert refusal(lambda: _core.Gains.of(Q)) == (
        "Gains.of: argument damping_ratio: expected an array of real numbers, got none"
    )
    assert refusal(lambda: _core.ComputedTorque(solver, 3, 4)) == (
        "ComputedTorque: argument gains: expected a Gains, got 3"
    )
    assert refusal(lambda: _core.SafeStop(Q, "elbow")) == (
        "SafeStop: argument joint_names: expected a list of texts, got 'elbow'"
    )
    with pytest.raises(TypeError, match="^argument solver: expected a Solver, got int$"):
        _core.damping_for(3, Q, 0.1, 0.1)


@pytest.mark.parametrize(
    ("positional", "named", "text"),
    [
        (
            (3, "ur10_real"),
            {},
            "argument bag: expected a path or a text or a dictionary whose keys are texts or a "
            "DataFrame, got 3",
        ),
        (
            ("bag", "ur10_real"),
            {"joints": "elbow"},
            "argument joints: expected a list of texts or None, got 'elbow'",
        ),
    ],
)
def test_evaluate_names_the_argument(positional: tuple, named: dict, text: str) -> None:
    assert refusal(lambda: evaluate(*positional, **named)) == f"evaluate: {text}"


@pytest.mark.parametrize(
    ("annotation", "right", "wrong"),
    [
        ("bool", [True, np.True_], [1, "no"]),
        ("int", [3, np.int32(3)], [3.5, "3"]),
        ("SupportsInt | typing.SupportsIndex", [3], [3.5]),
        ("float", [3, 0.5, np.float32(1)], ["3", None]),
        ("float | None", [3, None], ["3"]),
        ("Optional[float]", [3, None], ["3"]),
        ("List[str]", [["a"], ()], ["a", [3], 3, np.float64(3)]),
        ("numpy.ndarray[numpy.float64[m, 1]]", [[1, 2], np.zeros(3), 3], ["a", [[1], [1, 2]]]),
        ("inverse_dynamics._core.Gains | None", [None], [3]),
        ("whatever", [3, None, "a"], []),
    ],
)
def test_types_of_several_pybind11_releases(annotation: str, right: list, wrong: list) -> None:
    signature = f"f(x: {annotation}) -> None"
    for value in right:
        assert str(refused("f", signature, [value], {})).startswith("f: arguments: expected f(x")
    for value in wrong:
        assert str(refused("f", signature, [value], {})).startswith("f: argument x: expected ")


def test_signatures_that_are_not_python_are_shown() -> None:
    signature = "f(x: std::vector<int>) -> None"
    assert str(refused("f", signature, [1], {})) == f"f: arguments: expected {signature}, got 1"


def test_what_fits_is_passed_on(solver: Solver) -> None:
    @checked
    def hypotenuse(a: float, *, b: float = 1) -> float:
        return math.hypot(a, b)

    assert hypotenuse(3, b=4) == 5
    assert hypotenuse.__name__ == "hypotenuse"
    assert solver.gravity_vector(q=Q).shape == (6,)


@pytest.mark.parametrize(
    ("mask", "got"),
    [
        (np.ones(3), "an array of float64 of shape (3,)"),
        (np.ones(3, dtype=int), "an array of int64 of shape (3,)"),
    ],
)
def test_masks_of_numbers_are_named(mask: np.ndarray, got: str) -> None:
    numbers = np.zeros((3, 2))
    assert refusal(lambda: _core.joint_errors(["a", "b"], ["c", "d"], numbers, numbers, mask)) == (
        f"joint_errors: argument kept: expected an array of True and False or None, got {got}"
    )


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
