# SPDX-License-Identifier: Apache-2.0
"""Ways to spoil a number, a name, a text."""

from __future__ import annotations

NOT_NUMBERS = {
    "empty": "",
    "blank": "  ",
    "a word": "heavy",
    "a unit": "{}kg",
    "a comma": "1,5",
    "two numbers": "{} {}",
    "nan": "nan",
    "infinity": "inf",
    "minus infinity": "-Infinity",
    "beyond double": "1e400",
    "hexadecimal": "0x1p3",
    "underscore": "1_0",
    "full-width digits": "１.5",
    "two points": "1.2.3",
    "a sign alone": "-",
    "an exponent alone": "e5",
    "text behind": "{};",
    "400 digits": "9" * 400,
}

SAME_NUMBER = {
    "blank behind": "{} ",
    "blank before": " {}",
    "tab and line": "\t{}\n",
}


def typos(name: str) -> dict[str, str]:
    """Other names that a hurried writer may mean it by."""
    middle = len(name) // 2
    return {
        "a letter less": name[:-1],
        "a letter twice": name[:middle] + name[middle] + name[middle:],
        "two letters swapped": _swapped(name),
        "upper case": name.upper(),
        "plural": name + "s",
    }


def _swapped(name: str) -> str:
    """The first two different neighbours in each other's place."""
    for i in range(len(name) - 1):
        if name[i] != name[i + 1]:
            return name[:i] + name[i + 1] + name[i] + name[i + 2 :]
    return name + name


def spoiled_numbers(value: str) -> dict[str, str]:
    """What isn't a number, made from one."""
    return {what: text.format(value, value) for what, text in NOT_NUMBERS.items()}


def same_numbers(value: str) -> dict[str, str]:
    """The same number or numbers, written with white space."""
    return {what: text.format(value) for what, text in SAME_NUMBER.items()}
