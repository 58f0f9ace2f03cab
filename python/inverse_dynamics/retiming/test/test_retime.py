# SPDX-License-Identifier: Apache-2.0
import json
import os
import re
from xml.etree import ElementTree

import numpy as np
import pytest
import two_arms
from example_recordings import trajectory, write_trajectories
from example_robots import JOINTS
from pages import browser, child, complaints, time_of, wait_until
from scipy.interpolate import CubicSpline

from inverse_dynamics import (
    JointPath,
    MotionLimits,
    RetimeOptions,
    Solver,
    cli,
    load_robot,
    retime,
    trajectory_torques,
)
from inverse_dynamics._core import retime_path, sample_times
from inverse_dynamics.errors import UserError
from inverse_dynamics.retiming.files import message_of
from inverse_dynamics.retiming.page import retime_page, spans
from inverse_dynamics.retiming.retiming import described_limits, torque_limit
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.motion_energy import MotionEnergy
from inverse_dynamics.robots.robots import robot_of_description, with_changes

WAYPOINTS = np.array(
    [
        [0.0, -1.0, 1.0, 0.0, 0.0, 0.0],
        [0.5, -1.5, 1.5, 0.5, 0.3, 0.0],
        [1.5, -1.2, 0.8, 0.2, 1.3, 0.4],
        [2.0, -0.5, 0.5, 0.0, 1.0, 1.0],
    ]
)
LIMITS = {
    "ur10_simulated": [330.0, 330.0, 150.0, 56.0, 56.0, 56.0],
    "panda_simulated": [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0],
}
PATHS = 200 if "IDS_NIGHTLY_TESTS" in os.environ else 4  # of each robot, against other planners
SHORTER = 5e-3


@pytest.fixture(scope="module")
def fastest():
    return retime(WAYPOINTS, "ur10_real")


def write_waypoints(directory, suffix):
    path = directory / f"way{suffix}"
    if suffix == ".csv":
        columns = ",".join(f"position.{joint}" for joint in JOINTS)
        np.savetxt(path, WAYPOINTS, delimiter=",", header=columns, comments="")
        return path
    rows = ", ".join(f"[{', '.join(map(str, row))}]" for row in WAYPOINTS)
    path.write_text(
        f"schema: 1\nkind: waypoints\njoints: [{', '.join(JOINTS)}]\ntimes: [0, 1, 2, 3]\n"
        f"positions: [{rows}]\n"
    )
    return path


def test_motion_visits_the_waypoints_at_rest_at_both_ends(fastest):
    assert fastest.qd[[0, -1]] == pytest.approx(0.0)
    for waypoint in WAYPOINTS:
        assert np.abs(fastest.q - waypoint).max(axis=1).min() < 0.01  # between samples
    q, qd, _ = fastest.timed.states(fastest.time)
    assert np.abs(np.gradient(q, fastest.time, axis=0) - qd)[1:-1].max() < 0.1
    assert (np.abs(fastest.use) <= 1.005).all()
    assert (np.abs(fastest.qd) <= 1.005 * fastest.limits.velocity).all()
    assert fastest.seconds_saved > 0.0


def test_masses_that_are_guesses_are_told(tmp_path):
    table = tmp_path / "dh.yaml"
    table.write_text(
        "convention: modified\njoints: [{a: 0, alpha: 0, d: 1}, {a: 1, alpha: 0, d: 0}]\n"
    )
    robot = robot_of_description(table)
    limits = MotionLimits(torque=[100.0], velocity=[1.0])
    motion = retime([[0.0, 0.0], [1.0, -1.0]], robot, limits=limits)
    assert "the mass of link1, link2 (2 kg each is a guess)" in motion.notes[0]
    states = np.column_stack([motion.time, motion.q, motion.qd])
    names = "time,position.joint1,position.joint2,velocity.joint1,velocity.joint2"
    np.savetxt(tmp_path / "way.csv", states, delimiter=",", header=names, comments="")
    assert motion.notes[0] in trajectory_torques(tmp_path / "way.csv", robot).notes


def test_efforts_are_those_of_the_solver(fastest):
    solver = load_robot("ur10_real").solver()
    np.testing.assert_array_equal(
        fastest.efforts, solver.torques(fastest.q, fastest.qd, fastest.qdd)
    )


@pytest.mark.parametrize("suffix", [".yaml", ".csv"])
def test_files_of_waypoints_give_the_same_motion(tmp_path, fastest, suffix):
    found = retime(write_waypoints(tmp_path, suffix), "ur10_real")
    assert found.duration == pytest.approx(fastest.duration, abs=1e-12)


def test_columns_of_a_path_may_be_called_like_joints(tmp_path, fastest):
    path = tmp_path / "way.csv"
    np.savetxt(path, WAYPOINTS, delimiter=",", header=",".join(JOINTS), comments="")
    assert retime(path, "ur10_real").duration == pytest.approx(fastest.duration, abs=1e-12)


def test_energy_of_a_lifted_and_lowered_load_counts_the_lift_alone():
    time = np.linspace(0.0, 2.0, 2001)
    qd = np.sin(np.pi * time)[:, None]
    efforts = np.full((2001, 1), 10.0)

    class Frictionless:
        def friction_vector(self, qd, q):
            return 0.0 * qd

    energy = MotionEnergy.of(Frictionless(), time, np.zeros_like(qd), qd, efforts)
    assert energy.driven == pytest.approx(10.0 * 2.0 / np.pi, rel=1e-5)
    assert energy.peak_power == pytest.approx(10.0)
    assert energy.friction == 0.0


def test_weight_trades_time_for_energy(fastest):
    """Sums come within 1 % of the best of 30 shares of velocity, and of the fastest motion slowed as a whole."""
    solver = load_robot("ur10_real").solver()
    torque = fastest.limits.torque

    def energy_of(time, q, qd, qdd):
        return MotionEnergy.of(solver, time, q, qd, solver.torques(q, qd, qdd)).driven

    capped, slowed = [], []
    for share in np.linspace(0.1, 1.0, 30):
        velocity = share * np.abs(fastest.qd).max(axis=0)
        limits = MotionLimits(torque=torque, velocity=velocity)
        timed = retime_path(solver, JointPath.spline(WAYPOINTS), limits)
        time = sample_times(timed.duration, 250.0)
        capped.append((timed.duration, energy_of(time, *timed.states(time))))
        state = fastest.q, share * fastest.qd, share**2 * fastest.qdd
        slowed.append((fastest.duration / share, energy_of(fastest.time / share, *state)))

    motions = [retime(WAYPOINTS, "ur10_real", weight=weight) for weight in (1e-4, 0.01, 0.1)]
    assert motions[0].duration == pytest.approx(fastest.duration, rel=1e-3)
    assert motions[1].duration > 1.1 * fastest.duration
    assert motions[1].energy.driven < 0.92 * fastest.energy.driven
    for weight, motion in zip((1e-4, 0.01, 0.1), motions, strict=True):
        assert (np.abs(motion.use) <= 1.005).all()
        found = motion.duration + weight * motion.energy.driven
        for others in (capped, slowed):
            assert found < 1.01 * min(duration + weight * joules for duration, joules in others)


def test_friction_that_helps_to_brake_is_used(fastest):
    without = retime(WAYPOINTS, load_robot("ur10_simulated"), fastest.limits)
    assert without.energy.friction == 0.0
    assert fastest.energy.friction > 0.5 * fastest.energy.driven


def toppra_duration(robot, waypoints, knots, velocity, torque):
    toppra = pytest.importorskip("toppra")
    limits = [
        toppra.constraint.JointVelocityConstraint(np.c_[-velocity, velocity]),
        toppra.constraint.JointTorqueConstraint(
            robot.solver().torques, np.c_[-torque, torque], np.zeros_like(torque)
        ),
    ]
    path = toppra.SplineInterpolator(knots, waypoints, bc_type="natural")
    grid = np.linspace(0.0, knots[-1], 1001)
    return toppra.algorithm.TOPPRA(limits, path, gridpoints=grid).compute_trajectory(0, 0).duration


def drake_duration(robot, waypoints, knots, velocity, torque):
    drake = pytest.importorskip("pydrake.all")
    plant = drake.MultibodyPlant(0.0)
    drake.Parser(plant).AddModels(str(robot.urdf))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(robot.root))
    plant.Finalize()
    spline = CubicSpline(knots, waypoints, bc_type="natural")
    path = drake.PiecewisePolynomial.CubicHermite(knots, waypoints.T, spline(knots, 1).T)
    timing = drake.Toppra(path, plant, np.linspace(0.0, knots[-1], 1001))
    timing.AddJointVelocityLimit(-velocity, velocity)
    timing.AddJointTorqueLimit(-torque, torque)
    return timing.SolvePathParameterization().end_time()


@pytest.mark.parametrize("planner", [toppra_duration, drake_duration])
@pytest.mark.parametrize("name", LIMITS)
def test_as_fast_as_other_planners(name, planner):
    torque = np.array(LIMITS[name])
    velocity = np.full(len(torque), 10.0)
    robot, random = load_robot(name), np.random.default_rng(1)
    for k in range(PATHS):
        waypoints = random.uniform(-1.5, 1.5, (5, len(torque)))[:: 1 if k % 2 else -1]
        path = JointPath.spline(waypoints)
        limits = MotionLimits(torque=torque, velocity=velocity)
        ours = retime_path(robot.solver(), path, limits).duration
        theirs = planner(robot, waypoints, path.knots, velocity, torque)
        assert ours == pytest.approx(theirs, rel=SHORTER)


def test_every_path_is_timed_on_which_the_robot_can_stand():
    """Among them one with a point without inertia for joint 2, beside a point of the grid."""
    solver = load_robot("panda_real").solver()
    velocity = [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]
    limits = MotionLimits(torque=LIMITS["panda_simulated"], velocity=velocity)
    for waypoints in np.random.default_rng(1).uniform(-1.0, 1.0, (1010, 5, 7)):
        assert retime_path(solver, JointPath.spline(waypoints), limits).duration < 10.0


@pytest.mark.parametrize(
    ("arm", "velocity"), [("panda", [2.2] * 4 + [2.6] * 3), ("ur10", [2.0] * 2 + [3.1] * 4)]
)
def test_limits_hold_between_points_of_the_grid(arm, velocity):
    """Where a joint turns back in a corner, its speed changes fast, and friction steps within an interval."""
    solver = load_robot(f"{arm}_real").solver()
    torque, random = LIMITS[f"{arm}_simulated"], np.random.default_rng(7)
    for k in range(100):
        waypoints = random.uniform(-1.2, 1.2, (random.integers(2, 6), len(torque)))
        path = JointPath.spline(waypoints) if k % 2 else JointPath.lines(waypoints, 0.05)
        grid = RetimeOptions(points=100 if k % 4 < 2 else 1000)
        limits = MotionLimits(
            torque=torque, velocity=velocity, tip_speed=0.25 if k % 10 < 3 else 10.0
        )
        timed = retime_path(solver, path, limits, grid)
        between = timed.time[:-1, None] + np.outer(np.diff(timed.time), np.arange(0.05, 1.0, 0.1))
        q, qd, qdd = timed.states(between.ravel())
        assert (np.abs(qd) / velocity).max() < 1.0 + SHORTER
        tip = [
            np.linalg.norm(solver.jacobian(a)[:3] @ v) for a, v in zip(q[::7], qd[::7], strict=True)
        ]
        assert max(tip) < limits.tip_speed * (1.0 + SHORTER)
        assert (np.abs(solver.torques(q, qd, qdd)) / torque).max() < 1.0 + SHORTER


@pytest.mark.parametrize(
    ("arm", "velocity"), [("panda", [2.2] * 4 + [2.6] * 3), ("ur10", [2.0] * 2 + [3.1] * 4)]
)
def test_limits_hold_on_paths_of_many_waypoints_with_friction(arm, velocity):
    solver, random = load_robot(f"{arm}_real").solver(), np.random.default_rng(11)
    limits = MotionLimits(torque=LIMITS[f"{arm}_simulated"], velocity=velocity)
    for k in range(PATHS):
        waypoints = random.uniform(-1.2, 1.2, (50, len(velocity)))
        path = JointPath.spline(waypoints) if k % 2 else JointPath.lines(waypoints, 0.05)
        timed = retime_path(solver, path, limits)
        between = timed.time[:-1, None] + np.outer(np.diff(timed.time), np.arange(0.025, 1.0, 0.05))
        q, qd, qdd = timed.states(between.ravel())
        assert (np.abs(qd) / velocity).max() < 1.002
        assert (np.abs(solver.torques(q, qd, qdd)) / limits.torque).max() < 1.002


def test_torque_that_falls_with_speed_is_the_limit_kept_and_shown():
    """Also where the motors' greatest speed leaves them no torque to hold the arm."""
    random, torque = np.random.default_rng(3), np.array(LIMITS["ur10_simulated"])
    solver = load_robot("ur10_real").solver()
    for k in range(20):
        waypoints = random.uniform(-1.2, 1.2, (random.integers(2, 6), 6))
        knee = random.uniform(0.05, 1.0)
        limits = MotionLimits(
            torque=torque,
            knee_velocity=np.full(6, knee),
            no_load_velocity=np.full(6, knee + random.uniform(0.2, 2.0)),
        )
        path = JointPath.spline(waypoints) if k % 2 else JointPath.lines(waypoints, 0.05)
        timed = retime_path(solver, path, limits)
        q, qd, qdd = timed.states(sample_times(timed.duration, 1000.0))
        over = np.abs(solver.torques(q, qd, qdd)) - torque_limit(limits, qd)
        assert (over < SHORTER * torque).all()

    shown = retime(path, "ur10_real", limits)
    assert shown.torque_limit.min() < 0.8 * torque.min()
    assert 0.99 < np.abs(shown.use).max() < 1.01
    other = shown.by_acceleration
    states = other.states(sample_times(other.duration, 100.0))
    assert (np.abs(solver.torques(*states)) < 1.02 * torque_limit(limits, states[1])).all()


def test_command_line_takes_speeds_at_the_ends_and_curves_of_motors(tmp_path):
    waypoints, out = write_waypoints(tmp_path, ".csv"), tmp_path / "out"
    given = [
        "--deviation",
        "0.05",
        "--start-speed",
        "0.2",
        "--end-speed",
        "0.1",
        "--figures",
        "none",
    ]
    given += ["--knee-velocity", "0.5", "--no-load-velocity", "2"]
    assert (
        cli.main(["retime", str(waypoints), "--robot", "ur10_real", "--out", str(out), *given]) == 0
    )
    table = np.genfromtxt(out / "trajectory.csv", delimiter=",", names=True)
    velocity = np.stack([table[f"velocity{joint}"] for joint in JOINTS])
    assert np.linalg.norm(velocity[:, [0, -1]], axis=0) == pytest.approx([0.2, 0.1], rel=1e-2)
    assert 0.5 < np.abs(velocity).max() < 2.0


def test_a_joint_without_a_velocity_limit_leaves_the_others_theirs(tmp_path):
    urdf = tmp_path / "arm.urdf"
    text = load_robot("ur10_simulated").urdf.read_text()
    element = ElementTree.fromstring(text)
    stated = {
        j.get("name"): float(j.find("limit").get("velocity"))
        for j in element.findall("joint[limit]")
    }
    element.find("joint[@name='wrist_3_joint']/limit").set("velocity", "0")
    urdf.write_text(ElementTree.tostring(element, encoding="unicode"))
    robot = with_changes(load_robot("ur10_simulated"), urdf=urdf)
    limits = described_limits(Arm(robot))
    assert limits.velocity[:5].tolist() == [stated[joint] for joint in JOINTS[:5]]
    assert limits.velocity[5] > 1e3
    assert "velocity of wrist_3_joint isn't limited" in retime(WAYPOINTS, robot).notes[-1]


TURNER = """<robot name="turner"><link name="base"/><link name="arm"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit effort="10" velocity="3"/></joint></robot>"""


@pytest.fixture
def turner(tmp_path):
    urdf = tmp_path / "turner.urdf"
    urdf.write_text(TURNER)
    return urdf


SLIDE = """\
schema: 1
name: slide
source: none
validity: none
units: SI
geometry: placements
gravity: [0, 0, -9.81]
parameters: about_center_of_mass
joints:
  - name: x
    type: prismatic
    placement: {xyz: [0, 0, 1], rpy: [0, 0, 0], axis: [1, 0, 0]}
    limits: {lower: -2, upper: 2, velocity: 3, effort: 100}
    friction: {law: none}
    link: [3, 0, 0, 0, 0.1, 0, 0, 0.1, 0, 0.1]
"""


def test_times_are_those_that_a_joint_trajectory_controller_accepts(turner):
    """Rising strictly, also where a duration is a multiple of the period but for rounding."""
    for n in range(300, 406):
        moved = retime([[0.0], [1.0]], turner, duration=n / 250.0, compare=False)
        stamps = [point.time_from_start for point in message_of(moved).points]
        steps = np.diff([stamp.sec * 10**9 + stamp.nanosec for stamp in stamps])
        assert steps.min() >= 2_000_000
        assert steps.max() <= 6_000_001
        assert moved.time[-1] == moved.duration == pytest.approx(n / 250.0, rel=1e-14)


def test_positions_beyond_the_range_are_found_however_short_they_are(tmp_path):
    waypoints = np.random.default_rng(4).uniform(-1.0, 1.0, (120, 1))
    path = JointPath.spline(waypoints)
    coarse = path.states(np.linspace(*path.knots[[0, -1]], 1001))[0].max()
    fine = path.states(np.linspace(*path.knots[[0, -1]], 1_000_001))[0].max()
    assert coarse < fine - 5e-5
    urdf = tmp_path / "arm.urdf"
    revolute = TURNER.replace("continuous", "revolute")
    for upper, refused in ((fine - 5e-5, True), (fine + 1e-6, False)):
        urdf.write_text(revolute.replace("effort=", f'lower="-9" upper="{upper}" effort='))
        if refused:
            with pytest.raises(UserError, match="turn: expected positions from -9 to"):
                retime(waypoints, urdf, compare=False)
        else:
            assert retime(waypoints, urdf, compare=False).q.max() < upper


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"velocity": [1e-5]}, r"rate: expected at most 10 Hz for a motion of 1e\+05 s"),
        (
            {"velocity": [1e-3], "jerk": [0.1]},
            r"takes at least 1000 s: with limits of jerk or torque rate",
        ),
        ({"jerk": [1e-12]}, "torque rate, expected at most 600 s"),
        ({"acceleration": [1e-200]}, "limits can't be kept"),
    ],
)
def test_tiny_limits_end_in_a_message(turner, given, text):
    with pytest.raises(UserError, match=text):
        retime([[0.0], [1.0]], turner, MotionLimits(**given), compare=False)


def test_a_longer_duration_is_the_same_motion_slower(fastest):
    slow = retime(WAYPOINTS, "ur10_real", duration=2.5)
    assert slow.duration == pytest.approx(2.5, rel=1e-14)
    factor = 2.5 / fastest.duration
    np.testing.assert_allclose(slow.timed.speed * factor, fastest.timed.speed, rtol=1e-12)
    assert (np.abs(slow.use) <= 1.005).all()
    least = rf"duration: expected at least {fastest.duration:.3f}\d s, .*, got 1 s"
    with pytest.raises(UserError, match=least):
        retime(WAYPOINTS, "ur10_real", duration=1.0)
    with pytest.raises(UserError, match="duration: expected none for a motion that starts"):
        retime(WAYPOINTS, "ur10_real", duration=9.0, options=RetimeOptions(end_speed=0.1))


def test_a_place_that_is_passed_but_not_slowly_limits_the_duration(tmp_path):
    """A heavy arm swings up past the horizontal, where its torque doesn't hold it."""
    urdf = tmp_path / "arm.urdf"
    lifted = TURNER.replace('<mass value="1"/>', '<origin xyz="1 0 0"/><mass value="1"/>')
    urdf.write_text(
        lifted.replace('xyz="0 0 1"', 'xyz="0 -1 0"').replace('velocity="3"', 'velocity="99"')
    )
    swing = [[-1.5], [1.5]]
    torque = MotionLimits(torque=[9.0])
    free = retime(swing, urdf, torque, compare=False)
    assert np.abs(free.use).max() < 1.002
    with pytest.raises(UserError, match=r"joint turn needs \d+ % of its torque limit"):
        retime(swing, urdf, torque, compare=False, duration=20.0)


def test_without_a_comparison_the_motion_is_the_same(fastest, tmp_path):
    alone = retime(WAYPOINTS, "ur10_real", compare=False)
    np.testing.assert_array_equal(alone.q, fastest.q)
    assert alone.by_acceleration is None
    assert np.isnan(alone.seconds_saved)
    alone.save(tmp_path / "out")
    assert (
        json.loads((tmp_path / "out/retime.json").read_text())["duration_by_acceleration"] is None
    )
    assert "timed in two ways" not in (tmp_path / "out/report.html").read_text()


def test_a_description_that_changed_is_read_again(turner):
    first = retime([[0.0], [5.0]], turner, compare=False)
    turner.write_text(TURNER.replace('velocity="3"', 'velocity="2"'))
    assert first.limits.velocity == [3.0]
    assert retime([[0.0], [5.0]], turner, compare=False).limits.velocity == [2.0]


def test_torque_rates_are_kept_and_named():
    limits = MotionLimits(torque=LIMITS["panda_simulated"], torque_rate=[1000.0])
    path = [[0.0, -0.5, 0.2, -2.0, 0.1, 1.8, 0.6], [1.0, 0.3, -0.5, -1.1, -0.9, 2.6, -0.6]]
    slow = retime(path, "panda_real", limits, rate=1000.0, compare=False)
    assert (
        np.abs(np.diff(slow.efforts, axis=0)) <= 1.003 * np.diff(slow.time)[:, None] * 1e3
    ).all()
    assert "limits of torque rate" in retime_page(slow)
    with pytest.raises(UserError, match=r"limits.torque_rate.*at rest"):
        retime(path, "panda_real", limits, options=RetimeOptions(end_speed=0.1))


def test_joints_at_their_velocity_are_shown_over_time(turner):
    """5 rad with 10 rad/s^2 to 3 rad/s: 0.3 s of acceleration, 1.3667 s of it, 0.3 s of braking."""
    moved = retime([[0.0], [5.0]], turner)
    fast = np.flatnonzero(moved.limiting_velocity == 0)
    assert moved.time[fast[[0, -1]]] == pytest.approx([0.3, 1.6667], abs=8e-3)
    assert (moved.limiting[fast[2:-2]] == -1).all()
    page = retime_page(moved)
    rows = page.split('<div class="strip">')[1:]
    assert [row.count("<rect") for row in rows] == [3, 2]
    starts = [float(row.split('<rect x="')[1].partition('"')[0]) for row in rows]
    assert starts == pytest.approx([0.0, 0.3 / moved.duration], abs=8e-3)
    strip = moved.plot().axes[1]
    assert strip.get_xlim() == moved.plot().axes[2].get_xlim()


def write_column(directory, positions):
    path = directory / "turns.csv"
    np.savetxt(path, positions, header="position.turn", comments="")
    return path


def test_continuous_joints_turn_as_far_as_waypoints_say(turner, tmp_path):
    for end in (3.3, 6.5, -9.0):
        assert retime([[0.0], [end]], turner).q[-1, 0] == pytest.approx(end)
        assert retime(write_column(tmp_path, [0.0, end]), turner).q[-1, 0] == pytest.approx(end)


def test_a_recorded_path_goes_on_over_the_seam_of_a_turn(turner, tmp_path):
    q = np.linspace(3.0, 3.6, 7)
    recorded = retime(write_column(tmp_path, (q + np.pi) % (2 * np.pi) - np.pi), turner)
    assert recorded.q[-1, 0] == pytest.approx(3.6)
    assert recorded.notes == ("turn goes on over the seam of its turn in 1 place",)


@pytest.mark.parametrize("given", [{}, {"velocity": [1.0]}, {"jerk": [9.0]}, {"torque": [5.0]}])
def test_limits_that_are_not_given_are_those_of_the_description(turner, given):
    limits = retime([[0.0], [9.0]], turner, MotionLimits(**given)).limits
    assert limits.torque == given.get("torque", [10.0])
    assert limits.velocity == given.get("velocity", [3.0])


def test_limits_of_urdf_1_2_are_kept_unless_others_are_given(turner, tmp_path):
    path, limits = [[0.0], [9.0]], 'acceleration="4" deceleration="3" jerk="20" effort'
    urdf = turner.read_text().replace("effort", limits)
    (tmp_path / "old.urdf").write_text(urdf)
    old = retime(path, tmp_path / "old.urdf")
    assert not len(old.limits.acceleration)
    assert any("<limit> acceleration is ignored: URDF knows it from 1.2 on" in n for n in old.notes)

    newer = tmp_path / "newer.urdf"
    newer.write_text(urdf.replace("<robot", '<robot version="1.2"', 1))
    result = retime(path, newer, rate=1000.0)
    assert result.notes == ()
    assert (result.limits.acceleration, result.limits.jerk) == ([3.0], [20.0])
    assert np.abs(result.qdd).max() <= 3.0 * (1 + 1e-3)
    assert np.abs(np.diff(result.qdd[:-1], axis=0)).max() / 1e-3 <= 20.0 * (1 + 1e-2)
    assert np.abs(old.qdd).max() > 4.0
    given = retime(path, newer, MotionLimits(acceleration=[5.0], jerk=[1e4]))
    assert np.abs(given.qdd).max() == pytest.approx(5.0, rel=2e-2)
    at_speed = retime(path, newer, options=RetimeOptions(start_speed=1.0))
    assert at_speed.notes[0].startswith("jerk isn't limited")


def test_limits_and_units_of_a_model_without_a_description_are_its_own(tmp_path):
    model = tmp_path / "slide.yaml"
    model.write_text(SLIDE)
    robot = tmp_path / "robot.yaml"
    robot.write_text(
        "schema: 1\nname: slide\ndescription: a slide\n"
        "plugin: rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody\nmodel: slide.yaml\n"
    )
    moved = retime([[0.0], [2.0]], robot)
    assert moved.units == ("N",)
    assert (moved.limits.torque, moved.limits.velocity) == ([100.0], [3.0])
    assert np.abs(moved.qd).max() == pytest.approx(3.0)
    with pytest.raises(
        UserError, match=r"x: expected positions from -2 to 2, the limits in .*slide.yaml"
    ):
        retime([[0.0], [5.0]], robot)


def test_command_writes_a_trajectory_that_ids_torques_confirms(tmp_path, capsys):
    out = tmp_path / "fast"
    way = write_waypoints(tmp_path, ".csv")
    options = ["--robot", "ur10_simulated", "--out", str(out), "--payload", "5,0,0,0.05"]
    assert cli.main(["retime", str(way), "--deviation", "0.1", *options]) == 0
    assert "duration" in capsys.readouterr().out
    numbers = json.loads((out / "retime.json").read_text())
    assert {path.name for path in out.iterdir()} == {
        "fast.db3",
        "metadata.yaml",
        "report.html",
        "retime.json",
        "series.npz",
        "torques.png",
        "trajectory.csv",
    }
    robot = with_changes(
        load_robot("ur10_simulated"),
        parameters={"payload": {"mass": 5.0, "center_of_mass": [0, 0, 0.05]}},
    )
    checked = trajectory_torques(out, robot)
    assert checked.times[0][-1] == pytest.approx(numbers["duration"], abs=1e-8)
    assert checked.energy.numbers == pytest.approx(
        {name: numbers[name] for name in checked.energy.numbers}, rel=1e-6
    )
    assert np.abs(checked.torques[0]).max(axis=0) == pytest.approx(
        [abs(joint["peak"]) for joint in numbers["joints"]]
    )
    assert cli.main(["retime", str(way), *options]) == 0  # replaces its own earlier result


def test_spans_reach_half_way_to_their_neighbours():
    place = np.array([0.0, 1.0, 2.0, 4.0])
    assert spans(place, np.array([True, False, True, True])) == [(0.0, 0.5), (1.5, 4.0)]
    assert spans(place, np.zeros(4, dtype=bool)) == []


def test_page_races_both_motions(fastest, tmp_path):
    page = tmp_path / "report.html"
    page.write_text(retime_page(fastest))
    assert f"{fastest.seconds_saved:.3f} s" in page.read_text()
    with browser(tmp_path / "profile") as driver:
        driver.get(page.as_uri())
        ask = driver.execute_script
        pictures = (
            "return [...document.querySelectorAll('.robot canvas')].map((c) => c.toDataURL());"
        )
        section = child(driver, "#main")
        play, slider = child(section, ".play"), child(section, ".scrub")
        seek = "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'));"
        start = ask(pictures)
        assert start[0] == start[1]
        for t, same in ((0.5 * fastest.duration, False), (10.0, True)):
            ask(seek, slider, t)
            first, second = ask(pictures)
            assert first != start[0]
            assert (first == second) is same
        ask("arguments[0].value = '0.1'; arguments[1].click();", child(section, ".speed"), play)
        wait_until(lambda: 0.0 < time_of(section) < 1.0, "it plays from the start")
        ask("arguments[0].value = '1';", child(section, ".speed"))
        wait_until(lambda: play.text == "Play", "it ends")
        assert time_of(section) == pytest.approx(fastest.by_acceleration.duration, abs=1e-3)
        assert complaints(driver) == []


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--torque", "1,2"], "expected 1 number or 6, one per joint"),
        (["--torque", "20"], "shoulder_lift_joint lacks"),
        (["--jerk", "0"], "error: --jerk of shoulder_pan_joint: expected a finite number > 0"),
        (["--margin", "0.95"], "error: --margin: expected 0, or a model that states the deviation"),
        (["--stops", "9"], "expected 0 to 3, got 9"),
        (["--velocity", "1e-5"], "error: --sample-rate: expected at most"),
        (["--duration", "0.1"], "error: --duration: expected at least"),
        (["--sample-rate", "1e9"], "error: --sample-rate: expected at most"),
        (["--points", "1000000000"], "error: --points: expected 2 to 1000000"),
        (["--end-speed", "99"], "the end's speed is too high: expected ds/dt of at most"),
        (["--start-speed", "99"], "the start's speed is too high: expected ds/dt of at most"),
    ],
)
def test_refusals_say_what_to_do(tmp_path, capsys, arguments, text):
    way = write_waypoints(tmp_path, ".csv")
    command = ["retime", str(way), "--robot", "ur10_simulated", "--out", str(tmp_path / "o")]
    assert cli.main([*command, *arguments]) == 2
    assert text in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "o").exists()


def test_acceleration_is_compared_under_the_same_other_limits():
    """So nothing is saved where the tip's speed is what limits."""
    limits = MotionLimits(torque=LIMITS["ur10_simulated"], tip_speed=0.1)
    slow = retime(WAYPOINTS, "ur10_simulated", limits)
    assert abs(slow.seconds_saved) < 0.01 * slow.duration
    jerky = MotionLimits(torque=LIMITS["ur10_simulated"], jerk=np.full(6, 100.0))
    assert retime(WAYPOINTS, "ur10_simulated", jerky).seconds_saved > -0.01


def test_the_compared_acceleration_is_one_that_the_motion_has():
    """Where jerk limits it, torques would allow any acceleration."""
    limits = MotionLimits(torque=LIMITS["ur10_simulated"], jerk=np.full(6, 5.0))
    slow = retime(WAYPOINTS, "ur10_simulated", limits)
    assert slow.acceleration < 5.0
    assert slow.seconds_saved >= 0.0


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("wrist_3_joint", "wrist_9_joint", r"way.yaml: joints: expected .*, got .*wrist_9_joint"),
        ("schema: 1", "units: deg", "units: unknown key"),
        ("kind: waypoints", "kind: fourier", "kind: expected one of waypoints"),
        ("[0.5, -1.5", "[30, -90", "shoulder_pan_joint: expected positions from -6.28.*degrees"),
    ],
)
def test_files_of_other_robots_and_units_are_refused(tmp_path, old, new, text):
    way = write_waypoints(tmp_path, ".yaml")
    way.write_text(way.read_text().replace(old, new))
    with pytest.raises(UserError, match=text):
        retime(way, "ur10_simulated")


def test_several_trajectories_are_not_joined_to_one_path(turner, tmp_path):
    points = [(k, [float(k)], [], [], []) for k in range(2)]
    messages = [trajectory(["turn"], points)] * 2
    write_trajectories(tmp_path / "two", messages)
    with pytest.raises(
        UserError, match="expected one trajectory, .* got 2 messages with up to 2 points"
    ):
        retime(tmp_path / "two", turner)


def test_a_waypoint_that_lacks_a_number_is_refused(turner, tmp_path):
    with pytest.raises(UserError, match="got 1 of 3 rows without"):
        retime(write_column(tmp_path, [0.0, np.nan, 1.0]), turner)


def test_a_file_without_waypoints_is_named(tmp_path):
    way = write_waypoints(tmp_path, ".yaml")
    way.write_text(way.read_text().partition("positions")[0] + "positions: []\n")
    with pytest.raises(UserError, match=r"way.yaml: expected two waypoints at least, got 0"):
        retime(way, "ur10_simulated")


def test_times_of_a_path_must_increase_unless_all_are_zero(tmp_path, turner):
    way = write_waypoints(tmp_path, ".yaml")
    way.write_text(way.read_text().replace("[0, 1, 2, 3]", "[0, 1, 1, 3]"))
    with pytest.raises(UserError, match=r"got 1 s in waypoint 3 after 1 s"):
        retime(way, "ur10_simulated")
    table = tmp_path / "turns.csv"
    table.write_text("time,position.turn\n0,0\n2,1\n1,2\n")
    with pytest.raises(UserError, match=r"turns.csv: time: expected .* got 1 s in row 3 after 2 s"):
        retime(table, turner)
    for name, stamps in (("untimed", (0, 0, 0)), ("timed", (0, 10**9, 2 * 10**9))):
        points = [(t, [float(k)], [0.0], [], []) for k, t in enumerate(stamps)]
        write_trajectories(tmp_path / name, [trajectory(["turn"], points)])
        assert retime(tmp_path / name, turner).notes == ()
    points[2] = (5, *points[2][1:])
    write_trajectories(tmp_path / "back", [trajectory(["turn"], points)])
    with pytest.raises(UserError, match=r"got 5e-09 s in point 3 after 1 s"):
        retime(tmp_path / "back", turner)


def test_a_path_whose_velocities_are_of_another_unit_or_that_jumps_is_noted(tmp_path, turner):
    time = np.linspace(0, 2, 41)
    q, qd = np.sin(time), np.cos(time)
    path = tmp_path / "turns.csv"
    for positions, velocities, note in (
        (q, qd, None),
        (q, qd * 180 / np.pi, "velocities are in degrees, positions in rad"),
        (
            q + (time == time[20]),
            qd,
            r"the position of turn jumps by 1.03 from row 20 \(0.95 s\) to row 21",
        ),
    ):
        rows = np.column_stack([time, positions, velocities])
        np.savetxt(path, rows, "%.6f", header="time position.turn velocity.turn", comments="")
        notes = retime(path, turner).notes
        assert (re.search(note, notes[0]) and len(notes) == 1) if note else notes == ()
    (note,) = retime((q + (time == time[20]))[:, None], turner).notes
    assert note.startswith("the position of turn jumps by 1.03 from waypoint 20 to waypoint 21")


def test_wrong_paths_are_refused():
    with pytest.raises(UserError, match="weight: expected a finite number"):
        retime(WAYPOINTS, "ur10_simulated", weight=np.nan)
    with pytest.raises(UserError, match=r"waypoints \(m, 6\)"):
        retime(WAYPOINTS[:, :5], "ur10_simulated")
    with pytest.raises(UserError, match="two different waypoints"):
        retime(WAYPOINTS[:1], "ur10_simulated")


def test_the_speed_of_each_tip_is_limited(tmp_path):
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    still = np.zeros(len(tree.joint_names))
    for arm, tip in (("left", "left_tool"), ("right", "right_tool")):
        away = np.where([name.startswith(arm) for name in tree.joint_names], 0.8, 0.0)
        timed = retime(
            np.array([still, away]),
            tree,
            MotionLimits(acceleration=np.full(8, 50.0), tip_speed=0.2),
        )
        speed = np.linalg.norm(
            tree.jacobian(timed.q, frame=tip)[:, :3] @ timed.qd[..., None], axis=1
        )
        assert speed.max() == pytest.approx(0.2, rel=0.01)
