# SPDX-License-Identifier: Apache-2.0
"""Names of solvers, and robots that many tests compute with; simulated_arms.py makes more."""

from __future__ import annotations

from inverse_dynamics.installation.ament import package_share

UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"
RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
KDL = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL"
PINOCCHIO = "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio"
FRANKA = "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria"
URDF = package_share("inverse_dynamics_robots") / "urdf" / "ur10.urdf"

JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)

# 2 kg whose center of mass is 0.5 m below a horizontal axis.
PENDULUM = """
<robot name="pendulum">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="swing" type="continuous"><parent link="base"/><child link="arm"/>
    <axis xyz="0 1 0"/></joint>
</robot>"""

# A model of that robot whose friction is presliding alone: 2 N m that turn round over 0.01 rad.
PRESLIDING = """
schema: 2
name: pendulum
source: worked by hand
validity: a test
units: SI
geometry: placements
gravity: [0, 0, -9.81]
parameters: about_center_of_mass
joints:
  - name: swing
    type: revolute
    placement: {xyz: [0, 0, 0], rpy: [0, 0, 0], axis: [0, 1, 0]}
    friction: {law: smooth_coulomb, fv: 0, fc: 0, width: 0.001, fm: 2, distance: 0.01}
    link: [2, 0, 0, -0.5, 0.1, 0, 0, 0.1, 0, 0.1]
"""
