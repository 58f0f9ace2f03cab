# SPDX-License-Identifier: Apache-2.0
"""`ids simulate`: a recording of a simulated robot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.decimals import decimal
from inverse_dynamics.recordings.joint_log import STORAGES
from inverse_dynamics.terminal.options import Options, stated
from inverse_dynamics.terminal.values import number, numbers, positive_number, whole_number
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.simulation import Payload, Resolution, SimulatedRun
    from inverse_dynamics.terminal.screen import Line

PLACE = ("plan", 1)
SUMMARY = "record a simulated robot on an exciting trajectory"
DESCRIPTION = (
    "Simulate a robot (MuJoCo) under a joint trajectory controller that commands efforts, "
    "while it follows an exciting trajectory, and record its joint states to a bag."
)
EPILOG = """\
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

  ids simulate --robot ur10_simulated --out recording --trajectory other.yaml \\
      --payload 5,0,0,0.1 --mount ceiling
      a motion of your own, with 5 kg 0.1 m in front of the tip; base mounted upside down

results, written whole or not at all:
  metadata.yaml, .db3 or .mcap   recording of sensor_msgs/JointState, as rosbag2 writes it
  simulation.yaml                all settings of the simulation
  trajectory.yaml                the desired motion
  truth.npz                      per message, without sensor errors: time, q, qd, effort, qdd, friction
"""

# Options that are arguments of Sensors, and those of simulate().
_SENSORS = "noise quantisation drop repeat jitter start_stamp effort_delay message_rate"
_SIMULATION = "trajectory optimise rate duration seed payload joint_friction from_model table"


def declare(options: Options) -> None:
    """Arguments and options."""
    options.robot(required=True)
    options.output("BAG", "the new recording", required=True)
    options.shared("--json")
    options.add("--storage", "storage of the recording (default: sqlite3)", choices=STORAGES)
    options.add(
        "--seed SEED",
        "seed of all random numbers, and of where in its period the run configuration's motion "
        "begins: the same seed gives the same recording, another one another (default: 0, from the "
        "beginning)",
        whole_number,
    )
    _declare_motion(options.group("motion"))
    _declare_robot(options.group("robot"))
    _declare_recording(options.group("recording"))


def _declare_motion(motion: Options) -> None:
    motion.add(
        "--trajectory FILE",
        "desired motion (YAML: waypoints or Fourier series; default: the run configuration's)",
        Path,
    )
    motion.add("--optimise", "search for a new exciting trajectory instead, as `ids excite` does")
    motion.add(
        "--duration S",
        "length of the motion (default: once through the trajectory; exciting ones repeat)",
        positive_number,
    )
    motion.add(
        "--rate HZ",
        "rate of controller and recording: 125, 500 or 1000 (default: the run configuration's)",
        whole_number,
    )
    motion.add(
        "--no-table", "allow the arm to reach below its base", dest="table", action="store_false"
    )


def _declare_robot(robot: Options) -> None:
    robot.add(
        "--payload KG[,X,Y,Z][,TIP]",
        "point mass at the tip [kg; m]; of a tree at the first, unless TIP names another one; may be "
        "given several times",
        _payload,
        action="append",
    )
    robot.add(
        "--joint-friction PART|urdf|model",
        "Coulomb friction as a share of each effort limit, and as much viscous friction at the "
        "velocity limit (without a value: 0.02); urdf: what the description's <dynamics> says; "
        "model: that of the run configuration's solver",
        nargs="?",
        const="0.02",
    )
    robot.add(
        "--from-model",
        "links, rotor inertias and friction of the run configuration's model, as `ids identify` "
        "writes it, instead of the description's links without friction",
    )
    gravity = robot.one_of()
    gravity.shared("--gravity")
    gravity.add(
        "--mount",
        "floor; wall: the x axis up; ceiling: upside down",
        choices=("floor", "wall", "ceiling"),
    )


def _declare_recording(recording: Options) -> None:
    recording.add(
        "--noise Q,QD,EFFORT",
        "standard deviations of Gaussian noise [rad, rad/s, N m] (without a value: 1e-5,1e-3,0.1)",
        _resolution,
        nargs="?",
        const="1e-5,1e-3,0.1",
    )
    recording.add(
        "--effort-noise DIR",
        "a result of `ids evaluate` of a real robot: stretches of 2 s of its measured minus "
        "computed torques, in random order, are the noise of the efforts",
        Path,
    )
    recording.add(
        "--effort-delay S", "delay of recorded efforts behind positions and velocities [s]", number
    )
    recording.add(
        "--message-rate HZ",
        "messages per second (default: one per period of the controller)",
        positive_number,
    )
    recording.add(
        "--quantisation Q,QD,EFFORT",
        "steps of the values [rad, rad/s, N m] (without a value: 1e-5,1e-3,0.01)",
        _resolution,
        nargs="?",
        const="1e-5,1e-3,0.01",
    )
    recording.add("--drop P", "share of messages that are lost", number)
    recording.add(
        "--repeat P", "share of messages that repeat the values of the previous one", number
    )
    recording.add("--jitter S", "standard deviation of the time stamps [s]", number)
    recording.add("--start-stamp S", "time stamp of the start [s] (default: 1700000000)", number)


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.outputs.files import check_output_directory
    from inverse_dynamics.robots.robots import load_robot
    from inverse_dynamics.simulation.run import CONTENTS
    from inverse_dynamics.terminal.screen import announce, progress_bar, show

    robot = load_robot(arguments.robot)
    inputs = (arguments.trajectory, arguments.effort_noise, *robot.files)
    check_output_directory(
        arguments.out, overwrite=arguments.overwrite, contents=CONTENTS, inputs=inputs
    )

    from inverse_dynamics.simulation import MOUNTS, EffortNoise, simulate, write_run
    from inverse_dynamics.simulation.sensors import Sensors

    noise = arguments.effort_noise and EffortNoise.of_result(arguments.effort_noise)
    sensors = Sensors(effort_noise=noise, **stated(arguments, *_SENSORS.split()))
    with progress_bar() as progress:
        result = simulate(
            robot,
            **stated(arguments, *_SIMULATION.split()),
            sensors=sensors,
            gravity=MOUNTS[arguments.mount] if arguments.mount else arguments.gravity,
            say=announce,
            progress=progress,
        )
        write_run(
            result,
            arguments.out,
            overwrite=arguments.overwrite,
            progress=progress,
            **stated(arguments, "storage"),
        )
    show(arguments, _summary(result), [arguments.out], _lines(result, arguments.out))


def _summary(result: SimulatedRun) -> dict[str, Any]:
    """The content of simulation.yaml, and notes."""
    return {
        **result.settings,
        "topic": result.log.topic,
        "messages": len(result.log),
        "condition_number": result.condition_number,
        "notes": result.notes,
    }


def _lines(result: SimulatedRun, out: Path) -> list[Line]:
    settings, log = result.settings, result.log
    excitation = f"condition number of the base regressor {result.condition_number:.4g}"
    whole, seconds = result.trajectory.duration, settings["duration"]
    played = f"{whole:g}" if seconds >= whole else f"{seconds:g} of {whole:g}"
    size = f"{counted(len(log), 'message')} of {counted(len(log.joint_names), 'joint')}"
    rate = settings["message_rate"] or settings["rate"]
    return [
        ("note", result.notes),
        ("trajectory", f"{played} s, {excitation}"),
        ("recording", f"{out}, {log.topic}: {size}, {settings['duration']:g} s at {rate:g} Hz"),
    ]


def _payload(text: str) -> Payload:
    from inverse_dynamics.simulation.model import Payload

    stated, _, tip = text.rpartition(",")
    try:
        decimal(tip)
    except ValueError:
        pass
    else:
        stated, tip = text, ""
    mass, *center = numbers(stated or text, "1 or 4 numbers, separated by commas", 1, 4)
    x, y, z = center or (0.0, 0.0, 0.0)
    return Payload(mass, (x, y, z), tip=tip)


def _resolution(text: str) -> Resolution:
    from inverse_dynamics.simulation.sensors import Resolution

    return Resolution(*numbers(text, "3 numbers, separated by commas", 3))
