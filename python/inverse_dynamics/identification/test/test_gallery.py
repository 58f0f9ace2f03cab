# SPDX-License-Identifier: Apache-2.0
"""The identified robots that the project brings, and how others are added to them."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from identified_arms import identification

from inverse_dynamics import Solver, load_robot, robot_names
from inverse_dynamics.identification.gallery import write_gallery
from inverse_dynamics.identification.hold_out import HoldOut
from inverse_dynamics.installation.ament import package_share

MODELS = package_share("inverse_dynamics_robots") / "models"
PAGE = (Path(__file__).parents[4] / "docs/robots.md").read_text(encoding="utf-8")
GALLERY = [name for name in robot_names() if name.endswith("_identified")]
SOURCE = "https://example.org/arm, recorded on 3 May 2026; licence CC-BY-4.0"


def section(page: str, name: str) -> str:
    """Of a robot."""
    return page.partition(f"\n## {name}\n")[2].partition("\n## ")[0]


def test_there_are_robots_and_each_has_its_section():
    assert len(GALLERY) >= 8
    assert sorted(re.findall(r"^## (\w+_identified)$", PAGE, re.MULTILINE)) == GALLERY


@pytest.mark.parametrize("name", GALLERY)
def test_a_robot_computes_and_states_what_it_is(name, ids):
    robot = load_robot(name)
    model = yaml.safe_load((MODELS / f"{name}.yaml").read_text(encoding="utf-8"))
    joints = [joint for joint in model["joints"] if "mimic" not in joint]
    q, qd, qdd = (
        np.random.default_rng(1).uniform(
            *np.array([j["seen"][key] for j in joints]).T, (20, len(joints))
        )
        for key in ("q", "qd", "qdd")
    )
    solver = Solver(name)
    torques = solver.torques(q, qd, qdd)
    assert np.isfinite(torques).all()
    np.testing.assert_array_equal(Solver(model=name).torques(q, qd, qdd), torques)
    assert list(solver.joint_names) == [joint["name"] for joint in joints]
    assert np.abs(solver.friction_vector(qd, q=q)).max() > 0
    assert all(joint["torque_deviation"] > 0 for joint in joints)
    assert model["name"] == name
    assert robot.source.strip() in model["source"]
    shown = section(PAGE, name)
    (command,) = re.findall(r"```bash\n(.*?)\n```", shown, re.DOTALL)
    command = command.replace(" \\\n   ", "")
    assert f"`{command}` on " in model["source"]
    for joint in joints:  # the error that the page shows, too
        (error,) = re.findall(rf"held out: [^;]*?{joint['name']} (\S+) N m", model["validity"])
        row = next(row for row in shown.splitlines() if row.startswith(f"| {joint['name']} "))
        assert float(row.split(" | ")[3]) == pytest.approx(float(error), rel=1e-3)
    code, out, _ = ids("robots")
    assert code == 0
    assert re.search(rf"^{name} ", out, re.MULTILINE)


@pytest.fixture
def found():
    robot = replace(load_robot("ur10_simulated"), description="My arm", source=SOURCE)
    test = HoldOut(Path("wednesday"), {"identified": np.full(6, 0.25)}, np.full(6, 0.9), ())
    return identification(robot=robot, hold_out=(test,))


def test_a_robot_is_added_to_a_checkout_and_replaced(found, tmp_path):
    name, out = "my_arm_identified", tmp_path / "my_arm_identified.yaml"
    (tmp_path / "checkout/docs").mkdir(parents=True)
    page = tmp_path / "checkout/docs/robots.md"
    page.write_text(f"# Robots\n\n## {name}\n\nOld.\n\n## other_identified\n\nKept.\n")
    files = write_gallery(found, out, tmp_path / "checkout", "ids identify 'my day' --out x")
    assert all(file.is_file() for file in files)
    robot = load_robot(files.robot)
    assert (robot.name, robot.source, robot.effort) == (name, SOURCE, found.robot.effort)
    states = np.random.default_rng(1).uniform(-1, 1, (3, 20, 6))
    np.testing.assert_array_equal(robot.solver().torques(*states), found.solver().torques(*states))
    assert files.picture.read_bytes()[:4] == b"\x89PNG"
    assert files.picture.stat().st_size < 60_000
    text = page.read_text(encoding="utf-8")
    assert text.startswith(f"# Robots\n\n## {name}\n\nMy arm. <https://example.org/arm>, recorded")
    assert text.endswith("\n\n## other_identified\n\nKept.\n")
    assert "Old." not in text
    model = yaml.safe_load(files.model.read_text(encoding="utf-8"))
    assert model["source"].startswith(
        f"My arm. {SOURCE}. `ids identify 'my day' --out x` on 1 recording"
    )
    assert "; on wednesday shoulder_pan_joint 0.25 N m" in model["validity"]
    assert "masses of single links are the description's" in model["validity"]
    request = files.request.read_text(encoding="utf-8")
    assert request.startswith(f"inverse_dynamics_robots: add {name}\n\nMy arm. ")
    assert section(text, name).partition("| joint")[2].strip() in request
    write_gallery(found, out, tmp_path / "checkout", "ids identify 'my day' --out x")
    assert page.read_text(encoding="utf-8") == text


def test_the_command_adds_a_robot_and_refuses_what_the_gallery_cant_take(
    found, tmp_path, ids, monkeypatch
):
    monkeypatch.setattr("inverse_dynamics.identification.identify.identify", lambda *_, **__: found)
    robot = tmp_path / "arm.yaml"
    own = (
        (load_robot("ur10_simulated").file).read_text(encoding="utf-8").partition("simulation:")[0]
    )
    robot.write_text(own)

    def add(out):
        return ids("identify", "monday", "--robot", robot, "--out", out, "--gallery", "g")

    code, _, err = add("my_arm.yaml")
    assert (code, "expected a name such as ur10e_identified.yaml" in err) == (2, True)
    code, _, err = add("my_arm_identified.yaml")
    assert code == 2
    assert "source: expected where the recordings are published, when they were made" in err
    assert not (tmp_path / "g").exists()
    robot.write_text(f"{own}source: {SOURCE}\n")
    code, out, err = add("my_arm_identified.yaml")
    assert (code, err) == (0, "")
    written = "g/core/inverse_dynamics_robots/models/my_arm_identified.yaml"
    assert written in out
    text = (tmp_path / written).read_text(encoding="utf-8")
    assert f"`ids identify monday --robot {robot} --out my_arm_identified.yaml --gallery g`" in text
    other = tmp_path / "other"
    other.mkdir()
    monkeypatch.chdir(other)
    code, _, err = ids(
        *("identify", "monday", "--robot", robot, "--out", "my_arm_identified.yaml"),
        *("--gallery", tmp_path / "g"),
    )
    assert (code, ": exists already; name another file" in err) == (2, True)
