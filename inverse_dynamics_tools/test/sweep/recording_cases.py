# SPDX-License-Identifier: Apache-2.0
"""Recordings: tables and bags, cut, mixed up, with numbers that aren't."""

from __future__ import annotations

import shutil
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from entry_points import evaluated
from mutations import spoiled_numbers
from outcome import Case, Expected
from process import run_apart

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from conftest import joint_log, joint_state, write_messages

from inverse_dynamics.data.bags import write_joint_logs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from outcome import Outcome

JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
_N = len(JOINTS)
_SAMPLES = 300


def cases(directory: Path) -> Iterator[Case]:
    """Tables, then bags of both storages, then messages."""
    yield from _tables(directory)
    for storage in ("sqlite3", "mcap"):
        yield from _bags(directory / storage, storage)
    yield from _messages(directory / "messages")


# ---------------------------------------------------------------------------------- tables


def _table() -> list[str]:
    quantities = ("position", "velocity", "effort")
    heading = ",".join(["time", *(f"{q}.{joint}" for q in quantities for joint in JOINTS)])
    time = np.arange(_SAMPLES) / 100.0
    phase = time[:, None] + np.arange(_N)
    columns = np.hstack([time[:, None], np.sin(phase), np.cos(phase), 9 * np.sin(2 * phase)])
    return [heading, *(",".join(repr(float(x)) for x in row) for row in columns)]


def _tables(directory: Path) -> Iterator[Case]:
    lines = _table()
    file = _written(directory, "\n".join(lines) + "\n")
    right = run_apart(partial(evaluated, file))
    assert right.kind == "accepted", right.text
    same = Expected(refused=False, right=True, torques=right.torques)
    yield Case("table as it is", partial(evaluated, file), same)
    line = 100
    cells = lines[line].split(",")
    for column in (0, 1, 8, 14):
        for what, text in spoiled_numbers(cells[column]).items():
            changed = ",".join([*cells[:column], text.replace("\n", " "), *cells[column + 1 :]])
            content = "\n".join([*lines[:line], changed, *lines[line + 1 :], ""])
            # A comma inside of a number is one cell more: the same line.
            expected = Expected(place=rf"\.csv:{line + 1}\b")
            yield _table_case(f"table, column {column + 1}: {what}", directory, content, expected)
    for what, change in _CHANGES_OF_TABLES.items():
        content = "\n".join(change(list(lines))) + "\n"
        expected = _SAME_TABLES.get(what)
        if expected is None:
            expected = Expected(place=r"\.csv", warned=True, mention=".")
        else:
            expected = same
        yield _table_case(f"table: {what}", directory, content, expected)
    for what, raw in _NOT_A_TABLE.items():
        file = _fresh(directory, ".csv")
        file.write_bytes(raw)
        yield Case(f"table: {what}", partial(evaluated, file), Expected(place=r"\.csv"))


def _with_line(lines: list[str], index: int, text: str) -> list[str]:
    return [*lines[:index], text, *lines[index + 1 :]]


_CHANGES_OF_TABLES: dict[str, Callable[[list[str]], list[str]]] = {
    "a cell less": lambda t: _with_line(t, 50, t[50].rsplit(",", 1)[0]),
    "a cell more": lambda t: _with_line(t, 50, t[50] + ",1"),
    "cut off within a number": lambda t: [*t[:-1], t[-1][:20]],
    "time goes back": lambda t: [*t[:100], t[50], *t[100:]],
    "one row": lambda t: t[:2],
    "heading alone": lambda t: t[:1],
    "no heading": lambda t: t[1:],
    "heading twice": lambda t: [t[0], *t],
    "a column twice": lambda t: _with_line(
        t, 0, t[0].replace("position.elbow", "position.wrist_1")
    ),
    "a joint misspelt": lambda t: _with_line(t, 0, t[0].replace("elbow", "elbw")),
    "degrees in the heading": lambda t: _with_line(
        t, 0, t[0].replace("position.elbow_joint", "position.elbow_joint [deg]")
    ),
    "no time": lambda t: [",".join(line.split(",")[1:]) for line in t],
    "time in milliseconds": lambda t: [
        t[0],
        *(",".join([str(1e3 * float(r.split(",")[0])), *r.split(",")[1:]]) for r in t[1:]),
    ],
    "a gap of 10 s": lambda t: [
        t[0],
        *(
            ",".join([str(float(r.split(",")[0]) + (10 if i > 150 else 0)), *r.split(",")[1:]])
            for i, r in enumerate(t[1:])
        ),
    ],
    "a velocity of 1e300": lambda t: _with_line(
        t, 50, ",".join([*t[50].split(",")[:8], "1e300", *t[50].split(",")[9:]])
    ),
    "semicolons": lambda t: [line.replace(",", ";") for line in t],
    "Windows line ends": lambda t: [line + "\r" for line in t],
    "an empty line at the end": lambda t: [*t, ""],
    "byte order mark": lambda t: ["\ufeff" + t[0], *t[1:]],
}
_SAME_TABLES = dict.fromkeys(
    ("semicolons", "Windows line ends", "an empty line at the end", "byte order mark"), True
)
_NOT_A_TABLE: dict[str, bytes] = {
    "empty": b"",
    "blank": b"\n\n\n",
    "binary": bytes(range(256)) * 10,
    "NUL bytes": b"time,position.a\n0,\0\n",
    "UTF-16": "time,position.a\n0,1\n".encode("utf-16"),
    "one line of 10 MB": b"1," * 5_000_000,
    "quotes without an end": b'"time,position.a\n0,1\n' * 100,
    "JSON": b'{"time": [0, 1]}\n',
}


def _table_case(name: str, directory: Path, content: str, expected: Expected) -> Case:
    return Case(name, partial(evaluated, _written(directory, content)), expected)


# ------------------------------------------------------------------------------------ bags


def _bags(directory: Path, storage: str) -> Iterator[Case]:
    log = joint_log(_SAMPLES, _N, joint_names=JOINTS)
    bag = directory / "bag"
    write_joint_logs(bag, {"/joint_states": log}, storage=storage)
    right = run_apart(partial(evaluated, bag))
    assert right.kind == "accepted", right.text
    same = Expected(refused=False, right=True, torques=right.torques)
    yield Case(f"{storage} as it is", partial(evaluated, bag), same)
    content = next(bag.glob("*.[dm][bc]*"))
    size = content.stat().st_size
    spoilt = Expected(place="bag", warned=True, mention=".")
    for share in (0.0, 0.01, 0.2, 0.5, 0.9, 0.999):
        act = partial(evaluated, _cut(bag, content.name, int(share * size)))
        yield Case(f"{storage} cut off at {share}", act, spoilt)
    random = np.random.default_rng(7)
    for k in range(20):
        copy = _copy(bag)
        raw = bytearray((copy / content.name).read_bytes())
        for place in random.integers(0, size, 20):
            raw[place] = random.integers(256)
        (copy / content.name).write_bytes(bytes(raw))
        # What stands in a gap between messages, or is one of their numbers, can't be seen.
        expected = Expected(place="bag", warned=True, mention=".", right=True)
        yield Case(f"{storage} with 20 other bytes, {k}", partial(evaluated, copy), expected)
    metadata = (bag / "metadata.yaml").read_text()
    for index, line in enumerate(metadata.splitlines()):
        if ":" not in line:
            continue
        for what, changed in {"left out": "", "a list": line.split(":")[0] + ": [1, [2]]"}.items():
            copy = _copy(bag)
            lines = metadata.splitlines()
            lines[index] = changed
            (copy / "metadata.yaml").write_text("\n".join(lines) + "\n")
            expected = Expected(place="bag", right=True, warned=True, mention=".")
            name = f"{storage}, metadata.yaml line {index + 1} {what}"
            yield Case(name, partial(evaluated, copy), expected)
    for what, raw_text in {"empty": b"", "binary": bytes(range(256)), "a list": b"- 1\n"}.items():
        copy = _copy(bag)
        (copy / "metadata.yaml").write_bytes(raw_text)
        yield Case(
            f"{storage}, metadata.yaml {what}", partial(evaluated, copy), Expected(place="bag")
        )
    copy = _copy(bag)
    (copy / content.name).unlink()
    yield Case(f"{storage} without its file", partial(evaluated, copy), Expected(place="bag"))


def _copy(bag: Path) -> Path:
    copy = bag.parent / f"bag_{sum(1 for _ in bag.parent.iterdir())}"
    shutil.copytree(bag, copy)
    return copy


def _cut(bag: Path, file: str, size: int) -> Path:
    copy = _copy(bag)
    with (copy / file).open("r+b") as stream:
        stream.truncate(size)
    return copy


# -------------------------------------------------------------------------------- messages


def _messages(directory: Path) -> Iterator[Case]:
    directory.mkdir()
    zero = [0.0] * _N
    kinds = {
        "no joints": ([], [], [], []),
        "no velocities": (JOINTS, zero, [], zero),
        "no efforts": (JOINTS, zero, zero, []),
        "a number less than names": (JOINTS, zero, zero[1:], zero),
        "a joint twice": ((*JOINTS[:5], JOINTS[0]), zero, zero, zero),
        "a joint missing": (JOINTS[:5], zero[1:], zero[1:], zero[1:]),
        "an empty name": ((*JOINTS[:5], ""), zero, zero, zero),
        "a name of 100 kB": ((*JOINTS[:5], "j" * 10**5), zero, zero, zero),
        "terminal escapes in a name": ((*JOINTS[:5], "\x1b[31mj"), zero, zero, zero),
        "a velocity of nan": (JOINTS, zero, [float("nan"), *zero[1:]], zero),
        "a position of infinity": (JOINTS, [float("inf"), *zero[1:]], zero, zero),
        "a velocity of 1e300": (JOINTS, zero, [1e300, *zero[1:]], zero),
    }
    for name, (names, q, qd, effort) in kinds.items():
        for which in ("all", "one"):
            bag = directory / f"bag_{name}_{which}".replace(" ", "_")
            states = [_message(k, which, names, q, qd, effort) for k in range(50)]
            expected = Expected(place="bag", warned=True, mention=".")
            yield Case(
                f"{which} of the messages: {name}", partial(_recorded, bag, states), expected
            )
    stamps = {"the same": lambda k: 5, "all zero": lambda k: 0, "backwards": lambda k: 10**9 - k}
    for name, stamp in stamps.items():
        bag = directory / f"stamps_{name}".replace(" ", "_")
        states = [
            joint_state(list(JOINTS), [0.1 * k] * _N, zero, zero, stamp(k)) for k in range(50)
        ]
        expected = Expected(place=bag.name, warned=True, mention=".")
        yield Case(f"stamps are {name}", partial(_recorded, bag, states), expected)


def _recorded(bag: Path, states: list[object]) -> Outcome:
    """Of messages that are recorded when the case runs: few of them may."""
    return evaluated(write_messages(bag, states))


def _message(k: int, which: str, *odd: list) -> object:
    usual = (JOINTS, *([np.sin(k / 20 + np.arange(_N)).tolist()] * 3))
    names, q, qd, effort = odd if which == "all" or k == 25 else usual
    return joint_state(list(names), list(q), list(qd), list(effort), 10_000_000 * (k + 1))


def _written(directory: Path, content: str) -> Path:
    file = _fresh(directory, ".csv")
    file.write_text(content, encoding="utf-8", newline="")
    return file


def _fresh(directory: Path, suffix: str) -> Path:
    directory.mkdir(exist_ok=True)
    return directory / f"{sum(1 for _ in directory.iterdir())}{suffix}"
