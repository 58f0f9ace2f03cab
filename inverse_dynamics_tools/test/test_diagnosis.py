# SPDX-License-Identifier: Apache-2.0
"""Why torques don't match: each mistake is named, and a robot without one isn't accused of any."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from simulation_arms import CHAINS, urdf_of

from inverse_dynamics import Solver, evaluate, read_joint_log, write_joint_logs
from inverse_dynamics.evaluation.diagnosis import (
    PAGE,
    ArmModel,
    Samples,
    diagnose,
    pieces_of,
    residual_cause,
)

RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
NOISE = 0.005  # of each joint's range
GAINS = np.array([13.5841, 14.2959, 11.3716, 11.2408, 11.7681, 11.7682, 11.0])


def solver_of(name: str) -> Solver:
    root, tip = CHAINS[name]
    return Solver(RIGID_BODY, urdf=urdf_of(name), root=root, tip=tip)


def motion_of(joints: int, duration: float = 20.0, rate: float = 200.0):
    """Three sines for each joint: time (N,) and q, qd, qdd (N, n)."""
    random = np.random.default_rng(4)
    time = np.arange(int(duration * rate)) / rate
    q, qd, qdd = (np.zeros((len(time), joints)) for _ in range(3))
    for j in range(joints):
        for k in range(1, 4):
            w = 2 * np.pi * 0.07 * k * random.uniform(0.9, 1.4)
            a, phase = random.uniform(0.3, 0.7), random.uniform(0, 6)
            q[:, j] += a * np.sin(w * time + phase)
            qd[:, j] += a * w * np.cos(w * time + phase)
            qdd[:, j] -= a * w**2 * np.sin(w * time + phase)
    return time, q + np.linspace(-1.0, 1.0, joints), qd, qdd


def model_of(name: str) -> ArmModel:
    solver = solver_of(name)

    def mounted(gravity):
        other = solver_of(name)
        other.set_gravity(gravity)
        return other.torques

    def loaded(mass, center):
        other = solver_of(name)
        other.set_payload("body", mass, center)
        return other.torques

    return ArmModel(solver.torques, solver.gravity_vector, solver.gravity, mounted, loaded)


def recorded(name: str, torques=None, friction: float = 0.04) -> Samples:
    """What a robot with friction and noise sends. torques: of another robot than the description's."""
    solver = solver_of(name)
    time, q, qd, qdd = motion_of(len(solver.joint_names))
    measured = (torques or solver.torques)(q, qd, qdd)
    span = np.ptp(measured, axis=0)
    random = np.random.default_rng(0)
    measured = measured + friction * span * (np.tanh(qd / 0.05) + 0.3 * qd)
    measured = measured + NOISE * span * random.standard_normal(q.shape)
    found = pieces_of(solver.joint_names, time, q, qd, qdd, measured)
    assert found is not None
    return found


def columns(samples: Samples, order: list[int]) -> Samples:
    return replace(
        samples,
        **{k: getattr(samples, k)[..., order] for k in ("q", "qd", "qdd", "measured")},
    )


def swapped(i: int, j: int, samples: Samples) -> Samples:
    order = list(range(len(samples.joints)))
    order[i], order[j] = j, i
    return columns(samples, order)


def swapped_efforts(i: int, j: int, samples: Samples) -> Samples:
    return replace(samples, measured=swapped(i, j, samples).measured)


def turned_effort(j: int, samples: Samples) -> Samples:
    sign = np.where(np.arange(len(samples.joints)) == j, -1.0, 1.0)
    return replace(samples, measured=sign * samples.measured)


def turned(j: int, samples: Samples) -> Samples:
    sign = np.where(np.arange(len(samples.joints)) == j, -1.0, 1.0)
    values = {k: sign * getattr(samples, k) for k in ("q", "qd", "qdd", "measured")}
    return replace(samples, **values)


def currents(samples: Samples) -> Samples:
    return replace(samples, measured=samples.measured / GAINS[: len(samples.joints)])


def in_degrees(samples: Samples) -> Samples:
    return replace(samples, **{k: np.degrees(getattr(samples, k)) for k in ("q", "qd", "qdd")})


def positions_in_degrees(samples: Samples) -> Samples:
    return replace(samples, q=np.degrees(samples.q))


def velocities_in_degrees(samples: Samples) -> Samples:
    return replace(samples, qd=np.degrees(samples.qd), qdd=np.degrees(samples.qdd))


def slow_clock(samples: Samples) -> Samples:
    return replace(samples, time=samples.time / 2, qdd=2 * samples.qdd)


def clipped(j: int, samples: Samples) -> Samples:
    measured = samples.measured.copy()
    low, high = np.quantile(measured[..., j], [0.1, 0.9])
    measured[..., j] = np.clip(measured[..., j], low, high)
    return replace(samples, measured=measured)


def coupled(j: int, k: int, samples: Samples) -> Samples:
    measured = samples.measured.copy()
    measured[..., j] += measured[..., k]
    return replace(samples, measured=measured)


def drifting(j: int, samples: Samples) -> Samples:
    measured = samples.measured.copy()
    span = np.ptp(measured[..., j])
    share = samples.time / samples.time.max()
    measured[..., j] += 0.3 * span * share * np.tanh(samples.qd[..., j] / 0.05)
    return replace(samples, measured=measured)


MISTAKES = [
    (currents, "currents", ()),
    (partial(turned_effort, 2), "effort_direction", (2,)),
    (partial(turned_effort, 1), "effort_direction", (1,)),
    (partial(turned, 1), "direction", (1,)),
    (partial(turned, 2), "direction", (2,)),
    (partial(swapped, 0, 2), "order", (0, 2)),
    (partial(swapped, 1, 2), "order", (1, 2)),
    (partial(swapped_efforts, 0, 2), "effort_order", (0, 2)),
    (partial(swapped_efforts, 3, 4), "effort_order", (3, 4)),
    (in_degrees, "degrees", ()),
    (positions_in_degrees, "degrees", ()),
    (velocities_in_degrees, "degrees", ()),
    (slow_clock, "clock", ()),
    (partial(clipped, 1), "saturation", (1,)),
    (partial(coupled, 4, 3), "coupling", (4, 3)),
    (partial(drifting, 2), "drift", (2,)),
]


def name_of(value: object) -> str:
    if isinstance(value, partial):
        return f"{value.func.__name__}{''.join(map(str, value.args))}"
    return getattr(value, "__name__", str(value))


@pytest.fixture(scope="module", params=["ur10", "panda"])
def arm(request):
    return request.param, recorded(request.param), model_of(request.param)


@pytest.fixture(scope="module")
def headings() -> list[str]:
    page = Path(__file__).resolve().parents[2] / PAGE
    return [line[3:] for line in page.read_text().splitlines() if line.startswith("## ")]


@pytest.mark.parametrize(("spoil", "kind", "joints"), MISTAKES, ids=name_of)
def test_a_mistake_is_named_and_is_a_heading_of_the_page(arm, headings, spoil, kind, joints):
    _, samples, model = arm
    found = diagnose(spoil(samples), model)
    assert found is not None
    assert found.kind == kind
    assert found.joints == tuple(samples.joints[j] for j in joints)
    assert found.mistake in ("", *headings)
    assert not found.mistake or found.reference in found.text
    assert kind != "drift" or found.reference == f"{PAGE}#friction"


def test_gravity_that_is_taken_off_is_found(arm):
    _, samples, model = arm
    gravity = model.gravity(samples.flat(samples.q)).reshape(samples.q.shape)
    spoiled = replace(samples, measured=samples.measured - gravity)
    found = diagnose(spoiled, model)
    assert found is not None
    assert found.kind == "no_gravity"
    right = replace(model, compared_without_gravity=True)
    assert getattr(diagnose(spoiled, right), "kind", "") in ("", "friction")


@pytest.mark.parametrize(
    ("gravity", "kind"),
    [((0, 0, 9.81), "ceiling"), ((-9.81, 0, 0), "wall"), ((0, 9.81, 0), "wall")],
)
def test_a_mount_is_found(arm, gravity, kind):
    name, _, model = arm
    found = diagnose(recorded(name, model.mounted(np.array(gravity, float))), model)
    assert found is not None
    assert found.kind == kind
    assert f"--gravity {','.join(f'{x:g}' for x in gravity)}" in found.text


@pytest.mark.parametrize(("center", "kind"), [((0, 0, 0.1), "payload"), ((0.12, 0, 0.08), "tool")])
def test_a_load_is_found(arm, center, kind):
    name, _, model = arm
    mass = 8.0 if name == "ur10" else 3.0
    found = diagnose(recorded(name, model.loaded(mass, np.array(center)), friction=0.01), model)
    assert found is not None
    assert found.kind == kind
    assert f"about {mass:g} kg" in found.reason or f"about {mass:.1f} kg" in found.reason


def test_a_model_without_friction_is_told_so(arm):
    name, _, model = arm
    assert diagnose(recorded(name, friction=0.3), model).kind == "friction"
    assert diagnose(recorded(name, friction=0.3), replace(model, has_friction=True)) is None


@pytest.mark.parametrize("friction", [0.0, 0.02, 0.04])
def test_torques_that_match_have_no_diagnosis(arm, friction):
    name, _, model = arm
    assert diagnose(recorded(name, friction=friction), model) is None


@pytest.mark.parametrize("scale", [0.7, 1.5])
def test_wrong_inertia_alone_is_no_mistake_of_the_page(arm, scale):
    """Masses that a maker has rounded, link by link, are neither a direction nor an order nor a mount."""
    name, _, model = arm
    solver = solver_of(name)
    factors = np.where(np.arange(len(solver.joint_names)) % 2, scale, 1.0)

    def other(q, qd, qdd):
        return factors * solver.torques(q, qd, qdd)

    found = diagnose(recorded(name, other), model)
    assert found is None or found.kind in ("payload", "tool", "friction")


def test_an_effort_that_is_not_measured_shows_no_coupling(arm):
    _, samples, model = arm
    states = (samples.flat(values) for values in (samples.q, samples.qd, samples.qdd))
    computed = model.torques(*states)
    for j in range(len(samples.joints)):
        measured = samples.measured.copy()
        measured[..., j] = 0.0
        found = residual_cause(replace(samples, measured=measured), computed)
        assert found is None or found.kind != "coupling"


@pytest.mark.parametrize("cycles", [0.5, 1.0])
def test_wrong_masses_in_a_slow_motion_are_no_drift(arm, cycles):
    """Gravity that the model gets wrong changes with time, as friction of a warming gear does."""
    name, _, model = arm
    joints = solver_of(name).joint_names
    time, w = np.arange(1000) / 50, 2 * np.pi * cycles / 20
    random = np.random.default_rng(1)
    for _ in range(20):
        phase, a = random.uniform(0, 6, len(joints)), random.uniform(0.3, 1.0, len(joints))
        q, qd, qdd = (
            a * size * wave(w * time[:, None] + phase)
            for size, wave in ((1.0, np.sin), (w, np.cos), (-(w**2), np.sin))
        )
        center = random.uniform(-0.2, 0.2, 3)
        samples = pieces_of(joints, time, q, qd, qdd, model.loaded(6.0, center)(q, qd, qdd))
        states = (samples.flat(values) for values in (samples.q, samples.qd, samples.qdd))
        found = residual_cause(samples, model.torques(*states))
        assert found is None or found.kind != "drift"


def test_few_samples_have_none():
    time, q, qd, qdd = motion_of(2, duration=0.02)
    assert pieces_of(("a", "b"), time, q, qd, qdd, q) is None


# ---- recordings of real robots ---------------------------------------------------------------------------------------


def notes_of(result) -> list[str]:
    return [note for note in result.notes if "likely cause" in note]


@pytest.mark.parametrize("robot", ["ur10_real", "panda_real"])
def test_given_robots_are_not_accused(recordings, robot):
    bag = recordings / f"{robot.partition('_')[0]}_exciting_trajectory"
    assert notes_of(evaluate(bag, robot)) == []


@pytest.mark.parametrize("robot", ["ur10_simulated", "panda_simulated"])
def test_a_description_of_a_real_robot_lacks_nothing_but_friction(recordings, robot):
    bag = recordings / f"{robot.partition('_')[0]}_exciting_trajectory"
    assert all("which the model lacks" in note for note in notes_of(evaluate(bag, robot)))


@pytest.mark.parametrize(
    ("robot", "joint"), [("ur10_real", 2), ("ur10_real", 1), ("panda_real", 3)]
)
def test_a_joint_of_a_real_recording_that_is_turned_is_found(recordings, robot, joint, tmp_path):
    log = read_joint_log(recordings / f"{robot.partition('_')[0]}_exciting_trajectory")
    name = evaluate_names(robot)[joint]
    effort = log.effort.copy()
    effort[:, log.joint_names.index(name)] *= -1
    write_joint_logs(tmp_path / "turned", {log.topic: replace(log, effort=effort)})
    (note,) = notes_of(evaluate(tmp_path / "turned", robot))
    assert f"joint {name}: torques match if its effort is reversed" in note
    assert f"{PAGE}#a-joint-is-reversed" in note


def evaluate_names(robot: str) -> tuple[str, ...]:
    from inverse_dynamics import load_robot

    return load_robot(robot).joints
