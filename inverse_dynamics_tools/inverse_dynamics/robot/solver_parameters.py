# SPDX-License-Identifier: Apache-2.0
"""Parameters of a solver beyond the keys of a run configuration, as YAML has them.

parameters:
  allow_massless: true
  locked_joints: {finger: 0.02}      # is the parameter locked_joints.finger
  weights: [1.0, 2.5]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics._core import Parameter
    from inverse_dynamics.base.located_yaml import Mapping, Scalar, Value

_KEYS = ("root", "tip", "gravity", "friction", "model", "robot_description")


def solver_parameters(mapping: Mapping) -> dict[str, Parameter]:
    """By name; names of nested mappings are joined by dots. Raises the mapping's error."""
    found: dict[str, Parameter] = {}
    start = mapping.value.key
    for name, value in _leaves(mapping).items():
        short = name.removeprefix(f"{start}.") if start else name
        if short in _KEYS:
            raise value.error(
                f"{value.where}: is a key of its own: put {short} at the top of the run configuration"
            )
        found[short] = _parameter(value)
    return found


def _leaves(mapping: Mapping) -> dict[str, Value]:
    """Values that aren't mappings, by their names."""
    found: dict[str, Value] = {}
    for value in mapping.values.values():
        inner = _leaves(value.mapping()) if value.is_mapping else {value.key: value}
        for name, leaf in inner.items():
            if name in found:
                raise leaf.error(f"{leaf.where}: stands here for a second time")
            found[name] = leaf
    return found


def _parameter(value: Value) -> Parameter:
    if not value.is_list:
        return value.scalar()
    entries = value.entries()
    scalars: list[Scalar] = [entry.scalar() for entry in entries]
    kinds = [_KINDS[type(scalar)] for scalar in scalars]
    for entry, kind in zip(entries, kinds, strict=True):
        if kind != kinds[0]:
            entry.fail(f"{kinds[0]}, as the entries before it")
    if float in map(type, scalars):
        return [float(scalar) for scalar in scalars]
    return scalars  # type: ignore[return-value]  # of one kind


_KINDS = {bool: "true or false", int: "a number", float: "a number", str: "a text"}
