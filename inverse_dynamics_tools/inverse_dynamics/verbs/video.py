# SPDX-License-Identifier: Apache-2.0
"""`ids video`: an evaluation as an animated GIF."""

from __future__ import annotations

import argparse
from pathlib import Path

from inverse_dynamics.verbs.common import positive_number, progress_bar
from inverse_dynamics.verbs.options import add_verb

_EPILOG = """\
examples:
  ids video result                               result.gif
  ids video result --out slides/ur10.gif --seconds 6

The robot is drawn by MuJoCo without a screen. MUJOCO_GL selects the renderer: osmesa (software, the
default; Debian package libosmesa6), egl (graphics card), glfw (needs a screen).
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "video",
        summary="make an animated GIF: the robot in motion and its torques",
        description="Make an animated GIF of an evaluation: the robot in motion and its torques.",
        epilog=_EPILOG,
    )
    parser.add_argument("evaluation", metavar="RUN", type=Path, help="result of `ids evaluate`")
    parser.add_argument("--out", metavar="FILE", type=Path, help="the video (default: RUN.gif)")
    parser.add_argument(
        "--title", metavar="TEXT", default="", help="title of the video (default: the robot's name)"
    )
    parser.add_argument(
        "--seconds",
        metavar="S",
        type=positive_number,
        default=10.0,
        help="length of the video; a longer motion is shown faster (default: 10)",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace an older file")
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.base.files import check_output_file
    from inverse_dynamics.figures.video import write_video
    from inverse_dynamics.results.evaluations import CONTENTS, read_evaluation
    from inverse_dynamics.verbs.screen import Screen

    out = arguments.out or Path(f"{arguments.evaluation.absolute().name}.gif")
    check_output_file(
        out, overwrite=arguments.overwrite, inputs=[arguments.evaluation], results=CONTENTS
    )
    with progress_bar() as progress:
        write_video(
            read_evaluation(arguments.evaluation),
            out,
            title=arguments.title,
            seconds=arguments.seconds,
            progress=progress,
        )
    Screen().print(str(out))
