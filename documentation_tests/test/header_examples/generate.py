# SPDX-License-Identifier: Apache-2.0
"""The examples at the heads of public headers as functions, so that they are compiled.

generate.py OUTPUT CONTEXT HEADER...: examples of a header are the indented blocks of the comment at its head that
have a semicolon (those without are formulas). CONTEXT declares what they take for granted: namespace given, for
all headers, and given::X_examples, for X.hpp.
"""

from __future__ import annotations

import sys
from itertools import groupby, takewhile
from pathlib import Path


def examples(header: Path) -> list[tuple[int, list[str]]]:
    """Number of the first line, and the lines, of each example."""
    lines = list(enumerate(header.read_text(encoding="utf-8").splitlines(), start=1))
    head = takewhile(lambda line: line[1] != "#pragma once", lines)
    blocks = [
        list(block)
        for indented, block in groupby(head, lambda line: line[1].startswith("///     "))
        if indented
    ]
    codes = [(block[0][0], [text[8:] for _, text in block]) for block in blocks]
    return [(number, code) for number, code in codes if ";" in "".join(code)]


def functions(header: Path) -> str:
    """A function for each example of a header, as that header's lines to the compiler."""
    texts = [
        "\n".join([f"void example{k}() {{", f'#line {number} "{header}"', *code, "}"])
        for k, (number, code) in enumerate(examples(header))
    ]
    if not texts:
        return ""
    include = f'#include "{header.parent.name}/{header.name}"'
    return "\n".join([include, f"namespace given::{header.stem}_examples {{", *texts, "}", ""])


def main() -> None:
    output, context, *headers = map(Path, sys.argv[1:])
    texts = [f'#include "{context}"\n', *map(functions, headers)]
    output.write_text("\n".join(texts), encoding="utf-8")


if __name__ == "__main__":
    main()
