# SPDX-License-Identifier: Apache-2.0
import warnings
from dataclasses import replace

import numpy as np
import pytest
from example_evaluations import make_evaluation

from inverse_dynamics import save_torque_figure, torque_figure
from inverse_dynamics._core import Accelerations
from inverse_dynamics.comparison.comparison import compare
from inverse_dynamics.show import palette


def texts(figure):
    """Everything that is written in a figure."""
    found = [t.get_text() for t in figure.texts]
    for axes in figure.axes:
        found += [axes.get_title(loc="left"), axes.get_xlabel()]
    for legend in figure.legends:
        found += [t.get_text() for t in legend.get_texts()]
    return "\n".join(found)


def test_every_joint_has_a_row_with_torques_and_error():
    evaluation = make_evaluation(joints=4)
    figure = torque_figure(evaluation)
    assert len(figure.axes) == 8
    for j, (left, right) in enumerate(zip(figure.axes[::2], figure.axes[1::2], strict=True)):
        measured, computed = left.get_lines()  # the computed one is drawn over the measured one
        np.testing.assert_array_equal(computed.get_ydata(), evaluation.computed[:, j])
        np.testing.assert_array_equal(measured.get_ydata(), evaluation.measured[:, j])
        np.testing.assert_array_equal(measured.get_xdata(), evaluation.time)
        assert measured.get_color() == palette.MEASURED
        assert computed.get_color() == palette.COMPUTED
        assert measured.get_linewidth() > 1.5 * computed.get_linewidth()
        error = right.get_lines()[-1]
        assert error.get_color() == palette.ERROR
        np.testing.assert_array_equal(
            error.get_ydata(), evaluation.computed[:, j] - evaluation.measured[:, j]
        )
        low, high = right.get_ylim()
        assert low == -high


def test_a_spike_does_not_flatten_the_error():
    evaluation = make_evaluation()
    computed = evaluation.computed.copy()
    usual = np.abs(computed[:, 0] - evaluation.measured[:, 0]).max()
    computed[0, 0] += 1000.0
    spiked = replace(evaluation, computed=computed)
    _, high = torque_figure(spiked).axes[1].get_ylim()
    assert usual <= high < 2.0 * usual
    comparison = compare([spiked, evaluation])
    _, high = comparison.plot().axes[1].get_ylim()
    assert usual <= high < 2.0 * usual


def test_the_figure_says_robot_solver_filter_and_units():
    evaluation = make_evaluation()
    shown = texts(torque_figure(evaluation))
    for part in (
        "Arm [of a test]",
        "solver a/B",
        "recording, 400 samples, 4.0 s",
        "cut-off 3.25 Hz (chosen from the data)",
        "joint_2 [N m]",
        f"RMSE {evaluation.errors[0].rmse:.3g} N m",
        "measured torque",
        "computed torque",
        "time [s]",
    ):
        assert part in shown
    raw = replace(evaluation, accelerations=Accelerations("backward-difference"))
    raw = replace(raw, robot=replace(raw.robot, friction=False))
    shown = texts(torque_figure(raw))
    assert "backward-difference, no filter" in shown
    assert "friction left out" in shown


def test_no_text_is_cut_off_or_covers_another():
    evaluation = make_evaluation()
    long = replace(evaluation.robot, description="A description that is long, " * 8)
    figure = torque_figure(replace(evaluation, robot=long))
    figure.canvas.draw()
    whole = figure.bbox
    boxes = [t.get_window_extent() for t in figure.texts]
    boxes += [legend.get_window_extent() for legend in figure.legends]
    for i, box in enumerate(boxes):
        assert whole.x0 <= box.x0
        assert box.x1 <= whole.x1
        assert box.y1 <= whole.y1
        assert not any(box.overlaps(other) for other in boxes[i + 1 :])


def test_the_same_evaluation_gives_the_same_bytes(tmp_path):
    evaluation = make_evaluation(100)
    starts = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}
    together = [tmp_path / f"together.{suffix}" for suffix in starts]
    save_torque_figure(evaluation, *together)
    for file, start in zip(together, starts.values(), strict=True):
        alone = file.with_stem("alone")
        save_torque_figure(evaluation, alone)
        assert alone.read_bytes() == file.read_bytes()
        assert alone.read_bytes().startswith(start)


def test_samples_that_are_left_out_are_shaded():
    evaluation = make_evaluation()  # without the first five of 400
    kept = evaluation.samples.kept.copy()
    kept[200] = kept[390:] = False
    figure = torque_figure(replace(evaluation, samples=replace(evaluation.samples, kept=kept)))
    t = evaluation.time
    for axes in figure.axes:
        spans = [(p.get_x(), p.get_x() + p.get_width()) for p in axes.patches]
        assert [begin for begin, _ in spans] == pytest.approx([t[0], t[200], t[390]])
        assert spans[0][1] == pytest.approx(t[4])
        assert spans[1][1] > t[200]  # a single sample can be seen too
        assert spans[2][1] == pytest.approx(t[-1])
    assert "samples left out" in texts(figure)
    everything = replace(evaluation.samples, kept=np.ones(400, dtype=bool))
    plain = torque_figure(replace(evaluation, samples=everything))
    assert "samples left out" not in texts(plain)


def test_a_comparison_uses_neither_the_colour_of_measured_torques_nor_that_of_an_error():
    evaluation = make_evaluation()
    runs = [replace(evaluation, computed=evaluation.computed + k) for k in range(5)]
    left, right = compare(runs, tuple("abcde")).plot().axes[:2]
    measured, *computed = left.get_lines()
    assert measured.get_color() == palette.MEASURED
    colors = [line.get_color() for line in computed]
    assert colors[0] == palette.COMPUTED
    assert len({*colors, palette.MEASURED, palette.ERROR}) == 7
    assert [line.get_color() for line in right.get_lines()[1:]] == colors


def test_characters_that_the_font_lacks_are_written_as_escapes(tmp_path):
    evaluation = make_evaluation(joints=2)
    evaluation = replace(evaluation, joint_names=("关节", "Gelenk_ä"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # matplotlib's: Glyph 20851 missing from font(s) DejaVu Sans
        save_torque_figure(evaluation, tmp_path / "torques.svg")
    drawn = (tmp_path / "torques.svg").read_text(encoding="utf-8")
    assert "\\u5173\\u8282" in drawn
    assert "Gelenk_ä" in drawn
