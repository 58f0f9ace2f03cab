# SPDX-License-Identifier: Apache-2.0
"""What tables and figures call the libraries, quantities and robots of a measurement."""

LIBRARIES = {"ours": "this library", "pinocchio": "Pinocchio", "kdl": "KDL", "mujoco": "MuJoCo"}
"""Those that are compared."""

QUANTITIES = {
    "torques": "torques",
    "inertia": "H",
    "coriolis": "Coriolis",
    "gravity": "gravity",
    "components": "H, C qd, g",
    "friction": "friction",
    "torques_fixed": "torques of a solver without payloads",
    "torques_payload": "torques with a payload",
    "set_payload": "setting a payload",
    "set_gravity": "setting gravity",
}
"""What solvers compute."""

ENGINE = {
    "derivatives": "derivatives of the torques",
    "forward_dynamics": "forward dynamics",
    "regressor": "regressor",
    "coriolis_matrix": "C",
    "tip_jacobian": "Jacobian of the tip",
}
"""What the engine computes besides."""

OBSERVERS = {
    "momentum_observer": "momentum observer",
    "acceleration_residual": "residual of inverse dynamics",
}
"""Estimators of external torques."""

ENGINE_BATCHES = {**ENGINE, "gram": "Gram matrices of the regressor"}
"""The same of many states."""

ROBOTS = {
    "ur10": "UR10",
    "panda": "Panda",
    "mixed6": "6 joints, 2 slide",
    "mixed7": "7 joints, 2 slide",
    "turning6": "6 joints, all turn",
    "turning7": "7 joints, all turn",
    "two_pandas": "two Pandas on a torso",
    "ur10_identified": "UR10, identified",
    "panda_identified": "Panda, identified",
    "panda_feasible": "Panda, identified as bodies that can exist",
}
"""Arms, and chains that are generated."""

REAL = ("ur10", "panda")
CHAINS = tuple(f"mixed{n}" for n in (1, 2, 3, 6, 7, 10, 15, 20, 30))
"""Robots that the figure shows."""


def in_words(name: str) -> str:
    """A robot or a quantity, as tables have it."""
    quantity = name.removesuffix("_batch")
    words = {**ROBOTS, **QUANTITIES, **ENGINE_BATCHES, **OBSERVERS}.get(quantity, quantity)
    return words if quantity == name else f"{words}, batch"
