# SPDX-License-Identifier: Apache-2.0
"""From decoded messages to a `JointLog`: which joints, which messages, which time.

The rules, said in the notes of the result wherever they change anything:

- Joints are matched by name. Other joints may be there, in any order, in some messages or in all.
- A message with none of the joints (the gripper's, on the same topic) is left out; one with only
  some of them is an error.
- Time is the header's stamp; if no header has one, the time of reception.
  Stamps are taken as they are, also where they don't increase: see accelerations.py.
- Arrays that are empty or not as long as the names, and numbers that aren't finite, are errors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import BagError
from inverse_dynamics.joint_log import JointLog

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.joint_log import Clock, Floats, Integers, Storage
    from inverse_dynamics.joint_state_cdr import Block

_FIELDS = ("position", "velocity", "effort")


class JointLogBuilder:
    """Collects decoded messages into arrays, one row per message.

    where: file and topic, for error texts. joints: names in the order wanted; none: those of the
    first message. expected: how many messages the recording says it has.
    """

    def __init__(self, where: str, joints: Sequence[str], expected: int) -> None:
        self.where = where
        self.expected = expected
        self.messages = 0  # taken so far
        self._joints = tuple(joints)
        if len(set(self._joints)) != len(self._joints):
            raise BagError(f"joints: expected each name once, got {', '.join(self._joints)}")
        self._frame_id = ""
        self._other_names: tuple[str, ...] = ()
        rows = max(1, min(expected, 10**7))  # metadata can say anything
        self._header = np.zeros(rows, np.int64)
        self._received = np.zeros(rows, np.int64)
        self._has_joints = np.zeros(rows, np.bool_)
        self._numbers = [np.zeros((rows, len(self._joints))) for _ in _FIELDS]

    def add(self, blocks: Sequence[Block], received: Integers) -> None:
        """Add blocks that together hold `len(received)` messages, received at these times [ns]."""
        end = self.messages + len(received)
        if end > len(self._header):
            self._make_room(2 * end)
        self._received[self.messages : end] = received
        # In order of their first messages: an error names the first message of its kind.
        for block in sorted(blocks, key=lambda b: int(b.rows[0])):
            self._add_block(block)
        self.messages = end

    def joint_log(self, clock: Clock, topic: str, storage: Storage) -> JointLog:
        """Everything added, by the rules at the top of this file."""
        kept = self._has_joints[: self.messages].copy()
        count = int(kept.sum())
        if count == 0:
            raise BagError(
                f"{self.where}: expected the joints {', '.join(self._joints)}, got only "
                f"{', '.join(self._other_names)}; give the recording's names with --joints, in "
                "the order of the chain"
            )
        notes = []
        if count < self.messages:
            notes.append(
                f"{self.messages - count} of {self.messages} messages left out: they hold none of "
                f"the joints, but {', '.join(self._other_names)}"
            )
        header, received = self._header[: self.messages], self._received[: self.messages]
        if clock == "auto":
            clock = "header"
            if not header[kept].any() and received[kept].any():
                clock = "receive"
                notes.append("no header has a stamp: the time of reception is used")
        q, qd, effort = (numbers[: self.messages] for numbers in self._numbers)
        rows = slice(None) if kept.all() else kept  # without a copy where all are kept
        return JointLog(
            joint_names=self._joints,
            header_stamps=header[rows],
            receive_stamps=received[rows],
            q=q[rows],
            qd=qd[rows],
            effort=effort[rows],
            frame_id=self._frame_id,
            clock=clock,
            topic=topic,
            storage=storage,
            notes=tuple(notes),
        )

    def _make_room(self, rows: int) -> None:
        for column in (self._header, self._received, self._has_joints, *self._numbers):
            column.resize((rows, *column.shape[1:]), refcheck=False)

    def _add_block(self, block: Block) -> None:
        where = f"{self.where}, message {self.messages + int(block.rows[0]) + 1}"
        if not self._joints:
            if not block.names:
                raise BagError(f"{where}: expected joint names, got none; record it again")
            self._joints = block.names
            rows = len(self._header)
            self._numbers = [np.zeros((rows, len(self._joints))) for _ in _FIELDS]
        columns = self._columns_of(block, where)
        if columns is None:
            return
        rows_of_block = self.messages + block.rows
        for field, numbers in zip(_FIELDS, self._numbers, strict=True):
            values: Floats = getattr(block, field)
            if values.shape[1] != len(block.names):
                raise BagError(_wrong_length(where, field, values.shape[1], len(block.names)))
            chosen = values[:, columns]
            self._check_finite(field, chosen, block)
            numbers[rows_of_block] = chosen
        self._header[rows_of_block] = block.stamps
        self._has_joints[rows_of_block] = True
        self._frame_id = self._frame_id or block.frame_id

    def _columns_of(self, block: Block, where: str) -> list[int] | None:
        """Where the joints are among the names of the messages; None if none of them is."""
        missing = [joint for joint in self._joints if joint not in block.names]
        if len(missing) == len(self._joints):
            self._other_names = self._other_names or block.names
            return None
        if missing:
            raise BagError(
                f"{where}: expected the joints {', '.join(self._joints)}, got "
                f"{', '.join(block.names)}; missing: {', '.join(missing)}; give the recording's "
                "names with --joints, in the order of the chain"
            )
        twice = [joint for joint in self._joints if block.names.count(joint) > 1]
        if twice:
            raise BagError(
                f"{where}: expected each joint once, got {', '.join(block.names)}; repeated: "
                f"{', '.join(twice)}; do two drivers publish on this topic?"
            )
        return [block.names.index(joint) for joint in self._joints]

    def _check_finite(self, field: str, values: Floats, block: Block) -> None:
        finite = np.isfinite(values)
        if finite.all():
            return
        row, column = (int(i) for i in np.argwhere(~finite)[0])
        raise BagError(
            f"{self.where}, message {self.messages + int(block.rows[row]) + 1}: {field} of joint "
            f"{self._joints[column]}: expected a finite number, got {values[row, column]}; cut "
            "such messages out of the recording, or record it again"
        )


def _wrong_length(where: str, field: str, got: int, expected: int) -> str:
    what = "an empty array" if got == 0 else f"{got}"
    reason = {
        "position": "joint positions are needed",
        "velocity": "joint velocities are needed (accelerations come from them)",
        "effort": "measured efforts are what computed torques are compared with",
    }[field]
    return (
        f"{where}: {field}: expected {expected} numbers, one per name, got {what}; {reason}: "
        "does the driver publish them?"
    )
