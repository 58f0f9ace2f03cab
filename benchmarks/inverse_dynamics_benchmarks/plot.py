# SPDX-License-Identifier: Apache-2.0
"""A measurement as a figure: two arms, and chains of 1 to 30 joints.

The background is white, so that it can be read on a dark page too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import OutputError
from inverse_dynamics.show.plots import save_figure
from inverse_dynamics_benchmarks.names import CHAINS, LIBRARIES, QUANTITIES, REAL, ROBOTS

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics_benchmarks.measurement import Measurement

# Okabe and Ito: for all eyes.
_COLORS = {
    "kdl": "#CC79A7",
    "mujoco": "#009E73",
    "pinocchio": "#0072B2",
    "ours": "#D55E00",
}
_SHOWN = ("torques", "inertia", "coriolis", "gravity", "components")
_BATCH = (f"{LIBRARIES['ours']}, batch", "#F0B88F")


def check_figure_name(file: Path) -> None:
    """Raise OutputError unless the suffix is that of a format."""
    if file.suffix not in (".svg", ".png", ".pdf"):
        raise OutputError(f"{file}: expected a name that ends in .svg, .png or .pdf")


def save_speed_figure(result: Measurement, file: Path) -> None:
    """Save speed_figure(); the format is that of the suffix. The same measurement, the same bytes."""
    check_figure_name(file)
    save_figure(lambda: speed_figure(result), file)


def speed_figure(result: Measurement) -> Figure:
    """Times of UR10 and Panda as bars; torques over the number of joints as lines."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.2), layout="constrained", facecolor="white")
    axes = figure.subplots(1, 3, width_ratios=(1, 1, 1.15))
    for axis, robot in zip(axes, REAL, strict=False):
        _draw_robot(axis, result, robot)
        axis.set_title(f"{ROBOTS[robot]}: time of one state [ns]", loc="left")
    _draw_chains(axes[2], result)
    handles: dict[str, Any] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside lower center",
        ncols=max(1, len(handles)),
        frameon=False,
    )
    return figure


def _draw_robot(axes: Axes, result: Measurement, robot: str) -> None:
    bars: list[tuple[str, str, dict[str, float | None]]] = [
        (LIBRARIES[library], color, {q: _time(result, robot, q, library) for q in _SHOWN})
        for library, color in _COLORS.items()
    ]
    batch = {q: result.time(robot, f"{q}_batch", "ours") for q in _SHOWN}
    bars.append((*_BATCH, batch))
    height = 0.85 / len(bars)
    for k, (label, color, times) in enumerate(bars):
        at = [i + (k - len(bars) / 2 + 0.5) * height for i, t in enumerate(times.values()) if t]
        widths = [t for t in times.values() if t]
        if not widths:
            continue
        drawn = axes.barh(at, widths, height=0.92 * height, color=color, label=label)
        axes.bar_label(drawn, fmt="%.0f", padding=2, fontsize=6.5, color="#333333")
    axes.set_xscale("log")
    axes.set_xlim(8, 9900)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_axisbelow(True)
    axes.set_yticks(range(len(_SHOWN)), [QUANTITIES[q] for q in _SHOWN])
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)


def _draw_chains(axes: Axes, result: Measurement) -> None:
    for library, color in _COLORS.items():
        label = LIBRARIES[library]
        points = [
            (int(chain.removeprefix("mixed")), t)
            for chain in CHAINS
            if (t := result.time(chain, "torques", library)) is not None
        ]
        if points:
            axes.plot(
                *zip(*points, strict=True), color=color, marker="o", markersize=3, label=label
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = (1, 2, 3, 6, 10, 20, 30)
    axes.set_xticks(ticks, [str(n) for n in ticks])
    axes.set_xticks([], minor=True)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("joints")
    axes.set_title("torques of any chain [ns]", loc="left")


def _time(result: Measurement, robot: str, quantity: str, library: str) -> float | None:
    if library != "pinocchio" or quantity != "components":
        return result.time(robot, quantity, library)
    times = [result.time(robot, part, library) for part in ("inertia", "coriolis", "gravity")]
    return sum(t for t in times if t is not None) if None not in times else None
