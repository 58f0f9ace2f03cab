# SPDX-License-Identifier: Apache-2.0
"""What the words in a column's name say: quantity, unit, nothing.

words_of("Joint1_Pos [deg]")               # ("joint", "1", "pos", "deg")
quantity_of(("joint", "*", "pos", "deg"))  # "position"
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

TIME, POSITION, VELOCITY, ACCELERATION = "time", "position", "velocity", "acceleration"
EFFORT, CURRENT = "effort", "current"
QUANTITIES = (POSITION, VELOCITY, ACCELERATION, EFFORT, CURRENT)

# Words that say a quantity. Those of the second row do so only beside no word of the first row:
# `current_q_0` and `state_tau_0` are a position and an effort.
_WORDS = {
    POSITION: "position positions pos q angle angles theta jpos qpos",
    VELOCITY: "velocity velocities vel qd dq qdot speed speeds omega jvel qvel",
    ACCELERATION: "acceleration accelerations acc accel qdd ddq qddot qacc",
    EFFORT: "effort efforts eff torque torques torq tau trq moment moments qfrc",
}
_WEAK_WORDS = {
    CURRENT: "current currents cur curr i iq amps ampere amperes",
    POSITION: "state ang",
    VELOCITY: "v",
    ACCELERATION: "a",
}
# The first ones are preferred.
_TIME = (
    "time t timestamp timestamps stamp stamps ts secs seconds sec duration tout millis micros zeit"
)
TIME_WORDS = (*_TIME.split(),)
# Beside these words a quantity stays what it is: a name that has fewer others is preferred.
_NEUTRAL_WORDS = (
    "actual act measured meas msrd joint joints jnt j axis a state states robot arm field data observation header "
    "cont abs rec real elapsed sim sample relative from start fb feedback present actuator actuators dof tv"
)
NEUTRAL = frozenset(_NEUTRAL_WORDS.split())
# Not what the arm did, or not what its motors did.
_PASSED_OVER = (
    "target desired des ref reference cmd command commanded goal setpoint planned action ext extn external error err "
    "limit limits max min std temperature temp tcp ee cartesian cart tool wrench model predicted"
)
_OTHER = frozenset(_PASSED_OVER.split())
# Where there is `q` too, `theta` is the motor's position, and `ang` another angle.
_LESS_SURE = frozenset({"theta", "ang"})

# Factors to SI units.
UNITS = {
    **{"deg": 0.017453292519943295, "rad": 1.0, "mrad": 1e-3, "rpm": 0.10471975511965977},
    **{"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    **{"nm": 1.0, "knm": 1e3, "ncm": 1e-2, "nmm": 1e-3, "mnm": 1e-3, "kgfcm": 0.0980665},
    **{"a": 1.0, "ma": 1e-3},
    **{"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
}
_SECONDS = ("sec", "secs", "second", "seconds")
_PREFIXES = {"": "s", "m": "ms", "milli": "ms", "u": "us", "micro": "us", "n": "ns", "nano": "ns"}
_TIME_UNITS = {prefix + word: unit for prefix, unit in _PREFIXES.items() for word in _SECONDS}
_TIME_UNITS |= {"millis": "ms", "micros": "us"}
_SPELLINGS = {"degrees": "deg", "degree": "deg", **_TIME_UNITS}
_OF_POSITION = ("deg", "degree", "degrees", "rad", "mrad", "mm", "cm")
# Units that words of a name may state; `a`, `m` and `s` alone are too often something else.
UNITS_OF_NAMES = {
    TIME: ("ms", "us", "ns", "s", *_TIME_UNITS),
    POSITION: _OF_POSITION,
    VELOCITY: (*_OF_POSITION, "rpm"),
    ACCELERATION: _OF_POSITION,
    EFFORT: ("nm", "knm", "ncm", "nmm", "mnm", "kgfcm"),
    CURRENT: ("ma",),
}
_PER_TIME = frozenset({"per", "s", "s2", "sec", "second"})
# In names without any other word than neutral ones, `joint_1 [deg]`, units say the quantity, or the joint alone.
# The first ones come first.
_BARE_WORDS = {
    EFFORT: frozenset(UNITS_OF_NAMES[EFFORT]),
    VELOCITY: frozenset({"rpm"}),
    CURRENT: frozenset(UNITS_OF_NAMES[CURRENT]),
    POSITION: frozenset(("joint", "joints", "jnt", "j", "axis", *UNITS_OF_NAMES[POSITION])),
}
BARE = NEUTRAL.union({"*"}, _PER_TIME, *_BARE_WORDS.values())
# Units whose factor only the owner knows.
UNKNOWN_UNITS = frozenset({"percent", "permille", "counts", "ticks", "increments", "pulses"})

# What users call a quantity.
KEYS = {
    **{name: name for name in (TIME, *_WORDS, CURRENT)},
    **{"t": TIME, "q": POSITION, "qd": VELOCITY, "dq": VELOCITY, "qdd": ACCELERATION},
    **{"ddq": ACCELERATION, "tau": EFFORT, "torque": EFFORT, "i": CURRENT},
}

# What is wrong with joint states whose names of joints change: those of the first message, those of another.
JOINTS_CHANGE = (
    "expected the joints {} in all messages, as in the first one, got {}; record one topic per arm"
)


def words_of(name: str) -> tuple[str, ...]:
    """Words and numbers of a name: `Joint1_Pos` has joint, 1, pos."""
    name = re.sub(r"(?<![A-Za-z])(mNm|kNm|mA|q_?[dD]{1,2}ot)(?![a-z])", _one_word, name)
    name = name.replace("%", " percent ").replace("°", " deg ")
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[^\W\d_])(?=\d)|(?<=\d)(?=[^\W\d_])", " ", name)
    return tuple(re.findall(r"[^\W\d_]+|\d+", apart.lower()))


def words_of_numbered(name: str) -> tuple[str, ...]:
    """The same where numbers say the joint: `A1` is axis 1, as KUKA calls it."""
    return words_of(re.sub(r"(?<![A-Za-z])A(?=[1-9])", "axis ", name))


def _one_word(found: re.Match[str]) -> str:
    return found[0].lower().replace("_", "")


def quantity_of(words: Sequence[str]) -> str | None:
    """What the words say; None: nothing, or another thing than a measured quantity."""
    if _OTHER.intersection(words):
        return None
    for vocabulary in (_WORDS, _WEAK_WORDS):
        said = [kind for kind, known in vocabulary.items() if {*known.split()} & {*words}]
        if said:
            return said[0] if len(said) == 1 else None
    return _quantity_of_bare(words)


def _quantity_of_bare(words: Sequence[str]) -> str | None:
    """What a unit beside a joint's name or number says, or a word for the joint alone."""
    if "*" not in words or not BARE.issuperset(words):
        return None
    if not _PER_TIME.isdisjoint(words):  # `s` alone may be anything
        return None if {*UNITS_OF_NAMES[POSITION]}.isdisjoint(words) else VELOCITY
    return next((kind for kind, known in _BARE_WORDS.items() if known & {*words}), None)


def unit_of(quantity: str, words: Sequence[str]) -> str:
    """The unit that the words state, of UNITS or UNKNOWN_UNITS; "": none, or that of SI."""
    known = UNKNOWN_UNITS.union(UNITS_OF_NAMES[quantity])
    found = [_SPELLINGS.get(word, word) for word in words if word in known]
    return found[-1] if found and UNITS.get(found[-1]) != 1.0 else ""


def foreign(quantity: str, words: Sequence[str]) -> tuple[int, int]:
    """How many words say other things than the quantity: foreign ones, and neutral ones too."""
    said = {*_WORDS.get(quantity, "").split(), *_WEAK_WORDS.get(quantity, "").split(), "*"}
    said = said.union(UNITS_OF_NAMES[quantity], _PER_TIME) - _LESS_SURE
    others = [word for word in words if word not in said]
    return sum(word not in NEUTRAL for word in others), len(others)
