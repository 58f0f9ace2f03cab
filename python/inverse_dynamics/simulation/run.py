# SPDX-License-Identifier: Apache-2.0
"""From a run configuration to a simulated recording: what `ids simulate` does, for scripts.

    run = simulate("ur10_simulated", rate=500, seed=1)
    run.save("bag")
    evaluate(run.log, "ur10_simulated")

configuration.py reads the settings that a run configuration has for it. Files are a bag like any other, with the truth
beside its messages; rosbag2 and its tools read only what metadata.yaml names:

    BAG/metadata.yaml, BAG/BAG.db3 or BAG/BAG.mcap      what rosbag2 would have recorded
    BAG/simulation.yaml                                 how it was made
    BAG/trajectory.yaml                                 the desired motion, for --trajectory
    BAG/truth.npz                                       one row per message: the motion without any sensor's error
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from dataclasses import dataclass, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from inverse_dynamics._core import Solver
from inverse_dynamics.arguments import checked
from inverse_dynamics.errors import SolverError
from inverse_dynamics.evaluation.posture import LOCKED
from inverse_dynamics.installation.extras import lazily_imported
from inverse_dynamics.outputs.files import Contents, move_up, write_text, written_whole
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import write_joint_logs
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.dh_tables import guess_of
from inverse_dynamics.robots.robots import Robot, robot_of
from inverse_dynamics.simulation.collision import ContactChecker
from inverse_dynamics.simulation.configuration import StatedSimulation
from inverse_dynamics.simulation.controller import default_gains
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.limits import MotionLimits, check_trajectory
from inverse_dynamics.simulation.model import payloads_of
from inverse_dynamics.simulation.modelled import (
    ModelFriction,
    PlantOptions,
    carried_by,
    description_of,
    simulated_robot,
)
from inverse_dynamics.simulation.physics import (
    Motion,
    check_followed,
    check_rate,
    follow,
)
from inverse_dynamics.simulation.sensors import EffortNoise, Recorded, Sensors
from inverse_dynamics.simulation.trajectory import (
    FourierTrajectory,
    read_trajectory,
    trajectory_text,
)
from inverse_dynamics.wording import listed, told

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import mujoco
    from typing_extensions import Unpack

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage
    from inverse_dynamics.simulation.model import Friction, Payload, SimulatedRobot
    from inverse_dynamics.simulation.trajectory import Trajectory
    from inverse_dynamics.simulation.urdf import UrdfChain
else:
    mujoco = lazily_imported("mujoco", "a simulation")
yaml = lazily_imported("yaml", "a simulation")

MARK = "simulation.yaml"
"""The file by which a directory is known as a simulated recording."""

CONTENTS = Contents(
    MARK,
    (MARK, "metadata.yaml", "{name}.db3*", "{name}.mcap", "trajectory.yaml", "truth.npz"),
)


@dataclass(frozen=True, repr=False)
class SimulatedRun:
    """A simulated recording, the truth behind it, and how it was made."""

    log: JointLog  # the recording
    motion: Motion  # every sample as it was
    recorded: Recorded  # which samples became messages
    trajectory: Trajectory
    trajectory_source: str
    condition_number: float  # of the base regressor
    settings: dict[str, Any]  # everything needed to make it again, ready for YAML
    notes: tuple[str, ...]  # what was left out or assumed, in words

    def differences_from(self, solver: Solver) -> Floats:
        """(n,) N m: greatest `|tau - effort|` at the simulator's own accelerations, joint friction aside.

        solver: of rigid bodies, of the robot that was simulated.
        """
        motion = self.motion
        computed = solver.torques(motion.q, motion.qd, motion.qdd)
        return np.asarray(np.abs(computed - (motion.effort - motion.friction)).max(axis=0))

    def save(
        self,
        out: Path | str,
        *,
        storage: Storage = "sqlite3",
        overwrite: bool = False,
        progress: Progress = no_progress,
    ) -> None:
        """Writes the recording to the directory `out`, whole or not at all.

        overwrite: replace an older simulated recording. Raises OutputError, BagError.
        """
        out = Path(out)
        with written_whole(out, overwrite=overwrite, contents=CONTENTS) as directory:
            bag = directory / out.name  # its files are named after the directory they will be in
            write_joint_logs(bag, {self.log.topic: self.log}, storage=storage, progress=progress)
            move_up(bag)
            settings = {**self.settings, "storage": storage}
            write_text(directory / MARK, yaml.safe_dump(settings, sort_keys=False))
            trajectory = trajectory_text(self.trajectory, self.trajectory_source)
            write_text(directory / "trajectory.yaml", trajectory)
            names = ("time", "q", "qd", "qdd", "effort", "friction", "q_desired")
            truth = {name: getattr(self.motion, name)[self.recorded.rows] for name in names}
            np.savez(
                directory / "truth.npz", joint_names=np.array(self.settings["joints"]), **truth
            )

    def __repr__(self) -> str:
        notes = "".join(f"\nnote: {note}" for note in self.notes[:8])
        return f"<SimulatedRun of {self.settings['robot']}: {self.log!r}>{notes}"


write_run = SimulatedRun.save


class SimulationOptions(PlantOptions, total=False):
    """What is simulated, and how it is recorded.

    rate: of controller and recording, 125, 500 or 1000 Hz. duration: s; None: once through the trajectory. A periodic
    one repeats until then. seed: of the search, of the sensors' random numbers, and of where in its period the run
    configuration's trajectory begins if it is a periodic one; 0: at its beginning. table: whether the plane z = 0 of
    the root link must not be touched.
    """

    rate: int | None
    duration: float | None
    seed: int
    sensors: Sensors | None
    table: bool


@checked
def simulate(
    robot: Robot | Solver | Path | str,
    *,
    trajectory: Path | str | Trajectory | None = None,
    optimise: bool = False,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = no_progress,
    **options: Unpack[SimulationOptions],
) -> SimulatedRun:
    """Simulate a robot under a joint trajectory controller, and record its joint states.

    Parameters
    ----------
    robot
        As evaluate() takes it.
    trajectory
        A file or an object; by default the run configuration's. Without one, or with `optimise`, a new exciting
        trajectory is searched for, which takes about a minute.
    say
        Called with a sentence before each slow step.
    **options
        Of the plant and of the recording, see SimulationOptions.

    Raises
    ------
    UserError
        SimulationError, TrajectoryError, RobotError.

    Examples
    --------
    >>> from inverse_dynamics import evaluate, simulate
    >>> run = simulate("ur10_simulated", duration=2.0, table=False)
    >>> evaluate(run.log, "ur10_simulated").mean_rmse < 0.1  # N m
    True
    """
    plant = cast(
        "PlantOptions", {k: v for k, v in options.items() if k in PlantOptions.__annotations__}
    )
    if isinstance(robot, Solver) and plant.get("payload") is None:
        with suppress(SolverError):  # of one that can't carry any
            plant["payload"] = carried_by(robot)
    robot = robot_of(robot)
    description = description_of(robot)
    simulated = simulated_robot(robot, description, **plant)
    seed, table = options.get("seed", 0), options.get("table", True)
    chain = simulated.chain
    stated = StatedSimulation.of(robot, chain.joint_names)
    rate = stated.rate if (given := options.get("rate")) is None else given
    check_rate(rate)
    sensors = options.get("sensors") or Sensors()
    sensors.check(len(chain.joint_names), rate)
    if optimise and trajectory is not None:
        raise SimulationError(
            "expected either a trajectory or a search for one (optimise), got both"
        )
    if trajectory is not None:
        chosen, source = _given_trajectory(trajectory, chain)
    elif optimise or stated.trajectory is None:
        why = "" if optimise else "the run configuration names no trajectory: "
        say(
            f"{why}searching for an exciting one, which takes about a minute; --trajectory names one"
        )
        chosen, source = _searched(simulated, seed, progress, table=table)
    else:
        chosen, source = _begun_by_seed(*_given_trajectory(stated.trajectory, chain), seed)
    checker = ContactChecker(simulated, table=table)
    check_trajectory(simulated, chosen, MotionLimits.of(simulated), checker)
    notes = [*filter(None, [guess_of(robot.urdf)]), *chain.notes, *checker.notes, *_unused(robot)]
    if seed and trajectory is not None and not sensors.are_random:
        notes.append("the seed has no effect: the trajectory is given, and nothing is random")
    duration = options.get("duration") or chosen.duration
    gains = stated.with_gains(default_gains(simulated, chosen, rate))
    motion = follow(simulated, chosen, rate=rate, duration=duration, gains=gains, progress=progress)
    check_followed(motion, simulated)
    recorded = sensors.record(motion, seed)
    links = robot.model if options.get("from_model") else robot.urdf
    settings = {
        "robot": robot.name,
        "joints": list(chain.joint_names),
        "root": chain.root,
        "tip": ",".join(chain.tips),
        "gravity": _plain(simulated.gravity),
        "rate": rate,
        "duration": float(duration),
        "seed": seed,
        "trajectory": source,
        "payload": _payloads(plant.get("payload"), chain),
        "links": links.name if links else None,
        "joint_friction": _friction_settings(robot, simulated.friction),
        **_plain(sensors),
        "gains": _plain(gains),
        "mujoco": mujoco.__version__,
        "robot_description_sha256": hashlib.sha256(description.encode()).hexdigest(),
    }
    from inverse_dynamics.excitation.excitation import condition_of  # which imports this feature

    return SimulatedRun(
        log=_joint_log(robot, chain, recorded),
        motion=motion,
        recorded=recorded,
        trajectory=chosen,
        trajectory_source=source,
        condition_number=condition_of(simulated, chosen, duration),
        settings=settings,
        notes=tuple(map(told, notes)),
    )


def _given_trajectory(given: Path | str | Trajectory, chain: UrdfChain) -> tuple[Trajectory, str]:
    """The trajectory, and in words where it comes from."""
    if isinstance(given, Path | str):
        return read_trajectory(Path(given), chain.joint_names)
    return given, "Given by the caller."


def _searched(
    robot: SimulatedRobot, seed: int, progress: Progress, *, table: bool
) -> tuple[Trajectory, str]:
    """A new exciting trajectory, and where it comes from."""
    from inverse_dynamics.excitation.excitation import ExcitationOptions, optimise_excitation

    found = optimise_excitation(robot, ExcitationOptions(table=table), seed=seed, progress=progress)
    return found.trajectory, (
        f"Exciting trajectory for {robot.chain.name}, optimised with seed {seed}: condition number of "
        f"the base regressor {found.condition_number:.4g}."
    )


def _begun_by_seed(trajectory: Trajectory, source: str, seed: int) -> tuple[Trajectory, str]:
    """A periodic one begins at a random time of its period; with seed 0 at its beginning."""
    if not seed or not isinstance(trajectory, FourierTrajectory):
        return trajectory, source
    begin = round(np.random.default_rng(seed).uniform(0.0, trajectory.period), 3)
    return trajectory.later(begin), f"{source} Begun {begin:g} s later, by seed {seed}."


def _unused(robot: Robot) -> list[str]:
    """Notes on settings of the run configuration that the simulation doesn't use."""
    notes = []
    if unused := [name for name in robot.parameters if not name.startswith(LOCKED)]:
        notes.append(f"parameters of the solver aren't used by the simulation: {listed(unused)}")
    if robot.effort not in ("torque", "auto"):
        notes.append(
            f"efforts are recorded as torques, though the run configuration says {robot.effort}: "
            "evaluate them with --effort-is torque"
        )
    return notes


def _joint_log(robot: Robot, chain: UrdfChain, recorded: Recorded) -> JointLog:
    """Messages under the names that the run configuration gives the joints in recordings."""
    names = robot.joints or chain.joint_names
    if len(names) != len(chain.joint_names):
        raise SimulationError(
            f"{robot.file}: joints: expected {len(chain.joint_names)} names, one per joint of the chain "
            f"({', '.join(chain.joint_names)}), got {len(names)}"
        )
    return JointLog(
        joint_names=names,
        header_stamps=recorded.stamps,
        receive_stamps=recorded.stamps,
        q=recorded.q,
        qd=recorded.qd,
        effort=recorded.effort,
        topic=robot.topic,
    )


def _friction_settings(robot: Robot, friction: Friction | None) -> Any:
    if isinstance(friction, ModelFriction):
        return {"model": robot.plugin if robot.model is None else robot.model.name}
    return _plain(friction)


def _payloads(given: Payload | Sequence[Payload] | None, chain: UrdfChain) -> Any:
    """What YAML can hold: one, or a list of several."""
    bodies = [_plain(replace(body, tip=body.tip or chain.tips[0])) for body in payloads_of(given)]
    return bodies if len(bodies) > 1 else next(iter(bodies), None)


def _plain(thing: object) -> Any:
    """What YAML can hold."""
    if isinstance(thing, EffortNoise):
        return thing.source
    if is_dataclass(thing):
        return {name: _plain(value) for name, value in vars(thing).items()}
    return [float(x) for x in thing] if isinstance(thing, np.ndarray | tuple) else thing
