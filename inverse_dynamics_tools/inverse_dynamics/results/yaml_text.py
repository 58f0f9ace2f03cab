# SPDX-License-Identifier: Apache-2.0
"""Values as YAML has them: every digit of a number, texts in quotes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from inverse_dynamics.base.arrays import Floats


def yaml_number(value: float) -> str:
    """Every digit; a whole number as one."""
    number = float(value)
    return repr(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def yaml_list(numbers: Iterable[float]) -> str:
    """`[1, 2.5]`."""
    return f"[{', '.join(map(yaml_number, numbers))}]"


def yaml_mapping(values: Mapping[str, float | Floats]) -> str:
    """`{mass: 2, center: [0, 0, 0.1]}`."""
    return f"{{{yaml_entries(values)}}}"


def yaml_entries(values: Mapping[str, float | Floats]) -> str:
    """The same without braces."""
    return ", ".join(
        f"{key}: {yaml_list(np.asarray(value)) if np.ndim(value) else yaml_number(float(value))}"
        for key, value in values.items()
    )


def yaml_text(text: str) -> str:
    """In double quotes."""
    return json.dumps(text, ensure_ascii=False)
