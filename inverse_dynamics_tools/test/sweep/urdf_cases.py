# SPDX-License-Identifier: Apache-2.0
"""Robot descriptions, spoiled one place at a time: every attribute, every element."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING

from entry_points import KDL, PINOCCHIO, RIGID_BODY, cpp, installed, python
from mutations import same_numbers, spoiled_numbers, typos
from outcome import Case, Expected
from process import run_apart

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0.02 0.3" rpy="0.1 0.2 0.3"/>
      <mass value="2.5"/>
      <inertia ixx="0.03" ixy="0.001" ixz="0.002" iyy="0.04" iyz="0.003" izz="0.05"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0.2 0.01 0.1" rpy="0.3 0.1 0.2"/>
      <mass value="1.5"/>
      <inertia ixx="0.02" ixy="0.001" ixz="0.001" iyy="0.03" iyz="0.002" izz="0.04"/>
    </inertial>
  </link>
  <link name="tool">
    <inertial>
      <origin xyz="0.05 0.01 0.02" rpy="0.1 0.1 0.1"/>
      <mass value="0.5"/>
      <inertia ixx="0.002" ixy="0.0001" ixz="0.0001" iyy="0.003" iyz="0.0002" izz="0.004"/>
    </inertial>
  </link>
  <link name="finger">
    <inertial>
      <origin xyz="0.01 0.02 0.03" rpy="0.2 0.1 0.3"/>
      <mass value="0.2"/>
      <inertia ixx="0.001" ixy="0.0001" ixz="0.0001" iyy="0.002" iyz="0.0002" izz="0.001"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.3 0.2 0.1"/>
    <axis xyz="0.6 0 0.8"/>
    <limit lower="-2" upper="2" effort="100" velocity="3"/>
  </joint>
  <joint name="elbow" type="prismatic">
    <parent link="upper"/>
    <child link="fore"/>
    <origin xyz="0.4 0.1 0.2" rpy="0.1 0.4 0.2"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="50" velocity="2"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="fore"/>
    <child link="tool"/>
    <origin xyz="0.1 0.1 0.3" rpy="0.2 0.3 0.1"/>
  </joint>
  <joint name="grip" type="revolute">
    <parent link="tool"/>
    <child link="finger"/>
    <origin xyz="0.1 0.05 0.02" rpy="0.1 0.1 0.4"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="1"/>
  </joint>
</robot>
"""

TIP = "tool"
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_NUMERIC = {"xyz", "rpy", "value", *_INERTIA, "lower", "upper", "effort", "velocity"}
# What URDF gives a default, so that leaving it out is another robot, rightly.
_DEFAULTS = {"xyz": "0 0 0", "rpy": "0 0 0", "lower": "0", "upper": "0"}
_ATTRIBUTE = re.compile(r'(?P<name>\w+)="(?P<value>[^"]*)"')


@dataclass(frozen=True)
class _Change:
    name: str
    text: str
    expected: Expected
    meaning: str = ""  # a description whose torques are the right ones, if not those of ARM


def cases(directory: Path) -> Iterator[Case]:
    """Each change, by one of the ways in."""
    solvers = installed(RIGID_BODY, KDL, PINOCCHIO)
    for number, change in enumerate(_changes()):
        file = directory / f"{number}.urdf"
        expected = change.expected
        if expected.right:
            expected = replace(expected, torques=_torques(change.meaning or ARM))
        yield _case(number, solvers, change, file, expected)


@cache
def _torques(urdf: str) -> tuple[float, ...]:
    return run_apart(partial(python, RIGID_BODY, urdf=urdf, tip=TIP)).torques


def _case(
    number: int, solvers: Sequence[str], change: _Change, file: Path, expected: Expected
) -> Case:
    """Entry points and solvers take turns: they share one reader."""
    turn = number % (len(solvers) + 1)
    if turn == len(solvers):
        file.write_text(change.text)
        act = partial(cpp, RIGID_BODY, str(file), f"{{tip: {TIP}}}")
        return Case(f"{change.name} [C++]", act, expected)
    plugin = solvers[turn]
    act = partial(python, plugin, urdf=change.text, tip=TIP)
    return Case(f"{change.name} [Python, {plugin.split('/')[0]}]", act, expected)


def _changes() -> Iterator[_Change]:
    yield _Change("as it is", ARM, Expected(refused=False, right=True))
    for element, attribute, value, place in _attributes():
        where = f"{element} {attribute}, line {place.line}"
        yield from _of_attribute(where, element, attribute, value, place)
    for name, place in _elements():
        yield from _of_element(f"<{name}>, line {place.line}", name, place)
    yield from _of_the_whole()


@dataclass(frozen=True)
class _Place:
    begin: int
    end: int

    @property
    def line(self) -> int:
        return ARM.count("\n", 0, self.begin) + 1

    def replaced(self, text: str) -> str:
        return ARM[: self.begin] + text + ARM[self.end :]


def _body_begin() -> int:
    return ARM.index("<link")


def _attributes() -> Iterator[tuple[str, str, str, _Place]]:
    for found in _ATTRIBUTE.finditer(ARM, _body_begin()):
        element = ARM[ARM.rindex("<", 0, found.start()) :].split()[0].strip("<")
        yield element, found["name"], found["value"], _Place(found.start(), found.end())


def _elements() -> Iterator[tuple[str, _Place]]:
    """Elements without content, whole."""
    for found in re.finditer(r"<(\w+)[^>]*/>", ARM):
        yield found[1], _Place(found.start(), found.end())


def _of_attribute(
    where: str, element: str, name: str, value: str, place: _Place
) -> Iterator[_Change]:
    at = Expected(place=rf"URDF:{place.line}\b.*{name}")
    if name in _NUMERIC:
        for what, text in spoiled_numbers(value).items():
            yield _Change(f"{where}: {what}", place.replaced(f'{name}="{text}"'), at)
        for what, text in same_numbers(value).items():
            changed = place.replaced(f'{name}="{text}"')
            yield _Change(f"{where}: {what}", changed, Expected(refused=False, right=True))
    for what, typo in typos(name).items():
        expected = Expected(place=rf"URDF:{place.line}\b", warned=True, mention=re.escape(typo))
        yield _Change(f"{where}: {what}", place.replaced(f'{typo}="{value}"'), expected)
    optional = name in _DEFAULTS and element != "axis"
    yield _Change(
        f"{where}: left out",
        place.replaced(""),
        Expected(place=rf"URDF:{place.line}\b.*{name}", refused=not optional, right=optional),
        place.replaced(f'{name}="{_DEFAULTS[name]}"') if optional else "",
    )


def _of_element(where: str, name: str, place: _Place) -> Iterator[_Change]:
    whole = ARM[place.begin : place.end]
    for what, typo in typos(name).items():
        changed = place.replaced(whole.replace(name, typo, 1))
        mention = rf"<{re.escape(typo)}>"
        yield _Change(
            f"{where}: {what}", changed, Expected(place="URDF:", warned=True, mention=mention)
        )
    yield _Change(f"{where}: twice", place.replaced(whole + whole), Expected(place="URDF:"))


def _of_the_whole() -> Iterator[_Change]:
    right = Expected(refused=False, right=True)
    place = Expected(place="URDF")
    yield _Change("empty", "", place)
    yield _Change("a file name", "robots/arm.urdf", Expected(place="file name|URDF"))
    yield _Change("not XML", "name: arm\n", place)
    for share in (0.1, 0.5, 0.9):
        yield _Change(f"cut off at {share}", ARM[: int(share * len(ARM))], place)
    yield _Change("another root element", "<sdf/>", place)
    yield _Change("no link", '<robot name="arm"/>', place)
    for version in ("1", "1.0", "1.1", "1.2"):
        changed = ARM.replace("<robot ", f'<robot version="{version}" ')
        yield _Change(f"version {version}", changed, right)
    yield _Change("comments", ARM.replace("<link ", "<!-- a link -->\n<link "), right)
    yield _Change("Windows line ends", ARM.replace("\n", "\r\n"), right)
    yield _Change("byte order mark", "\ufeff" + ARM, Expected(right=True, place="URDF"))
    visual = '<visual><geometry><mesh filename="a.stl"/></geometry></visual><collision/>'
    yield _Change("visuals", ARM.replace("<inertial>", visual + "<inertial>"), right)
    extras = '<transmission name="t"/><gazebo/><material name="grey"/>'
    yield _Change("extensions", ARM.replace("</robot>", extras + "</robot>"), right)
    yield _Change(
        "left-over xacro",
        ARM.replace("</robot>", '<xacro:arm name="b"/></robot>'),
        Expected(warned=True, mention="xacro", place="URDF"),
    )
    entity = '<!DOCTYPE r [<!ENTITY a "&b;&b;"><!ENTITY b "&a;&a;">]>'
    yield _Change("entities that expand each other", entity + ARM.replace("arm", "&a;"), place)
    yield _Change("terminal escapes", ARM.replace('"elbow"', '"\x1b[31melbow"'), place)
    yield _Change(
        "a name of 100 kB", ARM.replace('child link="upper"', f'child link="{"u" * 10**5}"'), place
    )
    yield _Change("a NUL", ARM.replace("2.5", "2\0.5"), place)
    yield from _of_the_tree(right)


def _of_the_tree(right: Expected) -> Iterator[_Change]:
    place = Expected(place="URDF")
    fixed = '<joint name="f{0}" type="fixed"><parent link="{1}"/><child link="l{0}"/></joint>'
    many, above = [], "base"
    for i in range(20_000):
        many.append(f'<link name="l{i}"/>' + fixed.format(i, above))
        above = f"l{i}"
    yield _Change("20,000 fixed joints", ARM.replace("</robot>", "".join(many) + "</robot>"), right)
    loop = ARM.replace('<parent link="base"/>', '<parent link="tool"/>')
    yield _Change("a loop", loop, place)
    yield _Change("two roots", ARM.replace("</robot>", '<link name="x"/></robot>'), place)
    yield _Change("own parent", ARM.replace('<child link="upper"/>', '<child link="base"/>'), place)
    yield _Change("unknown type", ARM.replace("prismatic", "sliding"), place)
    yield _Change("floating", ARM.replace("prismatic", "floating"), place)
    yield _Change("zero axis", ARM.replace('"0 1 0"', '"0 0 0"'), place)
    yield _Change("negative mass", ARM.replace('"2.5"', '"-2.5"'), place)
    implausible = Expected(place="URDF|chain", warned=True)
    yield _Change("1e300 m", ARM.replace('"0.4 0.1 0.2"', '"1e300 0.1 0.2"'), implausible)
    yield _Change("1e308 kg", ARM.replace('"2.5"', '"1e308"'), implausible)
    yield _Change(
        "a negative moment",
        ARM.replace('"0.03"', '"-0.03"'),
        replace(implausible, mention="upper|shoulder"),
    )
    dynamics = '<dynamics damping="1.5" friction="0.5"/><limit lower="-2"'
    yield _Change(
        "damping and friction",
        ARM.replace('<limit lower="-2"', dynamics),
        Expected(refused=False, warned=True, mention="urdf_friction"),
    )
