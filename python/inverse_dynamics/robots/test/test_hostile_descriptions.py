# SPDX-License-Identifier: Apache-2.0
"""Robot descriptions that aren't what they should be.

Most of them are refused by the solver before; the simulator, and the drawing for a solver that brings its own
model, may be the first to see one. In a process of its own: what hangs or crashes must not take the tests along.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from simulation_arms import joint, link, pendulum, robot, two_links

VISUAL = "<visual>{}<geometry>{}</geometry>{}</visual>"
BOMB = "<!DOCTYPE r [<!ENTITY a 'xxxxxxxxxx'>" + "".join(
    f"<!ENTITY {b} '{('&' + a + ';') * 10}'>" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)


def shape(geometry: str, origin: str = "", material: str = "") -> str:
    """A pendulum with something to draw."""
    return robot(
        link("base"),
        link("arm", 2.0, "0.5 0 0", VISUAL.format(origin, geometry, material)),
        joint("swing", "base", "arm"),
    )


BOX = '<box size="1 1 1"/>'
HOSTILE = {
    "nothing": "",
    "a word": "hello",
    "half of it": pendulum()[:200],
    "another element": "<robots/>",
    "no links": "<robot/>",
    "many entities": BOMB + "]><robot name='&i;'><link name='base'/></robot>",
    "a file as an entity": "<!DOCTYPE r [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><robot name='&a;'/>",
    "a document type": "<!DOCTYPE robot>" + pendulum(),
    "an entity after a comment": (
        "<!-- <robot --><!DOCTYPE robot [<!ENTITY a '2.0'>]>" + pendulum().replace('"2.0"', '"&a;"')
    ),
    "many entities after a comment": "<!-- <robot -->" + BOMB + "]><robot name='&i;'/>",
    "deep elements": "<robot>" + "<link>" * 100_000 + "</link>" * 100_000 + "</robot>",
    "a NUL": pendulum().replace("swing", "swi\0ng"),
    "a number of words": pendulum(xyz="0 0 up"),
    "an axis of words": pendulum(axis="up"),
    "an axis of NaN": pendulum(axis="nan 0 0"),
    "an origin of infinity": pendulum(xyz="inf 0 0"),
    "an origin of 1e300": pendulum(xyz="1e300 0 0"),
    "digits of another script": pendulum(xyz="１ 0 0"),
    "an underscore": pendulum(xyz="1_0 0 0"),
    "two numbers": pendulum(xyz="0 0"),
    "four numbers": pendulum(rpy="0 0 0 0"),
    "400 digits": pendulum(xyz=f"{'9' * 400} 0 0"),
    "a mass of words": pendulum().replace('"2.0"', '"heavy"'),
    "a negative mass": pendulum().replace('"2.0"', '"-2.0"'),
    "a mass of 1e308": pendulum().replace('"2.0"', '"1e308"'),
    "no mass": pendulum().replace('<mass value="2.0"/>', ""),
    "no value of the mass": pendulum().replace('value="2.0"', ""),
    "an effort of words": pendulum(
        limit='<limit lower="-1" upper="1" velocity="1" effort="strong"/>'
    ),
    "an effort of NaN": pendulum(limit='<limit lower="-1" upper="1" velocity="1" effort="nan"/>'),
    "an effort with an underscore": pendulum(limit='<limit effort="1_0" velocity="1"/>'),
    "a joint without a name": pendulum().replace('joint name="swing"', "joint"),
    "a joint without a type": pendulum().replace('type="revolute"', ""),
    "an unknown type": pendulum(kind="rotary"),
    "a joint without a parent": pendulum().replace('<parent link="base"/>', ""),
    "a joint without a child": pendulum().replace('<child link="arm"/>', ""),
    "an unknown child": pendulum().replace('<child link="arm"/>', '<child link="leg"/>'),
    "a link without a name": pendulum().replace('<link name="arm"', "<link"),
    "a link twice": pendulum().replace("</robot>", link("arm") + "</robot>"),
    "a joint twice": pendulum().replace(
        "</robot>", link("x") + joint("swing", "arm", "x") + "</robot>"
    ),
    "a loop": robot(
        link("base"),
        link("arm", 1.0, "0 0 0", VISUAL.format("", BOX, "")),
        link("leg", 1.0),
        joint("a", "base", "arm"),
        joint("b", "arm", "leg"),
        joint("c", "leg", "arm"),
    ),
    "a joint to itself": robot(link("base"), link("arm", 1.0), joint("a", "arm", "arm")),
    "a size of words": shape('<box size="1 1 big"/>'),
    "two sizes": shape('<box size="1 1"/>'),
    "no size": shape("<box/>"),
    "a size of infinity": shape('<box size="inf 1 1"/>'),
    "a sphere without a radius": shape("<sphere/>"),
    "a radius of words": shape('<cylinder radius="r" length="1"/>'),
    "a place of words": shape(BOX, '<origin xyz="here" rpy="0 0 0"/>'),
    "a place of two numbers": shape(BOX, '<origin xyz="0 0"/>'),
    "an angle of NaN": shape(BOX, '<origin rpy="nan 0 0"/>'),
    "a colour of words": shape(BOX, "", '<material name="m"><color rgba="red"/></material>'),
    "two colours": shape(BOX, "", '<material name="m"><color rgba="1 0"/></material>'),
}

# What each reader makes of each description: [] for a result, else the kind and the text of the error.
SCRIPT = """
import json, math, resource, sys
resource.setrlimit(resource.RLIMIT_AS, (6 * 2**30, 6 * 2**30))
from pathlib import Path
from inverse_dynamics._core import RobotDescription
from inverse_dynamics.errors import UserError
from inverse_dynamics.show.scene import scene_of
from inverse_dynamics.simulation.model import SimulatedRobot

names = ("swing",)
readers = {
    "joints": lambda text: [joint.limits for joint in RobotDescription(text).joints],
    "scene": lambda text: json.dumps(scene_of(text, names, Path()).links, allow_nan=False),
    "simulation": lambda text: SimulatedRobot.from_urdf(text),
}
for case, text in json.load(sys.stdin).items():
    for name, read in readers.items():
        found = []
        try:
            read(text)
        except Exception as error:
            found = ["user" if isinstance(error, UserError) else type(error).__name__, str(error)]
        print(json.dumps([case, name, found]), flush=True)
"""


def outcomes(cases: dict[str, str], directory: Path) -> dict[tuple[str, str], list[str]]:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=json.dumps(cases),
        cwd=directory,
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )
    found = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0, (found[-1:], done.stderr[-2000:])
    return {(case, name): error for case, name, error in found}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return outcomes(HOSTILE, tmp_path_factory.mktemp("cases"))


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_description_is_refused_in_one_line_or_read(found, case):
    for name in EVERY:
        error = found[case, name]
        assert not error or error[0] == "user", (name, error)
        if error:
            assert "\n" not in error[1]
            assert len(error[1]) < 600
            assert "root:" not in error[1]  # of /etc/passwd


EVERY = ("joints", "scene", "simulation")


# What each must refuse; the others may not care.
@pytest.mark.parametrize(
    ("readers", "cases"),
    [
        (EVERY, ("a word", "half of it", "another element", "a NUL")),
        (EVERY, ("a file as an entity", "deep elements")),
        (("scene", "simulation"), ("a document type", "many entities")),  # C++ expands none
        (EVERY, ("an entity after a comment", "many entities after a comment")),
        (("joints",), ("an effort of words", "an effort of NaN", "an effort with an underscore")),
        (("scene",), ("a loop", "a size of words", "two sizes", "no size", "a size of infinity")),
        (("scene",), ("a radius of words", "a place of words", "a colour of words", "two colours")),
        (("simulation",), ("no links", "a number of words", "an axis of NaN", "an underscore")),
        (("simulation",), ("digits of another script", "two numbers", "400 digits", "a loop")),
        (("simulation",), ("a link twice", "a joint twice", "a joint without a name", "no mass")),
        (("simulation",), ("an unknown type", "a joint without a type", "a negative mass")),
        (("simulation",), ("no value of the mass", "an unknown child", "a joint without a child")),
    ],
)
def test_what_matters_to_a_reader_is_refused(found, readers, cases):
    missed = [(case, name) for case in cases for name in readers if not found[case, name]]
    assert not missed


def test_sound_descriptions_are_read(tmp_path):
    sound = {"pendulum": pendulum(), "two links": two_links(), "a shape": shape(BOX)}
    sound["a comment on a document type"] = "<!-- no <!DOCTYPE robot> -->" + pendulum()
    assert not any(outcomes(sound, tmp_path).values())
    assert resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY
