# SPDX-License-Identifier: Apache-2.0
"""What pip installs: extras, plugins of other packages, metadata."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import fails

from inverse_dynamics.demo import demo
from inverse_dynamics.errors import UserError
from inverse_dynamics.installation import extras, wheels

ROOT = Path(__file__).resolve().parents[4]


@pytest.fixture
def pyproject():
    tomllib = pytest.importorskip("tomllib", reason="Python 3.10 can't read pyproject.toml")
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def test_each_extra_that_messages_name_is_there(pyproject):
    offered = pyproject["project"]["optional-dependencies"]
    assert set(extras.EXTRAS.values()) == set(offered) - {"all"}
    assert re.search(r"\[(.*)\]", offered["all"][0])[1].split(",") == [
        k for k in offered if k != "all"
    ]


def without(monkeypatch, *modules):
    """As if these weren't installed."""
    for module in modules:
        monkeypatch.setitem(sys.modules, module, None)


def test_a_missing_package_is_named_with_the_command_that_installs_it(monkeypatch, ids):
    without(monkeypatch, "mujoco")
    arguments = ("simulate", "--robot", "ur10_simulated", "--duration", 1, "--out", "bag")
    fails(
        ids(*arguments),
        "ids: error: a simulation needs mujoco: run ./scripts/setup in the workspace",
    )
    monkeypatch.setattr(extras, "installed_by_pip", lambda: True)
    fails(
        ids(*arguments),
        'ids: error: a simulation needs mujoco: pip install "inverse-dynamics[sim]"',
    )
    assert not Path("bag").exists()


def test_figures_need_matplotlib_if_they_are_asked_for(monkeypatch, ids):
    without(monkeypatch, "matplotlib")
    bag = demo.stored_recording("ur10_simulated")
    arguments = ("evaluate", bag, "--robot", "ur10_simulated", "--out")
    fails(ids(*arguments, "asked", "--figures", "png"), "a figure needs matplotlib: ")
    assert not Path("asked").exists()
    code, out, err = ids(*arguments, "result")
    assert (code, err) == (0, "")
    assert f"figure         none, it needs matplotlib: {extras.how_to_install('matplotlib')}" in out
    assert Path("result/metrics.json").is_file()
    assert not Path("result/torques.png").exists()


def test_a_package_works_without_its_extras():
    program = (
        "import sys\n"
        f"for name in {sorted(extras.EXTRAS)!r}: sys.modules[name] = None\n"
        "from inverse_dynamics import cli\n"
        "sys.exit(cli.main(['robots', 'ur10_simulated']))\n"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")
    assert "Simulated UR10" in result.stdout


def test_demo_shows_the_stored_recordings_without_extras(monkeypatch, tmp_path):
    without(monkeypatch, "mujoco", "matplotlib", "rosbags", "yaml")
    result = demo.run_demo(tmp_path / "demo")
    assert set(result.evaluations) == {"ur10_simulated", "panda_simulated"}
    for evaluation in result.evaluations.values():
        assert evaluation.mean_rmse < 0.1  # N m, of torques up to 180 N m
        assert any("with MuJoCo the demo simulates the robots" in n for n in evaluation.notes)
    assert "UR10, simulated" in result.page.read_text(encoding="utf-8")
    assert not list(result.directory.glob("*/*.png"))


def test_the_extras_of_several_packages_are_named_at_once(monkeypatch):
    without(monkeypatch, "mujoco", "matplotlib", "yaml")
    monkeypatch.setattr(extras, "installed_by_pip", lambda: True)
    with pytest.raises(extras.MissingPackageError) as caught:
        extras.require("a trial", "mujoco", "json", "matplotlib", "yaml")
    assert str(caught.value) == (
        'a trial needs mujoco, matplotlib, yaml: pip install "inverse-dynamics[plots,sim]"'
    )


def declare(site: Path, name: str, module: str) -> None:
    """A distribution whose entry point names a module."""
    info = site / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{wheels.GROUP}]\n{name} = {module}\n")


@pytest.fixture
def site(monkeypatch, tmp_path):
    """Two distributions that declare a prefix, and one whose module is gone."""
    site = tmp_path / "site"
    for name in ("zeta_solver", "alpha_solver"):
        declare(site, name, name)
        (site / name).mkdir()
    declare(site, "gone_solver", "gone_solver.plugins")
    declare(site, "rude_solver", "rude_solver.plugins")
    (site / "rude_solver" / "plugins").mkdir(parents=True)
    (site / "rude_solver" / "__init__.py").write_text("raise RuntimeError('imported')\n")
    monkeypatch.syspath_prepend(site)
    monkeypatch.delenv(wheels.VARIABLE, raising=False)
    return site


def test_packages_that_declare_a_prefix_are_found_in_the_order_of_their_names(site):
    expected = [str(site / name) for name in ("alpha_solver", "rude_solver/plugins", "zeta_solver")]
    assert [p for p in wheels.declared_prefixes() if p.startswith(str(site))] == expected
    assert "alpha_solver" not in sys.modules


def test_they_come_after_what_the_variable_names_each_once(site, monkeypatch):
    monkeypatch.setattr(wheels, "installed_by_pip", lambda: True)
    monkeypatch.setenv(wheels.VARIABLE, f"/given:{site / 'zeta_solver'}")
    wheels.find_other_wheels()
    found = os.environ[wheels.VARIABLE].split(":")
    others = [str(site / "alpha_solver"), str(site / "rude_solver/plugins")]
    assert found == ["/given", str(site / "zeta_solver"), *others]


def test_a_package_of_a_workspace_looks_in_workspaces_alone(site):
    assert not extras.installed_by_pip()
    wheels.find_other_wheels()
    assert wheels.VARIABLE not in os.environ


def test_error_of_a_missing_package_is_the_users():
    assert issubclass(extras.MissingPackageError, UserError)
