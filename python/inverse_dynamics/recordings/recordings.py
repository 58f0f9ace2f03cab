# SPDX-License-Identifier: Apache-2.0
"""A recorded motion from whatever it is stored in.

    log = read_recording("recording", ["joint_1", "joint_2"])

rosbag2 recordings of sensor_msgs/JointState (bags.py) or trajectory_msgs/JointTrajectory
(joint_trajectories.py), ROS 1 recordings (ros1_bags.py), and tables: .csv, .tsv, .txt, .dat, .log,
.asc, .parquet, .npz, .npy, .mat, data sets of LeRobot, arrays by name (tables.py, table_logs.py).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import Recording
from inverse_dynamics.arrays import whole_turns
from inverse_dynamics.errors import BagError
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings import bags, joint_trajectories
from inverse_dynamics.recordings.array_files import HDF5, command_for
from inverse_dynamics.recordings.joint_log import JointLog, check_clock
from inverse_dynamics.recordings.log_format import PLAIN, LogFormat
from inverse_dynamics.recordings.ros1_bags import is_ros1_bag, read_ros1_log
from inverse_dynamics.recordings.table_logs import read_named_positions, read_table_log
from inverse_dynamics.recordings.tables import is_table, open_table
from inverse_dynamics.recordings.vocabulary import ACCELERATION, EFFORT, POSITION, VELOCITY

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Clock, Recorded

_PUBLISHED_BY = 1000  # messages: a joint that none of them has isn't published
# Of a table t, by name or by row: columns by name. With `/` before them, no name is that of an argument of savez().
_ARRAYS = (
    "; c = t if hasattr(t, 'keys') else {{k: [r[k] for r in t] for k in t[0]}}; numpy.savez(sys.argv[2], "
    "**{{'/' + str(k): [*c[k].values()] if isinstance(c[k], dict) else c[k] for k in c.keys()}})\" {path} {stem}.npz"
)
_PYTHON = 'python3 -c "import json, numpy, pickle, sys; t = '
# What isn't read here: what to do, with the modules that a command needs.
_CONVERTED_BY: dict[str, tuple[str, ...]] = {
    ".xlsx": ("save it as .csv in the program that wrote it",),
    ".json": (f"{_PYTHON}json.load(open(sys.argv[1])){_ARRAYS}",),
    ".jsonl": (f"{_PYTHON}[json.loads(r) for r in open(sys.argv[1])]{_ARRAYS}",),
    ".pkl": (f"{_PYTHON}pickle.load(open(sys.argv[1], 'rb')){_ARRAYS}",),
    ".feather": (
        'python3 -c "import sys, pyarrow.feather as f, pyarrow.parquet as p; p.write_table(f.read_table(sys.argv[1]), '
        'sys.argv[2])" {path} {stem}.parquet',
        "pyarrow",
    ),
    ".h5": (HDF5, "h5py"),
    ".hdf5": (HDF5, "h5py"),
    ".gz": ("gunzip -k {path}",),
    ".zip": ("python3 -m zipfile -e {path} .",),
}


def read_recording(
    path: Recorded,
    joints: Sequence[str] = (),
    *,
    topic: str = "",
    usual_topic: str = "",
    clock: Clock = "auto",
    form: LogFormat = PLAIN,
    progress: Progress = no_progress,
) -> JointLog:
    """Samples of a motion: time, positions, velocities, efforts, accelerations where there are any.

    Parameters
    ----------
    path
        A table (.csv, .tsv, .txt, .dat, .log, .asc, .parquet, .npz, .npy, .mat), arrays by name, a structured
        array or a DataFrame, else a recording of ROS.
    joints
        Names, in the order wanted; by default those of the recording.
    topic
        Of a bag, or several joined by +. By default usual_topic if it is there, else the only one of joint
        states, else the only one of trajectories if there are no joint states, but other ones or several
        together if these have all the joints alone.
    clock
        Which stamp of messages is the time.
    form
        What names don't say.

    Raises
    ------
    UserError
        BagError.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import read_recording
    >>> table = {"t": np.arange(20) / 100, "q": np.zeros((20, 3)), "tau": np.ones((20, 3))}  # s, rad, N m
    >>> read_recording(table).effort.shape
    (20, 3)
    """
    motion = open_motion(
        path,
        joints,
        topic=topic,
        usual_topic=usual_topic,
        clock=clock,
        form=form,
        progress=progress,
    )
    return motion if isinstance(motion, JointLog) else motion.read(joints, clock, progress)


def open_motion(
    path: Recorded,
    joints: Sequence[str],
    *,
    topic: str,
    usual_topic: str,
    clock: Clock,
    form: LogFormat,
    progress: Progress,
) -> JointLog | bags.JointStateTopic:
    """The samples, but for those of joint states, which may be too many for the memory.

    The arguments are those of read_recording(). Joint states that a scale, a sign or gears are stated for are read.
    """
    path = Path(path) if isinstance(path, str) else path
    check_clock(clock)
    if isinstance(path, JointLog):
        return _scaled(path.of(joints), form, "samples")
    if is_table(path):
        table = open_table(path, topic=topic, clock=clock)
        return read_table_log(table, joints, form, progress=progress)
    assert isinstance(path, Path)
    if is_ros1_bag(path):
        return read_ros1_log(path, joints, topic=topic, clock=clock, form=form, progress=progress)
    if (convert := _CONVERTED_BY.get(path.suffix.lower())) and path.is_file():
        command, *modules = convert
        raise BagError(
            f"{path}: expected a recording of ROS or a table, got {path.suffix}; convert it: "
            f"{command_for(command, path, *modules)}"
        )
    recording = Recording(path)
    topics = bags.topics_of(recording)
    types = {t.name: t.message_type for t in topics if t.message_count or t.name == topic}
    types = types or {t.name: t.message_type for t in topics}
    if not topic:
        topic = recording.topics_with_joints(_topic(types, usual_topic), list(joints))
    if types.get(topic) == joint_trajectories.MESSAGE_TYPE:
        trajectories = joint_trajectories.read_joint_trajectories(path, topic, progress)
        log = joint_trajectories.joint_log_of(trajectories, joints, clock, topic, recording.storage)
    else:
        topic = recording.topic_of_type(bags.MESSAGE_TYPE, topic)
        states = bags.JointStateTopic(recording, topic)
        if not (form.scale or form.sign or form.gears):
            return states
        log = states.read(joints, clock, progress)
    return _scaled(log, form, f"{path}")


def _scaled(log: JointLog, form: LogFormat, where: str) -> JointLog:
    """The log with what is stated: other units, other signs. Raises BagError."""
    kinds = {"q": POSITION, "qd": VELOCITY, "effort": EFFORT}
    if log.qdd is not None:
        kinds["qdd"] = ACCELERATION
    numbers = {kind: getattr(log, field) for field, kind in kinds.items()}
    scaled: dict[str, Any] = form.scaled(numbers, {}, len(log.joint_names), where)
    return replace(log, **{field: scaled[kind] for field, kind in kinds.items()})


def position_ranges(
    path: Recorded,
    joints: Sequence[str],
    *,
    turning: Sequence[str] = (),
    topic: str = "",
    usual_topic: str = "",
    form: LogFormat = PLAIN,
) -> dict[str, tuple[float, float, float]]:
    """Least, mean and greatest position of those of the joints that the recording has, by name.

    turning: joints of which whole turns don't count: positions are those nearest to the first one.
    Positions that aren't finite are left out. topic, usual_topic: as for read_recording(). Of joint states
    only. Raises BagError.
    """
    path = Path(path) if isinstance(path, str) else path
    found: dict[str, tuple[float, float, float]] = {}
    first: dict[str, float] = {}
    counts: dict[str, int] = {}
    for names, positions in _positions(path, joints, topic, usual_topic, form):
        for name in filter(names.__contains__, joints):
            q = positions[:, names.index(name)]
            q = q[np.isfinite(q)]
            if not len(q):
                continue
            if name in turning:
                q = q - whole_turns(q - first.setdefault(name, float(q[0])))
            least, mean, greatest = found.get(name, (np.inf, 0.0, -np.inf))
            count = counts[name] = counts.get(name, 0) + len(q)
            mean += float((q - mean).sum()) / count
            found[name] = (min(least, float(q.min())), mean, max(greatest, float(q.max())))
    return found


def _positions(
    path: Recorded,
    joints: Sequence[str],
    topic: str,
    usual_topic: str,
    form: LogFormat,
) -> Iterator[tuple[tuple[str, ...], Floats]]:
    """Names, and positions of them in some messages, until it shows that none is of the joints."""
    if isinstance(path, JointLog):
        yield path.joint_names, path.q
        return
    if is_table(path):
        found = read_named_positions(open_table(path), joints, form)
        if found:
            yield tuple(found), np.column_stack([*found.values()])
        return
    assert isinstance(path, Path)
    factors = form.factors(f"{path}").get(POSITION, np.ones(1))
    if len(factors) > 1:  # of the chain's joints
        return
    if is_ros1_bag(path):
        log = read_ros1_log(path, topic=topic)
        yield log.joint_names, factors * log.q
        return
    recording = Recording(path)
    there = {t.name: t for t in bags.topics_of(recording) if t.message_type == bags.MESSAGE_TYPE}
    usual = [usual_topic] if usual_topic in there else there
    for name in topic.split("+") if topic else usual:
        if name in there:
            for names, positions in _positions_of_topic(recording, name, joints):
                yield names, factors * positions


def _positions_of_topic(
    recording: Recording, topic: str, joints: Sequence[str]
) -> Iterator[tuple[tuple[str, ...], Floats]]:
    messages, published = 0, False
    for block in recording.joint_states(topic):
        names, positions = block[0], block[4]
        if positions.shape[1:] == (len(names),):
            yield names, positions
        messages += len(positions)
        published = published or not set(joints).isdisjoint(names)
        if messages > _PUBLISHED_BY and not published:
            return


def _topic(types: dict[str, str], usual: str) -> str:
    """The usual topic, else the only one of joint states, else that of trajectories."""
    if usual in types:
        return usual
    for message_type in (bags.MESSAGE_TYPE, joint_trajectories.MESSAGE_TYPE):
        found = [name for name, kind in types.items() if kind == message_type]
        if found:
            return found[0] if len(found) == 1 else usual
    return usual
