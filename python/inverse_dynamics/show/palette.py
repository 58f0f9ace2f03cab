# SPDX-License-Identifier: Apache-2.0
"""The colours of all figures and pages: one quantity, one colour.

Computed and error are of Okabe and Ito's palette, other models of Tol's: colour-blind readers can tell them apart.
Measured torques are a wide grey line below the computed ones, so that both are visible where many samples share a
pixel; in black and white the widths differ.
"""

from __future__ import annotations

MEASURED = "#8C959F"
COMPUTED = "#D55E00"
ERROR = "#0072B2"
CONTACT = "#E69F00"
QUIET = "#009E73"
LEFT_OUT = "#F3EBD9"  # behind samples that the second metrics leave out: no grid line looks like it
RUNS = (COMPUTED, "#332288", "#882255", "#7A4A12", "#56B4E9")
"""Of what several runs, or models of one run, compute: never that of measured torques or of a single error."""

INK = "#1B1F24"
MUTED = "#555555"
GRID = "#E3E6EA"
PAPER = "#FFFFFF"

LIGHT = {
    "ink": INK,
    "soft": "#57606A",
    "line": "#D8DEE4",
    "paper": PAPER,
    "panel": "#F6F8FA",
    "accent": "#0067A3",
    "on-accent": "#FFFFFF",
    "grid": GRID,
    "scene": "#F3F5F8",
    "floor": "#DBE0E7",
    "measured": MEASURED,
    "computed": COMPUTED,
    "error": ERROR,
    "cursor": "#007A59",
    "contact": CONTACT,
    "left-out": LEFT_OUT,
    **{f"run{k}": color for k, color in enumerate(RUNS)},
}
"""Of a page, by CSS variable."""

DARK = {
    **LIGHT,
    "ink": "#E6E9EC",
    "soft": "#A3ADB8",
    "line": "#323A44",
    "paper": "#13171C",
    "panel": "#1C222A",
    "accent": "#6CB4EE",
    "on-accent": "#0B1117",
    "grid": "#2A313A",
    "scene": "#20262E",
    "floor": "#39424D",
    "computed": "#E8701A",
    "error": "#4AA3DF",
    "cursor": "#2BC79A",
    "left-out": "#2B2718",
    "run0": "#E8701A",
    "run1": "#E8D9A0",
    "run2": "#9FF0D0",
    "run3": "#B07A3A",
    "run4": "#5C7CFA",
}
"""The same where the reader prefers dark pages: computed and error of the same hue, lighter."""
