# SPDX-License-Identifier: Apache-2.0
"""Arrays of states as Python gives them: shapes, types, strides, numbers that aren't."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from entry_points import UR10
from outcome import Case, Expected, Outcome

from inverse_dynamics import Solver
from inverse_dynamics.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

_N = 6


def _rows(count: int) -> np.ndarray:
    return np.sin(np.arange(count * _N, dtype=float)).reshape(count, _N)


# Arguments of torques(), made when the case runs.
_WRONG: dict[str, Callable[[], tuple[Any, ...]]] = {
    "one joint too few": lambda: (np.zeros(5),) * 3,
    "three dimensions": lambda: (np.zeros((2, 2, _N)),) * 3,
    "a number": lambda: (1.0,) * 3,
    "None": lambda: (None,) * 3,
    "a text": lambda: ("zero",) * 3,
    "texts": lambda: (np.array(["0"] * _N),) * 3,
    "objects": lambda: (np.array([object()] * _N),) * 3,
    "complex": lambda: (np.zeros(_N, dtype=complex),) * 3,
    "times": lambda: (np.zeros(_N, dtype="datetime64[s]"),) * 3,
    "a ragged list": lambda: ([[0.0] * _N, [0.0]],) * 3,
    "other numbers of rows": lambda: (_rows(3), _rows(2), _rows(3)),
    "a dictionary": lambda: ({},) * 3,
}
_OUT_WRONG: dict[str, Callable[[], Any]] = {
    "too small": lambda: np.empty((2, _N)),
    "single precision": lambda: np.empty((3, _N), dtype=np.float32),
    "read only": lambda: _read_only(),
    "one row for all": lambda: np.lib.stride_tricks.as_strided(np.empty(_N), (3, _N), (0, 8)),
    "overlapping rows": lambda: np.lib.stride_tricks.as_strided(np.empty(20), (3, _N), (8, 8)),
    "one number for all": lambda: np.lib.stride_tricks.as_strided(np.empty(1), (3, _N), (0, 0)),
    "a list": lambda: [[0.0] * _N] * 3,
    "other byte order": lambda: np.empty((3, _N), dtype=">f8"),
}
_RIGHT: dict[str, Callable[[], tuple[Any, ...]]] = {
    "columns": lambda: tuple(np.asfortranarray(_rows(3)) for _ in range(3)),
    "every other row": lambda: tuple(np.repeat(_rows(3), 2, axis=0)[::2] for _ in range(3)),
    "backwards": lambda: tuple(_rows(3)[::-1].copy()[::-1] for _ in range(3)),
    "single precision": lambda: tuple(_rows(3).astype(np.float32).astype(float) for _ in range(3)),
    "lists": lambda: tuple(_rows(3).tolist() for _ in range(3)),
    "one row in each row": lambda: tuple(np.broadcast_to(_rows(1), (3, _N)) for _ in range(3)),
    "other byte order": lambda: tuple(_rows(3).astype(">f8") for _ in range(3)),
    "unaligned": lambda: tuple(_unaligned(_rows(3)) for _ in range(3)),
}


def cases(_: Path) -> Iterator[Case]:
    """Arguments and results of a method."""
    place = Expected(place="torques|q|solver|Solver")
    for name, make in _WRONG.items():
        yield Case(f"{name} [torques]", partial(_torques, make), place)
    for name, make_out in _OUT_WRONG.items():
        act = partial(_torques, lambda: (_rows(3),) * 3, make_out)
        yield Case(f"out: {name} [torques]", act, Expected(place="out"))
    for name, make in _RIGHT.items():
        yield Case(
            f"{name} [torques]",
            partial(_same_row_by_row, make),
            Expected(refused=False, right=True),
        )
    yield Case("made without arguments [Solver]", _made_without_init, Expected(place="Solver"))
    for value in (np.nan, np.inf, -np.inf):
        for argument in range(3):
            for count in (1, 3, 40):
                act = partial(_nan_comes_out, value, argument, count)
                name = f"{value} in argument {argument + 1} of {count} rows [torques]"
                yield Case(name, act, Expected(refused=False, right=True))


def _read_only() -> np.ndarray:
    array = np.empty((3, _N))
    array.flags.writeable = False
    return array


def _unaligned(values: np.ndarray) -> np.ndarray:
    raw = np.zeros(values.nbytes + 1, dtype=np.uint8)
    raw[1:] = np.frombuffer(values.tobytes(), dtype=np.uint8)
    return raw[1:].view(float).reshape(values.shape)


def _torques(make: Callable[[], tuple[Any, ...]], out: Callable[[], Any] | None = None) -> Outcome:
    solver = Solver(UR10)
    arguments = make()
    try:
        solver.torques(*arguments, out=None if out is None else out())
    except UserError as error:
        return Outcome("refused", str(error))
    except TypeError as error:  # Python's own word for an argument of another type
        return Outcome("refused", "torques: " + str(error).splitlines()[0])
    return Outcome("accepted")


def _same_row_by_row(make: Callable[[], tuple[Any, ...]]) -> Outcome:
    solver = Solver(UR10)
    arguments = make()
    together = solver.torques(*arguments)
    rows = [np.array(a, dtype=float) for a in arguments]
    each = np.array([solver.torques(*(a[i].copy() for a in rows)) for i in range(len(rows[0]))])
    if np.allclose(together, each, rtol=0, atol=1e-9):
        return Outcome("accepted")
    return Outcome("failed", f"{together} instead of {each}")


def _made_without_init() -> Outcome:
    q = np.zeros(_N)
    try:
        Solver.__new__(Solver).torques(q, q, q)
    except (TypeError, UserError) as error:
        return Outcome("refused", str(error).splitlines()[0])
    return Outcome("accepted")


def _nan_comes_out(value: float, argument: int, count: int) -> Outcome:
    """Every joint's torque of that state, and no other state's, for any joint of the argument.

    The first joint turns about the direction of gravity: no torque depends on its position. Other
    torques depend on positions of all further joints; each torque on all velocities and accelerations
    of the chain, as its parameters are those of the whole row.
    """
    solver = Solver(UR10)
    row = count - 1
    for joint in range(_N):
        states = [_rows(count) for _ in range(3)]
        states[argument][row, joint] = value
        with np.errstate(invalid="ignore"):
            tau = solver.torques(*states)
        if not np.isfinite(tau[:row]).all():
            return Outcome("failed", f"joint {joint + 1}: other states' torques aren't finite")
        if argument != 1 and np.isfinite(tau[row]).all():
            return Outcome("failed", f"joint {joint + 1}: ordinary torques {tau[row]}")
    return Outcome("accepted")
