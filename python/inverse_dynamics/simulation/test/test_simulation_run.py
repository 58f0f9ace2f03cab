# SPDX-License-Identifier: Apache-2.0
"""From a run configuration to files: content, form, reproducibility, mistakes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from simulation_arms import CHAINS, pendulum, robots_package, two_links, write_robot

from inverse_dynamics.errors import OutputError, RobotError, UserError
from inverse_dynamics.recordings.bags import read_joint_log
from inverse_dynamics.robots.robots import Robot, load_robot
from inverse_dynamics.simulation import (
    Payload,
    Resolution,
    Sensors,
    SimulationError,
    TrajectoryError,
    simulate,
    write_run,
)
from inverse_dynamics.simulation.trajectory import WaypointTrajectory

SWING = WaypointTrajectory.through(("swing",), np.array([0.0, 1.0]), np.array([[0.0], [-0.5]]))
SWING_FILE = """\
schema: 1
kind: waypoints
source: up and down
joints: [swing]
times: [0, 0.5, 1]
positions: [[0], [-0.3], [0]]
"""


def robot(directory: Path, simulation: str = "", extra: str = "", urdf: str = "") -> Robot:
    return load_robot(write_robot(directory, urdf or pendulum(), extra + simulation))


def stored(name: str) -> Robot:
    """One of the project's, without anything installed."""
    package = robots_package()
    return Robot(
        name=f"{name}_simulated",
        description="",
        file=package / f"robots/{name}_simulated.yaml",
        plugin="some/Solver",
        urdf=package / f"urdf/{name}.urdf",
        root=CHAINS[name][0],
        tip=CHAINS[name][1],
    )


def test_recording_reads_back_as_simulated(tmp_path: Path) -> None:
    arm = robot(tmp_path, extra="topic: /arm/joint_states\njoints: [motor]\n")
    sensors = Sensors(noise=Resolution(1e-3, 1e-3, 0.1), drop=0.1)
    run = simulate(arm, trajectory=SWING, rate=500, sensors=sensors, seed=3)
    for storage in ("sqlite3", "mcap"):
        out = tmp_path / storage
        write_run(run, out, storage=storage)
        log = read_joint_log(out, ["motor"], topic="/arm/joint_states")
        assert log.storage == storage
        for field in ("q", "qd", "effort", "header_stamps", "receive_stamps"):
            np.testing.assert_array_equal(getattr(log, field), getattr(run.log, field))
        assert len(log) == len(run.recorded.rows) < 500


def test_truth_has_a_row_per_message_and_fits_the_equation_of_motion(tmp_path: Path) -> None:
    sensors = Sensors(noise=Resolution(1e-3, 1e-3, 0.1), drop=0.2)
    run = simulate(robot(tmp_path), trajectory=SWING, rate=500, sensors=sensors, joint_friction=0.1)
    write_run(run, tmp_path / "bag")
    truth = np.load(tmp_path / "bag/truth.npz")
    log = read_joint_log(tmp_path / "bag")
    assert list(truth["joint_names"]) == ["swing"]
    assert len(truth["q"]) == len(log)
    assert 0 < np.abs(truth["q"] - log.q).max() < 6e-3
    np.testing.assert_allclose(truth["time"] - truth["time"][0], log.time, atol=1e-9)
    q, qd, qdd = truth["q"][:, 0], truth["qd"][:, 0], truth["qdd"][:, 0]
    needed = (0.02 + 2 * 0.25) * qdd - 2 * 9.81 * 0.5 * np.cos(q)
    friction = 10.0 * np.tanh(qd / 0.02) + 5.0 * qd
    np.testing.assert_allclose(truth["friction"][:, 0], friction, atol=1e-9)
    np.testing.assert_allclose(truth["effort"][:, 0], needed + friction, atol=1e-9)
    assert np.abs(truth["q_desired"] - truth["q"]).max() < 0.05


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_same_seed_same_bytes(tmp_path: Path, storage: str) -> None:
    arm = robot(tmp_path)
    sensors = Sensors(noise=Resolution(1e-3, 1e-3, 0.1), jitter=1e-4)
    for name, seed in (("first", 7), ("again", 7), ("other", 8)):
        run = simulate(arm, trajectory=SWING, rate=125, seed=seed, sensors=sensors)
        write_run(run, tmp_path / name / "bag", storage=storage)
    files = sorted(file.name for file in (tmp_path / "first/bag").iterdir())
    for file in files:
        content = [(tmp_path / name / "bag" / file).read_bytes() for name in ("first", "again")]
        assert content[0] == content[1], file
    data = "bag.mcap" if storage == "mcap" else "bag.db3"
    assert (tmp_path / "other/bag" / data).read_bytes() != (
        tmp_path / "first/bag" / data
    ).read_bytes()


def test_stored_trajectory_makes_the_same_recording_again(tmp_path: Path) -> None:
    arm = robot(tmp_path)
    write_run(simulate(arm, trajectory=SWING, rate=125), tmp_path / "one")
    file = tmp_path / "one/trajectory.yaml"
    again = simulate(arm, trajectory=file, rate=125)
    np.testing.assert_array_equal(again.log.effort, read_joint_log(tmp_path / "one").effort)
    assert again.trajectory_source == "Given by the caller."


def test_nothing_is_overwritten_unless_asked_and_only_simulations(tmp_path: Path) -> None:
    run = simulate(robot(tmp_path), trajectory=SWING, rate=125)
    out = tmp_path / "bag"
    write_run(run, out)
    before = (out / "metadata.yaml").read_bytes()
    with pytest.raises(OutputError, match="exists already"):
        write_run(run, out)
    assert (out / "metadata.yaml").read_bytes() == before
    write_run(simulate(robot(tmp_path), trajectory=SWING, rate=500), out, overwrite=True)
    assert len(read_joint_log(out)) == 500
    (out / "simulation.yaml").unlink()
    with pytest.raises(OutputError, match=r"won't be overwritten: it holds no simulation.yaml"):
        write_run(run, out, overwrite=True)


def test_settings_of_the_run_configuration_are_used_and_said(tmp_path: Path) -> None:
    (tmp_path / "swing.yaml").write_text(SWING_FILE)
    simulation = (
        "simulation:\n  trajectory: swing.yaml\n  rate: 125\n  gains:\n    swing: {p: 77, i: 0}\n"
    )
    run = simulate(robot(tmp_path, simulation, "gravity: [0, 0, -3.7]\n"))
    assert len(run.log) == 125
    assert run.trajectory_source == "up and down"
    assert run.settings["rate"] == 125
    assert run.settings["gravity"] == [0, 0, -3.7]
    assert run.settings["gains"]["p"] == [77]
    assert run.settings["gains"]["i"] == [0]
    assert run.settings["gains"]["d"][0] > 1
    assert run.motion.gains.p == [77]
    assert run.log.effort[0, 0] == pytest.approx(-2 * 3.7 * 0.5, rel=0.1)
    other = simulate(robot(tmp_path, simulation), rate=500, gravity=(0, 0, -1.0), duration=0.25)
    assert len(other.log) == 125
    assert other.log.effort[0, 0] == pytest.approx(-2 * 1.0 * 0.5, rel=0.1)


def test_friction_by_part_by_the_description_and_by_figures(tmp_path: Path) -> None:
    urdf = pendulum(inner='<dynamics damping="0.25" friction="1.5"/>')
    arm = robot(tmp_path, urdf=urdf)

    def friction(given: object) -> dict[str, list[float]]:
        run = simulate(arm, trajectory=SWING, rate=125, duration=0.1, joint_friction=given)
        return run.settings["joint_friction"]

    assert friction(None) is None
    assert friction("urdf") == {"coulomb": [1.5], "viscous": [0.25], "slip": 0.02}
    assert friction(0.05) == {"coulomb": [5.0], "viscous": [2.5], "slip": 0.02}
    assert friction("0.05") == friction(0.05)


def test_description_without_shapes_is_said(tmp_path: Path) -> None:
    notes = simulate(robot(tmp_path), trajectory=SWING, rate=125).notes
    assert notes == ("the description has no collision shapes: self-collision can't be checked",)


@pytest.mark.parametrize(
    ("simulation", "text"),
    [
        (
            "simulation: {rate: 200}",
            "simulation.rate: expected one of 125, 500, 1000 Hz, got '200'",
        ),
        ("simulation: {trajectory: none.yaml}", "simulation.trajectory: expected a file"),
        ("simulation: {speed: 1}", "simulation.speed: unknown key"),
        ("simulation: {gains: {elbow: {p: 1}}}", "simulation.gains.elbow: unknown key"),
        ("simulation: {gains: {swing: {k: 1}}}", "simulation.gains.swing.k: unknown key"),
        ("simulation: {gains: {swing: {p: x}}}", "gains.swing.p: expected a number, got 'x'"),
        ("joints: [a, b]", "joints: expected 1 names, one per joint of the chain (swing), got 2"),
    ],
)
def test_mistakes_in_the_run_configuration_are_pointed_at(
    tmp_path: Path, simulation: str, text: str
) -> None:
    with pytest.raises(UserError) as error:
        simulate(robot(tmp_path, simulation + "\n"), trajectory=SWING)
    assert text in str(error.value)
    assert "arm.yaml" in str(error.value)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"rate": 0}, "rate: expected one of 125, 500, 1000 Hz, got 0"),
        (
            {"optimise": True},
            "expected either a trajectory or a search for one (optimise), got both",
        ),
        ({"joint_friction": "some"}, "joint friction: expected a part of the effort limit"),
        ({"duration": 0.001}, "duration: expected at least two periods"),
        ({"duration": 1e300}, "duration: expected at most 80000 s at 125 Hz, got 1e+300 s"),
        (
            {"payload": Payload(20.0, (0.5, 0, 0))},
            "trajectory: joint swing: effort at 0.00 s: expected -100 to",
        ),
    ],
)
def test_impossible_wishes_are_refused(
    tmp_path: Path, options: dict[str, object], text: str
) -> None:
    with pytest.raises((SimulationError, TrajectoryError)) as error:
        simulate(robot(tmp_path, urdf=pendulum()), **{"trajectory": SWING, "rate": 125, **options})
    if "payload" in options:
        assert "got -" in str(error.value)
    assert text in str(error.value)


def test_friction_by_part_needs_limits(tmp_path: Path) -> None:
    arm = robot(
        tmp_path, urdf=pendulum(limit='<limit lower="-1" upper="1" velocity="0" effort="90"/>')
    )
    with pytest.raises(SimulationError, match="joint swing: joint friction needs a velocity limit"):
        simulate(arm, trajectory=SWING, rate=125, joint_friction=0.1)


def test_robot_without_description_cannot_be_simulated(tmp_path: Path) -> None:
    arm = replace(robot(tmp_path), urdf=None)
    with pytest.raises(SimulationError, match=r"arm.yaml: names no urdf; a simulation needs"):
        simulate(arm)
    with pytest.raises(RobotError, match=r"gone.urdf: no such file"):
        simulate(replace(arm, urdf=tmp_path / "gone.urdf"))


@pytest.mark.parametrize("name", CHAINS)
def test_stored_configuration_names_its_trajectory(name: str) -> None:
    package = robots_package()
    config = yaml.safe_load((package / f"robots/{name}_simulated.yaml").read_text())["simulation"]
    file = config["trajectory"].removeprefix("package://inverse_dynamics_robots/")
    run = simulate(stored(name), trajectory=package / file, rate=config["rate"])
    assert f"base regressor {run.condition_number:.4g}." in run.trajectory_source


def test_another_seed_begins_the_motion_elsewhere():
    runs = {seed: simulate(stored("ur10"), rate=125, duration=1.0, seed=seed) for seed in (0, 1, 2)}
    again = simulate(stored("ur10"), rate=125, duration=1.0, seed=1)
    np.testing.assert_array_equal(again.log.q, runs[1].log.q)
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert np.abs(runs[one].log.q - runs[other].log.q).max() > 0.1
    # the same motion, some time later
    begin = float(runs[1].trajectory_source.split("Begun ")[1].split()[0])
    q, qd, _ = runs[0].trajectory.at(begin + np.linspace(0.0, 30.0, 7))
    later = runs[1].trajectory.at(np.linspace(0.0, 30.0, 7))
    np.testing.assert_allclose(later[0], q, atol=1e-12)
    np.testing.assert_allclose(later[1], qd, atol=1e-12)


def test_a_seed_without_effect_is_said(tmp_path):
    arm = robot(tmp_path)
    unused = "the seed has no effect: the trajectory is given, and nothing is random"
    assert unused in simulate(arm, trajectory=SWING, rate=500, seed=1).notes
    assert unused not in simulate(arm, trajectory=SWING, rate=500).notes
    noisy = Sensors(noise=Resolution(1e-5, 1e-3, 0.1))
    assert unused not in simulate(arm, trajectory=SWING, rate=500, seed=1, sensors=noisy).notes


def test_a_load_above_the_axis_of_a_light_joint_is_held():
    """Gravity topples it: its stiffness was half of what that takes, and it turned by 3.7 rad."""
    load = Payload(5.0, (0.02, -0.03, 0.1))
    run = simulate(stored("ur10"), rate=125, duration=10.0, payload=load)
    assert np.abs(run.motion.q - run.motion.q_desired).max() < 0.01


def test_a_motion_that_is_not_followed_is_refused(tmp_path):
    weak = "simulation:\n  gains:\n    swing: {p: 0.1, i: 0, d: 0.01, ff_velocity_scale: -5}\n"
    arm = robot(tmp_path, weak)
    with pytest.raises(SimulationError) as error:
        simulate(arm, trajectory=SWING, rate=500)
    assert "joint swing doesn't follow the trajectory: expected at most 0.2 rad" in str(error.value)
    assert "give a higher rate=" in str(error.value)


def test_a_massless_link_is_named(tmp_path):
    urdf = two_links().replace('<mass value="0.1"/>', '<mass value="0"/>', 1)
    urdf = re.sub(r'(<link name="elbow">)<inertial>.*?</inertial>', r"\1", urdf)
    with pytest.raises(
        SimulationError, match="can't move a body without mass, as elbow; give each"
    ):
        simulate(robot(tmp_path, urdf=urdf), trajectory=None, rate=500)
