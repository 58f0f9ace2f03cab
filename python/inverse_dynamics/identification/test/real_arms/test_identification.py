# SPDX-License-Identifier: Apache-2.0
"""Models from recordings: of real robots, with bounds on unseen blocks, and of one that is known."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from inverse_dynamics import _core, evaluate, identify, load_robot, write_joint_logs
from inverse_dynamics.errors import EvaluationError
from inverse_dynamics.evaluation.bands import SHARE
from inverse_dynamics.evaluation.evaluation import CAUSE
from inverse_dynamics.evaluation.exports import series_columns
from inverse_dynamics.identification import cross_validation
from inverse_dynamics.identification.blocks import Block, blocks_of
from inverse_dynamics.identification.cross_validation import choose, errors_of
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.findings import motion_findings
from inverse_dynamics.identification.knowledge import independent_samples, intervals, knowledge
from inverse_dynamics.identification.result import COLUMNS, LAWS, IdentificationError
from inverse_dynamics.identification.temperature import at_temperature
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.link_parameters import pseudo_inertia

# Mean over the joints of the RMSE on five held-out blocks [N m].
MOST = {"ur10": 1.2, "panda": 0.28}
ROBOTS = pytest.mark.parametrize("name", ["ur10", "panda"])


def rms(errors):
    return np.sqrt((errors**2).mean(0))


def description(robot):
    return read_description(robot.urdf), {"root": robot.root, "tip": robot.tip}


@ROBOTS
def test_unseen_blocks_are_predicted_better_than_by_all_others(identified, name):
    found = identified(name)
    assert tuple(found.held_out) == tuple(COLUMNS)
    assert found.rmse("identified") <= MOST[name]
    assert found.rmse("identified") < found.rmse("present_refitted") < found.rmse("present")
    assert found.rmse("present") < found.rmse("urdf")
    assert found.law in LAWS


@ROBOTS
def test_notes_leave_out_that_a_model_could_be_identified(identified, name):
    assert not any(note.startswith(CAUSE) for note in identified(name).notes)


@ROBOTS
def test_bands_hold_on_unseen_blocks(identified, name):
    coverage = identified(name).coverage
    assert 0.92 <= coverage.mean() <= 0.98  # of blocks of the same day
    assert coverage.min() >= 0.85


@ROBOTS
def test_links_are_bodies_and_friction_brakes(identified, name):
    model = identified(name).model
    for p in model.parameters:
        assert np.linalg.eigvalsh(pseudo_inertia(p))[0] > 0
    assert model.rotor_inertia.min() >= 0
    for law in model.friction:
        assert min(law["fv"], law["fc"], law.get("fl", 0.0), law.get("fs", 0.0)) >= 0
        assert law["width"] > 0
        assert law.get("fl", 0.0) < 0.5


@ROBOTS
def test_what_is_held_out_is_what_figures_are_of(identified, name):
    found = identified(name)
    assert len(found.blocks) == 5
    times = [block.time for block in found.blocks]
    assert all(one[-1] < other[0] for one, other in pairwise(times))
    errors = np.concatenate([b.measured - b.computed["present"] for b in found.blocks])
    if name == "ur10":  # whose samples all count
        np.testing.assert_allclose(rms(errors), found.held_out["present"])
    assert found.model.seen.shape == (3, len(found.joints), 2)
    assert (found.model.seen[:, :, 0] < found.model.seen[:, :, 1]).all()


@ROBOTS
def test_what_the_prior_decided_is_marked(identified, name):
    found = identified(name)
    decided = {(p.link, p.parameter) for p in found.prior_decided}
    # no torque depends on it: the first joint's axis is vertical
    assert (found.links[0], "m") in decided
    assert all(p.share < 0.5 for p in found.prior_decided)
    assert len(decided) < 10 * len(found.joints)
    names = [i.name for i in found.intervals]
    assert len(set(names)) == len(names)
    assert all(i.half_width > 0 for i in found.intervals)


def test_the_panda_has_a_link_with_a_floor(identified):
    floors = [f for f in identified("panda").findings if f.kind == "floor"]
    assert [f.joint for f in floors] == ["fer_link4"]


def trained_on(bag, begin, end, blocks):
    """Errors of a UR10 (N, n) on all that is outside of a part of the recording."""
    robot = load_robot("ur10_real")
    text, ends = description(robot)
    fitter = _core.ArmFitter.from_urdf(text, **ends)
    chosen = choose(fitter, blocks_of(evaluate(bag, robot, start=begin, end=end), blocks))
    rest = [(0.0, begin), (end, 27.52)]
    tested = [evaluate(bag, robot, start=a, end=b) for a, b in rest if b - a > 1]
    errors = [errors_of(fitter, chosen.fit, blocks_of(e, 1)[0]) for e in tested]
    return np.concatenate(errors)


def test_half_of_the_recording_predicts_the_other(recordings):
    bag = recordings / "ur10_exciting_trajectory"
    halves = [trained_on(bag, 0.0, 13.76, 5), trained_on(bag, 13.76, 27.52, 5)]
    assert np.mean([rms(errors).mean() for errors in halves]) <= 1.25


# A robot that is known: the Panda with other masses and friction, whose torques are 12 ms late.
DELAY = 0.012
STEP, WIDTH, VISCOUS, OFFSET = 1.5, 0.06, 2.0, 0.3


def motion(joints, seconds, rate, seed):
    """Sums of sines: q, qd, qdd, (N, n)."""
    random = np.random.default_rng(seed)
    time = np.arange(0, seconds, 1 / rate)[:, None]
    q, qd, qdd = (np.zeros((len(time), joints)) for _ in range(3))
    for frequency in (0.11, 0.23, 0.41, 0.67):
        w, phase = 2 * np.pi * frequency, random.uniform(0, 6, joints)
        amplitude = random.uniform(0.1, 0.3, joints) / (2 * np.pi * frequency)
        q += amplitude * np.sin(w * time + phase)
        qd += amplitude * w * np.cos(w * time + phase)
        qdd -= amplitude * w**2 * np.sin(w * time + phase)
    return q, qd, qdd


class Known:
    """A known Panda."""

    def __init__(self):
        self.robot = load_robot("panda_simulated")
        text, ends = description(self.robot)
        self.model = _core.FastModel.from_urdf(text, **ends)
        self.fitter = _core.ArmFitter.from_urdf(text, **ends)
        n = len(self.model.joint_names)
        scale = np.random.default_rng(3).uniform(0.7, 1.4, n)
        # a described body, heavier or lighter: still one
        self.parameters = (scale[:, None] * self.fitter.prior).ravel()

    def torques(self, q, qd, qdd):
        friction = VISCOUS * qd + STEP * np.tanh(qd / WIDTH) + OFFSET
        return self.model.regressor(q, qd, qdd) @ self.parameters + friction

    def record(self, path, seconds, rate=125.0, seed=1, rest=0.0, **changes):
        """A recording with coloured noise."""
        n = len(self.model.joint_names)
        q, qd, qdd = motion(n, seconds, rate, seed)
        if rest:  # after the arm has come to it
            left = np.clip((seconds - np.arange(len(q)) / rate) / 2, 0, 1)[:, None]
            q *= left**3 * (10 - 15 * left + 6 * left**2)
            q = np.vstack([q, np.repeat(q[-1:], int(rest * rate), axis=0)])
            qd = np.gradient(q, 1 / rate, axis=0)
            qdd = np.gradient(qd, 1 / rate, axis=0)
        tau = self.torques(q, qd, qdd)
        late = np.arange(len(q)) / rate - DELAY
        tau = np.transpose([np.interp(late, late + DELAY, column) for column in tau.T])
        random = np.random.default_rng(seed + 1)
        noise = np.zeros_like(tau)
        for k in range(1, len(noise)):
            noise[k] = 0.97 * noise[k - 1] + random.normal(0, 0.03, n)
        stamps = (np.arange(1, len(q) + 1) * 1e9 / rate).astype(np.int64)
        log = JointLog(
            self.robot.joints or tuple(self.model.joint_names),
            stamps,
            stamps,
            q + random.normal(0, 1e-5, q.shape),
            qd + random.normal(0, 1e-4, q.shape),
            tau + noise,
        )
        write_joint_logs(path, {self.robot.topic: replace(log, **changes)})
        return path


@pytest.fixture(scope="module")
def known():
    return Known()


@pytest.fixture(scope="module")
def found(known, tmp_path_factory):
    """What was identified from 30 s of the known robot."""
    bag = known.record(tmp_path_factory.mktemp("known") / "bag", 30.0)
    return identify([bag], known.robot)


def test_a_known_robot_comes_back(known, found):
    q, qd, qdd = motion(len(found.joints), 20.0, 50.0, seed=9)
    truth = known.torques(q, qd, qdd)
    model = found.model.parameters.ravel()
    friction = np.transpose(
        [
            law["fv"] * v + law["fo"] + law["fc"] * np.tanh((v + law["shift"]) / law["width"])
            for law, v in zip(found.model.friction, qd.T, strict=True)
        ]
    )
    computed = known.model.regressor(q, qd, qdd) @ model + friction
    computed += found.model.rotor_inertia * qdd
    assert found.law == "step"
    assert rms(computed - truth).mean() < 0.1  # less than the noise, which is 0.12 N m
    assert found.delay == pytest.approx(DELAY, abs=0.004)
    assert "present" not in found.held_out


def delay_where(noise_of):
    """What is found where the noise depends on the delay like this."""
    fitter = SimpleNamespace(
        data=lambda delays, **_: delays,
        fit=lambda delays, *_: SimpleNamespace(noise=noise_of(np.array(delays))),
    )
    block = SimpleNamespace(
        instants=np.array([0.0, 0.008]),
        used=np.array([True, True]),
        later=lambda delay, _: SimpleNamespace(fitted=delay, before=None),
    )
    return cross_validation._delay(fitter, [block], 1, "step", None)[0]


@pytest.mark.parametrize(("best", "found"), [(3e-5, 0.0), (0.003, 0.003), (-0.003, -0.003)])
def test_a_delay_of_less_than_a_tenth_of_a_millisecond_counts_as_none(best, found):
    delay = delay_where(lambda delays: np.exp((delays - best) ** 2))
    assert delay == pytest.approx(found, abs=1e-9)


@pytest.mark.parametrize("late", [0.02, 0.03, -0.05])
def test_a_delay_of_several_steps_is_found(late):
    delay = delay_where(lambda delays: np.hypot(1e-4, delays - late))
    assert delay == pytest.approx(late, abs=0.002)


def test_without_a_least_noise_there_is_no_delay():
    assert delay_where(lambda delays: 1.0 - delays) == 0.0


@pytest.mark.parametrize(
    ("delay", "delays", "told"),
    [
        (-1e-4, [-2e-4, 0.0, -2e-4, 0.0, -1e-4], None),
        (4e-3, [4.1e-3, 3.9e-3, 4e-3, 4.1e-3, 3.9e-3], "4.0 ms later than the states, +- 0.5 ms"),
        (0.0, [0.0] * 5, None),
    ],
)
def test_a_delay_is_stated_where_blocks_agree_that_it_isnt_zero(delay, delays, told):
    still = SimpleNamespace(q=np.zeros((2, 0)))
    fitter = SimpleNamespace(joint_names=())
    found = motion_findings(fitter, delay, np.array(delays), [still], np.empty(0))
    assert [told in finding.text for finding in found] == [True] * (told is not None)


def test_intervals_hold_the_truth(known, found):
    values = {i.name: i for i in found.intervals}
    inside = [
        abs(values[f"{joint} {key}"].value - true) <= values[f"{joint} {key}"].half_width
        for joint in found.joints
        for key, true in {"fv": VISCOUS, "fc": STEP, "fo": OFFSET, "width": WIDTH}.items()
    ]
    assert np.mean(inside) >= 0.8  # of 28: 0.95 is meant


def test_the_noise_and_its_correlation_are_found(found):
    np.testing.assert_allclose(found.noise, 0.03 / np.sqrt(1 - 0.97**2), rtol=0.3)
    # (1 + 0.97) / (1 - 0.97) = 66 samples for one
    assert found.samples / 150 < found.independent.mean() < found.samples / 20


def test_independent_samples_of_white_noise_are_all():
    errors = np.random.default_rng(1).normal(size=(5000, 3))
    np.testing.assert_allclose(independent_samples([errors]), 5000, rtol=0.1)


def test_several_recordings_are_used_together(known, tmp_path):
    bags = [known.record(tmp_path / f"bag{k}", 10.0, seed=k) for k in (1, 2, 3)]
    several = identify(bags, known.robot, blocks=3)
    assert len(several.recordings) == len(several.blocks) == 3
    assert {block.recording for block in several.blocks} == {str(bag) for bag in bags}
    assert several.rmse("identified") < 0.3


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"end": 3.0}, "at least 5 s of motion"),
        ({"blocks": 2}, "blocks: expected at least 3, got 2"),
    ],
)
def test_refusals_say_what_to_do(known, tmp_path, changes, expected):
    bag = known.record(tmp_path / "bag", 6.0)
    with pytest.raises(IdentificationError, match=expected):
        identify([bag], known.robot, **changes)


def test_no_recording_and_no_description_are_refused(known, tmp_path):
    with pytest.raises(IdentificationError, match="at least one"):
        identify([], known.robot)
    with pytest.raises(IdentificationError, match="expected a description"):
        identify([tmp_path], replace(known.robot, urdf=None))
    assert issubclass(IdentificationError, EvaluationError)


def test_a_recording_that_is_given_twice_is_refused(known, tmp_path):
    with pytest.raises(IdentificationError, match="expected each recording once"):
        identify([tmp_path, tmp_path / "."], known.robot)


SLIDE = """<robot name="slide"><link name="base"/><link name="cart"/><link name="arm"/>
<joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="100"/></joint>
<joint name="hinge" type="continuous"><parent link="cart"/><child link="arm"/><axis xyz="0 1 0"/></joint>
</robot>""".replace(
    "/><link",
    "><inertial><mass value='2'/><origin xyz='.1 0 0'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' "
    "ixz='0' iyz='0'/></inertial></link><link",
).replace(
    '<link name="arm"/>',
    "<link name='arm'><inertial><mass value='1'/><origin xyz='.2 0 0'/><inertia ixx='.1' "
    "iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial></link>",
)


def test_intervals_of_a_prismatic_joint_are_in_newtons_and_metres():
    fitter = _core.ArmFitter.from_urdf(SLIDE)
    model = _core.FastModel.from_urdf(SLIDE)
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, 400, 2))
    tau = model.regressor(q, qd, qdd) @ model.parameters + qd + np.tanh(qd / 0.05)
    tau += np.random.default_rng(2).normal(0, 0.1, tau.shape)
    blocks = blocks_of_arrays(q, qd, qdd, tau)
    options = _core.ArmFitOptions("memory", prior_strength=10)
    fit = fitter.fit(fitter.data([b.fitted for b in blocks]), options)
    known = knowledge(fitter, fit, blocks, options)
    units = {i.name: i.unit for i in intervals(known, model, ("N", "N m"))}
    of = {key: (units[f"slide {key}"], units[f"hinge {key}"]) for key in OWN_UNITS}
    assert of == OWN_UNITS


OWN_UNITS = {
    "rotor_inertia": ("kg", "kg m^2"),
    "fv": ("N s/m", "N m s/rad"),
    "fo": ("N", "N m"),
    "fc": ("N", "N m"),
    "shift": ("m/s", "rad/s"),
    "width": ("m/s", "rad/s"),
    "fl": ("", ""),
    "fs": ("N", "N m"),
    "vs": ("m/s", "rad/s"),
    "fm": ("N", "N m"),
    "distance": ("m", "rad"),
}


RANGE = np.array([87.0] * 4 + [12.0] * 3)  # N m, of the Panda's torque sensors


class Day(Known):
    """The known Panda on a day with so much friction, and offsets; at last it rests for 8 s."""

    def __init__(self, share, seed):
        super().__init__()
        random = np.random.default_rng(seed)
        self.share, n = share, len(self.model.joint_names)
        self.offset = random.normal(0, 0.005, n) * RANGE  # an accuracy of 1 %
        self.holding = STEP * random.uniform(-1, 1, n)  # friction of the arm at rest

    def torques(self, q, qd, qdd):
        rests = (qd == 0).all(axis=1)[:, None]
        friction = VISCOUS * qd + STEP * np.tanh(qd / WIDTH)
        friction = self.share * np.where(rests, self.holding, friction)
        return self.model.regressor(q, qd, qdd) @ self.parameters + OFFSET + self.offset + friction


@pytest.fixture(scope="module")
def identified_on(tmp_path_factory):
    """What is identified from all days but the last, and the evaluation of the last by the written model."""

    @cache
    def identified(*shares):
        directory = tmp_path_factory.mktemp("days")
        bags = [
            Day(share, k).record(directory / f"day{k}", 30.0, seed=k, rest=8.0)
            for k, share in enumerate(shares)
        ]
        found = identify(bags[:-1], "panda_simulated")
        write_identification(found, directory / "arm.yaml")
        return found, evaluate(bags[-1], directory / "arm.yaml")

    return identified


@pytest.mark.parametrize("days", [(1.1, 0.95), (0.9, 1.1, 1.0)])
def test_bands_hold_on_another_day(identified_on, days):
    found, other = identified_on(*days)
    errors = np.abs(other.computed - other.measured)[other.samples.kept]
    assert other.coverage.mean() >= 0.9
    assert other.coverage.min() >= 0.85
    assert other.band.mean() <= 1.6 * np.quantile(errors, 0.95, axis=0).mean()
    assert f"band.{found.joints[0]}" in [column.name for column in series_columns(other)]


def test_friction_at_rest_is_unknown_and_zero_at_best(identified_on):
    found, other = identified_on(1.1, 0.95)
    solver = found.solver()
    n = len(found.joints)
    still = np.zeros(n)
    np.testing.assert_allclose(solver.friction_vector(still, q=still), found.offsets, atol=1e-12)
    rests = np.abs(other.log.qd).max(axis=1) < 1e-3
    heights = np.array([law["fc"] for law in found.model.friction])
    assert (other.band[rests] >= 0.95 * heights).all()  # 95 % of what is anywhere between them
    creeping = 0.3 * np.array([law["width"] for law in found.model.friction])[None]
    friction = solver.friction_vector(creeping, q=still[None]) - found.offsets
    half = found.band.half_widths(solver, still[None], creeping, still[None])
    assert (friction - half <= -0.85 * heights).all()  # that of the motion before
    fast = np.where(np.arange(n) == 0, 3.0, 0.0) * found.model.seen[1, :, 1]  # beyond what was seen
    seen = fast / 3.0
    band = [
        found.band.half_widths(solver, *(v[None] for v in (still, qd, still)))
        for qd in (seen, fast)
    ]
    assert band[1][0, 0] > 1.2 * band[0][0, 0]


def test_a_level_of_each_recording_is_found(identified_on):
    found, _ = identified_on(0.8, 1.0, 1.2, 1.0)
    assert [block.recording for block in found.blocks] == [str(path) for path in found.recordings]
    first, middle, last = (level.share.mean() for level in found.levels)
    # against the other two: 0.8 - 1.1, 1 - 1, 1.2 - 0.9
    np.testing.assert_allclose([first, middle, last], [-0.3, 0.0, 0.3], atol=0.06)
    assert found.band.share.mean() > 1.4 * SHARE
    differences = [level.offset - found.levels[0].offset for level in found.levels[1:]]
    offsets = [Day(1.0, k).offset for k in range(3)]
    for difference, offset in zip(differences, offsets[1:], strict=True):
        # each is held against the mean of the others, so differences are 1.5 times as large
        np.testing.assert_allclose(difference / 1.5, offset - offsets[0], atol=0.1)


def test_friction_follows_the_temperature(identified_on, tmp_path):
    found, _ = identified_on(0.8, 1.0, 1.2, 1.0)
    warm = at_temperature(found, [40.0, 30.0, 20.0], 45.0)  # 2 % less a degree
    for law, new in zip(found.model.friction, warm.model.friction, strict=True):
        assert new["fc"] / law["fc"] == pytest.approx(0.7, abs=0.04)
        assert new["fv"] / law["fv"] == pytest.approx(new["fc"] / law["fc"])
        assert new["width"] == law["width"]
    assert (warm.band.share < SHARE).all()
    file = write_identification(warm, tmp_path / "arm.yaml").robot
    assert evaluate(found.recordings[0], file).band is not None
    for temperatures in ([], [40.0, 30.0], [30.0, 30.0, 30.0]):
        with pytest.raises(IdentificationError, match="expected different ones of 3 or more"):
            at_temperature(found, temperatures, 45.0)
    with pytest.raises(IdentificationError, match=r"joint \w+: expected .* range, 20 to 40$"):
        at_temperature(found, [40.0, 30.0, 20.0], 120.0)


def blocks_of_arrays(q, qd, qdd, tau):
    time, all_of = np.arange(len(q)) * 0.01, np.full(len(q), True)
    return Block("arrays", time, time, all_of, q, qd, qdd, tau, all_of, ~all_of, q[:0]).parts(4)


@pytest.mark.parametrize("seed", [64, 116, 118])
def test_more_passes_over_the_samples_are_never_worse(seed):
    robot = load_robot("ur10_simulated")
    text, ends = description(robot)
    fitter, model = _core.ArmFitter.from_urdf(text, **ends), _core.FastModel.from_urdf(text, **ends)
    random = np.random.default_rng(seed)
    count = int(random.choice([60, 150, 400]))
    noise = float(random.choice([0.003, 0.03, 0.3]))

    def block(scale):
        """Steps of friction that are narrow or wide, off zero or not."""
        width, shift, vs = (
            10 ** random.uniform(-2.5, -0.3),
            random.uniform(-0.15, 0.15),
            10 ** random.uniform(-1.3, 0),
        )
        fs = random.choice([0, 5])
        q, qd = random.uniform(-3, 3, (count, 6)), random.uniform(-1, 1, (count, 6)) ** 3 * 1.5
        qdd = random.uniform(-4, 4, (count, 6))
        tau = scale * model.regressor(q, qd, qdd) @ model.parameters + 2 * qd
        tau += (3 + fs * np.exp(-((qd / vs) ** 2))) * np.tanh((qd + shift) / width)
        return q, qd, qdd, tau + random.normal(0, noise, tau.shape)

    one, other = fitter.data([block(1.0)]), fitter.data([block(1.3)])
    for law in LAWS:
        options = _core.ArmFitOptions(law, prior_strength=10)
        start = fitter.fit(one, options)
        costs = []
        for options.most_passes in (1, 2, 3, 4):
            costs.append(fitter.fit(other, options, start).cost)
        assert (np.diff(costs) <= 1e-6 * np.abs(costs[1:])).all(), (law, costs)
