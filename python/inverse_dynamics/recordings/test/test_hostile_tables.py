# SPDX-License-Identifier: Apache-2.0
"""Tables that aren't what they should be: one line with file, row and column."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest
from example_recordings import damaged

from inverse_dynamics import read_recording
from inverse_dynamics.errors import BagError

HEADER = "time,position.a,velocity.a,effort.a\n"
ROW = "0,1,2,3\n"


def row(field: str, line: int = 3) -> str:
    """A table whose velocity is something else in that line."""
    return HEADER + ROW * (line - 2) + f"0.01,1,{field},3\n" + "0.02,1,2,3\n"


HOSTILE = {
    "an underscore": (row("1_0"), ":3: column 3 (velocity.a): expected a number, got '1_0'"),
    "full-width digits": (row("１２"), ":3: column 3 (velocity.a): expected a number, got '１２'"),
    "Arabic digits": (row("١٢"), ":3: column 3 (velocity.a): expected a number, got '١٢'"),
    "a minus sign of typography": (row("−1"), ":3: column 3 (velocity.a): expected a number, got"),
    "a no-break space": (
        row("1\u00a0"),
        ":3: column 3 (velocity.a): expected a number, got '1\\xa0'",
    ),
    "an ideographic space": (row("\u30001"), ":3: column 3 (velocity.a): expected a number, got"),
    "a hexadecimal number": (row("0x10"), ":3: column 3 (velocity.a): expected a number, got"),
    "infinity": (row("-Infinity"), ":3: column 3 (velocity.a): expected a finite number, got"),
    "too large for a double": (row("1e999"), ":3: column 3 (velocity.a): expected a finite numbe"),
    "a velocity of 1e300": (
        row("1e300"),
        ": velocity.a: expected numbers of a motion, in SI units",
    ),
    "400 digits": (row("1" * 400), ":3: column 3 (velocity.a): expected a finite number, got '111"),
    "a field of 100 kB": (row("x" * 100_000), ":3: column 3 (velocity.a): expected a number, got "),
    "an escape sequence": (
        row("\x1b[31m"),
        ":3: column 3 (velocity.a): expected a number, got '\\x1b",
    ),
    "a NUL": (row("1\0"), ":3: column 3 (velocity.a): expected a number, got '1\\x00'"),
    "a form feed": (row("1\f2"), ":3: column 3 (velocity.a): expected a number, got '1\\x0c2'"),
    "a bad number after many rows": (
        row("1_0", 90_000),
        ":90000: column 3 (velocity.a): expected a",
    ),
    "a column too many": (row("1,2"), ":3: expected 4 columns, as the header has, got 5"),
    "a cut row": (HEADER + ROW + "0.01,1\n", ":3: expected 4 columns, as the header has, got 2"),
    "a row of blanks and a comma": (
        HEADER + ROW + " , \n",
        ":3: expected 4 columns, as the header",
    ),
    "only a header": (HEADER, ": expected at least 2 rows after the header, got 0"),
    "one row": (HEADER + ROW, ": expected at least 2 rows after the header, got 1"),
    "nothing": ("", ": is empty; expected a header line and rows of numbers"),
    "an empty comment": ("#\n", ": is empty; expected a header line and rows of numbers"),
    "minutes and seconds": (
        HEADER + "12:30.7,1,2,3\n" * 2,
        ":2: column 1 (time): expected a number, got '12:30.7'",
    ),
    "blank lines": ("\n \n", ": is empty; expected a header line and rows of numbers"),
    "numbers alone": (ROW + ROW, ": expected a header line that names the columns, got numbers"),
    "a column twice": (
        "time,time,position.a,velocity.a,effort.a\n0,0,1,2,3\n",
        ": expected each col",
    ),
    "a header of 10 MB": ("x" * 10_000_000, ":1: expected a header line of at most"),
    "100,000 columns": (
        ",".join(f"c{i}" for i in range(100_000)) + "\n",
        ": expected columns of position",
    ),
    "names of 100 kB": (f"time,{'x' * 100_000}\n0,1\n", ": expected columns of position"),
    "escapes in names": ("time,\x1b[31mred\n0,1\n", ": expected columns of position"),
    "a joint of 100 kB": (
        HEADER.replace(".a", "." + "x" * 100_000) + ROW,
        ": expected columns of position and effort for 1 joint, a, got time, position.xxx",
    ),
    "no time": (
        HEADER[5:] + "1,2,3\n" * 2,
        ": expected a column of time [s], got position.a, velocity",
    ),
    "time in words": (
        HEADER + "now,1,2,3\n" * 2,
        ":2: column 1 (time): expected a number, got 'now'",
    ),
    "a picture": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", ": can't be read (it isn't text in UTF-8)"),
    "UTF-16": ((HEADER + ROW * 2).encode("utf-16"), ": can't be read (it isn't text in UTF-8)"),
    "Latin-1 after many rows": ((HEADER + ROW * 9).encode() + b"\xe9", ": can't be read (it isn't"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_table_is_one_line_with_its_place(tmp_path, name):
    content, expected = HOSTILE[name]
    file = tmp_path / "motion.csv"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    start = time.process_time()
    with pytest.raises(BagError) as caught:
        read_recording(file, ["a"])
    text = str(caught.value)
    assert text.startswith(f"{file}{expected}")
    assert re.fullmatch(r"[^\x00-\x1f\x7f-\x9f]{1,800}", text)
    assert time.process_time() - start < 10.0  # quadratic work would take hours


def test_a_damaged_table_is_read_or_refused_but_never_crashes(tmp_path):
    file = tmp_path / "motion.csv"
    rows = "".join(f"{0.01 * k},{0.1 * k},{-1e-3 * k},{k}e2\n" for k in range(30))
    refused = []
    for content in damaged((HEADER + rows).encode(), 400):
        file.write_bytes(content)
        try:
            log = read_recording(file, ["a"])
        except BagError as error:
            refused.append(str(error))
        else:
            assert np.isfinite([log.q, log.qd, log.effort]).all()
    assert len(refused) > 200
    assert all(str(file) in text and len(text) < 1000 for text in refused)


def test_numbers_in_any_plain_notation_are_read(tmp_path):
    file = tmp_path / "motion.csv"
    file.write_text(HEADER + "0,+1.5e-3, .5 ,5.\n0.01,-2,1E2,1e-400\n")
    log = read_recording(file, ["a"])
    assert log.q[:, 0].tolist() == [1.5e-3, -2.0]
    assert log.qd[:, 0].tolist() == [0.5, 100.0]
    assert log.effort[:, 0].tolist() == [5.0, 0.0]


def test_columns_that_are_not_asked_for_may_hold_anything(tmp_path):
    file = tmp_path / "motion.csv"
    file.write_text(HEADER[:-1] + ",note\n0,1,2,3,1_0 \x1b[31m\n0.01,1,2,3,１\n", encoding="utf-8")
    assert len(read_recording(file, ["a"])) == 2


def test_a_path_that_is_too_long_is_one_line(tmp_path):
    for suffix in (".csv", ".db3", ""):
        with pytest.raises(BagError, match=r"x{200}.*: (can't be read|no such file)"):
            read_recording(tmp_path / ("x" * 300 + suffix), ["a"])
