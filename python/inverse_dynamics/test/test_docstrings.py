# SPDX-License-Identifier: Apache-2.0
"""What help() and inspect.signature() show of the public names; examples of docstrings are run."""

import doctest
import inspect
import re

import numpy as np
import pytest

import inverse_dynamics
from inverse_dynamics import _core, contact, control

PUBLIC = {name: getattr(inverse_dynamics, name) for name in inverse_dynamics.__all__}
BOUND = {n: v for n, v in PUBLIC.items() if v.__module__ == _core.__name__ and n != "JointError"}
EXAMPLES = [
    example
    for name, value in PUBLIC.items()
    for example in doctest.DocTestFinder().find(value, name, module=False)
    if example.examples
]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_give_what_they_show(example, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shown = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=shown.append)
    assert not shown, "".join(shown)


def methods(owner):
    return [(n, m) for n, m in vars(owner).items() if inspect.isroutine(m) and n[0] != "_"]


def test_computing_methods_have_sections_and_examples():
    shown = {example.name for example in EXAMPLES}
    for name in ("Solver", "FastModel"):
        for method, function in methods(PUBLIC[name]):
            if "q" in inspect.signature(getattr(PUBLIC[name], method)).parameters:
                assert f"{name}.{method}" in shown
                for section in ("Parameters", "Returns", "Examples"):
                    assert f"\n{section}\n{'-' * len(section)}\n" in function.__doc__
    assert {"Solver", "FastModel", "Robot", "Evaluation"} <= shown
    assert {"available_solvers", "load_robot", "robot_names"} <= shown
    assert {"evaluate", "evaluate_many", "identify", "retime"} <= shown


def test_functions_have_sections():
    for name, function in PUBLIC.items():
        if inspect.isroutine(function) and len(inspect.signature(function).parameters) > 2:
            for section in ("Parameters", "Raises"):
                assert f"\n{section}\n{'-' * len(section)}\n" in inspect.getdoc(function), name


def bound_members():
    """Functions, methods and properties of the bound module, by name."""
    for name, value in vars(_core).items():
        if inspect.isclass(value) and not issubclass(value, BaseException):
            for member, of in vars(value).items():
                if member[0] != "_" and not isinstance(of, value) and member not in ENUMS:
                    yield name, f"{name}.{member}", getattr(of, "__func__", of)
        elif callable(value) and name[0] != "_":
            yield name, name, value


ENUMS = ("name", "value")  # what pybind11 gives members of enumerations
PUBLIC_BOUND = {*BOUND, "JointError", *contact.__all__, *control.__all__}


def test_every_bound_member_says_what_it_is():
    assert [place for _, place, of in bound_members() if not (of.__doc__ or "").strip()] == []


def test_bound_functions_that_users_call_say_their_arguments_and_results():
    lacking = []
    for owner, place, function in bound_members():
        if owner not in PUBLIC_BOUND or isinstance(function, property):
            continue
        doc, signature = inspect.getdoc(function), inspect.signature(function)
        for name in signature.parameters:
            if name != "self" and not re.search(rf"^[\w, ]*\b{name}\b[\w, ]* : ", doc, re.M):
                lacking.append(f"{place}: {name}")
        if signature.return_annotation != "None" and "\nReturns\n-------\n" not in doc:
            lacking.append(f"{place}: Returns")
    assert lacking == []


def test_bound_functions_have_signatures_with_types():
    signature = inspect.signature(inverse_dynamics.Solver.torques)
    assert list(signature.parameters) == ["self", "q", "qd", "qdd", "wrench", "frame", "tip", "out"]
    assert signature.parameters["q"].annotation == "numpy.typing.ArrayLike"
    assert signature.parameters["frame"].default == "root"
    assert signature.parameters["out"].kind is inspect.Parameter.KEYWORD_ONLY
    assert "NDArray" in signature.return_annotation
    assert list(inspect.signature(inverse_dynamics.Solver).parameters)[:2] == ["plugin", "urdf"]
    solver = inverse_dynamics.Solver("ur10_real")
    assert list(inspect.signature(solver.jacobian).parameters) == ["q", "frame", "out"]
    for owner in (value for value in BOUND.values() if inspect.isclass(value)):
        for name, _ in methods(owner):
            assert inspect.signature(getattr(owner, name)).parameters is not None
            assert not (getattr(owner, name).__doc__ or "").startswith(f"{name}(")


def test_public_names_are_shown():
    assert dir(inverse_dynamics) == sorted([*PUBLIC, "__version__"])


def test_a_method_of_a_class_is_called_with_an_object():
    solver = inverse_dynamics.Solver("ur10_real")
    q = np.zeros(6)
    np.testing.assert_array_equal(
        inverse_dynamics.Solver.gravity_vector(solver, q), solver.gravity_vector(q)
    )
