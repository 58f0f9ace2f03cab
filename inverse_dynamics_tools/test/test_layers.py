# SPDX-License-Identifier: Apache-2.0
"""The layers of the package: a module imports from its own part and from those below, never upwards.

Imports inside functions and those for annotations alone count too.
"""

from __future__ import annotations

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "inverse_dynamics"

# From the bottom. Parts of one layer don't know each other.
LAYERS = (
    ("base",),
    ("data", "robot", "control", "contact"),
    ("evaluation", "simulation"),
    ("identification",),
    ("figures",),
    ("report",),
    ("results",),
    ("verbs",),
    ("cli",),
)
LEVEL = {part: level for level, parts in enumerate(LAYERS) for part in parts}
IN_BASE = ("errors", "_core")  # modules whose names users know


def modules() -> dict[str, Path]:
    """Files by the dotted names of their modules, without the package's own."""
    files = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        parts = file.relative_to(PACKAGE).with_suffix("").parts
        files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    del files[""]  # the public names, from everywhere
    return files


def part_of(module: str) -> str:
    """The part that a module belongs to."""
    first = module.partition(".")[0]
    return "base" if first in IN_BASE else first


def imports(source: str, known: set[str]) -> set[str]:
    """Modules of the package that a source imports anywhere; `from inverse_dynamics import x` too."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, "a relative import"
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            whole = [alias.name for alias in node.names]
        else:
            continue
        for name in whole:
            top, _, module = name.partition(".")
            if top == "inverse_dynamics":
                found.add(module if module in known else module.rpartition(".")[0] or module)
    return found


def graph() -> dict[str, set[str]]:
    """What each module imports."""
    files = modules()
    known = {*files, "_core"}
    return {module: imports(file.read_text(), known) for module, file in files.items()}


def test_every_module_belongs_to_a_part() -> None:
    assert {part_of(module) for module in modules()} == set(LEVEL)


def test_imports_point_down() -> None:
    upward = [
        f"{module} imports {other}"
        for module, others in graph().items()
        for other in sorted(others)
        if part_of(module) != part_of(other) and LEVEL[part_of(module)] <= LEVEL[part_of(other)]
    ]
    assert upward == []


def test_no_module_imports_itself_over_others() -> None:
    try:
        TopologicalSorter(graph()).prepare()
    except CycleError as error:
        pytest.fail(f"modules in a circle: {' <- '.join(error.args[1])}")


def test_verbs_import_no_other_verb() -> None:
    """What several verbs need is in modules that aren't verbs."""
    from inverse_dynamics.cli import VERBS

    verbs = {f"verbs.{verb}" for verb in VERBS}
    arrows = graph()
    assert {verb: arrows[verb] & verbs for verb in verbs if arrows[verb] & verbs} == {}
