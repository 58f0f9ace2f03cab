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
FILES = {
    ".".join(file.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__"): file
    for file in sorted(PACKAGE.rglob("*.py"))
    if file != PACKAGE / "__init__.py"  # the public names, from everywhere
}


def part_of(module: str) -> str:
    first = module.partition(".")[0]
    return "base" if first in IN_BASE else first


def imports(file: Path) -> set[str]:
    """Modules of the package that a file imports anywhere; `from inverse_dynamics import x` too."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, "a relative import"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    own = [n.removeprefix("inverse_dynamics.") for n in found if n.startswith("inverse_dynamics.")]
    return {n if n in {*FILES, "_core"} else n.rpartition(".")[0] or n for n in own}


IMPORTS = {module: imports(file) for module, file in FILES.items()}


def test_imports_point_down() -> None:
    upward = [
        f"{module} imports {other}"
        for module, others in IMPORTS.items()
        for other in sorted(others)
        if part_of(module) != part_of(other) and LEVEL[part_of(module)] <= LEVEL[part_of(other)]
    ]
    assert upward == []


def test_no_module_imports_itself_over_others() -> None:
    try:
        TopologicalSorter(IMPORTS).prepare()
    except CycleError as error:
        pytest.fail(f"modules in a circle: {' <- '.join(error.args[1])}")


def test_verbs_import_no_other_verb() -> None:
    """What several verbs need is in modules that aren't verbs."""
    from inverse_dynamics.cli import VERBS

    verbs = {f"verbs.{verb}" for verb in VERBS}
    assert [verb for verb in verbs if IMPORTS[verb] & verbs] == []
