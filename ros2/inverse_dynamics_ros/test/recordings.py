# SPDX-License-Identifier: Apache-2.0
"""Recordings and a robot for the tests: a pendulum of 2 kg on a rod of 0.5 m."""

import math
from pathlib import Path

import rosbag2_py
from builtin_interfaces.msg import Duration, Time
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

MASS, LENGTH, GRAVITY = 2.0, 0.5, 9.81
SOLVER = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL"

# Turns about a horizontal axis; hangs down at q = 0. Its own inertia is next to nothing.
PENDULUM = f"""<?xml version="1.0"?>
<robot name="pendulum">
  <link name="base"/>
  <joint name="swing" type="revolute">
    <parent link="base"/> <child link="rod"/> <axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="100" velocity="10"/>
  </joint>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 {-LENGTH}"/> <mass value="{MASS}"/>
      <inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
</robot>
"""


def torque(q, qdd):
    """Torque of the pendulum [N m]."""
    return MASS * LENGTH**2 * qdd + MASS * GRAVITY * LENGTH * math.sin(q)


def motion(t):
    """Position, velocity and acceleration of a sine of 0.25 Hz."""
    w = 0.5 * math.pi
    return math.sin(w * t), w * math.cos(w * t), -w * w * math.sin(w * t)


def stamp(t):
    """A time as a message has it."""
    nanoseconds = round(1e9 * t)
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


def joint_state(t, more_effort=0.0):
    """The pendulum in motion, beside a gripper."""
    q, qd, qdd = motion(t)
    message = JointState()
    message.header.stamp = stamp(t)
    message.header.frame_id = "base"
    message.name = ["gripper", "swing"]
    message.position = [0.1, q]
    message.velocity = [0.2, qd]
    message.effort = [0.3, torque(q, qdd) + more_effort]
    return message


def joint_states(count=1000, begin=1.0):
    """Joint states at 100 Hz, with the time of reception [ns]."""
    times = [begin + 0.01 * k for k in range(count)]
    return [(joint_state(t), round(1e9 * t) + 1000) for t in times]


def trajectory(count=200, effort=True):
    """A trajectory with accelerations, at 50 Hz."""
    message = JointTrajectory()
    message.header.stamp = stamp(5.0)
    message.joint_names = ["swing"]
    for k in range(count):
        q, qd, qdd = motion(0.02 * k)
        point = JointTrajectoryPoint(positions=[q], velocities=[qd], accelerations=[qdd])
        if effort:
            point.effort = [torque(q, qdd) + 0.25]
        point.time_from_start = Duration(sec=20 * k // 1000, nanosec=20 * k % 1000 * 10**6)
        message.points.append(point)
    return message


_TYPES = {
    JointState: "sensor_msgs/msg/JointState",
    JointTrajectory: "trajectory_msgs/msg/JointTrajectory",
    String: "std_msgs/msg/String",
}


def write_bag(path: Path, topics, storage="sqlite3"):
    """Write a recording. topics: name to pairs of message and time of reception [ns]."""
    writer = rosbag2_py.SequentialWriter()
    writer.open(
        rosbag2_py.StorageOptions(uri=str(path), storage_id=storage),
        rosbag2_py.ConverterOptions("cdr", "cdr"),
    )
    for topic, messages in topics.items():
        about = {"name": topic, "type": _TYPES[type(messages[0][0])], "serialization_format": "cdr"}
        try:
            metadata = rosbag2_py.TopicMetadata(**about)
        except TypeError:  # from jazzy on topics have a number
            metadata = rosbag2_py.TopicMetadata(id=0, **about)
        writer.create_topic(metadata)
        for message, received in messages:
            writer.write(topic, serialize_message(message), received)
    del writer  # closes it
    return path


def read_bag(path: Path, kind=JointState, storage=""):
    """Messages and times of reception of a recording, by topic."""
    reader = rosbag2_py.SequentialReader()
    storage = storage or ("mcap" if list(path.glob("*.mcap")) else "sqlite3")
    reader.open(
        rosbag2_py.StorageOptions(uri=str(path), storage_id=storage),
        rosbag2_py.ConverterOptions("cdr", "cdr"),
    )
    topics = {}
    while reader.has_next():
        topic, raw, received = reader.read_next()
        topics.setdefault(topic, []).append((deserialize_message(raw, kind), received))
    return topics


def bits(messages):
    """All that joint states hold, numbers as bytes.

    Not the payload as stored: Fast DDS leaves the bytes that align numbers as they were in memory.
    """
    return [
        (m.header, m.name, *(x.tobytes() for x in (m.position, m.velocity, m.effort)), received)
        for m, received in messages
    ]
