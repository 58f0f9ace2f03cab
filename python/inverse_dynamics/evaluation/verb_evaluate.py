# SPDX-License-Identifier: Apache-2.0
"""`ids evaluate`: from a recording to computed torques, errors and plots."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.installation.extras import how_to_install, is_installed
from inverse_dynamics.recordings.joint_log import STORAGES
from inverse_dynamics.terminal.options import (
    FILTER,
    RECORDING,
    SOLVER,
    Options,
    chosen_robot,
    given_overrides,
)
from inverse_dynamics.terminal.values import count, file_name

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.robots.robots import Robot
    from inverse_dynamics.terminal.screen import Line

PLACE = ("look", 4)
SUMMARY = "compare computed with measured torques of a recording"
DESCRIPTION = "Compute the torques of a recorded motion and compare them with the measured ones."
EPILOG = """\
examples:
  ids evaluate recording --robot ur10_real --out result
      computed against measured torques, with the run configuration ur10_real

  ids evaluate recording --urdf my_arm.urdf --tip flange
      no run configuration yet: the description alone, without friction

  ids evaluate recording --robot ur10_real --gravity 0,-9.81,0 --effort-is auto
      mounted on a wall; find out what the recorded efforts mean

  ids evaluate motion.csv --urdf my_arm.urdf
      a table with columns such as time, q0, dq0, tau0 or JOINT_position, JOINT_effort

  ids evaluate log.csv --urdf arm.urdf --columns "q=ax*_pos, i=ax*_amp"
      a table whose names don't say what its columns are (docs/tables.md)

  ids evaluate monday tuesday wednesday --robot ur10_real --out week
  ids evaluate recordings_of_a_week --robot ur10_real --jobs 4
      many recordings in parallel: one table, one page, and a result for each (docs/many_recordings.md)

results, written whole or not at all:
  metrics.json            errors of each joint
  report.html             a page: the robot in motion, its torques, errors
  torques.png             measured and computed torques and the error, over time
  bag/                    recording with /torques (computed) and /torques_gt (measured)
  series.npz              time, q, qd, qdd, effort (as recorded), measured, computed, band, for numpy.load()
  evaluation.json         assumptions: filter, messages left out, model, meaning of efforts

results of several recordings:
  report.html             all recordings on one page; NAME/report.html shows a single one
  summary.csv             errors, one row per recording and joint, for pandas, polars, DuckDB
  recordings.json         the recordings, and why some failed
  NAME/                   the files listed above, for each recording; with --parquet also series.parquet

If a recording fails, the others are finished; the exit status is 3. docs/outputs.md: limits on what is read.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.argument(
        "bags",
        metavar="BAG",
        type=file_name,
        nargs="+",
        help="rosbag2 recording of sensor_msgs/JointState or trajectory_msgs/JointTrajectory (a "
        "directory, or a .db3 or .mcap file), a ROS 1 recording (.bag), or a table (.csv, .tsv, "
        ".txt, .dat, .log, .asc, .parquet, .npz, .npy, .mat; several files of one "
        "recording: A+B); or a directory that holds recordings",
    )
    options.robot()
    options.output(
        "DIR",
        "output directory (default: BAG_ROBOT in the working directory; for several recordings: "
        "recordings_ROBOT)",
        replaces=True,
    )
    options.add(
        "--storage",
        "storage of the output recording (default: that of BAG; for a table: sqlite3)",
        choices=STORAGES,
    )
    options.shared("--json")
    options.figures()
    options.add("--parquet", "write series.parquet too: see `ids export --help`")

    many = options.group("several recordings")
    many.add(
        "--jobs N",
        "number evaluated at the same time, each in its own process (default: one per core)",
        count,
    )
    many.add(
        "--scheduler ADDRESS",
        "on the workers of a Dask cluster instead: tcp://HOST:8786 of its scheduler",
    )
    options.overrides(*SOLVER, *RECORDING, *FILTER)


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.evaluation.files import evaluate_into
    from inverse_dynamics.recordings.several_recordings import holds_recordings, name_of
    from inverse_dynamics.recordings.tables import parts_joined
    from inverse_dynamics.terminal.screen import progress_bar, show

    arguments.bags = parts_joined(arguments.bags)
    robot = chosen_robot(arguments)
    options = {
        "overwrite": arguments.overwrite,
        "storage": arguments.storage,
        "figures": arguments.figures,
        **given_overrides(arguments),
    }
    bag, *others = arguments.bags
    asked = arguments.jobs is not None or arguments.scheduler is not None
    if asked or others or holds_recordings(bag):
        _run_many(arguments, robot, options)
        return
    out = arguments.out or Path(f"{name_of(bag)}_{robot.name}")
    parquet = name_of(bag) if arguments.parquet else None
    with progress_bar() as progress:
        evaluation = evaluate_into(out, bag, robot, parquet=parquet, progress=progress, **options)
    drawn = [str(out / f"torques.{suffix}") for suffix in arguments.figures]
    if not drawn and not is_installed("matplotlib"):
        drawn = [f"none, it needs matplotlib: {how_to_install('matplotlib')}"]
    files: list[Line] = [
        ("page", [page] if (page := out / "report.html").is_file() else []),
        ("figure", drawn),
        ("bag", f"{out / 'bag'}: /torques (computed), /torques_gt (measured)"),
        ("errors", out / "metrics.json"),
    ]
    show(arguments, evaluation.numbers(), [out], [*evaluation.lines(), *files])


def _run_many(arguments: argparse.Namespace, robot: Robot, options: dict[str, Any]) -> None:
    from inverse_dynamics.errors import PartialError
    from inverse_dynamics.evaluation.many_evaluations import evaluate_many, failures_text, summary
    from inverse_dynamics.evaluation.tables import recordings_table
    from inverse_dynamics.terminal.screen import progress_bar, show

    with progress_bar() as progress:
        result = evaluate_many(
            arguments.bags,
            robot,
            arguments.out or Path(f"recordings_{robot.name}"),
            jobs=arguments.jobs,
            scheduler=arguments.scheduler,
            parquet=arguments.parquet,
            progress=progress,
            **options,
        )
    lines: list[Line] = [
        ("", robot.description or robot.name),
        ("solver", result.summaries[0].plugin),
        recordings_table(result.summaries),
        ("page", result.directory / "report.html"),
        ("summary", result.directory / "summary.csv"),
        ("results", f"{result.directory}/NAME"),
    ]
    show(arguments, summary(result, robot), [result.directory], lines)
    if result.failures:
        failed = len(result.failures)
        what = f"{failed} of {failed + len(result.summaries)} recordings failed"
        raise PartialError(failures_text(what, result.failures))
