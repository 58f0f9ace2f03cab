# SPDX-License-Identifier: Apache-2.0
"""The READMEs of the ROS packages list the parameters that the code declares.

python documentation_tests/test/parameters_test.py    # writes the lists
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from pages import REPOSITORY

BEGIN = "<!-- generated: documentation_tests/test/parameters_test.py -->\n"
PACKAGES = sorted({path.parents[1] for path in REPOSITORY.glob("*/*/src/*_parameters.yaml")})

# Descriptions name the allowed strings themselves.
RANGES = {
    "bounds<>": "{} to {}",
    "element_bounds<>": "{} to {}",
    "fixed_size<>": "{} numbers",
    "gt<>": "above {}",
    "gt_eq<>": "at least {}",
    "lower_element_bounds<>": "at least {}",
}


def row(name: str, declared: dict[str, Any]) -> str:
    """Name, type with range, default, meaning."""
    kind = [declared["type"]]
    for check, values in declared.get("validation", {}).items():
        if check in RANGES:
            values = values if isinstance(values, list) else [values]
            kind.append(RANGES[check].format(*(f"{value:g}" for value in values)))
    default = declared.get("default_value", "")
    shown = (
        ""
        if default in ("", [])
        else f"`{yaml.safe_dump(default, default_flow_style=True).split(chr(10))[0]}`"
    )
    return f"| `{name}` | {', '.join(kind)} | {shown} | {declared['description']} |"


def rows(declared: dict[str, Any], prefix: str = "") -> list[str]:
    if "type" in declared and isinstance(declared["type"], str):
        return [row(prefix.removesuffix("."), declared)]
    return [line for name, inner in declared.items() for line in rows(inner, f"{prefix}{name}.")]


def section(file: Path) -> str:
    """A file's comment and its parameters."""
    text = file.read_text(encoding="utf-8")
    comment = [line[2:] for line in text.splitlines() if line.startswith("# ")][1:]
    ((_, declared),) = yaml.safe_load(text).items()
    title = f"`{file.stem.removesuffix('_parameters')}`"
    table = ["| parameter | type | default | |", "|---|---|---|---|", *rows(declared)]
    return "\n".join([f"\n## {title}\n", *([*comment, ""] if comment else []), *table, ""])


def generated(package: Path) -> str:
    files = sorted(package.glob("src/*_parameters.yaml"))
    written = (package / "README.md").read_text(encoding="utf-8")
    return written.partition(BEGIN)[0] + BEGIN + "".join(section(file) for file in files)


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_the_readme_lists_the_declared_parameters(package: Path) -> None:
    written = (package / "README.md").read_text(encoding="utf-8")
    assert written == generated(package), f"run python {Path(__file__).relative_to(REPOSITORY)}"


if __name__ == "__main__":
    for package in PACKAGES:
        (package / "README.md").write_text(generated(package), encoding="utf-8")
