# SPDX-License-Identifier: Apache-2.0
"""A simulated recording on disk: a bag like any other, with the truth beside its messages.

    BAG/metadata.yaml, BAG/BAG.db3 or BAG/BAG.mcap      what rosbag2 would have recorded
    BAG/simulation.yaml                                 how it was made
    BAG/trajectory.yaml                                 the desired motion, for --trajectory
    BAG/truth.npz                                       one row per message: the motion without any sensor's error

rosbag2 and its tools read only what metadata.yaml names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.files import Contents, move_up, write_text, written_whole
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.data.bags import write_joint_logs
from inverse_dynamics.simulation.trajectory_file import trajectory_text

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Storage
    from inverse_dynamics.simulation.run import SimulatedRun

MARK = "simulation.yaml"
"""The file by which a directory is known as a simulated recording."""

CONTENTS = Contents(
    MARK,
    (MARK, "metadata.yaml", "{name}.db3*", "{name}.mcap", "trajectory.yaml", "truth.npz"),
)


def write_run(
    run: SimulatedRun,
    out: Path,
    *,
    storage: Storage = "sqlite3",
    overwrite: bool = False,
    progress: Progress = no_progress,
) -> None:
    """Writes a simulated recording to the directory `out`, whole or not at all.

    overwrite: replace an older simulated recording. Raises OutputError, BagError.
    """
    import yaml

    with written_whole(out, overwrite=overwrite, contents=CONTENTS) as directory:
        bag = directory / out.name  # its files are named after the directory they will be in
        write_joint_logs(bag, {run.log.topic: run.log}, storage=storage, progress=progress)
        move_up(bag)
        settings = {**run.settings, "storage": storage}
        write_text(directory / MARK, yaml.safe_dump(settings, sort_keys=False))
        trajectory = trajectory_text(run.trajectory, run.trajectory_source)
        write_text(directory / "trajectory.yaml", trajectory)
        motion, rows = run.motion, run.recorded.rows
        np.savez(
            directory / "truth.npz",
            joint_names=np.array(run.settings["joints"]),
            time=motion.time[rows],
            q=motion.q[rows],
            qd=motion.qd[rows],
            qdd=motion.qdd[rows],
            effort=motion.effort[rows],
            friction=motion.friction[rows],
            q_desired=motion.q_desired[rows],
        )
