# SPDX-License-Identifier: Apache-2.0
"""The types of the extension module are those of the module that is built: names and arguments."""

import ast
import re
from pathlib import Path

import pytest

import inverse_dynamics
from inverse_dynamics import _core

STUB = Path(inverse_dynamics.__file__).with_name("_core.pyi")
# Aliases of types, of the stub alone.
ALIASES = {"Block", "Floats", "Integers", "Mask", "Parameter"}
# Every enum of the extension module has them, as every Enum of the stub.
OF_ENUMS = {"name", "value"}


def public(names):
    return {name for name in names if not name.startswith("_")}


def functions(body):
    return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}


def names_in(body):
    targets = [target for node in body if isinstance(node, ast.Assign) for target in node.targets]
    return (
        functions(body).keys()
        | {node.name for node in body if isinstance(node, ast.ClassDef)}
        | {node.target.id for node in body if isinstance(node, ast.AnnAssign)}
        | {target.id for target in targets}
    )


MODULE = ast.parse(STUB.read_text()).body
CLASSES = {node.name: node for node in MODULE if isinstance(node, ast.ClassDef)}
BUILT = {name: value for name, value in vars(_core).items() if isinstance(value, type)}


def is_property(node):
    return any(getattr(mark, "id", "") == "property" for mark in node.decorator_list)


def stub_arguments(node):
    """Names, with a star where those begin that must be named."""
    names = [argument.arg for argument in node.args.args if argument.arg != "self"]
    return names + ["*"] * bool(node.args.kwonlyargs) + [a.arg for a in node.args.kwonlyargs]


def built_arguments(function):
    """The same, from the signature that begins the function's text."""
    signature = function.__doc__.splitlines()[0].rsplit(" -> ", 1)[0]
    names = re.findall(r"(?:(?<=[(, ])(\w+): |, (\*)(?=,))", signature)
    return [name or star for name, star in names if name != "self"]


def callables():
    for name, node in functions(MODULE).items():
        yield name, node, getattr(_core, name)
    for owner, body in ((name, node.body) for name, node in CLASSES.items()):
        for name, node in functions(body).items():
            if not is_property(node):
                yield f"{owner}.{name}", node, getattr(getattr(_core, owner), name)


def test_the_module_has_the_names_of_the_stub():
    assert names_in(MODULE) - ALIASES == public(vars(_core))


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_has_the_names_of_the_stub(name):
    assert public(names_in(CLASSES[name].body)) == public(vars(BUILT[name])) - OF_ENUMS


@pytest.mark.parametrize("name", CLASSES)
def test_properties_of_the_stub_are_properties(name):
    built = {key for key, value in vars(BUILT[name]).items() if isinstance(value, property)}
    stub = {key for key, node in functions(CLASSES[name].body).items() if is_property(node)}
    assert stub == public(built) - OF_ENUMS


@pytest.mark.parametrize(
    ("name", "node", "built"), [pytest.param(*c, id=c[0]) for c in callables()]
)
def test_a_function_has_the_arguments_of_the_stub(name, node, built):
    assert stub_arguments(node) == built_arguments(built), built.__doc__
