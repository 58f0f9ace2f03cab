# SPDX-License-Identifier: Apache-2.0
"""Every public header declares its names in the inline ABI namespace, and all in the same one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]

# Headers that cross no boundary: compiled by the program that includes them, or of another plugin interface.
WITHOUT = ("conformance", "inverse_dynamics_controllers", "inverse_dynamics_ros")

HEADERS = [
    path
    for path in sorted(REPOSITORY.glob("*/include/**/*.hpp"))
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
