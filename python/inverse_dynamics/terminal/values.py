# SPDX-License-Identifier: Apache-2.0
"""Values of options: what a text on the command line stands for, or an argparse.ArgumentTypeError."""

from __future__ import annotations

import argparse
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.decimals import decimal
from inverse_dynamics.errors import UserError
from inverse_dynamics.wording import shown

if TYPE_CHECKING:
    from inverse_dynamics._core import YamlMap
    from inverse_dynamics.arrays import Parameter

_OWN_OPTIONS = {  # by the solver's parameter that they set
    "root": "--root",
    "tip": "--tip",
    "gravity": "--gravity",
    "friction": "--no-friction",
    "robot_description": "--urdf",
}
_PAYLOAD = (
    "MASS, MASS,x,y,z or MASS,x,y,z,Ixx,Ixy,Ixz,Iyy,Iyz,Izz (1, 4 or 10 numbers), or a YAML file with "
    "mass, center_of_mass, inertia, frame and tip"
)


def _wrong(expected: str, got: str) -> argparse.ArgumentTypeError:
    return argparse.ArgumentTypeError(f"expected {expected}, got '{got}'")


def numbers(text: str, expected: str = "numbers, a,b,c", *counts: int) -> tuple[float, ...]:
    """`a,b,c`: finite decimals. expected: for the error; counts: how many there may be, if not any."""
    try:
        found = tuple(decimal(part) for part in text.split(","))
    except ValueError:
        found = (math.nan,)
    if (counts and len(found) not in counts) or not all(map(math.isfinite, found)):
        raise _wrong(expected, text)
    return found


def three_numbers(text: str) -> tuple[float, ...]:
    """`x,y,z`."""
    return numbers(text, "three numbers, x,y,z", 3)


def number(text: str) -> float:
    """A finite number."""
    return numbers(text, "a number", 1)[0]


def positive_number(text: str) -> float:
    """A finite number above zero."""
    expected = "a number above zero"
    value = numbers(text, expected, 1)[0]
    if value <= 0.0:
        raise _wrong(expected, text)
    return value


def share(text: str) -> float:
    """A number above 0 and up to 1."""
    value = positive_number(text)
    if value > 1.0:
        raise _wrong("a part, above 0 and up to 1", text)
    return value


def whole_number(text: str, expected: str = "an integer that isn't negative") -> int:
    """0, 1, 2, ..."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 18):
        raise _wrong(expected, text)
    return int(text)


def count(text: str) -> int:
    """1, 2, ..."""
    expected = "a whole number above zero"
    value = whole_number(text, expected)
    if value == 0:
        raise _wrong(expected, text)
    return value


def span(text: str) -> tuple[float, ...]:
    """`from,to`: two times."""
    expected = "two times, the later one second"
    times = numbers(text, expected, 2)
    if not times[0] < times[1]:
        raise _wrong(expected, text)
    return times


def names(text: str) -> tuple[str, ...]:
    """`a,b,c`."""
    parts = tuple(part.strip() for part in text.split(","))
    if not all(parts):
        raise _wrong("names, a,b,c", text)
    return parts


def file_name(text: str) -> Path:
    """A path; not "", which an unset variable leaves and Path takes for `.`."""
    if not text:
        raise _wrong("the name of a file or directory", text)
    return Path(text)


def xacro_argument(text: str) -> str:
    """`NAME:=VALUE`, in one word."""
    if not re.fullmatch(r"\w+:=\S*", text):
        raise _wrong("NAME:=VALUE", text)
    return text


def figure_formats(text: str) -> tuple[str, ...]:
    """`png,svg`; `none`: no figure."""
    from inverse_dynamics.show.plots import FORMATS

    formats = () if text == "none" else tuple(part.strip() for part in text.split(","))
    if any(part not in FORMATS for part in formats) or len(set(formats)) < len(formats):
        raise argparse.ArgumentTypeError(
            f"expected some of {', '.join(FORMATS)}, such as png,pdf, or none, got {shown(text)}"
        )
    return formats


def parameter(text: str) -> tuple[str, Parameter]:
    """`NAME=VALUE` of a solver; VALUE as in a run configuration."""
    from inverse_dynamics import _core
    from inverse_dynamics.robots.located_yaml import parse_mapping

    name, _, value = text.partition("=")
    if name == "model":
        raise argparse.ArgumentTypeError(
            "model: is not an option: put it at the top of the run configuration"
        )
    if name in _OWN_OPTIONS:
        raise argparse.ArgumentTypeError(
            f"{name}: has an option of its own: give {_OWN_OPTIONS[name]} instead"
        )
    found, why = {}, ""
    try:
        found = _core.solver_parameters(parse_mapping(f"{name}: {value}", "option", UserError))
    except UserError as error:
        why = f" ({re.sub(r'^option(:[0-9]+)?: ', '', str(error))})"
    if list(found) != [name]:
        raise argparse.ArgumentTypeError(
            "expected NAME=VALUE, VALUE a number, a text, true, false or a list of one of them, "
            f"[1, 2], got {shown(text)}{why}"
        )
    return name, found[name]


def payload(text: str) -> dict[str, Parameter]:
    """A body at the tip: all of its parameters, so that they replace those of another body."""
    return {"payload.center_of_mass": [0.0, 0.0, 0.0], **stated_payload(text)}


def stated_payload(text: str) -> dict[str, Parameter]:
    """The same without a center of mass where none is stated."""
    try:
        [decimal(part) for part in text.split(",")]
    except ValueError:
        stated = _payload_of_file(text)
    else:
        mass, *others = numbers(text, _PAYLOAD, 1, 4, 10)
        parts = {"center_of_mass": others[:3], "inertia": others[3:]}
        stated = {"payload.mass": mass}
        stated |= {f"payload.{name}": part for name, part in parts.items() if part}
    zeros = [0.0, 0.0, 0.0]
    rest = {"inertia": 2 * zeros, "frame.xyz": zeros, "frame.rpy": zeros}
    return {**{f"payload.{name}": part for name, part in rest.items()}, **stated}


def _payload_of_file(text: str) -> dict[str, Parameter]:
    from inverse_dynamics.robots.located_yaml import read_mapping

    stated: dict[str, Parameter] = {}

    def add(mapping: YamlMap, name: str, count: int) -> None:
        value = mapping.optional(name.rpartition(".")[2])
        if value is not None:
            stated[f"payload.{name}"] = [entry.number() for entry in value.entries(count)]

    if not Path(text).is_file():
        raise argparse.ArgumentTypeError(
            f"expected {_PAYLOAD}, got '{text}': there is no such file"
        )
    try:
        body = read_mapping(Path(text), UserError)
        stated["payload.mass"] = body.required("mass").number()
        add(body, "center_of_mass", 3)
        add(body, "inertia", 6)
        frame = body.optional("frame")
        if frame is not None:
            pose = frame.mapping()
            add(pose, "frame.xyz", 3)
            add(pose, "frame.rpy", 3)
            pose.reject_others()
        if (tip := body.optional("tip")) is not None:
            stated["payload.tip"] = tip.text()
        body.reject_others()
    except UserError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return stated


def whole_numbers(text: str) -> tuple[int, ...]:
    """`0,1,2`."""
    return tuple(
        whole_number(part, "integers that aren't negative, a,b,c") for part in text.split(",")
    )
