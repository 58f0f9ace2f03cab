# SPDX-License-Identifier: Apache-2.0
"""What public headers must do for users who compile with other flags than the libraries.

All names are in one inline ABI namespace. No compiled function returns an Eigen object of dynamic size:
one side would allocate its memory, the other free it, and which functions Eigen uses depends on flags.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]

# Headers that cross no boundary: compiled by the program that includes them, or of another plugin interface.
WITHOUT = (
    "conformance",
    "inverse_dynamics_controllers",
    "inverse_dynamics_ros",
)

HEADERS = [
    path
    for room in ("core", "solvers", "methods", "ros2")
    for path in sorted((REPOSITORY / room).glob("*/include/**/*.hpp"))
    if not any(part in str(path.relative_to(REPOSITORY)) for part in WITHOUT)
    and "\nnamespace " in path.read_text(encoding="utf-8")
]


def abi_namespaces(text: str) -> list[str]:
    """What follows each opening of a package's namespace: the ABI namespace, or the line itself."""
    openings = re.findall(r"^namespace \w+(?:::\w+)* \{\n+((?:///.*\n)*)(.*)$", text, re.MULTILINE)
    return [line.removeprefix("inline namespace ").removesuffix(" {") for _, line in openings]


def test_there_are_headers() -> None:
    assert len(HEADERS) > 50


@pytest.mark.parametrize("header", HEADERS, ids=lambda path: path.name)
def test_names_are_in_the_abi_namespace(header: Path) -> None:
    # Eigen's traits of our types, and what is nested in the first namespace, aside.
    assert abi_namespaces(header.read_text(encoding="utf-8"))[0] == "v2"


def test_a_header_without_it_is_found() -> None:
    assert abi_namespaces("\nnamespace chain_dynamics {\n\nstruct A;\n}\n") == ["struct A;"]


def compiled_results(text: str) -> list[str]:
    """Functions returning Eigen objects of dynamic size that are declared without being defined."""
    code = re.sub(r"//[^\n]*", "", text)
    declarations = re.findall(
        r"\b(?:Eigen::)?(?:Vector|RowVector|Matrix|Array)XX?[df]\s+(\w+)"
        r"\s*\((?:\)|(?:const\s+)?[\w:<>]+[&*]*\s+\w+\s*[,)=])[^;{}]*?(;|\{)",
        code,
    )
    return [name for name, end in declarations if end == ";"]


@pytest.mark.parametrize("header", HEADERS, ids=lambda path: path.name)
def test_no_compiled_function_returns_what_eigen_allocates(header: Path) -> None:
    assert compiled_results(header.read_text(encoding="utf-8")) == []


def test_a_compiled_function_that_returns_what_eigen_allocates_is_found() -> None:
    assert compiled_results("Eigen::VectorXd f(int a,\n  const B& b);\n") == ["f"]
    assert compiled_results("class A {\n  virtual MatrixXd g() const;\n};") == ["g"]
    assert compiled_results("inline Eigen::VectorXd h(int a) {\n  return VectorXd(a);\n}") == []
    assert compiled_results("{\n  Eigen::VectorXd p(10 * n), c(n.rows());\n}") == []
