# SPDX-License-Identifier: Apache-2.0
"""A feature is a folder. What it may import is stated here, once.

Imports inside functions, for annotations alone and by the name of a module in a text count, too.
"""

from __future__ import annotations

import ast
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]

# What features share, from the bottom: each knows itself and those before it.
SHARED = (
    *("wording", "_core", "errors", "arrays", "decimals", "progress", "arguments", "contact"),
    *("installation", "outputs", "robots", "recordings", "show", "evaluation"),
)
# Only modules verb_*.py and cli.py know the terminal.
TERMINAL = "terminal"

# Features that import another feature, and why.
ALLOWED = {
    ("demo", "comparison"): "the models of the real UR10 side by side",
    ("demo", "public_recordings"): "recordings that were fetched",
    ("demo", "simulation"): "recordings of the simulated robots",
    ("evaluation", "diagnosis"): "meaning of efforts, and causes of errors",
    ("excitation", "simulation"): "the robot whose motion is chosen",
    ("feedforward", "diagnosis"): "plans that contradict themselves",
    ("identification", "diagnosis"): "recordings that no model is identified from",
    ("identification", "payload"): "the former name of payload.payload",
    ("results", "identification"): "the former name of identification.files",
    ("retiming", "diagnosis"): "paths that contradict themselves",
    ("robots", "simulation"): "the verb checks `simulation:` of a run configuration",
    ("simulation", "excitation"): "`ids simulate --optimise`",
}

FILES = {
    ".".join(file.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__"): file
    for file in sorted(PACKAGE.rglob("*.py"))
    if file != PACKAGE / "__init__.py"  # the public names, from everywhere
    and "test" not in file.relative_to(PACKAGE).parts
}


def part_of(module: str) -> str:
    return module.partition(".")[0]


def imports(file: Path) -> set[str]:
    """Modules of the package that a file imports anywhere; `from inverse_dynamics import x` too."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, "a relative import"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            found |= {node.value} if " " not in node.value else set()
    own = [n.removeprefix("inverse_dynamics.") for n in found if n.startswith("inverse_dynamics.")]
    named = {n if n in {*FILES, "_core"} else n.rpartition(".")[0] or n for n in own}
    return {n for n in named if n == "_core" or n in FILES}


IMPORTS = {module: imports(file) for module, file in FILES.items()}
CROSSING = {
    (module, part_of(other))
    for module, others in IMPORTS.items()
    for other in others
    if part_of(module) != part_of(other)
}


def may_import(module: str, other: str) -> bool:
    """Whether a module may import from another part of the package."""
    part, is_verb = part_of(module), ".verb_" in module or module == "cli"
    if other == TERMINAL:
        return is_verb
    if other in SHARED:
        below = SHARED[: SHARED.index(part)] if part in SHARED else SHARED
        return other in below or is_verb
    return (part, other) in ALLOWED


def test_features_import_what_is_shared_and_what_is_listed() -> None:
    wrong = sorted(f"{m} imports {other}" for m, other in CROSSING if not may_import(m, other))
    assert wrong == []


def test_the_list_has_no_more_than_what_is_imported() -> None:
    assert sorted(ALLOWED) == sorted(ALLOWED.keys() & {(part_of(m), o) for m, o in CROSSING})


def test_verbs_import_no_other_verb() -> None:
    """What several verbs need is in modules that aren't verbs."""
    assert [m for m, others in IMPORTS.items() if any(".verb_" in other for other in others)] == []


def test_functions_have_eight_parameters_at_most_and_options_with_types() -> None:
    for file in FILES.values():
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.FunctionDef):
                given = node.args
                names = [a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
                assert len(names) - (names[:1] in (["self"], ["cls"])) <= 8, (file, node.name)
                if given.kwarg is not None and given.kwarg.arg == "options":
                    assert ast.unparse(given.kwarg.annotation).startswith("Unpack["), (
                        file,
                        node.name,
                    )
