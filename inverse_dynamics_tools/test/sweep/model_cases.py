# SPDX-License-Identifier: Apache-2.0
"""Model files, spoiled one line at a time."""

from __future__ import annotations

import re
from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from entry_points import RIGID_BODY, cpp, python
from outcome import Case, Expected
from process import run_apart
from yaml_text import NOT_A_MAPPING, spoiled

from inverse_dynamics.base.ament import package_share

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from outcome import Outcome


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
    files = (directory / f"{k}.yaml" for k in count())
    for name, right_text in same.items():
        yield from _both(name, next(files), as_it_is, right_text.encode())
    for fault in spoiled(text):
        # The line itself, or the one of the mapping or list that lacks what stood there.
        file = next(files)
        expected = Expected(place=rf"{re.escape(file.name)}:\d+")
        yield from _both(fault.name, file, expected, fault.text.encode())
    for name, content in NOT_A_MAPPING.items():
        file = next(files)
        yield from _both(name, file, Expected(place=re.escape(file.name)), content)
    missing = directory / "missing.yaml"
    yield from _both("a missing file", missing, Expected(place="missing.yaml"))
    yield from _both("a directory", directory, Expected(place=re.escape(directory.name)))


def _both(
    name: str, file: Path, expected: Expected, content: bytes | None = None
) -> Iterator[Case]:
    """Cases that write the content, if any, when they run: few of them may."""
    in_python = partial(python, RIGID_BODY, model=str(file))
    in_cpp = partial(cpp, RIGID_BODY, "", f"{{model: '{file}'}}")
    yield Case(f"{name} [Python]", partial(_with, file, content, in_python), expected)
    yield Case(f"{name} [C++]", partial(_with, file, content, in_cpp), expected)


def _with(file: Path, content: bytes | None, act: Callable[[], Outcome]) -> Outcome:
    if content is not None:
        file.write_bytes(content)
    return act()
