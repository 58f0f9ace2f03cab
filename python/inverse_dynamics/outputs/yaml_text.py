# SPDX-License-Identifier: Apache-2.0
"""Values as YAML has them: every digit of a number, texts in quotes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


def yaml_number(value: float) -> str:
    """Every digit; a whole number as one."""
    number = float(value)
    return repr(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def yaml_list(numbers: Iterable[float]) -> str:
    """`[1, 2.5]`."""
    return f"[{', '.join(map(yaml_number, numbers))}]"


def yaml_text(text: str) -> str:
    """In double quotes."""
    return json.dumps(text, ensure_ascii=False)
