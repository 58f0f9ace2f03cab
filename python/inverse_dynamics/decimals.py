# SPDX-License-Identifier: Apache-2.0
"""Decimal numbers in texts: digits, point, exponent, all of them ASCII.

Python's float() takes `1_0` for ten, and the digits of every script.
"""

from __future__ import annotations

import re

DECIMAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
ASCII_SPACE = " \t\n\v\f\r"  # what float() leaves out of an ASCII text
NOT_FINITE = re.compile(r"[-+]?(inf|infinity|nan)", re.IGNORECASE)

# Of a recorded or planned motion, in SI units: beyond it lie damage and mistaken units, and squares of
# squares still fit into a double.
LARGEST = 1e12


def decimal(text: str) -> float:
    """The number; infinite where it is too large for a double. Raises ValueError for anything else."""
    text = text.strip(ASCII_SPACE)
    if not DECIMAL.fullmatch(text):
        raise ValueError(f"not a decimal number: {text[:60]!r}")
    return float(text)
