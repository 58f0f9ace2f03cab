# SPDX-License-Identifier: Apache-2.0
"""`ids evaluate`: from a recording to computed torques, errors and plots."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.extras import how_to_install, is_installed
from inverse_dynamics.verbs.common import (
    file_name,
    number,
    positive_number,
    process_count,
    progress_bar,
)
from inverse_dynamics.verbs.heading import print_heading
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import (
    add_effort_is,
    add_figures,
    add_robot,
    add_robot_changes,
    add_verb,
    chosen_robot,
    robot_changes,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.results.many_evaluations import ManyEvaluations
    from inverse_dynamics.robot.robots import Robot

_EPILOG = """\
examples:
  ids evaluate recording --robot ur10_real
      computed against measured torques, with the run configuration ur10_real

  ids evaluate recording --robot my_robot.yaml --out result
      a robot of your own, results into the directory result

  ids evaluate recording --urdf my_arm.urdf --tip flange
      no run configuration yet: the description alone, without friction

  ids evaluate recording --robot ur10_real \\
      --plugin kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL
      another solver on the same robot

  ids evaluate recording --robot panda_real --accelerations low-pass --cutoff 5
      another filter; backward-difference uses none

  ids evaluate recording --robot ur10_real --from 10 --to 20
      ten seconds of the recording

  ids evaluate recording --robot ur10_real --gravity 0,-9.81,0
      mounted on a wall: the direction of gravity in the frame of the root link

  ids evaluate recording --robot ur10_real --effort-is auto
      find out whether efforts are torques, motor currents or torques without gravity

  ids evaluate motion.csv --robot my_robot.yaml
      a table: columns time [s] and, for each joint, position.JOINT, velocity.JOINT, effort.JOINT
      (or current.JOINT [A]), optionally acceleration.JOINT; separated by comma, semicolon, tab or spaces

  ids evaluate robot_data.csv --robot ur10_real
      a recording of UR's RTDE client library: efforts are motor currents

  ids evaluate monday tuesday wednesday --robot ur10_real --out week
  ids evaluate recordings_of_a_week --robot ur10_real --jobs 4
      many recordings at the same time: one table, one page, and a result for each (docs/many_recordings.md)

results, written whole or not at all:
  metrics.json            errors of each joint
  torques.png             measured and computed torques and the error, over time; with --figures
                          also torques.svg, torques.pdf
  bag/                    recording with /torques (computed) and /torques_gt (measured)
  plotjuggler.xml         layout for PlotJuggler: `plotjuggler --layout plotjuggler.xml`
  series.npz              time, q, qd, qdd, effort (as recorded), measured, computed, for numpy.load()
  evaluation.json         assumptions: filter, messages left out, model, meaning of efforts

results of several recordings:
  report.html             all recordings on one page; NAME/report.html shows a single one
  summary.csv, .parquet   errors, one row per recording and joint, for pandas, polars, DuckDB
  recordings.json         the recordings, and why some failed
  NAME/                   the files listed above, for each recording; with --parquet also series.parquet

A recording that fails is named, and the others are finished; the exit status is then 3.

A piece of a compressed recording may unpack to 256 MB, or to 50 times its size; the environment
variable IDS_UNPACK_LIMIT_MB sets another limit.
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    from inverse_dynamics.data.joint_log import CLOCKS
    from inverse_dynamics.evaluation.accelerations import RULES
    from inverse_dynamics.robot.choices import METHODS

    parser = add_verb(
        subparsers,
        "evaluate",
        summary="compute the torques of a recorded motion and compare them with the measured ones",
        epilog=_EPILOG,
        json=True,
    )
    parser.add_argument(
        "bags",
        metavar="BAG",
        type=file_name,
        nargs="+",
        help="rosbag2 recording of sensor_msgs/JointState or trajectory_msgs/JointTrajectory (a "
        "directory, or a .db3 or .mcap file), or a table of numbers (.csv or .txt); or a directory "
        "that holds recordings",
    )
    add_robot(parser)
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="output directory (default: BAG_ROBOT in the working directory; for several recordings: "
        "recordings_ROBOT)",
    )
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace an older result in that directory, unless it holds other files too",
    )
    parser.add_argument(
        "--storage",
        choices=("sqlite3", "mcap"),
        help="storage of the output recording (default: that of BAG; for a table: sqlite3)",
    )
    add_figures(parser)
    parser.add_argument(
        "--parquet", action="store_true", help="write series.parquet too: see `ids export --help`"
    )
    parser.add_argument("--verbose", action="store_true", help="print also how long each step took")

    many = parser.add_argument_group("several recordings")
    many.add_argument(
        "--jobs",
        metavar="N",
        type=process_count,
        help="number evaluated at the same time, each in its own process (default: one per core)",
    )
    many.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="on the workers of a Dask cluster instead: tcp://HOST:8786 of its scheduler",
    )

    robot = add_robot_changes(parser, "recording")
    robot.add_argument(
        "--topic", metavar="NAME", help="topic of the joint states, or of the trajectory"
    )
    add_effort_is(robot)

    samples = parser.add_argument_group("time and accelerations")
    samples.add_argument(
        "--accelerations",
        metavar="METHOD",
        choices=tuple(METHODS),
        help="; ".join(f"{name}: {text}" for name, text in METHODS.items()),
    )
    samples.add_argument(
        "--cutoff",
        metavar="HZ",
        type=positive_number,
        help="cut-off frequency of the low-pass filter",
    )
    samples.add_argument(
        "--from",
        dest="start",
        metavar="SECONDS",
        type=number,
        help="leave out the samples before this time, counted from the first sample",
    )
    samples.add_argument(
        "--to",
        dest="end",
        metavar="SECONDS",
        type=number,
        help="leave out the samples after this time",
    )
    samples.add_argument(
        "--clock",
        choices=CLOCKS,
        default="auto",
        help="time stamps that are used: the header's, those of reception, or the header's if "
        "there are any (auto)",
    )
    samples.add_argument(
        "--without-rule",
        metavar="RULE",
        choices=tuple(RULES),
        action="append",
        default=[],
        help="report what this rule finds, but do not act on it; may be given several times. "
        + "; ".join(f"{name}: {text}" for name, text in RULES.items()),
    )
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.data.several_recordings import holds_recordings

    robot = chosen_robot(arguments)
    asked = arguments.jobs is not None or arguments.scheduler is not None
    if asked or len(arguments.bags) > 1 or holds_recordings(arguments.bags[0]):
        _run_many(arguments, robot)
    else:
        _run_one(arguments, robot)


def _run_one(arguments: argparse.Namespace, robot: Robot) -> None:
    from inverse_dynamics.base.files import check_output_directory
    from inverse_dynamics.data.several_recordings import name_of
    from inverse_dynamics.results.evaluations import CONTENTS, evaluate_into, metrics

    (bag,) = arguments.bags
    out = arguments.out or Path(f"{name_of(bag)}_{robot.name}")
    inputs = (bag, arguments.urdf, *robot.files)
    # Before the work.
    check_output_directory(out, overwrite=arguments.overwrite, contents=CONTENTS, inputs=inputs)
    if arguments.parquet:
        from inverse_dynamics.results.exports import check_pyarrow

        check_pyarrow()

    with progress_bar() as progress:
        evaluation = evaluate_into(
            out,
            bag,
            robot,
            overwrite=arguments.overwrite,
            storage=arguments.storage,
            figures=arguments.figures,
            parquet=name_of(bag) if arguments.parquet else None,
            progress=progress,
            **_options(arguments),
        )
    if arguments.json:
        print_json("evaluate", metrics(evaluation), [out])
        return
    _print(evaluation, out, arguments.figures)
    if arguments.verbose:
        _print_times(evaluation.seconds, len(evaluation.log))


def _options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Options of evaluate(), except recording and robot."""
    return {
        **robot_changes(arguments),
        "topic": arguments.topic,
        "effort_is": arguments.effort_is,
        "accelerations": arguments.accelerations,
        "cutoff": arguments.cutoff,
        "clock": arguments.clock,
        "start": arguments.start,
        "end": arguments.end,
        "without_rules": arguments.without_rule,
    }


def _run_many(arguments: argparse.Namespace, robot: Robot) -> None:
    from inverse_dynamics.errors import PartialError
    from inverse_dynamics.results.many_evaluations import evaluate_many, failures_told, summary

    start = time.perf_counter()
    with progress_bar() as progress:
        result = evaluate_many(
            arguments.bags,
            arguments.robot or robot,
            arguments.out or Path(f"recordings_{robot.name}"),
            jobs=arguments.jobs,
            scheduler=arguments.scheduler,
            overwrite=arguments.overwrite,
            storage=arguments.storage,
            figures=arguments.figures,
            parquet=arguments.parquet,
            progress=progress,
            **_options(arguments),
        )
    if arguments.json:
        print_json("evaluate", summary(result, robot), [result.directory])
    else:
        _print_many(result, robot)
    if arguments.verbose and not arguments.json:
        from inverse_dynamics.verbs.screen import Screen

        Screen().print(f"time           {time.perf_counter() - start:.1f} s")
    if result.failures:
        count = len(result.failures) + len(result.summaries)
        raise PartialError(
            failures_told(f"{len(result.failures)} of {count} recordings failed", result.failures)
        )


def _print_many(result: ManyEvaluations, robot: Robot) -> None:
    from inverse_dynamics.verbs.screen import Screen
    from inverse_dynamics.verbs.tables import recordings_table

    console = Screen()
    console.print(robot.description or robot.name, style="bold")
    console.print(f"solver         {result.summaries[0].plugin}")
    console.print(recordings_table(result.summaries))
    console.print(f"page           {result.directory / 'report.html'}")
    console.print(f"summary        {result.directory / 'summary.csv'}")
    console.print(f"results        {result.directory}/NAME")


def _print(evaluation: Evaluation, out: Path, figures: Sequence[str]) -> None:
    from inverse_dynamics.verbs.screen import Screen
    from inverse_dynamics.verbs.tables import error_table

    console = Screen()
    print_heading(console, evaluation)
    console.print(f"accelerations  {evaluation.accelerations.summary}")
    console.print(f"effort means   {evaluation.effort.summary}")
    for note in evaluation.notes:
        console.print(f"note           {note}")
    console.print(error_table(evaluation))
    for suffix in figures:
        console.print(f"figure         {out / f'torques.{suffix}'}")
    if not figures and not is_installed("matplotlib"):
        console.print(f"figure         none, it needs matplotlib: {how_to_install('matplotlib')}")
    console.print(f"bag            {out / 'bag'}: /torques (computed), /torques_gt (measured)")
    console.print(f"errors         {out / 'metrics.json'}")


def _print_times(seconds: dict[str, float], messages: int) -> None:
    """Where the time went: what grows with the recording, and the rest."""
    from inverse_dynamics.verbs.screen import Screen

    growing = ("reading", "accelerations", "torques", "writing")
    each = ", ".join(f"{what} {seconds[what] / messages * 1e6:.1f} µs" for what in growing)
    together = sum(seconds[what] for what in growing)
    Screen().print(
        f"time           {each} per message, {together:.1f} s together; solver "
        f"{seconds['solver']:.1f} s, plots {seconds['plotting']:.1f} s"
    )
