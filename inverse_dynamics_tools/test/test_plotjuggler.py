# SPDX-License-Identifier: Apache-2.0
"""The output recording as PlotJuggler and Foxglove find it."""

from dataclasses import replace
from xml.etree import ElementTree as Xml

import pytest
from rosbags.rosbag2 import Reader
from test_results import make_evaluation

from inverse_dynamics import write_evaluation
from inverse_dynamics.figures import palette


@pytest.fixture(scope="module", params=["sqlite3", "mcap"])
def result(request, tmp_path_factory):
    target = tmp_path_factory.mktemp(request.param) / "result"
    write_evaluation(make_evaluation(), target, storage=request.param)
    return target


def layout(result):
    return Xml.parse(result / "plotjuggler.xml").getroot()


def test_the_layout_shows_both_torques_of_each_joint_in_one_tab(result):
    plots = layout(result).findall("./tabbed_widget/Tab/Container/DockSplitter/DockArea")
    assert [plot.get("name") for plot in plots] == [f"joint_{i} [N m]" for i in (1, 2, 3)]
    for i, area in enumerate(plots, start=1):
        curves = [(c.get("name"), c.get("color")) for c in area.findall("plot/curve")]
        assert curves == [
            (f"/torques_gt/joint_{i}/effort", palette.MEASURED),
            (f"/torques/joint_{i}/effort", palette.COMPUTED),
        ]
    assert len(layout(result).findall(".//Tab")) == 1


def test_the_layout_opens_the_recording_and_its_topics(result):
    file = layout(result).find("previouslyLoaded_Datafiles/fileInfo")
    opened = result / file.get("filename")
    assert opened.is_file()
    loader = file.find("plugin")
    if opened.suffix == ".mcap":
        assert loader.get("ID") == "DataLoad MCAP"
        selected = loader.find("parameters").get("selected_topics")
    else:
        assert opened.name == "metadata.yaml"
        assert loader.get("ID") == "DataLoad ROS2 bags"
        selected = loader.find("selected_topics").get("value")
    with Reader(result / "bag") as reader:
        assert set(selected.split(";")) == set(reader.topics)


def test_joint_names_that_xml_must_escape_are_kept(tmp_path):
    evaluation = make_evaluation(20, 1)
    log = replace(evaluation.log, joint_names=('a<b>&"c"',))
    write_evaluation(replace(evaluation, log=log), tmp_path / "result")
    names = [c.get("name") for c in layout(tmp_path / "result").iter("curve")]
    assert names == ['/torques_gt/a<b>&"c"/effort', '/torques/a<b>&"c"/effort']


def test_the_stamps_that_are_the_time_are_those_of_the_layout(tmp_path):
    evaluation = make_evaluation(20, 1)
    log = replace(evaluation.log, clock="receive")
    write_evaluation(replace(evaluation, log=log), tmp_path / "a", storage="mcap")
    write_evaluation(evaluation, tmp_path / "b", storage="mcap")
    use = [layout(tmp_path / d).find(".//parameters").get("use_timestamp") for d in "ab"]
    assert use == ["0", "1"]
