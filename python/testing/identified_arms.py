# SPDX-License-Identifier: Apache-2.0
"""Identifications for tests of files, pages and tables, of a simulated recording.

A UR10 whose links and friction differ from its description, with noise. What was found is the arm itself.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from example_recordings import motion
from example_robots import JOINTS, URDF

from inverse_dynamics import FastModel, load_robot
from inverse_dynamics.evaluation.bands import TorqueBand
from inverse_dynamics.identification.result import (
    Choice,
    Finding,
    HeldOutBlock,
    Identification,
    IdentifiedModel,
    Interval,
    PriorDecided,
)

WIDTH = 0.05  # rad/s, of the step
NOISE = 0.1  # N m


def engine() -> FastModel:
    return FastModel.from_urdf(URDF.read_text(), root="base_link", tip="tool0")


def arm() -> IdentifiedModel:
    """The robot that is recorded: 5 % heavier than its description, and with friction."""
    n = len(JOINTS)
    return _model(1.05 * engine().parameters.reshape(n, 10), np.full(n, 0.3), _friction(n))


def predicted_torques(model: IdentifiedModel, q, qd, qdd) -> np.ndarray:
    """By the regressor, and by the law of friction as it is written."""
    fv, fc, fo = (np.array([law[key] for law in model.friction]) for key in ("fv", "fc", "fo"))
    friction = fv * qd + fo + fc * np.tanh(qd / WIDTH)
    rigid = engine().regressor(q, qd, qdd) @ model.parameters.ravel()
    return rigid + model.rotor_inertia * qdd + friction


def simulated_torques(q, qd, qdd, seed: int = 0) -> np.ndarray:
    """Measured torques of the arm."""
    noise = NOISE * np.random.default_rng(seed).standard_normal(q.shape)
    return predicted_torques(arm(), q, qd, qdd) + noise


def identification(recording: Path = Path("recording"), **changes: object) -> Identification:
    """The arm, as found in five blocks; `changes` replace fields."""
    robot = load_robot("ur10_simulated")
    q, qd, qdd, stamps = motion()
    measured = simulated_torques(q, qd, qdd)
    model = arm()
    blocks = [
        _block(recording, model, q, qd, qdd, stamps, measured, part)
        for part in np.array_split(np.arange(len(q)), 5)
    ]
    residual = {
        column: np.concatenate([block.computed[column] - block.measured for block in blocks])
        for column in blocks[0].computed
    }
    inside = np.concatenate([abs(b.computed["identified"] - b.measured) <= b.band for b in blocks])
    factor = 1e-3 * np.eye(16 * len(JOINTS))[:, :3]
    fields = {
        "robot": robot,
        "recordings": (recording,),
        "joints": JOINTS,
        "units": ("N m",) * len(JOINTS),
        "links": tuple(name.replace("_joint", "_link") for name in JOINTS),
        "model": model,
        "prior": engine().parameters.reshape(-1, 10),
        "law": "step",
        "prior_strength": 10.0,
        "delay": 0.004,
        "cutoff": 8.0,
        "filter": "low-pass 8 Hz",
        "effort": "torque",
        "samples": len(q),
        "duration": float(stamps[-1] - stamps[0]) * 1e-9,
        "held_out": {c: np.sqrt((error**2).mean(axis=0)) for c, error in residual.items()},
        "coverage": inside.mean(axis=0),
        "blocks": tuple(blocks),
        "noise": np.sqrt((residual["identified"] ** 2).mean(axis=0)),
        "independent": np.full(len(JOINTS), float(len(q))),
        "choices": (
            Choice("step", 10.0, 0.004, 1.02, 0.01, chosen=True),
            Choice("load", 10.0, 0.004, 1.01, 0.0, chosen=False),
        ),
        "intervals": (Interval("elbow_joint fc", "N m", 3.0, 0.1, "elbow_joint"),),
        "prior_decided": (PriorDecided("forearm_link", "m", 17.1, 17.4, 0.02),),
        "factor": factor,
        "band": TorqueBand(
            factor=factor,
            friction=model.friction,
            noise=np.full(len(JOINTS), NOISE),
            level=np.full(len(JOINTS), 0.5),
            share=np.full(len(JOINTS), 0.1),
            seen=np.abs(qd).max(axis=0),
        ),
        "levels": (),
        "findings": (Finding("prior", "masses of single links are the description's"),),
        "notes": ("3 samples repeat an earlier one",),
    }
    return Identification(**{**fields, **changes})


def _friction(n: int) -> tuple[dict[str, float], ...]:
    return tuple(
        {"fv": 10.0 / (j + 1), "fc": 6.0 / (j + 1), "width": WIDTH, "fo": 0.2} for j in range(n)
    )


def _model(parameters, rotor, friction) -> IdentifiedModel:
    q, qd, qdd, _ = motion()
    seen = np.array([[values.min(axis=0), values.max(axis=0)] for values in (q, qd, qdd)])
    return IdentifiedModel(
        parameters=parameters,
        rotor_inertia=rotor,
        friction=friction,
        drive_gains=None,
        torque_deviation=np.full(len(rotor), 1.96 * NOISE),
        seen=np.moveaxis(seen, 1, 2),
    )


def _block(recording, model, q, qd, qdd, stamps, measured, part) -> HeldOutBlock:
    states = q[part], qd[part], qdd[part]
    return HeldOutBlock(
        recording=recording.name,
        time=(stamps[part] - stamps[0]) * 1e-9,
        q=q[part],
        qd=qd[part],
        counts=np.full(len(q[part]), True),
        measured=measured[part],
        computed={
            "urdf": engine().regressor(*states) @ engine().parameters,
            "identified": predicted_torques(model, *states),
        },
        band=np.full(q[part].shape, 1.96 * NOISE),
        law="step",
        prior_strength=10.0,
        delay=0.004,
    )
