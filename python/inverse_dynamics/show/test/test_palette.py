# SPDX-License-Identifier: Apache-2.0
"""Colours can be told apart by all readers, on light and on dark paper."""

from itertools import combinations

import numpy as np
import pytest

from inverse_dynamics.show import palette

# Linear RGB as seen by protanopes, deuteranopes and tritanopes [Machado, Oliveira, Fernandes 2009, table 1].
SIGHT = {
    "usual": np.eye(3),
    "protanopia": np.array([
        [0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998],
    ]),
    "deuteranopia": np.array([
        [0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881],
    ]),
    "tritanopia": np.array([
        [1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900],
    ]),
}  # fmt: skip


def linear(color):
    share = np.array([int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def contrast(a, b):
    """Of two colours [WCAG 2.2]."""
    dark, light = sorted(float(np.dot([0.2126, 0.7152, 0.0722], linear(c))) for c in (a, b))
    return (light + 0.05) / (dark + 0.05)


def lab(color, sight):
    """CIE L*a*b* (D65) of a colour as it is seen."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    xyz = to_xyz @ np.clip(sight @ linear(color), 0, 1) / [0.9505, 1.0, 1.089]
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def nearest(colors, sight):
    """Least distance of two of the colours: below 2.3 nobody sees a difference."""
    return min(np.linalg.norm(lab(a, sight) - lab(b, sight)) for a, b in combinations(colors, 2))


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("colors", [palette.LIGHT, palette.DARK], ids=["light", "dark"])
def test_measured_computed_and_error_differ_for_all_eyes(colors, sight):
    shown = [colors[name] for name in ("measured", "computed", "error")]
    assert nearest(shown, SIGHT[sight]) > 20


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("colors", [palette.LIGHT, palette.DARK], ids=["light", "dark"])
def test_other_runs_and_models_differ_for_all_eyes(colors, sight):
    runs = [colors[f"run{k}"] for k in range(len(palette.RUNS))]
    assert nearest([*runs, colors["measured"]], SIGHT[sight]) > 12
    shown = [colors[name] for name in ("measured", "computed", "error")]
    assert nearest([*runs[1:4], *shown], SIGHT[sight]) > 12


@pytest.mark.parametrize("colors", [palette.LIGHT, palette.DARK], ids=["light", "dark"])
def test_lines_and_texts_stand_out_from_the_paper(colors):
    for name in ("measured", "computed", "error", "cursor"):
        assert contrast(colors[name], colors["paper"]) >= 3, name
    for name in ("ink", "soft", "accent"):
        for ground in ("paper", "panel"):
            assert contrast(colors[name], colors[ground]) >= 4.5, (name, ground)
    assert contrast(colors["on-accent"], colors["accent"]) >= 4.5
