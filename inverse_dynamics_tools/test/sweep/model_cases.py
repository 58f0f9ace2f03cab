# SPDX-License-Identifier: Apache-2.0
"""Model files, spoiled one line at a time."""

from __future__ import annotations

import re
from functools import partial
from typing import TYPE_CHECKING

from entry_points import RIGID_BODY, cpp, python
from outcome import Case, Expected
from process import run_apart
from yaml_text import NOT_A_MAPPING, spoiled

from inverse_dynamics.base.ament import package_share

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


def cases(directory: Path) -> Iterator[Case]:
    """A model of the project, each line of it spoiled, and what is no model file."""
    model = package_share("inverse_dynamics_robots") / "models" / "franka_inria_identified.yaml"
    text = model.read_text()
    right = run_apart(partial(python, RIGID_BODY, model=str(model)))
    as_it_is = Expected(refused=False, right=True, torques=right.torques)
    same = {
        "as it is": text,
        "Windows line ends": text.replace("\n", "\r\n"),
        "BOM": "\ufeff" + text,
    }
    for name, content in same.items():
        yield from _both(name, _written(directory, content.encode()), as_it_is)
    for fault in spoiled(text):
        # The line itself, or the one of the mapping or list that lacks what stood there.
        file = _written(directory, fault.text.encode())
        yield from _both(fault.name, file, Expected(place=rf"{re.escape(file.name)}:\d+"))
    for name, content in NOT_A_MAPPING.items():
        file = _written(directory, content)
        yield from _both(name, file, Expected(place=re.escape(file.name)))
    missing = directory / "missing.yaml"
    yield from _both("a missing file", missing, Expected(place="missing.yaml"))
    yield from _both("a directory", directory, Expected(place=re.escape(directory.name)))


def _written(directory: Path, content: bytes) -> Path:
    file = directory / f"{sum(1 for _ in directory.iterdir())}.yaml"
    file.write_bytes(content)
    return file


def _both(name: str, file: Path, expected: Expected) -> Iterator[Case]:
    yield Case(f"{name} [Python]", partial(python, RIGID_BODY, model=str(file)), expected)
    parameters = f"{{model: '{file}'}}"
    yield Case(f"{name} [C++]", partial(cpp, RIGID_BODY, "", parameters), expected)
