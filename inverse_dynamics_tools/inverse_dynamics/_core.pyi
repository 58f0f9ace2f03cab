# SPDX-License-Identifier: Apache-2.0
"""Types of the extension module: solvers, samples of recordings, accelerations, metrics, control laws.

Arrays are (n,), one state, or (N, n), one state per row; results have the same shape.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Any, Literal, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inverse_dynamics.data.joint_log import JointLog
from inverse_dynamics.errors import UserError
from inverse_dynamics.robot.robots import Robot

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
Parameter = (
    bool | int | float | str | Sequence[bool] | Sequence[int] | Sequence[float] | Sequence[str]
)

def available_solvers() -> list[str]:
    """Names of the installed solver plugins, sorted; none if no workspace is sourced."""

class Solver:
    """An inverse dynamics solver, made by name and ready to compute. Threads: safe.

    rad, rad/s, rad/s^2, N m (prismatic m, m/s, m/s^2, N); joints in the order of joint_names. out:
    an array of doubles, of any layout, that takes the result; it is returned.
    """

    def __init__(
        self,
        plugin: str,
        urdf: str | Path = "",
        root: str = "",
        tip: str = "",
        gravity: Sequence[float] | None = None,
        friction: bool = True,
        attached: str = "",
        model: str | None = None,
        parameters: dict[str, Parameter] = ...,
    ) -> None: ...
    @property
    def plugin(self) -> str:
        """Its name: package/Class."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, from root to tip: the order of all arrays."""

    @property
    def joint_types(self) -> tuple[str, ...]:
        """revolute, continuous or prismatic, of each joint.

        Positions of a continuous joint that differ by whole turns are the same.
        """

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the robot that don't prevent computing, one sentence each."""

    @property
    def inertia_is_physical(self) -> bool:
        """Whether H is symmetric and positive definite by construction."""

    @property
    def drive_gains(self) -> Floats | None:
        """(n,) N m/A (prismatic N/A) of a model identified in motor currents; None of any other."""

    @property
    def friction_depends_on_position(self) -> bool:
        """Whether friction grows with the gravity torques: then friction_vector() needs q."""

    @property
    def torque_deviation(self) -> Floats | None:
        """(n,) N m (prismatic N): half the width of the band that holds 95 % of the differences.

        Between measured and computed torques of data that weren't used to identify. None where the
        model doesn't state it.
        """

    @property
    def seen(self) -> Floats | None:
        """(3, n, 2): least and greatest q, qd, qdd of the data of identification.

        None where the model doesn't state it.
        """

    def torques(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        qdd: ArrayLike,
        *,
        wrench: ArrayLike | None = None,
        frame: str = "root",
        out: Floats | None = None,
    ) -> Floats:
        """Tau = H(q) qdd + C(q, qd) qd + f(q, qd) + g(q); with a wrench + J(q)^T wrench.

        wrench, frame: as in external_torques(); frame="tip" without a wrench is an error.
        """

    def inertia_matrix(self, q: ArrayLike, *, out: Floats | None = None) -> Floats:
        """H(q), (n, n) or (N, n, n)."""

    def coriolis_vector(self, q: ArrayLike, qd: ArrayLike, *, out: Floats | None = None) -> Floats:
        """C(q, qd) qd."""

    def gravity_vector(self, q: ArrayLike, *, out: Floats | None = None) -> Floats:
        """g(q): what holds the robot still."""

    def friction_vector(
        self, qd: ArrayLike, *, q: ArrayLike | None = None, out: Floats | None = None
    ) -> Floats:
        """f(q, qd); zero if the solver has no friction model or was made without.

        q is needed where friction_depends_on_position.
        """

    def dynamic_components(
        self, q: ArrayLike, qd: ArrayLike, *, out: tuple[Floats, Floats, Floats] | None = None
    ) -> tuple[Floats, Floats, Floats]:
        """H(q), C(q, qd) qd, g(q)."""

    def set_payload(
        self,
        name: str,
        mass: float,
        center_of_mass: ArrayLike | None = None,
        inertia: ArrayLike | None = None,
        frame: ArrayLike | None = None,
    ) -> None:
        """Add a rigid body to the tip, or replace the one of that name.

        Other threads may compute meanwhile. mass: kg. center_of_mass: (3,) m, in the body's frame.
        inertia: (3, 3) or ixx ixy ixz iyy iyz izz, kg m^2, about the center of mass, in the axes of
        the body's frame; none: a point mass. frame: (4, 4) pose of that frame in the tip frame.
        """

    def remove_payload(self, name: str) -> bool:
        """Take a body away; False if there is none of that name."""

    def clear_payloads(self) -> None:
        """Take all bodies away."""

    @property
    def payloads(self) -> dict[str, dict[str, Any]]:
        """The bodies: name to the arguments of set_payload()."""

    def set_gravity(self, gravity: ArrayLike) -> None:
        """Sets the gravitational acceleration: (3,) m/s^2, in the axes of the root link."""

    def set_base_acceleration(self, acceleration: ArrayLike) -> None:
        """How the root link accelerates, (3,) m/s^2 in its axes. Not for a base that rotates."""

    @property
    def gravity(self) -> Floats:
        """(3,) m/s^2."""

    @property
    def base_acceleration(self) -> Floats:
        """(3,) m/s^2."""

    def tip_pose(self, q: ArrayLike) -> tuple[Floats, Floats]:
        """Pose of the tip in the root frame: R, (3, 3) or (N, 3, 3), and p, (3,) or (N, 3)."""

    def tip_jacobian(self, q: ArrayLike, *, out: Floats | None = None) -> Floats:
        """J(q), (6, n) or (N, 6, n): [v, w] = J qd is the velocity of the tip.

        That of its origin, linear first, in the axes of the root frame.
        """

    def tip_jacobian_derivative(
        self, q: ArrayLike, qd: ArrayLike, *, out: Floats | None = None
    ) -> Floats:
        """dJ/dt where q moves with qd, in the shape of J."""

    def external_torques(
        self,
        q: ArrayLike,
        wrench: ArrayLike,
        frame: str = "root",
        *,
        out: Floats | None = None,
    ) -> Floats:
        """J(q)^T wrench: what the joints add so that the tip exerts the wrench on its surroundings.

        wrench: (6,) or (N, 6), force [N] and torque [N m] about the tip's origin, in the axes of
        frame, "root" or "tip".
        """

    def coriolis_matrix(self, q: ArrayLike, qd: ArrayLike, *, out: Floats | None = None) -> Floats:
        """C(q, qd) of Christoffel's symbols, (n, n) or (N, n, n)."""

    def kinetic_energy(self, q: ArrayLike, qd: ArrayLike) -> np.float64 | Floats:
        """1/2 qd^T H qd [J], a number or (N,); where H is symmetric."""

    def potential_energy(self, q: ArrayLike) -> np.float64 | Floats:
        """Of gravity [J], a number or (N,); zero where all masses are at the root's origin.

        Where H is symmetric.
        """

    def torque_derivatives(
        self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike
    ) -> tuple[Floats, Floats, Floats]:
        """dtau/dq, dtau/dqd and dtau/dqdd = H, (n, n) or (N, n, n) each, friction included."""

    def regressor(
        self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, *, out: Floats | None = None
    ) -> Floats:
        """Y, (n, 10 n) or (N, n, 10 n): torques of rigid bodies are Y p."""

    def accelerations(
        self, q: ArrayLike, qd: ArrayLike, tau: ArrayLike, *, out: Floats | None = None
    ) -> Floats:
        """Qdd under these torques, friction subtracted."""

class FastModel:
    """The engine without a plugin, of many states at a time, and Gram matrices. Threads: safe.

    Arrays are (n,), one state, or (N, n), one row per state. threads: among how many a large batch
    is shared.
    """

    @staticmethod
    def from_urdf(
        urdf: str | Path,
        *,
        root: str = "",
        tip: str = "",
        gravity: Sequence[float] | None = None,
        threads: int = 1,
    ) -> FastModel:
        """Of a URDF: its text or its path; without the friction that it states."""

    @staticmethod
    def from_file(path: str, *, threads: int = 1) -> FastModel:
        """Of a model file, with its friction."""

    @staticmethod
    def from_joints(
        names: Sequence[str],
        prismatic: Sequence[bool],
        rotations: ArrayLike,
        offsets: ArrayLike,
        links: ArrayLike,
        gravity: Sequence[float],
        *,
        threads: int = 1,
    ) -> FastModel:
        """Of joints about or along z of their links' frames.

        (n, 3, 3) and (n, 3), of each frame in the one before, and (n, 10) parameters of the links.
        """

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, from root to tip: the order of all arrays."""

    @property
    def parameters(self) -> Floats:
        """(10 n,): m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz of each link, in its frame."""

    def forward_dynamics(
        self, q: ArrayLike, qd: ArrayLike, tau: ArrayLike, *, out: Floats | None = None
    ) -> Floats:
        """Accelerations under these torques, friction subtracted."""

    def torque_derivatives(
        self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike
    ) -> tuple[Floats, Floats, Floats]:
        """dtau/dq, dtau/dqd and dtau/dqdd = H, (n, n) or (N, n, n)."""

    def coriolis_matrix(self, q: ArrayLike, qd: ArrayLike, *, out: Floats | None = None) -> Floats:
        """C of Christoffel's symbols, (n, n) or (N, n, n): dH/dt = C + C'."""

    def tip_pose(self, q: ArrayLike) -> tuple[Floats, Floats]:
        """R, (3, 3) or (N, 3, 3), and p [m], (3,) or (N, 3), of the tip in the root frame."""

    def tip_jacobian(self, q: ArrayLike, *, out: Floats | None = None) -> Floats:
        """J, (6, n) or (N, 6, n): rows linear, then angular; of the tip's origin, axes of the root."""

    def tip_jacobian_derivative(
        self, q: ArrayLike, qd: ArrayLike, *, out: Floats | None = None
    ) -> Floats:
        """Derivative of J by time: the tip's acceleration is J qdd + dJ qd."""

    def regressor(
        self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, *, out: Floats | None = None
    ) -> Floats:
        """Y, (n, 10 n) or (N, n, 10 n): tau = Y parameters + rotor inertia qdd + friction."""

    def regressor_gram(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        qdd: ArrayLike,
        tau: ArrayLike,
        *,
        own_columns: Sequence[ArrayLike] = ...,
        weights: ArrayLike | None = None,
    ) -> Floats:
        """Gram matrices of the rows [Y_j, own columns, tau_j] of each joint, summed: (n, m, m).

        m = 10 n + own columns + 1. own_columns: arrays like q, of what else a joint's torque is
        linear in. weights: an array like q.
        """

class ArmFit:
    """A model of an arm: inverse_dynamics_identification/arm_fit.hpp."""

    @property
    def parameters(self) -> Floats:
        """(n, 10) m, mc, I of each link, in its frame and about its origin."""

    @property
    def rotor_inertia(self) -> Floats:
        """(n,) kg m^2 (prismatic kg)."""

    @property
    def friction(self) -> list[dict[str, float]]:
        """Figures of smooth_coulomb of each joint, by the keys of the model file."""

    @property
    def noise(self) -> Floats:
        """(n,) root mean squares of the errors of the samples that it was fitted to."""

    @property
    def drive_gains(self) -> Floats | None:
        """(n,) N m/A (prismatic N/A) that were fitted; None: of measured torques."""

    @property
    def cost(self) -> float: ...
    @property
    def passes(self) -> int: ...

Block = tuple[Floats, Floats, Floats, Floats]

class ArmFitter:
    """Fits models of one arm: inverse_dynamics_identification/arm_fit.hpp. Threads: safe.

    blocks: q, qd, qdd, tau, (N, n) each. law: step, load, stribeck.
    """

    @staticmethod
    def from_urdf(
        urdf: str,
        *,
        root: str = "",
        tip: str = "",
        gravity: Sequence[float] | None = None,
        locked_joints: Mapping[str, float] = ...,
    ) -> ArmFitter:
        """Of a URDF's text, whose links are the prior.

        locked_joints: positions of joints beside the chain, else 0.
        """

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, from root to tip: the order of all arrays."""

    @property
    def prior(self) -> Floats:
        """(n, 10) parameters of the links that fits are drawn to."""

    @property
    def changes(self) -> list[str]:
        """What the prior has changed about each described link, in words; empty: nothing."""

    def fit(
        self,
        blocks: Sequence[Block],
        *,
        law: str,
        prior_strength: float,
        most_passes: int = 10,
        start: ArmFit | None = None,
        drive_gains: ArrayLike | None = None,
        carried: Sequence[Floats | None] = ...,
    ) -> ArmFit:
        """A fit to the samples of all blocks. start: another one to begin with.

        drive_gains: (n,) N m/A, about: tau are currents [A], and the gains are fitted. carried: (10,)
        or None of each block, a known body m, mc, I in the tip frame, about its origin.
        """

    def torques(self, fit: ArmFit, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike) -> Floats:
        """Torques of a fit, friction included: (n,) or (N, n)."""

    def information(
        self,
        fit: ArmFit,
        blocks: Sequence[Block],
        *,
        law: str,
        prior_strength: float,
        carried: Sequence[Floats | None] = ...,
    ) -> tuple[Floats, Floats, Floats]:
        """What data and prior say of the m unknowns, (m, m) each, and scores (blocks, m)."""

    def whitened_information(
        self,
        fit: ArmFit,
        blocks: Sequence[Block],
        times: Sequence[ArrayLike],
        *,
        law: str,
        noise: ResidualNoise,
    ) -> Floats:
        """What samples say of the m unknowns where errors are like this noise, (m, m).

        times: (N,) s of each block.
        """

class SampleRules:
    """Which rules on faults of samples are acted upon."""

    def __init__(
        self,
        *,
        repeated: bool = True,
        non_increasing: bool = True,
        time_base: bool = True,
        start_transient: bool = True,
    ) -> None: ...

class SampleReport:
    """What was found in N samples: inverse_dynamics_evaluation/samples.hpp."""

    @property
    def repeated(self) -> Mask: ...
    @property
    def non_increasing(self) -> Mask: ...
    @property
    def start_transient(self) -> Mask: ...
    @property
    def isolated(self) -> Mask: ...
    @property
    def used(self) -> Mask: ...
    @property
    def kept(self) -> Mask: ...
    @property
    def time_base(self) -> str: ...
    @property
    def time(self) -> Floats: ...
    @property
    def pieces(self) -> list[int]: ...
    @property
    def period(self) -> float: ...
    @property
    def stamped_period(self) -> float: ...
    @property
    def jitter(self) -> float: ...

class CutoffChoice:
    """How a cut-off was chosen [Hz]: inverse_dynamics_evaluation/cutoff.hpp."""

    @property
    def cutoff(self) -> float: ...
    @property
    def lowest(self) -> float: ...
    @property
    def highest(self) -> float: ...
    @property
    def moving(self) -> float:
        """Share of the samples in motion, 0 to 1."""

class FilterChoice:
    """What a filter did: inverse_dynamics_evaluation/accelerations.hpp."""

    @property
    def method(self) -> str: ...
    @property
    def cutoff(self) -> float: ...
    @property
    def chosen(self) -> bool: ...
    @property
    def choice(self) -> CutoffChoice: ...
    @property
    def order(self) -> int: ...
    @property
    def sampling_frequency(self) -> float: ...
    @property
    def time_base(self) -> str: ...
    @property
    def pieces(self) -> int: ...

class RecordedJoints:
    """Joint states over time: joint_log.hpp. (N, n) arrays are views of its memory."""

    @property
    def joint_names(self) -> list[str]: ...
    @property
    def header_stamps(self) -> Integers:
        """(N,) ns."""

    @property
    def receive_stamps(self) -> Integers:
        """(N,) ns."""

    @property
    def q(self) -> Floats: ...
    @property
    def qd(self) -> Floats: ...
    @property
    def effort(self) -> Floats: ...
    @property
    def frame_id(self) -> str: ...
    @property
    def clock(self) -> Literal["header", "receive"]:
        """Which of the stamps is the time."""

    @property
    def notes(self) -> list[str]:
        """What was left out or assumed."""

class Connection:
    """What a recording states about the messages of a publisher."""

    @property
    def topic(self) -> str: ...
    @property
    def message_type(self) -> str: ...
    @property
    def message_count(self) -> int: ...
    @property
    def serialization(self) -> str: ...
    @property
    def qos_profiles(self) -> str:
        """YAML; empty where there are none."""

    @property
    def definition(self) -> str:
        """Of the type; empty where the recording doesn't hold it."""

    @property
    def definition_hash(self) -> str: ...

class Messages:
    """Serialized messages, thousands at a time: indices of connections, times [ns], bytes."""

    def __iter__(self) -> Messages: ...
    def __next__(self) -> tuple[list[int], list[int], list[bytes]]: ...

class JointStates:
    """Joint states of a topic, in blocks of messages that have the same names, frame and lengths.

    A block: names, frame, header and receive stamps (N,) [ns], position, velocity, effort, one row
    per message. A JointLogBuilder takes them too.
    """

    @property
    def expected_messages(self) -> int:
        """How many messages there are by the recording's own account."""

    def __iter__(self) -> JointStates: ...
    def __next__(
        self,
    ) -> tuple[tuple[str, ...], str, Integers, Integers, Floats, Floats, Floats]: ...

class Recording:
    """A rosbag2 recording: inverse_dynamics_recordings/recording.hpp. Errors are BagError.

    path: directory with metadata.yaml, or a .db3 or .mcap file; bytes, as os.fsencode gives.
    """

    def __init__(self, path: str | bytes) -> None: ...
    @property
    def storage(self) -> Literal["sqlite3", "mcap"]: ...
    def topics(self) -> list[tuple[str, str, int]]:
        """By name: name, type, number of messages."""

    def topic_of_type(self, message_type: str, topic: str | bytes = "") -> str:
        """The topic; none given: the only one with messages of the type."""

    def expected_messages(self, topic: str | bytes) -> int:
        """How many messages a topic has by the recording's own account."""

    def connections(self) -> list[Connection]:
        """In the order of the recording, with definitions."""

    def messages(self, topic: str | bytes) -> Messages:
        """All messages of a topic; an error where they aren't as many as expected."""

    def all_messages(self) -> Messages:
        """All messages of all topics."""

    def joint_states(self, topic: str | bytes = "") -> JointStates:
        """Of a topic; none given: of the only one with joint states."""

class JointStateWriter:
    """A new recording: inverse_dynamics_recordings/joint_state_writer.hpp. Errors are BagError.

    topics: name, joint names and frame of each. It is complete after finish() only.
    """

    def __init__(
        self,
        path: str | bytes,
        storage: Literal["sqlite3", "mcap"],
        topics: Sequence[tuple[str, Sequence[str], str]],
    ) -> None: ...
    def write(self, rows: Sequence[tuple[Integers, Integers, Floats, Floats, Floats]]) -> None:
        """Append messages, per topic: header and receive stamps (N,) [ns]; position, velocity, effort (N, n)."""

    def finish(self) -> None:
        """Write indexes and metadata."""

def write_torques(
    path_and_storage: tuple[str | bytes, Literal["sqlite3", "mcap"]],
    topic: tuple[str, Sequence[str], str],
    computed: tuple[Integers, Integers, Floats, Floats, Floats],
    measured: Floats,
    progress: Callable[[float], None],
) -> None: ...

class JointLogBuilder:
    """Collects messages, one row each, by the rules of joint_log.hpp.

    states: name file and topic in error texts. joints: names in the order wanted; none: those of
    the first message. Errors are BagError.
    """

    def __init__(self, states: JointStates, joints: Sequence[str]) -> None: ...
    @property
    def messages(self) -> int:
        """How many were added."""

    def add_next(self, states: JointStates) -> bool:
        """Add the next messages of a recording; whether there were any."""

    def finish(self, clock: Literal["auto", "header", "receive"]) -> RecordedJoints:
        """Everything added, whose memory the builder gives away: it holds no message then."""

class JointMetrics:
    """Errors of one joint: inverse_dynamics_evaluation/metrics.hpp."""

    @property
    def count(self) -> int: ...
    @property
    def mae(self) -> float: ...
    @property
    def rmse(self) -> float: ...
    @property
    def nrmse(self) -> float: ...
    @property
    def bias(self) -> float: ...
    @property
    def r2(self) -> float: ...
    @property
    def max_abs(self) -> float: ...
    @property
    def max_at(self) -> int: ...
    @property
    def measured_range(self) -> float: ...

def examine_samples(
    time: ArrayLike, q: ArrayLike, qd: ArrayLike, effort: ArrayLike, rules: SampleRules = ...
) -> SampleReport: ...
def backward_difference(time: ArrayLike, qd: ArrayLike) -> Floats: ...
def low_pass_accelerations(
    time: ArrayLike,
    q: ArrayLike,
    qd: ArrayLike,
    effort: ArrayLike,
    cutoff: float = 0.0,
    rules: SampleRules = ...,
) -> tuple[Floats, FilterChoice, SampleReport]: ...
def low_pass(
    samples: ArrayLike,
    sampling_frequency: float,
    cutoff: float,
    order: int = 2,
    padding: int = -1,
) -> Floats: ...
def low_pass_derivative(
    samples: ArrayLike, sampling_frequency: float, cutoff: float, order: int = 2
) -> Floats: ...
def sample_findings(
    clock: str,
    samples: SampleReport,
    filter: FilterChoice | None = None,
) -> list[str]: ...
def low_pass_gain(
    frequency: float, cutoff: float, sampling_frequency: float, order: int = 2
) -> float: ...
def metrics(
    computed: ArrayLike, measured: ArrayLike, mask: Mask | None = None
) -> list[JointMetrics]: ...

class EffortCandidate:
    """A meaning of efforts: inverse_dynamics_evaluation/effort_verdict.hpp."""

    def __init__(self, meaning: str, error: float, margin: float, worse_in: int) -> None: ...
    @property
    def meaning(self) -> str: ...
    @property
    def error(self) -> float: ...
    @property
    def margin(self) -> float: ...
    @property
    def worse_in(self) -> int: ...

class EffortVerdict:
    """Candidates, the best first: inverse_dynamics_evaluation/effort_verdict.hpp."""

    def __init__(
        self, candidates: list[EffortCandidate], sure: bool, stretches: int, reason: str = ""
    ) -> None: ...
    @property
    def candidates(self) -> list[EffortCandidate]: ...
    @property
    def sure(self) -> bool: ...
    @property
    def stretches(self) -> int: ...
    @property
    def reason(self) -> str: ...
    @property
    def rivals(self) -> list[str]: ...
    @property
    def summary(self) -> str: ...

class EffortOptions:
    """What is stated of efforts: inverse_dynamics_evaluation/effort.hpp. Made by effort_options()."""

class Evaluated:
    """What came of evaluate(): inverse_dynamics_evaluation/evaluator.hpp."""

    @property
    def method(self) -> str: ...
    @property
    def filter(self) -> FilterChoice: ...
    @property
    def period(self) -> float: ...
    @property
    def jitter(self) -> float: ...
    @property
    def recording(self) -> RecordedJoints: ...
    @property
    def meaning(self) -> str: ...
    @property
    def stated_by(self) -> str: ...
    @property
    def drive_gains(self) -> list[float]: ...
    @property
    def verdict(self) -> EffortVerdict | None: ...
    @property
    def errors(self) -> list[JointMetrics]: ...
    @property
    def errors_of_kept(self) -> list[JointMetrics]: ...
    @property
    def reading_seconds(self) -> float: ...
    @property
    def acceleration_seconds(self) -> float: ...
    @property
    def torque_seconds(self) -> float: ...
    @property
    def series(self) -> dict[str, NDArray[Any]]: ...
    @property
    def notes(self) -> list[str]: ...

def compare_meanings(
    computed: ArrayLike,
    gravity: ArrayLike,
    effort: ArrayLike,
    drive_gains: list[float] = ...,
    mask: Mask | None = None,
) -> EffortVerdict: ...
def effort_summary(
    meaning: str, stated_by: str, drive_gains: list[float], verdict: EffortVerdict | None
) -> str: ...

class EvaluationOptions:
    """How evaluate() is to work, by keyword: the options of evaluator.hpp."""

    def __init__(self, **kwargs: Any) -> None: ...
    @property
    def method(self) -> str: ...
    @property
    def cutoff(self) -> float: ...
    @property
    def without_rules(self) -> list[str]: ...
    @property
    def effort(self) -> EffortOptions: ...
    @property
    def recording(self) -> str: ...
    @property
    def topic(self) -> str: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def clock(self) -> str: ...
    @property
    def window(self) -> tuple[float, float]: ...
    @property
    def scratch(self) -> bytes: ...

def evaluate(
    solver: Solver,
    motion: JointLog | JointStates,
    options: EvaluationOptions,
    progress: Callable[[float], None],
) -> Evaluated: ...
def check_options(
    method: str, cutoff: float | None, without_rules: list[str], effort_is: str | None
) -> None: ...
def acceleration_summary(method: str, cutoff: float | None, chosen: bool) -> str: ...
def check_torques(
    where: str, joint_names: list[str], units: list[str], computed: ArrayLike
) -> None: ...

class Status(Enum):
    """How an update ended: inverse_dynamics_control/status.hpp."""

    OK = ...
    SATURATED = ...
    RATE_LIMITED = ...
    REFERENCE_NOT_FINITE = ...
    STATE_NOT_FINITE = ...
    TORQUE_NOT_FINITE = ...
    SOLVER_FAILED = ...
    WRONG_SIZE = ...

    @property
    def text(self) -> str: ...
    @property
    def is_refusal(self) -> bool: ...

class FrictionSource(Enum):
    """Whose velocity decides about friction: friction_compensation.hpp."""

    NONE = ...
    REFERENCE_VELOCITY = ...
    MEASURED_VELOCITY = ...

class ModelState(Enum):
    """Where a feed-forward takes H, C and g: feed_forward.hpp."""

    REFERENCE = ...
    MEASURED = ...

class Compensated:
    """What the robot adds by itself."""

    def __init__(
        self, *, gravity: bool = False, coriolis: bool = False, friction: bool = False
    ) -> None: ...

class FrictionOptions:
    """How friction is compensated: friction_compensation.hpp."""

    def __init__(
        self,
        source: FrictionSource = ...,
        *,
        dead_band: float = 0.0,
        blend: float = 0.05,
        scale: float = 1.0,
    ) -> None: ...

class LawOptions:
    """Options of every law: control_law.hpp. effort_limit, damping, rate_limit: (n,)."""

    def __init__(
        self,
        *,
        effort_limit: ArrayLike,
        damping: ArrayLike,
        rate_limit: ArrayLike = ...,
        compensated: Compensated = ...,
        friction: FrictionOptions = ...,
    ) -> None: ...

class Gains:
    """Gains of computed torque, (n,) each: 1/s^2, 1/s."""

    def __init__(self, Kp: ArrayLike, Kd: ArrayLike) -> None: ...
    @staticmethod
    def of(natural_frequency: ArrayLike, damping_ratio: ArrayLike) -> Gains: ...
    @property
    def Kp(self) -> Floats: ...
    @property
    def Kd(self) -> Floats: ...

class PdGains:
    """Gains of a PD law, (n,) each: N m/rad, N m s/rad."""

    def __init__(self, Kp: ArrayLike, Kd: ArrayLike) -> None: ...
    @property
    def Kp(self) -> Floats: ...
    @property
    def Kd(self) -> Floats: ...

def damping_for(solver: Solver, q: ArrayLike, rate: float, period: float) -> Floats: ...

class ControlLaw:
    """What all laws share: control_law.hpp."""

    def start(self, effort: ArrayLike | None = None) -> None: ...
    def hold(self, q: ArrayLike, qd: ArrayLike, period: float) -> tuple[Floats, Status]: ...
    @property
    def saturated(self) -> Mask: ...
    @property
    def rate_limited(self) -> Mask: ...

class ComputedTorque(ControlLaw):
    """tau = H(q) (qdd_ref + Kp e + Kd ed) + C(q, qd) qd + g(q) + f."""

    def __init__(self, solver: Solver, gains: Gains, options: LawOptions) -> None: ...
    def update(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        q_reference: ArrayLike,
        qd_reference: ArrayLike,
        qdd_reference: ArrayLike,
        period: float,
    ) -> tuple[Floats, Status]: ...
    def set_gains(self, gains: Gains) -> None: ...

class PdGravityCompensation(ControlLaw):
    """tau = g(q) + Kp e + Kd ed + f."""

    def __init__(self, solver: Solver, gains: PdGains, options: LawOptions) -> None: ...
    def update(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        q_reference: ArrayLike,
        qd_reference: ArrayLike,
        period: float,
    ) -> tuple[Floats, Status]: ...
    def set_gains(self, gains: PdGains) -> None: ...

class GravityCompensation(ControlLaw):
    """tau = g(q) - damping qd + f."""

    def __init__(self, solver: Solver, options: LawOptions) -> None: ...
    def update(
        self, q: ArrayLike, qd: ArrayLike, period: float, qd_reference: ArrayLike | None = None
    ) -> tuple[Floats, Status]: ...

class FeedForward(ControlLaw):
    """tau = effort + H qdd_ref + C qd + g + f."""

    def __init__(
        self, solver: Solver, options: LawOptions, at: ModelState = ModelState.REFERENCE
    ) -> None: ...
    def update(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        q_reference: ArrayLike,
        qd_reference: ArrayLike,
        qdd_reference: ArrayLike,
        effort: ArrayLike,
        period: float,
    ) -> tuple[Floats, Status]: ...

class EstimateStatus(Enum):
    """How an update of an estimator ended; unless it is OK, the torques are zero."""

    OK = 0
    STARTING = 1
    GAP = 2
    STATE_NOT_FINITE = 3
    EFFORT_NOT_FINITE = 4
    MODEL_NOT_FINITE = 5
    SOLVER_FAILED = 6
    WRONG_SIZE = 7

    @property
    def text(self) -> str:
        """What happened, in words."""

class VelocitySource(Enum):
    """Where velocities come from."""

    POSITIONS = 0
    MEASURED = 1

class EstimatorOptions:
    """gain: 1/s, (n,); tracking: rad/s; friction_band: N m, (n,) or empty; longest_period: s."""

    def __init__(
        self,
        gain: ArrayLike,
        *,
        velocity: VelocitySource = VelocitySource.POSITIONS,
        tracking: float = 200.0,
        compensated: Compensated = ...,
        friction_band: ArrayLike = (),
        longest_period: float = 0.02,
    ) -> None: ...

class ExternalTorqueEstimator:
    """External torques of each joint, N m: external_torque_estimator.hpp."""

    def update(
        self, q: ArrayLike, effort: ArrayLike, period: float, qd: ArrayLike | None = None
    ) -> tuple[Floats, EstimateStatus]: ...
    def run(
        self, time: ArrayLike, q: ArrayLike, effort: ArrayLike, qd: ArrayLike | None = None
    ) -> tuple[Floats, Mask]:
        """(N, n) torques and (N,) whether they are estimates, of N samples."""

    def reset(self) -> None: ...
    @property
    def torques(self) -> Floats: ...

class MomentumObserver(ExternalTorqueEstimator):
    """From the generalised momentum H(q) qd: momentum_observer.hpp."""

    def __init__(self, solver: Solver, options: EstimatorOptions) -> None: ...

class AccelerationResidual(ExternalTorqueEstimator):
    """Measured minus computed torques, low-passed: acceleration_residual.hpp."""

    def __init__(self, solver: Solver, options: EstimatorOptions) -> None: ...

class ContactThresholds:
    """Thresholds (n,), and how they came about: contact_thresholds.hpp."""

    @property
    def torques(self) -> Floats: ...
    @property
    def noise(self) -> Floats: ...
    @property
    def correlation_time(self) -> Floats: ...
    @property
    def peaks(self) -> Floats: ...
    @property
    def level(self) -> Floats: ...
    @property
    def scale(self) -> Floats: ...
    @property
    def shape(self) -> Floats: ...
    @property
    def false_alarms_per_hour(self) -> float: ...

def contact_thresholds(
    quiet: ArrayLike, period: float, false_alarms_per_hour: float, joint_names: Sequence[str]
) -> ContactThresholds:
    """From external torques (N, n) without contact, period [s] apart, all of them estimates."""

class ContactDetector:
    """Compares external torques with thresholds: contact_detector.hpp."""

    def __init__(
        self,
        thresholds: ArrayLike,
        joint_names: Sequence[str],
        *,
        release_share: float = 0.5,
        release_time: float = 0.1,
    ) -> None: ...
    def update(self, torques: ArrayLike, period: float) -> bool: ...
    def run(self, time: ArrayLike, torques: ArrayLike, valid: ArrayLike | None = None) -> Mask:
        """(N,) whether something touches the robot. valid: (N,) samples that are looked at; None: all."""

    def reset(self) -> None: ...
    @property
    def contact(self) -> bool: ...
    @property
    def joint(self) -> int: ...
    @property
    def excess(self) -> float: ...

class WrenchStatus(Enum):
    """How an update of a wrench ended; unless it is OK, the wrench is zero."""

    OK = 0
    NOT_FINITE = 1
    SOLVER_FAILED = 2
    WRONG_SIZE = 3

    @property
    def text(self) -> str:
        """What happened, in words."""

class TipWrench:
    """Wrench at the tip from external torques: tip_wrench.hpp.

    What the tip exerts on its surroundings: force [N], torque [N m] about the tip's origin, in the
    axes of the root. noise: (n,) N m.
    """

    def __init__(
        self, solver: Solver, noise: ArrayLike, *, force: float = 100.0, torque: float = 10.0
    ) -> None: ...
    def update(self, q: ArrayLike, torques: ArrayLike) -> tuple[Floats, WrenchStatus]: ...
    def run(self, q: ArrayLike, torques: ArrayLike) -> tuple[Floats, Integers]:
        """(N, 6) forces and torques, (N,) how many directions can't be seen, of N samples."""

    @property
    def signal_to_noise(self) -> Floats:
        """(6,) the greatest first."""

    @property
    def directions(self) -> Floats:
        """(6, 6) whose columns they belong to: N, N m."""

    @property
    def unseen(self) -> int:
        """How many of them, the last ones, are below the noise."""

class SafeStop:
    """Ramps references to a standstill: safe_stop.hpp."""

    def __init__(self, deceleration: ArrayLike, joint_names: Sequence[str]) -> None: ...
    def begin(self, q: ArrayLike, qd: ArrayLike) -> Status: ...
    def advance(self, period: float) -> tuple[Floats, Floats, Floats]: ...
    @property
    def finished(self) -> bool: ...
    @property
    def duration(self) -> float: ...

class YamlValue:
    """A value of a YAML file and where it stands: chain_dynamics/located_yaml.hpp.

    What isn't as asked for is raised with the error class that the file was read with.
    """

    @property
    def where(self) -> str:
        """`file:line: key`, as errors begin."""

    @property
    def is_list(self) -> bool: ...
    @property
    def is_mapping(self) -> bool: ...
    def fail(self, expected: str, remedy: str = "") -> NoReturn:
        """Raise the error that says what was expected here."""

    def scalar(self) -> bool | int | float | str:
        """A text, a finite number, an integer, true or false: what it looks like."""

    def text(self, one_of: Sequence[str] = ()) -> str:
        """A text; one of these, if any are given."""

    def number(self) -> float:
        """A finite number."""

    def integer(self) -> int:
        """An integer of 64 bits."""

    def truth(self) -> bool:
        """True or false."""

    def entries(self, length: int | None = None) -> list[YamlValue]:
        """A list; of this length, if one is given."""

    def mapping(self) -> YamlMap:
        """Keys with values."""

class YamlMap:
    """Keys with values, and which of them have been asked for."""

    def required(self, key: str) -> YamlValue:
        """The value of a key that must be there."""

    def optional(self, key: str) -> YamlValue | None:
        """The value of a key, or None if it is absent or null."""

    def reject_others(self) -> None:
        """Raise the error for a key that hasn't been read."""

def read_yaml(path: bytes | str, error: type[UserError]) -> YamlValue:
    """The value that a YAML file is. error: what is raised, now and by the value."""

def parse_yaml(text: bytes | str, file: str, error: type[UserError]) -> YamlValue:
    """The value that a text of YAML is. file: what errors call it."""

def robot_names() -> list[str]:
    """Names of the run configurations that the sourced workspaces bring."""

def read_robot(name_or_file: bytes | str) -> dict[str, Any]:
    """Fields of the Robot of that name, or of that file."""

def change_robot(robot: Robot, changes: dict[str, Any]) -> dict[str, Any]:
    """Fields of a Robot with changes, by the names of its fields."""

def recorded_names(robot: Robot, joint_names: Sequence[str]) -> list[str]:
    """Names in a recording of the solver's joints, in the order of the chain."""

def effort_options(
    robot: Robot, solver: Solver, option: str | None = None, format: str = ""
) -> EffortOptions:
    """What is stated of efforts: by a Robot, the user, the recording's format."""

def solver_parameters(mapping: YamlMap) -> dict[str, Parameter]:
    """Parameters of a solver as YAML has them; dotted name to value."""

def package_share(package: str) -> Path:
    """Directory `share/PACKAGE` of an installed package."""

def resolved_path(path: str, directory: Path) -> Path:
    """File that a path in a configuration names; relative ones begin in the directory."""

class ResidualNoise:
    """Noise of the torques of n joints: white, and correlated in time."""

    def __init__(
        self, white: ArrayLike, correlated: ArrayLike, correlation_time: float = ...
    ) -> None:
        """(n,) standard deviations, N m; s."""

    @property
    def white(self) -> Floats:
        """(n,) N m."""

    @property
    def correlated(self) -> Floats:
        """(n,) N m."""

    @property
    def correlation_time(self) -> float:
        """In s."""

def residual_noise(
    time: ArrayLike, residuals: ArrayLike, *, correlation_time: float = ...
) -> ResidualNoise:
    """Noise of measured minus computed torques (N, n) [N m], at times (N,) [s]."""

class ArmUncertainty:
    """What the identified model of an arm may be wrong by: inverse_dynamics_identification/arm_uncertainty.hpp."""

    def __init__(self, friction: Sequence[Mapping[str, float]], factor: ArrayLike) -> None:
        """friction: figures of smooth_coulomb of each of n joints, by the keys of the model file.

        factor: (m, K), the covariance of the m unknowns is factor factor'.
        """

    def torques(
        self, solver: Solver, z: ArrayLike, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike
    ) -> Floats:
        """Of deviations z (K,) at N states (N, n): (N, n) N m."""

class PayloadStatus(Enum):
    """What happened to a sample, or to an estimate."""

    OK = ...
    NOT_LATER = ...
    NOT_FINITE = ...
    TOO_SHORT = ...
    SOLVER_FAILED = ...
    WRONG_SIZE = ...

    @property
    def text(self) -> str:
        """What happened, in words."""

class PayloadEstimate:
    """A body in the tip frame, with the half widths of its 95 % intervals."""

    @property
    def mass(self) -> float:
        """In kg."""

    @property
    def mass_half_width(self) -> float:
        """In kg."""

    @property
    def center_of_mass(self) -> Floats:
        """(3,) m."""

    @property
    def center_of_mass_half_width(self) -> Floats:
        """(3,) m."""

    @property
    def inertia(self) -> Floats:
        """(3, 3) about the center of mass, kg m^2."""

    @property
    def inertia_half_width(self) -> Floats:
        """(3, 3) kg m^2, of what the data alone tell."""

    @property
    def inertia_is_known(self) -> bool:
        """Whether the data tell the inertia."""

    @property
    def offset(self) -> Floats:
        """(n,) N m."""

    @property
    def arm(self) -> Floats:
        """(K,) deviations of the arm from its model, in standard deviations."""

    @property
    def covariance(self) -> Floats:
        """(10, 10) of m, mc, I about the origin of the tip frame."""

    @property
    def blocks(self) -> int:
        """Of time, that the intervals rest on."""

    @property
    def duration(self) -> float:
        """From the first sample to the last, s."""

class PayloadEstimator:
    """Mass, center of mass and inertia of what the tip carries."""

    def __init__(
        self,
        solver: Solver,
        noise: ResidualNoise,
        *,
        offset: ArrayLike | None = None,
        offset_deviation: ArrayLike | None = None,
        carried: dict[str, Any] | None = None,
        arm: ArmUncertainty | None = None,
        extent: float = ...,
        block: float = ...,
        model_error: float = ...,
    ) -> None:
        """offset, offset_deviation: (n,) N m, what is known of the offsets.

        carried: the body among solver.payloads that belongs to the estimate. arm: what its model may be
        wrong by. extent: m; block: s.
        model_error: variance of what the arm's model is wrong by, in units of what the noise gives.
        """

    def update(
        self, time: float, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, measured: ArrayLike
    ) -> PayloadStatus:
        """Add a sample: s, (n,) each."""

    def run(
        self, time: ArrayLike, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, measured: ArrayLike
    ) -> int:
        """Add N samples, (N,) and (N, n); how many were added."""

    def estimate(self) -> tuple[PayloadEstimate, PayloadStatus]:
        """The body that all samples so far tell of."""

    def restart(self) -> None:
        """Forget all samples."""
