# SPDX-License-Identifier: Apache-2.0
"""Parameters of solvers: wrong names, types, values; in Python and C++."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

from entry_points import FRANKA, KDL, PINOCCHIO, RIGID_BODY, UR10, cpp, installed, python
from outcome import Case, Expected
from urdf_cases import ARM, TIP

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_WITH_URDF = installed(RIGID_BODY, KDL, PINOCCHIO)
_WITH_MODEL = (UR10, FRANKA)

# Parameter and value that every solver refuses.
_WRONG: dict[str, tuple[str, Any]] = {
    "gravity of two numbers": ("gravity", [0.0, -9.81]),
    "gravity as a text": ("gravity", "down"),
    "gravity as a number": ("gravity", -9.81),
    "friction as a text": ("friction", "no"),
    "friction as a number": ("friction", 0),
    "no threads": ("batch_threads", 0),
    "negative threads": ("batch_threads", -1),
    "a million threads": ("batch_threads", 10**6),
    "threads as a text": ("batch_threads", "many"),
    "half a thread": ("batch_threads", 1.5),
}
_WRONG_WITH_URDF: dict[str, tuple[str, Any]] = {
    "unknown tip": ("tip", "tol"),
    "tip as a number": ("tip", 3),
    "unknown root": ("root", "bas"),
    "unknown attached": ("attached", "lumped"),
    "allow_massless as a text": ("allow_massless", "yes"),
    "a locked joint as a text": ("locked_joints.grip", "open"),
    "urdf_friction as a text": ("urdf_friction", "yes"),
    "rotor_inertia as a text": ("rotor_inertia", "yes"),
    "a rotor's inertia below zero": ("rotor_inertia.elbow", -0.1),
}
# What would have no effect, so it is refused or there is a warning.
_WITHOUT_EFFECT_WITH_MODEL: dict[str, tuple[str, Any]] = {
    "root": ("root", "base_link"),
    "tip": ("tip", "tool0"),
    "attached": ("attached", "ignore"),
    "a locked joint": ("locked_joints.finger", 0.5),
    "allow_massless": ("allow_massless", True),
    "urdf_friction": ("urdf_friction", True),
    "rotor_inertia": ("rotor_inertia", True),
    "a rotor's inertia": ("rotor_inertia.elbow", 0.1),
}
_WITHOUT_EFFECT: dict[str, tuple[str, Any]] = {
    "an unknown name": ("dampng", 1.0),
    "a known name with a typo": ("gravty", [0.0, 0.0, 0.0]),
    "threads with a typo": ("batch_thread", 2),
}


def cases(directory: Path) -> Iterator[Case]:
    """Each value for each solver it is wrong for."""
    urdf = directory / "arm.urdf"
    urdf.write_text(ARM)
    for plugin in (*_WITH_URDF, *_WITH_MODEL):
        description = ARM if plugin in _WITH_URDF else ""
        file = str(urdf) if plugin in _WITH_URDF else ""
        package = plugin.split("/")[0]
        for name, (key, value) in _all_for(plugin).items():
            without_effect = (key, value) not in {**_WRONG, **_WRONG_WITH_URDF}.values()
            expected = Expected(place=key, warned=without_effect, mention=key)
            given: dict[str, Any] = {key: value}
            if plugin in _WITH_URDF and key != "tip":
                given["tip"] = TIP
            act = partial(_python, plugin, description, given)
            yield Case(f"{name} [Python, {package}]", act, expected)
            act = partial(cpp, plugin, file, json.dumps(given))
            yield Case(f"{name} [C++, {package}]", act, expected)
    on_path = {"locked_joints.elbow": 0.5, "tip": TIP}
    expected = Expected(place="elbow", warned=True, mention="elbow")
    for plugin in _WITH_URDF:
        act = partial(_python, plugin, ARM, on_path)
        yield Case(f"a joint on the path is locked [Python, {plugin}]", act, expected)
    payload = Expected(place="tool", warned=True, mention="tool|payload|description")
    act = partial(python, UR10, urdf=ARM)
    yield Case("a description for an identified model [Python]", act, payload)
    yield from _nothing_given()


def _all_for(plugin: str) -> dict[str, tuple[str, Any]]:
    own = _WRONG_WITH_URDF if plugin in _WITH_URDF else _WITHOUT_EFFECT_WITH_MODEL
    return {**_WRONG, **own, **_WITHOUT_EFFECT}


def _python(plugin: str, urdf: str, parameters: dict[str, Any]) -> Any:
    """Through the arguments where there is one of that name, else through `parameters`."""
    own = {"root", "tip", "attached", "model"}
    arguments = {
        key: value for key, value in parameters.items() if key in own and isinstance(value, str)
    }
    others = {key: value for key, value in parameters.items() if key not in arguments}
    return python(plugin, urdf=urdf, **arguments, parameters=others)


def _nothing_given() -> Iterator[Case]:
    for plugin in _WITH_URDF:
        expected = Expected(place="robot.description")
        yield Case(f"no description [Python, {plugin}]", partial(python, plugin), expected)
        yield Case(f"no description [C++, {plugin}]", partial(cpp, plugin), expected)
    for name in ("", "x", "a/b", RIGID_BODY + "x", "x" * 10**5, "\x1b[31m/x", "../x"):
        expected = Expected(place="plugin")
        yield Case(f"plugin {name[:20]!r} [Python]", partial(python, name), expected)
        yield Case(f"plugin {name[:20]!r} [C++]", partial(cpp, name), expected)
