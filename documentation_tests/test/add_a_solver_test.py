# SPDX-License-Identifier: Apache-2.0
"""The code on the page `docs/add_a_solver.md` is code of the example package, letter by letter."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from pages import REPOSITORY, blocks_of, page

EXAMPLE = REPOSITORY / "core/inverse_dynamics_solver/examples/pendulum_inverse_dynamics_solver"
BLOCKS = blocks_of(page("docs/add_a_solver.md"))


def test_every_block_of_code_names_its_file() -> None:
    assert {block.language for block in BLOCKS} == {"console", "cpp", "cmake", "xml", "yaml"}
    for block in BLOCKS:
        assert (block.language in {"console", "yaml"}) == (block.file == ""), block.code


def test_blocks_equal_the_files() -> None:
    for _, file, code in BLOCKS:
        if file:
            assert code in (EXAMPLE / file).read_text(encoding="utf-8"), (
                f"{file} has no such lines:\n{code}"
            )


def test_the_example_is_renamed_by_the_commands_of_the_page(tmp_path: Path) -> None:
    commands = blocks_of(page("docs/add_a_solver.md"), "console")[0].code
    environment = {**os.environ, "HOME": str(tmp_path)}
    subprocess.run(["bash", "-euc", commands], cwd=REPOSITORY, env=environment, check=True)
    package = tmp_path / "workspace/src/spring_inverse_dynamics_solver"
    assert (package / "src/spring_inverse_dynamics_solver.cpp").is_file()
    for file in package.rglob("*"):
        assert "pendulum" not in file.name
        assert file.is_dir() or "pendulum" not in file.read_text(encoding="utf-8").lower()
