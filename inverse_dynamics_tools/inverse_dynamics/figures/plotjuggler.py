# SPDX-License-Identifier: Apache-2.0
"""A layout for PlotJuggler: measured and computed torque of each joint, from the output recording.

PlotJuggler names the series of a sensor_msgs/JointState /TOPIC/JOINT/effort. Names of files are
relative to the layout, so a result may be moved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree as Xml

from inverse_dynamics.figures import palette

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.data.joint_log import JointLog, Storage


def torque_layout(
    log: JointLog, units: Sequence[str], topics: tuple[str, str], recording: str, storage: Storage
) -> str:
    """The layout as XML: one tab, a plot per joint.

    topics: measured, computed. recording: what PlotJuggler opens, relative to the layout: the file
    metadata.yaml of a sqlite3 recording, or the .mcap file.
    """
    root = Xml.Element("root")
    window = _add(root, "tabbed_widget", parent="main_window", name="Main Window")
    tab = _add(window, "Tab", tab_name="torques", containers="1")
    n = len(log.joint_names)
    splitter = _add(
        _add(tab, "Container"),
        "DockSplitter",
        orientation="-",
        count=str(n),
        sizes=";".join([f"{1 / n:.6f}"] * n),
    )
    colors = (palette.MEASURED, palette.COMPUTED)
    for joint, unit in zip(log.joint_names, units, strict=True):
        area = _add(splitter, "DockArea", name=f"{joint} [{unit}]")
        plot = _add(area, "plot", mode="TimeSeries", style="Lines", flip_x="false", flip_y="false")
        _add(plot, "limitY")
        for topic, color in zip(topics, colors, strict=True):
            _add(plot, "curve", name=f"{topic}/{joint}/effort", color=color)
    _add(window, "currentTabIndex", index="0")
    _add(root, "use_relative_time_offset", enabled="1")
    files = _add(root, "previouslyLoaded_Datafiles")
    file = _add(files, "fileInfo", filename=recording, prefix="")
    _add_loader(file, topics, log.clock != "receive", storage)
    Xml.indent(root, " ")
    return Xml.tostring(root, encoding="unicode", xml_declaration=False)


def _add_loader(
    parent: Xml.Element, topics: Sequence[str], header_stamps: bool, storage: Storage
) -> None:
    """Which loader, and what it would otherwise ask."""
    selected = ";".join(topics)
    if storage == "mcap":
        settings: Mapping[str, str] = {
            "use_timestamp": str(int(header_stamps)),
            "use_mcap_log_time": str(int(not header_stamps)),
            "clamp_large_arrays": "0",
            "max_array_size": "500",
            "selected_topics": selected,
        }
        _add(_add(parent, "plugin", ID="DataLoad MCAP"), "parameters", **settings)
        return
    loader = _add(parent, "plugin", ID="DataLoad ROS2 bags")
    _add(loader, "use_header_stamp", value=str(header_stamps).lower())
    _add(loader, "discard_large_arrays", value="false")
    _add(loader, "max_array_size", value="500")
    _add(loader, "selected_topics", value=selected)


def _add(parent: Xml.Element, tag: str, /, **attributes: str) -> Xml.Element:
    return Xml.SubElement(parent, tag, attributes)
