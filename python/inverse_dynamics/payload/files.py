# SPDX-License-Identifier: Apache-2.0
"""A load in files: payload.yaml for --payload and run configurations, all numbers in payload.json, a page."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import OutputError
from inverse_dynamics.outputs.files import check_output_file, files_written_whole, write_text
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.outputs.yaml_text import yaml_list, yaml_number
from inverse_dynamics.payload.figure import payload_figure
from inverse_dynamics.payload.page import render_payload
from inverse_dynamics.payload.universal_robots import UPPER, payload_request
from inverse_dynamics.show.plots import check_formats, save_figure

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.payload.payload import Payload

_SUFFIXES = (".yaml", ".yml")


def payload_files(out: Path, figures: Sequence[str], ur: Path | None = None) -> tuple[Path, ...]:
    """All that write_payload() writes: the YAML; the JSON, the page and the figures beside it; ur."""
    beside = (".json", ".html")
    return (
        out,
        *map(out.with_suffix, beside),
        *(out.with_suffix(f".{suffix}") for suffix in figures),
        *([] if ur is None else [ur]),
    )


def check_payload_output(
    out: Path,
    figures: Sequence[str],
    *,
    ur: Path | None = None,
    overwrite: bool = False,
    inputs: Iterable[Path | None] = (),
) -> None:
    """Raise OutputError unless write_payload() may write there."""
    check_formats(figures)
    if out.suffix not in _SUFFIXES:
        raise OutputError(f"{out}: expected a name ending in .yaml; name another file with --out")
    inputs = tuple(inputs)
    for file in payload_files(out, figures, ur):
        check_output_file(file, overwrite=overwrite, inputs=inputs)


def write_payload(
    payload: Payload,
    out: Path | str,
    *,
    overwrite: bool = False,
    figures: Sequence[str] = ("png",),
    ur: Path | None = None,
) -> None:
    """Write all files of a load, or none of them.

    out: of the YAML; the others have its name and suffixes of their own. ur: of payload_request(). Raises OutputError.
    """
    out = Path(out)
    inputs = (payload.evaluation.bag, payload.empty, *payload.evaluation.robot.files)
    check_payload_output(out, figures, ur=ur, overwrite=overwrite, inputs=inputs)
    load, *beside = payload_files(out, figures)
    beside = [*([] if ur is None else [ur]), *beside]
    with files_written_whole([*beside, load]) as fresh:  # the load last
        if ur is not None:
            write_text(fresh[0], payload_request(payload, ur.name))
        data, page, *drawn, body = fresh[ur is not None :]
        write_text(data, json_text(summary(payload)))
        write_text(page, render_payload(payload))
        save_figure(lambda: payload_figure(payload), *drawn)
        write_text(body, yaml_text(payload))


def yaml_text(payload: Payload) -> str:
    """The body as --payload reads it, with the intervals as comments."""
    found, evaluation = payload.estimate, payload.evaluation
    center = payload.center_of_mass_half_width
    lines = [
        f"# What {evaluation.robot.name} carries at its tip, by `ids payload`; 95 % intervals.",
        f"# Tip frame: {payload.frame}.",
        f"mass: {yaml_number(found.mass)}  # kg, +- {found.mass_half_width:.2g}",
        f"center_of_mass: {yaml_list(payload.center_of_mass)}  # m, tip frame, +- "
        + ", ".join(f"{width:.2g}" if math.isfinite(width) else "any" for width in center),
    ]
    if found.inertia_is_known:
        widths = _upper(found.inertia_half_width)
        lines.append("# ixx ixy ixz iyy iyz izz about center_of_mass [kg m^2]")
        lines.append(
            f"inertia: {yaml_list(_upper(found.inertia))}  # +- "
            + ", ".join(f"{width:.2g}" for width in widths)
        )
    else:
        lines.append("# inertia: not determined by the data")
    return "\n".join(lines) + "\n"


def summary(payload: Payload) -> dict[str, Any]:
    """All numbers, for JSON."""
    found, evaluation = payload.estimate, payload.evaluation
    known = found.inertia_is_known
    return {
        "schema": 1,
        "bag": evaluation.bag,
        "empty": payload.empty,
        "topic": evaluation.log.topic,
        "robot": evaluation.robot.name,
        "plugin": evaluation.robot.plugin,
        "mass": found.mass,
        "mass_half_width": found.mass_half_width,
        "frame": payload.frame,
        "center_of_mass": payload.center_of_mass,
        "center_of_mass_half_width": payload.center_of_mass_half_width,
        "inertia": _upper(found.inertia) if known else None,
        "inertia_half_width": _upper(found.inertia_half_width) if known else None,
        "covariance": found.covariance,
        "confidence": 0.95,
        "blocks": found.blocks,
        "duration": found.duration,
        "samples": len(payload.time),
        "rounds": payload.rounds,
        "correlation_time": payload.noise.correlation_time,
        "joints": [
            {
                "joint": name,
                "unit": evaluation.units[j],
                "rmse_before": payload.rmse_before[j],
                "rmse_after": payload.rmse_after[j],
                "offset": found.offset[j],
                "white_noise": payload.noise.white[j],
                "correlated_noise": payload.noise.correlated[j],
            }
            for j, name in enumerate(payload.joint_names)
        ],
        "notes": payload.notes,
    }


def _upper(matrix: Floats) -> list[float]:
    return [float(matrix[entry]) for entry in UPPER]
