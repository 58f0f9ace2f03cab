# SPDX-License-Identifier: Apache-2.0
"""A recorded motion as arrays: time, positions, velocities, efforts, one row per message."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, get_args

from inverse_dynamics.errors import BagError
from inverse_dynamics.wording import told

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from typing import Any

    from inverse_dynamics.arrays import DataFrame, Floats, Integers

    # What functions take as a recording; a structured array counts as a DataFrame.
    Recorded = Path | str | "JointLog" | Mapping[str, Any] | DataFrame

# Which stamps are the time: the header's, those of reception, or what is there.
Clock = Literal["auto", "header", "receive"]
CLOCKS: tuple[Clock, ...] = get_args(Clock)

# What rosbag2 keeps messages in.
Storage = Literal["sqlite3", "mcap"]
STORAGES: tuple[Storage, ...] = get_args(Storage)


def check_clock(clock: str) -> None:
    """Raise BagError unless it is one of CLOCKS."""
    if clock not in CLOCKS:
        raise BagError(f"clock: expected one of {', '.join(CLOCKS)}, got '{clock}'")


def check_storage(storage: str) -> None:
    """Raise BagError unless it is one of STORAGES."""
    if storage not in STORAGES:
        raise BagError(f"storage: expected one of {', '.join(STORAGES)}, got '{storage}'")


@dataclass(frozen=True, repr=False)
class JointLog:
    """Joint states of one chain over time.

    N messages, n joints in the order of `joint_names`; rad, rad/s, N m (prismatic m, m/s, N).
    `effort` is as recorded, so A where it is a current: see effort_is.
    """

    joint_names: tuple[str, ...]
    header_stamps: Integers  # (N,) ns, as the publisher wrote them
    receive_stamps: Integers  # (N,) ns, as the recorder wrote them
    q: Floats  # (N, n)
    qd: Floats  # (N, n)
    effort: Floats  # (N, n)
    qdd: Floats | None = None  # (N, n) rad/s^2 (prismatic m/s^2), where the recording gives them
    frame_id: str = ""
    clock: Clock = "header"  # which of the two stamps is the time
    topic: str = "/joint_states"
    storage: Storage = "sqlite3"
    effort_is: str = ""  # the meaning that the file's format states, see Effort; "": none
    notes: tuple[str, ...] = ()  # what was left out or assumed, in words

    def __post_init__(self) -> None:
        object.__setattr__(self, "notes", tuple(map(told, self.notes)))

    @property
    def stamps(self) -> Integers:
        """(N,) ns: those stamps that are the time of the samples."""
        return self.receive_stamps if self.clock == "receive" else self.header_stamps

    @property
    def time(self) -> Floats:
        """(N,) s since the first sample."""
        return self.time_at(slice(None))

    def time_at(self, rows: slice | Integers) -> Floats:
        """`time` [s] of some rows, in their shape, without those of all samples in memory."""
        return (self.stamps[rows] - self.stamps[:1]).astype("float64") * 1e-9

    @property
    def duration(self) -> float:
        """s, from the first sample to the last one."""
        return float(self.stamps[-1] - self.stamps[0]) * 1e-9

    def of(self, joints: Sequence[str]) -> JointLog:
        """The samples of these joints, in their order; none named: of all. Raises BagError."""
        if missing := [joint for joint in joints if joint not in self.joint_names]:
            raise BagError(
                f"samples: expected joints {', '.join(joints)}, got {', '.join(self.joint_names)}: missing "
                f"{', '.join(missing)}"
            )
        columns = [self.joint_names.index(joint) for joint in joints or self.joint_names]
        chosen: dict[str, Any] = {
            name: None if (values := getattr(self, name)) is None else values[:, columns]
            for name in ("q", "qd", "effort", "qdd")
        }
        return replace(self, joint_names=tuple(joints) or self.joint_names, **chosen)

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        joints = ", ".join(self.joint_names)
        return f"<JointLog: {len(self)} samples in {self.duration:.4g} s of {joints}>"
