# SPDX-License-Identifier: Apache-2.0
"""The examples at the heads of public headers as functions, so that they are compiled.

generate.py OUTPUT HEADER...: the example of a header is the first indented block of the comment at its head.
"""

from __future__ import annotations

import sys
from itertools import dropwhile, takewhile
from pathlib import Path

_ESTIMATOR = "extern EstimatorOptions options;"
_LAW = "extern LawOptions options;"
GIVEN = {
    "acceleration_residual": _ESTIMATOR,
    "computed_torque": _LAW,
    "damping": _LAW,
    "estimator_choice": _ESTIMATOR,
    "feed_forward": _LAW,
    "gravity_compensation": _LAW,
    "momentum_observer": _ESTIMATOR,
    "output_stage": "extern OutputLimits limits; extern Eigen::VectorXd desired;",
    "pd_gravity_compensation": _LAW,
    "reference_guard": "extern ReferenceLimits limits; extern Reference desired;",
    "tip_wrench": "extern WrenchOptions options;",
}
"""What examples are given beside context.hpp, where a name means something else in each."""


def example(header: Path) -> tuple[int, list[str]]:
    """Number of its first line, and its lines; none: no example."""
    lines = list(enumerate(header.read_text(encoding="utf-8").splitlines(), start=1))
    head = list(takewhile(lambda line: line[1] != "#pragma once", lines))
    block = list(
        takewhile(
            lambda line: line[1].startswith("///     "),
            dropwhile(lambda line: not line[1].startswith("///     "), head),
        )
    )
    return (block[0][0], [text[8:] for _, text in block]) if block else (0, [])


def function(header: Path) -> str:
    """A function with the example of a header, as that header's lines to the compiler."""
    number, lines = example(header)
    if not lines:
        return ""
    include = f"{header.parent.name}/{header.name}"
    return "\n".join(
        [
            f'#include "{include}"',
            f"namespace example_{header.stem} {{",
            GIVEN.get(header.stem, ""),
            "void example() {",
            f'#line {number} "{header}"',
            *lines,
            "}",
            "}",
            "",
        ]
    )


def main() -> None:
    output, *headers = map(Path, sys.argv[1:])
    texts = ['#include "context.hpp"\n', *map(function, headers)]
    output.write_text("\n".join(texts), encoding="utf-8")


if __name__ == "__main__":
    main()
