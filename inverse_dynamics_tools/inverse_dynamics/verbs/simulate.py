# SPDX-License-Identifier: Apache-2.0
"""`ids simulate`: a recording of a simulated robot."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.decimals import decimal
from inverse_dynamics.base.wording import counted
from inverse_dynamics.verbs.common import (
    announce,
    number,
    positive_number,
    progress_bar,
    whole_number,
)
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import add_gravity, add_robot, add_verb

if TYPE_CHECKING:
    from inverse_dynamics.simulation import Payload, Resolution, SimulatedRun

_MOUNTS = ("floor", "wall", "ceiling")

_EPILOG = """\
examples:
  ids simulate --robot ur10_simulated --out recording
      a UR10 follows its exciting trajectory; `ids evaluate recording --robot ur10_simulated` evaluates it

  ids simulate --robot panda_simulated --out recording \\
      --rate 500 --noise --joint-friction
      with friction in the joints and noise of the sensors, as on a real robot

  ids simulate --robot my_arm.yaml --out recording --from-model \\
      --effort-noise evaluation --effort-delay 0.008 --message-rate 125
      the arm that `ids identify` found, with what its model leaves unexplained as noise, and torques
      that are 8 ms late: a test whether `ids identify` finds it again

  ids simulate --robot ur10_simulated --out recording \\
      --payload 5,0,0,0.1 --mount ceiling
      5 kg, 0.1 m in front of the tip; base mounted upside down

  ids simulate --robot my_robot.yaml --out recording --optimise --seed 1
      search for a new exciting trajectory first (about a minute), and store it in the recording

  ids simulate --robot ur10_simulated --out recording --trajectory other.yaml
      a motion of your own: waypoints or a Fourier series

results, written whole or not at all:
  metadata.yaml, .db3 or .mcap   recording of sensor_msgs/JointState, as rosbag2 writes it
  simulation.yaml                all settings of the simulation
  trajectory.yaml                the desired motion
  truth.npz                      per message, without the sensors' errors: time, q, qd, effort, and the simulator's qdd
                                 and friction
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "simulate",
        summary="record a simulated robot (MuJoCo) following an exciting trajectory",
        description=(
            "Simulate a robot (MuJoCo) under a joint trajectory controller that commands efforts, "
            "while it follows an exciting trajectory, and record its joint states to a bag."
        ),
        epilog=_EPILOG,
        json=True,
    )
    add_robot(parser, required=True)
    parser.add_argument("--out", metavar="BAG", type=Path, required=True, help="the new recording")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace an older simulated recording"
    )
    parser.add_argument(
        "--storage",
        choices=("sqlite3", "mcap"),
        default="sqlite3",
        help="storage of the recording (default: sqlite3)",
    )
    parser.add_argument(
        "--seed",
        type=whole_number,
        default=0,
        help="seed of all random numbers, and of where in its period the run configuration's motion begins: "
        "the same seed gives the same recording, another one another (default: 0, from the beginning)",
    )

    motion = parser.add_argument_group("motion")
    motion.add_argument(
        "--trajectory",
        metavar="FILE",
        type=Path,
        help="desired motion (YAML: waypoints or Fourier series; default: the run configuration's)",
    )
    motion.add_argument(
        "--optimise",
        action="store_true",
        help="search for a new exciting trajectory instead, as `ids excite` does",
    )
    motion.add_argument(
        "--duration",
        metavar="S",
        type=positive_number,
        help="length of the motion (default: once through the trajectory; exciting ones repeat)",
    )
    motion.add_argument(
        "--rate",
        metavar="HZ",
        type=whole_number,
        help="rate of controller and recording: 125, 500 or 1000 (default: the run configuration's)",
    )
    motion.add_argument(
        "--no-table",
        dest="table",
        action="store_false",
        help="allow the arm to reach below its base",
    )

    robot = parser.add_argument_group("robot")
    robot.add_argument(
        "--payload", metavar="KG[,X,Y,Z]", type=_payload, help="point mass at the tip [kg; m]"
    )
    robot.add_argument(
        "--joint-friction",
        metavar="PART|urdf|model",
        nargs="?",
        const="0.02",
        help="Coulomb friction as a share of each effort limit, and as much viscous friction at the "
        "velocity limit (without a value: 0.02); urdf: what the description's <dynamics> says; model: that of "
        "the run configuration's solver",
    )
    robot.add_argument(
        "--from-model",
        action="store_true",
        help="links, rotor inertias and friction of the run configuration's model, as `ids identify` "
        "writes it, instead of the description's links without friction",
    )
    gravity = robot.add_mutually_exclusive_group()
    add_gravity(gravity)
    gravity.add_argument(
        "--mount", choices=_MOUNTS, help="floor; wall: the x axis up; ceiling: upside down"
    )

    recording = parser.add_argument_group("recording")
    recording.add_argument(
        "--noise",
        metavar="Q,QD,EFFORT",
        nargs="?",
        const="default",
        type=_resolution,
        help="standard deviations of Gaussian noise [rad, rad/s, N m] (without a value: 1e-5,1e-3,0.1)",
    )
    recording.add_argument(
        "--effort-noise",
        metavar="DIR",
        type=Path,
        help="a result of `ids evaluate` of a real robot: stretches of 2 s of its measured minus computed "
        "torques, in random order, are the noise of the efforts",
    )
    recording.add_argument(
        "--effort-delay",
        metavar="S",
        type=number,
        default=0.0,
        help="delay of recorded efforts behind positions and velocities [s]",
    )
    recording.add_argument(
        "--message-rate",
        metavar="HZ",
        type=positive_number,
        help="messages per second (default: one per period of the controller)",
    )
    recording.add_argument(
        "--quantisation",
        metavar="Q,QD,EFFORT",
        nargs="?",
        const="default",
        type=_resolution,
        help="steps of the values [rad, rad/s, N m] (without a value: 1e-5,1e-3,0.01)",
    )
    recording.add_argument(
        "--drop", metavar="P", type=number, default=0.0, help="share of messages that are lost"
    )
    recording.add_argument(
        "--repeat",
        metavar="P",
        type=number,
        default=0.0,
        help="share of messages that repeat the values of the previous one",
    )
    recording.add_argument(
        "--jitter",
        metavar="S",
        type=number,
        default=0.0,
        help="standard deviation of the time stamps [s]",
    )
    recording.add_argument(
        "--start-stamp",
        metavar="S",
        type=number,
        help="time stamp of the start [s] (default: 1700000000)",
    )
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.base.files import check_output_directory
    from inverse_dynamics.robot.robots import load_robot

    robot = load_robot(arguments.robot)
    from inverse_dynamics.simulation.writer import CONTENTS

    # Before the work.
    inputs = (arguments.trajectory, arguments.effort_noise, *robot.files)
    check_output_directory(
        arguments.out, overwrite=arguments.overwrite, contents=CONTENTS, inputs=inputs
    )

    from inverse_dynamics.simulation import (
        MOUNTS,
        NOISE,
        QUANTISATION,
        EffortNoise,
        simulate,
        write_run,
    )
    from inverse_dynamics.simulation.sensors import EPOCH, Sensors

    def chosen(three: Resolution | str | None, default: Resolution) -> Resolution | None:
        return default if isinstance(three, str) else three

    sensors = Sensors(
        noise=chosen(arguments.noise, NOISE),
        quantisation=chosen(arguments.quantisation, QUANTISATION),
        drop=arguments.drop,
        repeat=arguments.repeat,
        jitter=arguments.jitter,
        epoch=EPOCH if arguments.start_stamp is None else arguments.start_stamp,
        effort_noise=arguments.effort_noise and EffortNoise.of_result(arguments.effort_noise),
        effort_delay=arguments.effort_delay,
        message_rate=arguments.message_rate,
    )
    with progress_bar() as progress:
        result = simulate(
            robot,
            trajectory=arguments.trajectory,
            optimise=arguments.optimise,
            rate=arguments.rate,
            duration=arguments.duration,
            seed=arguments.seed,
            sensors=sensors,
            payload=arguments.payload,
            joint_friction=arguments.joint_friction,
            from_model=arguments.from_model,
            gravity=MOUNTS[arguments.mount] if arguments.mount else arguments.gravity,
            table=arguments.table,
            say=announce,
            progress=progress,
        )
        write_run(
            result,
            arguments.out,
            storage=arguments.storage,
            overwrite=arguments.overwrite,
            progress=progress,
        )
    if arguments.json:
        print_json("simulate", _summary(result), [arguments.out])
    else:
        _print(result, arguments.out)


def _summary(result: SimulatedRun) -> dict[str, Any]:
    """The content of simulation.yaml, and notes."""
    return {
        **result.settings,
        "topic": result.log.topic,
        "messages": len(result.log),
        "condition_number": result.condition_number,
        "notes": result.notes,
    }


def _print(result: SimulatedRun, out: Path) -> None:
    from inverse_dynamics.verbs.screen import Screen

    console = Screen()
    settings, log = result.settings, result.log
    excitation = f", condition number of the base regressor {result.condition_number:.4g}"
    for note in result.notes:
        console.print(f"note        {note}")
    console.print(f"trajectory  {result.trajectory.duration:g} s{excitation}")
    console.print(
        f"recording   {out}, {log.topic}: {counted(len(log), 'message')} of "
        f"{counted(len(log.joint_names), 'joint')}, "
        f"{settings['duration']:g} s at {settings['message_rate'] or settings['rate']:g} Hz"
    )


def _payload(text: str) -> Payload:
    from inverse_dynamics.simulation.model import Payload

    numbers = _numbers(text, (1, 4))
    x, y, z = numbers[1:] or [0.0, 0.0, 0.0]
    return Payload(numbers[0], (x, y, z))


def _resolution(text: str) -> Resolution | str:
    if text == "default":
        return text
    from inverse_dynamics.simulation.sensors import Resolution

    return Resolution(*_numbers(text, (3,)))


def _numbers(text: str, counts: tuple[int, ...]) -> list[float]:
    try:
        numbers = [decimal(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in counts or not all(math.isfinite(entry) for entry in numbers):
        expected = " or ".join(map(str, counts))
        raise argparse.ArgumentTypeError(
            f"expected {expected} numbers, separated by commas, got '{text}'"
        )
    return numbers
