# SPDX-License-Identifier: Apache-2.0
"""Parameters of ROS 2 on pages and in files are declared, of the right type and within their limits; without ROS."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest
import yaml
from pages import REPOSITORY, blocks_of, page

from inverse_dynamics import Solver

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CONTROLLERS = REPOSITORY / "inverse_dynamics_controllers"
PAGE = "docs/ros2_controllers.md"
UR10 = REPOSITORY / "inverse_dynamics_robots/urdf/ur10.urdf"
FILES = ("ur10.yaml", "panda.yaml")  # of inverse_dynamics_simulation/config

_LAW = ("arm", "law", "gravity_compensation_controller")
_FOLLOWING = ("arm", "law", "reference")
DECLARED = {
    "ExternalWrenchBroadcaster": ("arm", "external_wrench_broadcaster"),
    "FeedForwardController": (*_FOLLOWING, "feed_forward_controller"),
    "GravityCompensationController": _LAW,
    "InverseDynamicsController": (*_FOLLOWING, "inverse_dynamics_controller"),
    "PdGravityCompensationController": (*_FOLLOWING, "pd_gravity_compensation_controller"),
}
"""Files `src/NAME_parameters.yaml` of each controller."""

SOLVER = {
    "root",
    "tip",
    "gravity",
    "friction",
    "payload",
}  # those of ids.* that pages and files use
TYPES = {
    "bool": bool,
    "double": float,
    "double_array": [float],
    "string": str,
    "string_array": [str],
}


def declared(controller: str) -> dict[str, dict[str, Any]]:
    """Parameters with their declarations, by their whole names."""
    found: dict[str, dict[str, Any]] = {}
    for name in DECLARED[controller]:
        found |= declared_in(CONTROLLERS / f"src/{name}_parameters.yaml")
    return found


def declared_in(file: Path) -> dict[str, dict[str, Any]]:
    """The same, of one declaration."""
    (library,) = yaml.safe_load(file.read_text(encoding="utf-8")).values()
    return flat(library, lambda node: isinstance(node.get("type"), str))


def flat(node: dict[str, Any], is_leaf: Any, prefix: str = "") -> dict[str, Any]:
    """Leaves by their whole names, joined by points."""
    found: dict[str, Any] = {}
    for key, value in node.items():
        if isinstance(value, dict) and not is_leaf(value):
            found |= flat(value, is_leaf, f"{prefix}{key}.")
        else:
            found[prefix + key] = value
    return found


def requires(controller: str, parameters: dict[str, Any]) -> None:
    """Fail unless a controller declares such parameters, and takes their values."""
    known = declared(controller)
    for name, value in flat(parameters, lambda node: False).items():
        if name.startswith("ids."):
            assert name.split(".")[1] in SOLVER, f"{controller}: {name}: not a solver's parameter"
            continue
        assert name in known, f"{controller}: {name}: not declared"
        check_type(f"{controller}: {name}", known[name]["type"], value)
        for rule, arguments in known[name].get("validation", {}).items():
            check_rule(f"{controller}: {name}", rule.removesuffix("<>"), arguments, value)


def check_type(where: str, name: str, value: Any) -> None:
    """A whole number isn't a double to rclcpp, nor is a list with one."""
    wanted = TYPES[name]
    if isinstance(wanted, list):
        assert isinstance(value, list), f"{where}: expected {name}, got {value!r}"
        assert all(type(item) is wanted[0] for item in value), f"{where}: {name}, got {value!r}"
    else:
        assert type(value) is wanted, f"{where}: expected {name}, got {value!r}"


def check_rule(where: str, rule: str, arguments: Any, value: Any) -> None:
    """The rules of generate_parameter_library that this project uses."""
    rules: dict[str, Callable[[Any], bool]] = {
        "gt": lambda a: value > a[0],
        "gt_eq": lambda a: value >= a[0],
        "bounds": lambda a: a[0] <= value <= a[1],
        "lower_element_bounds": lambda a: all(item >= a[0] for item in value),
        "element_bounds": lambda a: all(a[0] <= item <= a[1] for item in value),
        "fixed_size": lambda a: len(value) == a,
        "one_of": lambda a: value in a[0],
        "subset_of": lambda a: set(value) <= set(a[0]),
        "unique": lambda a: len(value) == len(set(value)),
    }
    assert rules[rule](arguments), f"{where}: {rule} {arguments}, got {value!r}"


def sections(text: str) -> dict[str, tuple[str, dict[str, Any]]]:
    """Of each of this project's controllers: its class and parameters."""
    document = yaml.safe_load(text)
    manager = document.pop("controller_manager", {}).get("ros__parameters", {})
    found = {}
    for name, section in document.items():
        of_the_name = name.title().replace("_", "")
        kind = manager.get(name, {}).get("type", of_the_name).rpartition("/")[2]
        if kind in DECLARED:
            found[name] = (kind, section["ros__parameters"])
    return found


def texts() -> dict[str, str]:
    blocks = {f"{PAGE}-{k}": b.code for k, b in enumerate(blocks_of(page(PAGE), "yaml"))}
    config = REPOSITORY / "inverse_dynamics_simulation/config"
    return blocks | {name: (config / name).read_text(encoding="utf-8") for name in FILES}


@pytest.mark.parametrize("name", texts())
def test_parameters_are_declared_and_within_their_limits(name: str) -> None:
    found = sections(texts()[name])
    assert found
    for kind, parameters in found.values():
        requires(kind, parameters)


def test_the_controller_before_writes_the_references_of_the_one_behind() -> None:
    document = yaml.safe_load(texts()[f"{PAGE}-0"])
    behind = document["inverse_dynamics_controller"]["ros__parameters"]
    before = document["joint_trajectory_controller"]["ros__parameters"]
    solver = Solver(behind["plugin_name"], UR10.read_text(encoding="utf-8"), **behind["ids"])
    assert before["joints"] == list(solver.joint_names)
    assert before["command_joints"] == [
        f"inverse_dynamics_controller/{j}" for j in before["joints"]
    ]
    interfaces = declared("InverseDynamicsController")["reference_interfaces"]["default_value"]
    assert before["command_interfaces"] == interfaces


def test_the_broadcaster_in_its_header_is_a_file_that_it_takes() -> None:
    file = "external_wrench_broadcaster.hpp"
    header = CONTROLLERS / "include/inverse_dynamics_controllers" / file
    lines = header.read_text(encoding="utf-8").splitlines()
    example = [line[8:] for line in lines if line.startswith("///     ")]
    found = sections("\n".join(example))
    assert list(found) == ["external_wrench_broadcaster"]
    requires(*found["external_wrench_broadcaster"])


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ({"gains": {"p": [1.0]}}, "gains.p: not declared"),
        ({"ids": {"base": "base_link"}}, "ids.base: not a solver's parameter"),
        ({"period": 1}, "period: expected double, got 1"),
        ({"gains": {"natural_frequency": [20]}}, "double_array, got"),
        ({"gains": {"natural_frequency": [2000.0]}}, "element_bounds"),
        ({"friction": {"source": "measured"}}, "one_of"),
        ({"payload": {"inertia": [0.0]}}, "fixed_size"),
    ],
)
def test_what_a_controller_would_refuse_fails(parameters: dict[str, Any], expected: str) -> None:
    with pytest.raises(AssertionError, match=re.escape(expected)):
        requires("InverseDynamicsController", parameters)


def names_in_tables(text: str, head: str) -> list[str]:
    """Of first columns; `.posture` stands for `damping.posture` behind another parameter of damping."""
    tables = re.findall(rf"^\| {head} \|.*?\n\n", text, re.MULTILINE | re.DOTALL)
    named = []
    for cells in re.findall(r"^\| (`.*?) \|", "".join(tables), re.MULTILINE):
        group = ""
        for name in re.findall(r"`(.*?)`", cells):
            named.append(group + name if name.startswith(".") else name)
            group = named[-1].rpartition(".")[0]
    return named


def test_tables_name_parameters_that_controllers_declare() -> None:
    known = {name for controller in DECLARED for name in declared(controller)}
    known |= {f"{name.rpartition('.')[0]}.*" for name in known} | {"ids.*"}
    named = set(names_in_tables(page(PAGE), "parameter"))
    assert {"damping.rate", "gains.p", "noise", "contact.thresholds", "payload.mass"} <= named
    assert named <= known


@pytest.mark.parametrize(
    ("head", "declaration", "group", "least"),
    [
        ("parameter", "evaluate_solver", "", 10),
        ("parameter of `external_torques`", "live_node", "external_torques.", 10),
    ],
)
def test_tables_name_parameters_that_nodes_declare(
    head: str, declaration: str, group: str, least: int
) -> None:
    known = declared_in(REPOSITORY / f"inverse_dynamics_ros/src/{declaration}_parameters.yaml")
    named = [group + name for name in names_in_tables(page("docs/ros2.md"), head)]
    of_the_node = {name for name in named if not name.startswith("ids.")}
    assert len(of_the_node) >= least
    assert of_the_node <= set(known)
