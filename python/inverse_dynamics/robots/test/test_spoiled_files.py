# SPDX-License-Identifier: Apache-2.0
"""Descriptions, model files and run configurations with one fault, at each place in turn.

None is read as another robot without a word: it is refused with the line, or a warning names the fault.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pytest
from simulation_arms import joint, link, robot

from inverse_dynamics import Solver, UserError, load_robot
from inverse_dynamics.installation.ament import package_share
from inverse_dynamics.robots.robots import RIGID_BODY

# What isn't a number, made from one.
NOT_NUMBERS = (
    *("", "  ", "heavy", "{}kg", "1,5", "{} {}", "nan", "inf", "-Infinity", "1e400", "0x1p3"),
    *("1_0", "１.5", "1.2.3", "-", "e5", "{};", "9" * 400),
)
SAME_NUMBER = ("{} ", " {}", "\t{}\n")


def typos(name: str) -> set[str]:
    """Other names that a hurried writer may mean it by."""
    middle = len(name) // 2
    swapped = name[:middle] + name[middle:][::-1]
    doubled = name[: middle + 1] + name[middle:]
    return {name[:-1], swapped, doubled, name.upper(), name + "s"} - {name, ""}


class Read(NamedTuple):
    """What became of a file."""

    error: str
    warnings: tuple[str, ...] = ()
    torques: np.ndarray = np.zeros(0)


def read(**arguments: str) -> Read:
    try:
        solver = Solver(RIGID_BODY, **arguments)
    except UserError as error:
        return Read(str(error))
    states = np.sin(np.arange(9.0 * len(solver.joint_names))).reshape(3, 3, -1)
    return Read("", solver.warnings, solver.torques(*states))


# ---- robot descriptions ----------------------------------------------------------------------------------------------

# A line for each element; the finger is beside the chain. The flange is fixed: it has no axis.
ARM = (
    robot(
        link("base"),
        link("upper", 2.5, "0.1 0.02 0.3"),
        link("fore", 1.5, "0.2 0.01 0.1"),
        link("tool", 0.5, "0.05 0.01 0.02"),
        link("finger", 0.2, "0.01 0.02 0.03"),
        joint("shoulder", "base", "upper", xyz="0.1 0.2 0.3", axis="0.6 0 0.8", rpy="0.3 0.2 0.1"),
        joint("elbow", "upper", "fore", "prismatic", xyz="0.4 0.1 0.2", rpy="0.1 0.4 0.2"),
        joint("flange", "fore", "tool", "fixed", xyz="0.1 0.1 0.3", axis="none", rpy="0.2 0.3 0.1"),
        joint("grip", "tool", "finger", xyz="0.1 0.05 0.02", axis="0 0 1", rpy="0.1 0.1 0.4"),
    )
    .replace('<axis xyz="none"/>', "")
    .replace("><", ">\n<")
)
TEXTS = {"name", "type", "link"}
# What URDF gives a default, so that another robot is meant where it is left out.
DEFAULTS = {"xyz": "0 0 0", "rpy": "0 0 0", "lower": "0", "upper": "0"}


class Place(NamedTuple):
    """Where an attribute or element of ARM is."""

    element: str
    name: str
    value: str
    span: tuple[int, int]

    @property
    def line(self) -> str:
        return rf"URDF:{1 + ARM.count(chr(10), 0, self.span[0])}\b"

    def read_as(self, text: str) -> Read:
        begin, end = self.span
        return read(urdf=ARM[:begin] + text + ARM[end:], tip="tool")


ELEMENTS = [Place(e[1], e[1], e[0], e.span()) for e in re.finditer(r"<(\w+)[^>]*/>", ARM)]
ATTRIBUTES = [
    Place(ARM[ARM.rindex("<", 0, a.start()) + 1 :].split()[0], a[1], a[2], a.span())
    for a in re.finditer(r'(\w+)="([^"]*)"', ARM)
    if ARM[: a.start()].count("\n") > 0  # not the robot's own
]


def test_numbers_of_a_description_are_read_or_refused():
    right = read(urdf=ARM, tip="tool").torques
    numbers = [place for place in ATTRIBUTES if place.name not in TEXTS]
    assert len(numbers) > 50
    for place in numbers:
        for text in NOT_NUMBERS:
            found = place.read_as(f'{place.name}="{text.format(place.value, place.value)}"')
            assert re.search(rf"{place.line}.*{place.name}", found.error), (place, text, found)
        for text in SAME_NUMBER:
            found = place.read_as(f'{place.name}="{text.format(place.value)}"')
            np.testing.assert_array_equal(found.torques, right, err_msg=f"{place} {text!r}")


def test_misspelt_attributes_of_a_description_are_named():
    for place in ATTRIBUTES:
        for typo in typos(place.name):
            found = place.read_as(f'{typo}="{place.value}"')
            told = re.search(place.line, found.error) or any(typo in w for w in found.warnings)
            assert told, (place, typo, found)


def test_attributes_that_a_description_leaves_out_are_named_or_have_their_default():
    for place in ATTRIBUTES:
        found = place.read_as("")
        if place.name in DEFAULTS and place.element != "axis":
            default = place.read_as(f'{place.name}="{DEFAULTS[place.name]}"').torques
            np.testing.assert_array_equal(found.torques, default, err_msg=str(place))
        else:
            assert re.search(rf"{place.line}.*{place.name}", found.error), (place, found)


def test_misspelt_and_repeated_elements_of_a_description_are_named():
    for place in ELEMENTS:
        for typo in typos(place.name):
            found = place.read_as(place.value.replace(place.name, typo, 1))
            told = "URDF:" in found.error or any(f"<{typo}>" in w for w in found.warnings)
            assert told, (place, typo, found)
        assert "URDF:" in place.read_as(place.value + place.value).error, place


# ---- YAML ------------------------------------------------------------------------------------------------------------

ROBOT = """\
schema: 1
name: arm
description: An arm
plugin: rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody
urdf: package://inverse_dynamics_robots/urdf/ur10.urdf
root: base_link
tip: tool0
gravity: [0, 0, -9.81]
topic: /joint_states
friction: true
effort: torque
accelerations:
  method: low-pass
  cutoff: 10
"""
KEY = re.compile(r"^(?P<before>\s*(?:- )?)(?P<key>\w+):(?P<value>.*)$")
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")


def changes(line: str) -> Iterator[str]:
    """A line of YAML with its key misspelt or twice, or its first number as none."""
    if found := KEY.match(line):
        before, key, value = found.groups()
        yield from (f"{before}{typo}:{value}" for typo in typos(key))
        if value.strip():
            yield f"{line}\n{' ' * len(before)}{key}:{value}"
    content = line.split("  #")[0]
    if number := NUMBER.search(content, content.find(":") + 1):
        for text in (*NOT_NUMBERS, "'3'", "1:30", "0b11", "0o17"):  # or not in every YAML
            written = text.format(number[0], number[0])
            quoted = written if written.strip() else f'"{written}"'  # nothing would be no value
            yield line[: number.start()] + quoted + line[number.end() :]


def spoiled(text: str) -> Iterator[str]:
    """The text with one fault; lines of block scalars are prose."""
    lines = text.splitlines()
    prose = 0  # indentation that a line of prose has at least
    for k, line in enumerate(lines):
        indentation = len(line) - len(line.lstrip())
        if (prose and (indentation >= prose or not line)) or line.lstrip().startswith("#"):
            continue
        prose = indentation + 1 if line.endswith((">", ">-", "|")) else 0
        for changed in changes(line) if not prose else ():
            yield "\n".join([*lines[:k], changed, *lines[k + 1 :], ""])


MODEL = package_share("inverse_dynamics_robots") / "models" / "franka_inria_identified.yaml"


@pytest.mark.parametrize(
    ("text", "open_file", "least"),
    [
        (ROBOT, load_robot, 100),
        (MODEL.read_text(), lambda file: Solver(RIGID_BODY, model=str(file)), 1000),
    ],
    ids=["run configuration", "model"],
)
def test_a_fault_in_a_line_of_yaml_is_refused_with_a_line(tmp_path, text, open_file, least):
    file = tmp_path / "file.yaml"
    file.write_text(text)
    open_file(file)
    faults = list(spoiled(text))
    assert len(faults) > least
    for fault in faults:
        file.write_text(fault)
        with pytest.raises(UserError, match=rf"{file.name}:\d+"):
            open_file(file)
