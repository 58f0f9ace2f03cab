# SPDX-License-Identifier: Apache-2.0
"""How far exported models of hidden arms run free in MuJoCo, beside what MuJoCo's own sysid fits to the same data.

A hidden arm is the identified UR10 with other links and another friction law. Both start from the description alone:
`ids identify` as it is, and sysid with masses, centers of mass, rotor inertias, damping and friction loss.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import astuple, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from known_truth import ENCODER, Truth
from mujoco import sysid
from studies import DOCS, identified, recording_of, show, table

from inverse_dynamics import identify, load_robot
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.urdf_export import mjcf_text
from inverse_dynamics.simulation import Sensors, simulate, write_run

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.robots.robots import Robot
    from inverse_dynamics.simulation import SimulatedRun
    from inverse_dynamics.simulation.trajectory import Trajectory

RATE = 500  # Hz
MOTION = DOCS.parent / "core" / "inverse_dynamics_robots" / "trajectories" / "ur10.yaml"
SECONDS = 20.0  # of the recording, and of the other one that errors are of
FREE = 0.5  # s that the model runs free from a true state
ITERATIONS = 16  # of sysid, the last of which lower its error by 0.5 to 5 % each
UNSTATED = {"damping": 5.0, "frictionloss": 5.0, "armature": 0.1}  # where sysid begins
MOST = {"damping": 60.0, "frictionloss": 60.0, "armature": 5.0}


@dataclass(frozen=True)
class Result:
    """Of one arm: errors in rad, mean over the joints; CPU time in s."""

    exported: float
    fitted: float
    exported_seconds: float
    fitted_seconds: float


def hidden_arm(found: Identification, seed: int, directory: Path) -> Robot:
    """The identified arm with other links and another friction."""
    random = np.random.default_rng(seed)
    friction = tuple(
        {
            key: 0.0 if key in ("fo", "shift") else value * random.uniform(0.6, 1.4)
            for key, value in law.items()
        }
        for law in found.model.friction
    )
    links = found.model.parameters * random.uniform(0.85, 1.2, (len(friction), 1))
    hidden = replace(found, model=replace(found.model, parameters=links, friction=friction))
    return load_robot(write_identification(hidden, directory / f"arm_{seed}.yaml").robot)


def recorded(arm: Robot, motion: Path | Trajectory) -> SimulatedRun:
    """As its encoders see the motion."""
    sensors = Sensors(noise=ENCODER, quantisation=ENCODER)
    return simulate(
        arm,
        trajectory=motion,
        from_model=True,
        rate=RATE,
        duration=SECONDS,
        sensors=sensors,
        table=False,
    )


def free_running_error(model: mujoco.MjModel, run: SimulatedRun) -> float:
    """RMS position error [rad] of stretches of FREE seconds, each from its true state with the true torques."""
    truth, data = run.motion, mujoco.MjData(model)
    model.opt.timestep = 0.5 / RATE
    errors = []
    for begin, end in _stretches(len(truth.time)):
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = truth.q[begin], truth.qd[begin]
        for row in range(begin, end):
            for torques in truth.effort[row : row + 2]:
                data.ctrl[:] = torques
                mujoco.mj_step(model, data)
            errors.append(data.qpos - truth.q[row + 1])
    return float(np.sqrt(np.square(errors).mean(axis=0)).mean())


def _stretches(samples: int) -> list[tuple[int, int]]:
    step = int(FREE * RATE)
    return [(begin, begin + step) for begin in range(0, samples - step, step)]


def _spec(text: str) -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_string(text)
    bits = mujoco.mjtDisableBit
    spec.option.disableflags |= int(bits.mjDSBL_LIMIT | bits.mjDSBL_CONTACT)
    return spec


def fitted_by_sysid(spec: mujoco.MjSpec, run: SimulatedRun) -> mujoco.MjModel:
    """Masses, centers, rotor inertias and friction, fitted to positions of free runs of FREE seconds."""
    names = [joint.name for joint in spec.joints]
    for name in names:
        kind = mujoco.mjtSensor.mjSENS_JOINTPOS
        spec.add_sensor(
            name=f"{name}_q", type=kind, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=name
        )
    spec.option.timestep = 1 / RATE
    parameters = sysid.ParameterDict()
    for name in names:
        for key, value in UNSTATED.items():
            parameters.add(_joint_parameter(name, key, value))
    model = spec.compile()
    for body in spec.bodies[1:]:
        kind = sysid.InertiaType.MassIpos
        parameters.add(sysid.body_inertia_param(spec, model, body.name, kind))
    residual = sysid.build_residual_fn(models_sequences=[_sequences(spec, run)], n_threads=1)
    best, _ = sysid.optimize(
        initial_params=parameters, residual_fn=residual, verbose=False, max_iters=ITERATIONS
    )
    sysid.apply_param_modifiers_spec(best, spec)
    return spec.compile()


def _joint_parameter(name: str, key: str, value: float) -> sysid.Parameter:
    def modify(spec: mujoco.MjSpec, parameter: sysid.Parameter) -> None:
        joint = spec.joint(name)
        number = parameter.value[0]
        setattr(joint, key, [number, 0, 0] if key == "damping" else number)

    return sysid.Parameter(f"{name}_{key}", value, 1e-5, MOST[key], modifier=modify)


def _sequences(spec: mujoco.MjSpec, run: SimulatedRun) -> sysid.ModelSequences:
    """Stretches of what was recorded: initial states, efforts between samples, positions."""
    model, log = spec.compile(), run.log
    names = [joint.name for joint in spec.joints]
    states, efforts, positions = [], [], []
    between = 0.5 * (log.effort[:-1] + log.effort[1:])
    stretches = _stretches(len(log.q))
    for begin, end in stretches:
        times, rows = np.arange(end - begin) / RATE, slice(begin, end)
        states.append(sysid.create_initial_state(model, log.q[begin], log.qd[begin]))
        efforts.append(sysid.TimeSeries.from_control_names(times, between[rows], model, names))
        positions.append(
            sysid.TimeSeries.from_names(times, log.q[rows], model, [f"{x}_q" for x in names])
        )
    labels = [f"from {begin}" for begin, _ in stretches]
    return sysid.ModelSequences("arm", spec, labels, states, efforts, positions)


def compared(arm: Robot, other_motion: Trajectory, directory: Path) -> Result:
    """Both fitted to one motion, and run free along the other."""
    run, test = recorded(arm, MOTION), recorded(arm, other_motion)
    bag = directory / f"{arm.name}_bag"
    write_run(run, bag)
    begin = time.process_time()
    found = identify([bag], "ur10_simulated")
    exported = _spec(mjcf_text(found)).compile()
    between = time.process_time()
    described = replace(found, model=replace(found.model, parameters=found.prior))
    fitted = fitted_by_sysid(_spec(mjcf_text(described)), run)
    end = time.process_time()
    return Result(
        exported=free_running_error(exported, test),
        fitted=free_running_error(fitted, test),
        exported_seconds=between - begin,
        fitted_seconds=end - between,
    )


def text_of(results: list[Result]) -> str:
    """Medians and ranges."""
    columns = np.array([astuple(result) for result in results]).T
    exported, fitted, exported_seconds, fitted_seconds = columns
    rows = [
        ("exported by `ids identify`", _range(1e3 * exported), _range(exported_seconds)),
        ("MuJoCo's sysid", _range(1e3 * fitted), _range(fitted_seconds)),
        ("ratio", _range(exported / fitted), _range(exported_seconds / fitted_seconds)),
    ]
    names = (f"{len(results)} arms: median (range)", "position error, mrad", "CPU time, s")
    return table(names, rows)


def _range(values: Floats) -> str:
    middle, low, high = (
        f"{float(f'{x:.2g}'):g}" for x in (np.median(values), min(values), max(values))
    )
    return f"{middle} ({low} to {high})"


if __name__ == "__main__":
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--arms", type=int, default=20)
    options.add_argument("--write", action="store_true", help="into the page")
    arms = options.parse_args().arms
    found = identified("ur10_real")
    results = []
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        other_motion = Truth.of(recording_of("ur10_real"), "ur10", folder, found).motion
        for seed in range(arms):
            results.append(compared(hidden_arm(found, seed, folder), other_motion, folder))
            print(seed, results[-1], file=sys.stderr, flush=True)
    show(text_of(results), "identification.md", "export_study")
