# SPDX-License-Identifier: Apache-2.0
"""Why torques don't match: each mistake is named, and a robot without one isn't accused of any."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import two_arms
from example_robots import RIGID_BODY
from simulation_arms import CHAINS, robots_package, urdf_of

from inverse_dynamics import (
    Solver,
    evaluate,
    load_robot,
    read_joint_log,
    write_joint_logs,
)
from inverse_dynamics.diagnosis.arm import arm_model
from inverse_dynamics.diagnosis.compare import (
    Cause,
    compare,
    meaning_of_efforts,
    residual_causes,
)
from inverse_dynamics.diagnosis.pieces import Pieces, pieces_of
from inverse_dynamics.diagnosis.rival import PAGE
from inverse_dynamics.payload.payload import PayloadError, _require_plausible
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import robot_of_description

NOISE = 0.005  # of each joint's range
GAINS = np.array([13.5841, 14.2959, 11.3716, 11.2408, 11.7681, 11.7682, 11.0])
GEARS = np.array([32.0, 32.0, 45.0, -48.0, 45.0, 32.0, 50.0])


@cache
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


def model_of(name: str, load: dict[str, object] | None = None, **options):
    """The arm by its description, as `ids evaluate` has it. load: parameters of a payload."""
    root, tip = CHAINS[name]
    file = robots_package() / "urdf" / f"{name}.urdf"
    robot = replace(robot_of_description(file), root=root, tip=tip, parameters=load or {})
    return arm_model(Arm(robot), **options)


def torques_of(name: str, gravity=None, load=None, description: str = ""):
    """Torques of an arm that is another one than the description's."""
    root, tip = CHAINS[name]
    solver = Solver(
        RIGID_BODY, urdf=description or urdf_of(name), root=root, tip=tip, gravity=gravity
    )
    if load is not None:
        solver.set_payload("load", load[0], load[1:])
    return solver.torques


def recorded(name: str, torques=None, friction: float = 0.04, speed: float = 1.0) -> Pieces:
    """What a robot with friction and noise sends. torques: of another robot than the description's."""
    solver = solver_of(name)
    time, q, qd, qdd = motion_of(len(solver.joint_names))
    time, qd, qdd = time / speed, qd * speed, qdd * speed**2
    measured = (torques or solver.torques)(q, qd, qdd)
    span = np.ptp(measured, axis=0)
    random = np.random.default_rng(0)
    measured = measured + friction * span * (np.tanh(qd / 0.05) + 0.3 * qd)
    measured = measured + NOISE * span * random.standard_normal(q.shape)
    found = pieces_of(solver.joint_names, time, (q, qd, qdd), measured)
    assert found is not None
    return found


def columns(samples: Pieces, order: list[int]) -> Pieces:
    return replace(
        samples,
        **{k: getattr(samples, k)[..., order] for k in ("q", "qd", "qdd", "measured")},
    )


def swapped(i: int, j: int, samples: Pieces) -> Pieces:
    order = list(range(len(samples.joints)))
    order[i], order[j] = j, i
    return columns(samples, order)


def swapped_efforts(i: int, j: int, samples: Pieces) -> Pieces:
    return replace(samples, measured=swapped(i, j, samples).measured)


def turned_effort(j: int, samples: Pieces) -> Pieces:
    sign = np.where(np.arange(len(samples.joints)) == j, -1.0, 1.0)
    return replace(samples, measured=sign * samples.measured)


def turned(j: int, samples: Pieces) -> Pieces:
    sign = np.where(np.arange(len(samples.joints)) == j, -1.0, 1.0)
    values = {k: sign * getattr(samples, k) for k in ("q", "qd", "qdd", "measured")}
    return replace(samples, **values)


def scaled(factors, samples: Pieces) -> Pieces:
    factors = np.broadcast_to(factors, 7 if np.ndim(factors) else 1)
    return replace(samples, measured=samples.measured * factors[: len(samples.joints)])


def per_mille(samples: Pieces) -> Pieces:
    limits = {6: "ur10", 7: "panda"}[len(samples.joints)]
    return replace(samples, measured=1000 * samples.measured / model_of(limits).effort_limits)


def rates(factor: float, samples: Pieces) -> Pieces:
    """Another time step, velocities of which were made from it."""
    s = samples
    return replace(s, time=s.time / factor, qd=factor * s.qd, qdd=factor**2 * s.qdd)


def velocities(factor: float, samples: Pieces) -> Pieces:
    return replace(samples, qd=factor * samples.qd, qdd=factor * samples.qdd)


def of_motors(samples: Pieces) -> Pieces:
    gears = GEARS[: len(samples.joints)]
    moved = {k: getattr(samples, k) * gears for k in ("q", "qd", "qdd")}
    return replace(samples, measured=samples.measured / gears, **moved)


def in_degrees(samples: Pieces) -> Pieces:
    return replace(samples, **{k: np.degrees(getattr(samples, k)) for k in ("q", "qd", "qdd")})


def positions_in_degrees(samples: Pieces) -> Pieces:
    return replace(samples, q=np.degrees(samples.q))


def velocities_in_degrees(samples: Pieces) -> Pieces:
    return replace(samples, qd=np.degrees(samples.qd), qdd=np.degrees(samples.qdd))


def slow_clock(factor: float, samples: Pieces) -> Pieces:
    return replace(samples, time=samples.time / factor, qdd=factor * samples.qdd)


def clipped(j: int, samples: Pieces) -> Pieces:
    measured = samples.measured.copy()
    limit = np.quantile(np.abs(measured[..., j]), 0.6)
    measured[..., j] = np.clip(measured[..., j], -limit, limit)
    return replace(samples, measured=measured)


def coupled(j: int, k: int, samples: Pieces) -> Pieces:
    measured = samples.measured.copy()
    measured[..., j] += measured[..., k]
    return replace(samples, measured=measured)


def drifting(j: int, samples: Pieces) -> Pieces:
    measured = samples.measured.copy()
    span = np.ptp(measured[..., j])
    share = samples.time / samples.time.max()
    measured[..., j] += 0.3 * span * share * np.tanh(samples.qd[..., j] / 0.05)
    return replace(samples, measured=measured)


def one_in_degrees(joint: int, samples: Pieces) -> Pieces:
    scale = np.where(np.arange(samples.q.shape[-1]) == joint, np.degrees(1), 1.0)
    q, qd, qdd = (scale * v for v in (samples.q, samples.qd, samples.qdd))
    return replace(samples, q=q, qd=qd, qdd=qdd)


def unrelated(samples: Pieces) -> Pieces:
    random = np.random.default_rng(4)
    walk = np.cumsum(np.cumsum(random.normal(size=samples.measured.shape), axis=1), axis=0)
    return replace(samples, measured=0.02 * np.ptp(samples.measured) * walk / np.abs(walk).max())


def off_zero(joint: int, angle: float, samples: Pieces) -> Pieces:
    q = samples.q.copy()
    q[..., joint] -= np.radians(angle)
    return replace(samples, q=q)


def off_zero_effort(joint: int, samples: Pieces) -> Pieces:
    measured = samples.measured.copy()
    measured[..., joint] += 0.4 * np.ptp(measured[..., joint])
    return replace(samples, measured=measured)


def shifted_efforts(by: int, samples: Pieces) -> Pieces:
    return replace(samples, measured=np.roll(samples.measured, by, axis=-1))


MISTAKES = [
    (partial(scaled, 1 / GAINS), "currents", ()),
    (partial(scaled, -1.0), "effort_sign", ()),
    (partial(scaled, 1000.0), "effort_scale", ()),
    (partial(scaled, 10.1972), "effort_scale", ()),
    (partial(scaled, 1000 / GAINS), "effort_scale", ()),
    (per_mille, "effort_scale", ()),
    (partial(scaled, [1, 1, 4, 1, 1, 1, 1]), "effort_scale", (2,)),
    (partial(scaled, [1, -1, -1, 1, 1, 1, 1]), "effort_direction", (1, 2)),
    (partial(turned_effort, 2), "effort_direction", (2,)),
    (partial(turned_effort, 1), "effort_direction", (1,)),
    (partial(turned, 1), "direction", (1,)),
    (partial(turned, 2), "direction", (2,)),
    (partial(swapped, 0, 2), "order", (0, 2)),
    (partial(swapped, 1, 2), "order", (1, 2)),
    (partial(swapped_efforts, 0, 2), "effort_order", (0, 2)),
    (partial(swapped_efforts, 1, 3), "effort_order", (1, 3)),
    (in_degrees, "degrees", ()),
    (positions_in_degrees, "degrees", ()),
    (velocities_in_degrees, "degrees", ()),
    (partial(slow_clock, 2.0), "clock", ()),
    (partial(slow_clock, 1e-3), "clock", ()),
    (partial(rates, 2.0), "clock", ()),
    (partial(velocities, 0.0), "velocity", ()),
    (partial(velocities, -1.0), "velocity", ()),
    (partial(velocities, 30 / np.pi), "velocity", ()),
    (of_motors, "motor_side", ()),
    (partial(clipped, 2), "saturation", (2,)),
    (partial(coupled, 2, 1), "coupling", (2, 1)),
    (partial(drifting, 2), "drift", (2,)),
    (partial(velocities, 2.0), "velocity", ()),
    (partial(one_in_degrees, 1), "degrees", ()),
    (unrelated, "unrelated", ()),
    (partial(off_zero, 1, 8.0), "zero", (1,)),
    (partial(off_zero, 2, -90.0), "zero", (2,)),
    (partial(off_zero_effort, 2), "effort_zero", (2,)),
    (partial(shifted_efforts, 1), "effort_order", ()),
    (partial(shifted_efforts, -1), "effort_order", ()),
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
    page = Path(__file__).resolve().parents[4] / PAGE
    return [line[3:] for line in page.read_text().splitlines() if line.startswith("## ")]


def only(found):
    """The one cause."""
    (cause,) = found.causes
    return cause


@pytest.mark.parametrize(("spoil", "kind", "joints"), MISTAKES, ids=name_of)
def test_a_mistake_is_named_and_is_a_heading_of_the_page(arm, headings, spoil, kind, joints):
    _, samples, model = arm
    found = compare(spoil(samples), model)
    cause = found.causes[0] if kind == "motor_side" else only(found)  # or degrees
    assert cause.kind == kind
    assert cause.joints == tuple(samples.joints[j] for j in joints)
    assert cause.mistake in ("", *headings)
    assert not cause.mistake or cause.reference in found.text
    assert cause.error_after is None or cause.error_after < min(0.1, 0.5 * cause.error_before)
    # recordings of ROS refuse it
    assert "scale=['time" not in cause.remedy or "of a table: scale=['time" in cause.remedy


def test_a_joint_at_rest_is_in_degrees_as_the_others_are(arm):
    _, samples, model = arm
    resting = np.arange(len(samples.joints)) == len(samples.joints) - 1
    still = {"q": np.where(resting, 1.5, samples.q), "qd": np.where(resting, 0.0, samples.qd)}
    found = compare(positions_in_degrees(replace(samples, **still)), model)
    assert found.causes[0].remedy == "convert positions to rad: give scale=['q=deg']"


def test_rounded_efforts_are_at_no_limit(arm):
    _, samples, model = arm
    step = np.ptp(samples.measured, axis=(0, 1)) / 12
    found = compare(replace(samples, measured=step * np.round(samples.measured / step)), model)
    assert "saturation" not in [cause.kind for cause in found.causes]


def test_the_units_of_efforts_are_named(arm):
    _, samples, model = arm
    for spoil, unit, value in (
        (partial(scaled, 1000.0), "in N mm", 1000.0),
        (partial(scaled, 10.1972), "in kgf cm", 10.1972),
        (per_mille, "per mille of the effort limits", None),
        (partial(scaled, 1000 / GAINS), "motor currents in mA", None),
    ):
        cause = only(compare(spoil(samples), model))
        assert unit in cause.reason
        assert value is None or cause.value == value


def test_limits_that_nobody_stated_are_no_evidence(arm):
    _, samples, model = arm
    unknown = np.full(len(samples.joints), np.inf)
    efforts = compare(per_mille(samples), replace(model, effort_limits=unknown))
    assert "limits" not in efforts.text
    limits = np.array([-unknown, unknown])
    motors = compare(of_motors(samples), replace(model, position_limits=limits))
    assert "motor_side" not in [cause.kind for cause in motors.causes]


def test_gravity_that_is_taken_off_is_found(arm):
    name, samples, model = arm
    gravity = model.gravity(samples.flat(samples.q)).reshape(samples.q.shape)
    spoiled = replace(samples, measured=samples.measured - gravity)
    assert only(compare(spoiled, model)).kind == "no_gravity"
    right = model_of(name, without_gravity=True)
    assert {cause.kind for cause in compare(spoiled, right).causes} <= {"friction"}
    assert only(compare(samples, right)).remedy == "give effort_is='torque'"


@pytest.mark.parametrize("speed", [1.0, 2.0])
@pytest.mark.parametrize("gravity", [(0, 0, 9.81), (-9.81, 0, 0), (0, 9.81, 0), (-4.9, 0, -8.5)])
def test_a_mount_is_found(arm, gravity, speed):
    name, _, model = arm
    cause = only(compare(recorded(name, torques_of(name, gravity), speed=speed), model))
    assert cause.kind == "gravity"
    np.testing.assert_allclose(cause.value, gravity, atol=0.3)
    assert f"gravity=({', '.join(f'{x:g}' for x in cause.value)})" in cause.remedy


@pytest.mark.parametrize(("center", "kind"), [((0, 0, 0.1), "payload"), ((0.12, 0, 0.08), "tool")])
def test_a_load_is_found(arm, center, kind):
    name, _, model = arm
    mass = 8.0 if name == "ur10" else 3.0
    cause = only(
        compare(recorded(name, torques_of(name, load=(mass, *center)), friction=0.01), model)
    )
    assert cause.kind == kind
    np.testing.assert_allclose(cause.value, [mass, *center], rtol=0.05, atol=0.02)


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_a_load_that_is_stated_but_not_carried_is_found(arm, share):
    name, *_ = arm
    mass, center = 8.0 if name == "ur10" else 3.0, [0.0, 0.02, 0.1]
    model = model_of(name, {"payload.mass": mass, "payload.center_of_mass": center})
    carried = torques_of(name, load=(share * mass, *center))
    cause = only(compare(recorded(name, carried, friction=0.01), model))
    assert cause.kind == "payload"
    np.testing.assert_allclose(cause.value, [(share - 1) * mass, *center], rtol=0.05, atol=0.02)
    assert f"kg less, at {cause.value[1]:g}," in cause.reason
    assert f"than the {mass:g} kg of the payload that is stated" in cause.reason


@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_a_mass_of_the_description_is_found(arm, factor):
    name, _, model = arm
    masses = list(re.finditer(r'<mass value="([0-9.]+)"', urdf_of(name)))
    third = masses[3]  # of the third link that moves
    mass = float(third[1]) / factor
    true = urdf_of(name)[: third.start()] + f'<mass value="{mass}"' + urdf_of(name)[third.end() :]
    found = compare(recorded(name, torques_of(name, description=true)), model)
    (cause,) = (cause for cause in found.causes if cause.kind == "mass")
    assert cause.value == pytest.approx(1 / factor, rel=0.15)
    assert len(found.causes) == 1 or all(cause.rival for cause in found.causes)


def test_somebody_who_guides_the_arm_is_found(arm):
    name, _, model = arm
    assert only(compare(recorded(name, friction=-0.1), model)).kind == "guided"


@pytest.mark.parametrize("friction", [0.06, 0.15])
def test_a_model_without_friction_is_told_so(arm, friction):
    name, _, model = arm
    samples = recorded(name, friction=friction)
    assert only(compare(samples, model)).kind == "friction"
    rubs = replace(model, friction=lambda q, qd: np.zeros_like(qd))
    assert compare(samples, rubs).causes == ()


@pytest.mark.parametrize(("friction", "told"), [(0.0, True), (0.02, True), (0.08, False)])
def test_friction_that_efforts_lack_is_told(arm, friction, told):
    name, samples, model = arm
    span = np.ptp(samples.measured, axis=(0, 1))

    def rubbing(q, qd):
        return 0.1 * span * (np.tanh(qd / 0.05) + 0.3 * qd)

    rubs = replace(
        model,
        friction=rubbing,
        torques=lambda *motion: model.torques(*motion) + rubbing(*motion[:2]),
    )
    found = compare(recorded(name, friction=friction), rubs)
    assert ["friction=False" in cause.remedy for cause in found.causes] == [True] * told


@pytest.mark.parametrize("friction", [0.0, 0.02])
def test_torques_that_match_have_no_cause(arm, friction):
    name, _, model = arm
    assert compare(recorded(name, friction=friction), model).text == ""


@pytest.mark.parametrize("seed", range(4))
def test_masses_that_a_maker_has_estimated_are_no_mistake(arm, seed):
    name, _, model = arm
    random = np.random.default_rng(seed)

    def other(mass: re.Match[str]) -> str:
        return f'<mass value="{float(mass[1]) * random.uniform(0.7, 1.3)}"'

    true = re.sub(r'<mass value="([0-9.]+)"', other, urdf_of(name))
    torques = torques_of(name, description=true)
    found = compare(recorded(name, torques), model)
    assert {cause.kind for cause in found.causes} <= {"friction"}
    without = recorded(name, lambda *m: torques(*m) - model.gravity(m[0]), speed=0.5)
    assert compare(without, model_of(name, without_gravity=True)).excluded == ()


@pytest.mark.parametrize(
    ("spoil", "kind"),
    [(partial(scaled, 10.1972), "effort_scale"), (partial(turned_effort, 2), "effort_direction")],
    ids=["scale", "sign"],
)
def test_two_mistakes_are_both_named(arm, spoil, kind):
    name, _, model = arm
    found = compare(spoil(recorded(name, torques_of(name, (-4.9, 0, -8.5)))), model)
    assert [cause.kind for cause in found.causes] == [kind, "gravity"]
    assert not any(cause.rival for cause in found.causes)


def test_rivals_that_fit_alike_are_named_together_with_the_motion_that_tells():
    """Slow motion without friction: efforts of the opposite sign are those of an arm upside down."""
    samples = scaled(-1.0, recorded("ur10", friction=0.0, speed=0.02))
    found = compare(samples, model_of("ur10"))
    assert {"effort_sign", "gravity"} <= {cause.kind for cause in found.causes}
    assert "doesn't tell them apart: record the same motion twice as fast" in found.text


def test_what_no_mistake_explains_is_said_with_what_was_excluded(arm):
    _, samples, model = arm
    noise = np.random.default_rng(1).standard_normal(samples.measured.shape).cumsum(axis=1)
    found = compare(replace(samples, measured=samples.measured + noise.std() * noise), model)
    assert found.causes == ()
    assert "no single cause explains the error; these were excluded: " in found.text
    assert {"gravity", "payload", "order"} <= set(found.excluded)


def test_a_contradiction_is_named_beside_what_nothing_explains(arm):
    _, samples, model = arm
    noise = np.random.default_rng(1).standard_normal(samples.measured.shape).cumsum(axis=1)
    spoilt = replace(samples, qd=0 * samples.qd, measured=samples.measured + noise.std() * noise)
    found = compare(spoilt, model)
    assert [cause.kind for cause in found.causes] == ["velocity"]
    assert found.text.startswith(found.causes[0].text)
    assert "no single cause explains the error that is left" in found.text


def test_white_noise_is_no_residual_cause():
    noise = np.random.default_rng(2).standard_normal((2000, 2))
    time = np.arange(2000) * 0.01
    motion = [np.sin(time[:, None] * [1.0, 1.3] + phase) for phase in (0.0, np.pi / 2, np.pi)]
    samples = pieces_of(("a", "b"), time, motion, 0.1 * noise)
    assert residual_causes(samples, 0 * samples.flat(samples.q)) == ()


@pytest.mark.parametrize(
    ("kinds", "rival", "refused"),
    [
        (("payload", "effort_sign"), False, True),
        (("payload", "effort_sign"), True, False),
        (("gravity", "effort_sign"), True, True),
        (("payload",), False, False),
    ],
)
def test_a_load_is_found_unless_something_else_is_wrong(kinds, rival, refused):
    causes = tuple(Cause(kind, (), None, 0.5, 0.1, kind, "mend it", rival=rival) for kind in kinds)
    evaluation = SimpleNamespace(
        bag="bag", diagnosis=causes, effort=SimpleNamespace(meaning="torque")
    )
    if not refused:
        _require_plausible(evaluation)
        return
    with pytest.raises(PayloadError, match="no load can be estimated: .*effort_sign; mend it"):
        _require_plausible(evaluation)


def test_an_effort_that_is_not_measured_shows_no_coupling(arm):
    _, samples, model = arm
    states = (samples.flat(values) for values in (samples.q, samples.qd, samples.qdd))
    computed = model.torques(*states)
    for j in range(len(samples.joints)):
        measured = samples.measured.copy()
        measured[..., j] = 0.0
        found = residual_causes(replace(samples, measured=measured), computed)
        assert "coupling" not in {cause.kind for cause in found}


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
        loaded = torques_of(name, load=(6.0, *random.uniform(-0.2, 0.2, 3)))
        samples = pieces_of(joints, time, (q, qd, qdd), loaded(q, qd, qdd))
        states = (samples.flat(values) for values in (samples.q, samples.qd, samples.qdd))
        found = residual_causes(samples, model.torques(*states))
        assert "drift" not in {cause.kind for cause in found}


def test_few_samples_have_none():
    time, q, qd, qdd = motion_of(2, duration=0.02)
    assert pieces_of(("a", "b"), time, (q, qd, qdd), q) is None


# ---- recordings of real robots ---------------------------------------------------------------------------------------


def notes_of(result) -> list[str]:
    return [note for note in result.notes if "cause" in note]


@pytest.mark.parametrize("robot", ["ur10_real", "panda_real"])
def test_given_robots_are_not_accused(recordings, robot):
    bag = recordings / f"{robot.partition('_')[0]}_exciting_trajectory"
    assert notes_of(evaluate(bag, robot)) == []


@pytest.mark.parametrize(
    ("robot", "joint"), [("ur10_real", 2), ("ur10_real", 1), ("panda_real", 3)]
)
def test_a_joint_of_a_real_recording_that_is_turned_is_found(recordings, robot, joint, tmp_path):
    log = read_joint_log(recordings / f"{robot.partition('_')[0]}_exciting_trajectory")
    name = load_robot(robot).joints[joint]
    effort = log.effort.copy()
    effort[:, log.joint_names.index(name)] *= -1
    write_joint_logs(tmp_path / "turned", {log.topic: replace(log, effort=effort)})
    (note,) = notes_of(evaluate(tmp_path / "turned", robot))
    assert f"torques match if the effort of {name} is reversed" in note
    assert f"{PAGE}#a-joint-is-reversed" in note


@pytest.mark.parametrize("gravity", [(0, 0, 9.81), (9.81, 0, 0), (0, 9.81, 0)])
@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_another_mount_isnt_taken_for_torque_without_gravity(gravity, speed):
    samples = recorded("ur10", torques_of("ur10", gravity=gravity), speed=speed)
    found = meaning_of_efforts(samples, model_of("ur10"), ())
    assert found.best == "torque" or not found.sure


def test_an_arm_that_carries_no_weight_cant_tell_its_efforts_apart():
    weightless = torques_of("ur10", gravity=(0, 0, 0))
    arm = replace(model_of("ur10"), torques=weightless, gravity=np.zeros_like)
    found = meaning_of_efforts(recorded("ur10", weightless), arm, ())
    assert not found.sure
    assert found.reason == "torque and torque_without_gravity can't be told apart"


def test_currents_without_gains_fit_no_meaning():
    found = meaning_of_efforts(scaled(1 / GAINS, recorded("panda")), model_of("panda"), ())
    assert not found.sure or found.best == "torque"  # then the causes doubt it
    assert "current wasn't considered, as no drive gains are known" in found.summary


def test_too_few_samples_tell_no_meaning():
    found = meaning_of_efforts(None, model_of("ur10"), ())
    assert (found.best, found.sure) == ("torque", False)
    assert "too few valid samples" in found.reason


@pytest.mark.parametrize("tip", two_arms.ARMS)
def test_a_load_of_either_arm_is_named(tip: str, tmp_path: Path) -> None:
    loaded = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    loaded.set_payload("load", 2.0, [0.0, 0.0, 0.1], tip=tip)
    table = two_arms.motion(loaded)
    table["effort"] += 0.02 * np.random.default_rng(0).standard_normal(table["effort"].shape)
    found = evaluate(table, urdf=two_arms.written(tmp_path), tip=two_arms.ARMS)
    (cause,) = found.diagnosis
    assert cause.kind == "payload"
    assert f"torques match if {tip} carries about 2 kg at 0,0,0.1 m" in cause.text
    remedy = {"payload.mass": 2.0, "payload.center_of_mass": [0.0, 0.0, 0.1], "payload.tip": tip}
    mended = evaluate(table, urdf=tmp_path / "two_arms.urdf", tip=two_arms.ARMS, parameters=remedy)
    assert max(error.rmse for error in mended.errors) < 0.03


def test_a_wrong_mass_of_a_tree_is_named(tmp_path: Path) -> None:
    heavy = two_arms.URDF.replace("<mass value='2.2'/>", "<mass value='6.6'/>")  # left shoulder
    table = two_arms.motion(Solver(urdf=heavy, tip="*"))
    table["effort"] += 0.02 * np.random.default_rng(0).standard_normal(table["effort"].shape)
    (cause,) = evaluate(table, urdf=two_arms.written(tmp_path), tip="*").diagnosis
    assert cause.kind == "mass"
    assert "link left_shoulder has 3 times the mass of the description" in cause.text
