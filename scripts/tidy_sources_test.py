# SPDX-License-Identifier: Apache-2.0
"""Tests of tidy_sources.py, on small repositories with a build by Ninja."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from tidy_sources import sources_to_check, write_database

NINJA = """\
rule compile
  command = g++ -MD -MF $out.d -I../../{}/include -c $in -o $out
  depfile = $out.d
  deps = gcc
"""
SOURCES = {
    "engine/src/chain.cpp": '#include "engine/chain.hpp"\n',
    "engine/src/text.cpp": "",
    "solver/src/solver.cpp": "#include <engine/chain.hpp>\n",
    "solver/src/plugin.cpp": "",
}
ALL = sorted(SOURCES)

pytestmark = pytest.mark.skipif(
    not all(map(shutil.which, ("git", "ninja", "g++"))), reason="git, Ninja or g++ isn't installed"
)


def git(root: Path, *arguments: str) -> None:
    who = ("-c", "user.name=test", "-c", "user.email=test@example.invalid")
    subprocess.run(["git", "-C", str(root), *who, *arguments], check=True, capture_output=True)


def commit(root: Path) -> None:
    git(root, "add", "--all")
    git(root, "commit", "--quiet", "--message", "change")


def write(root: Path, file: str, text: str) -> None:
    path = root / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def build(root: Path) -> None:
    """As colcon does: the second package includes the installed copy of the first one's header."""
    installed = root / "install/engine/include/engine"
    installed.mkdir(parents=True)
    shutil.copy(root / "engine/include/engine/chain.hpp", installed)
    for package in ("engine", "solver"):
        objects = [s for s in ALL if s.startswith(package)]
        rules = [f"build {Path(s).stem}.o: compile ../../{s}\n" for s in objects]
        headers = "engine" if package == "engine" else "install/engine"
        write(root, f"build/{package}/build.ninja", NINJA.format(headers) + "".join(rules))
        command = ["ninja", "-C", str(root / "build" / package)]
        subprocess.run(command, check=True, capture_output=True)


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two commits on `main`, of which the second changes engine/src/text.cpp; built."""
    monkeypatch.delenv("CHANGED_SINCE", raising=False)
    root = tmp_path / "workspace"
    root.mkdir()
    git(root, "init", "--quiet", "--initial-branch", "main")
    write(root, ".gitignore", "build/\ninstall/\n")
    write(root, "engine/include/engine/chain.hpp", "#pragma once\n")
    for file, text in SOURCES.items():
        write(root, file, text)
    commit(root)
    write(root, "engine/src/text.cpp", "// text\n")
    commit(root)
    build(root)
    return root


def test_on_the_main_branch_the_last_commit_counts(root: Path) -> None:
    sources, reason = sources_to_check(root)
    assert sources == ["engine/src/text.cpp"]
    assert "1 of 4 sources" in reason
    assert "the commit before" in reason


def test_on_the_main_branch_all_commits_of_a_push_count(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    show = ["git", "-C", str(root), "rev-parse", "HEAD"]
    before = subprocess.run(show, check=True, capture_output=True, text=True).stdout.strip()
    for file in ("solver/src/plugin.cpp", "engine/src/chain.cpp"):
        write(root, file, "// changed\n")
        commit(root)
    monkeypatch.setenv("CHANGED_SINCE", before)
    sources, reason = sources_to_check(root)
    assert sources == ["engine/src/chain.cpp", "solver/src/plugin.cpp"]
    assert f"since {before[:10]}, which CHANGED_SINCE names" in reason


def test_a_stated_commit_that_the_clone_lacks_means_all(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CHANGED_SINCE", 40 * "0")
    sources, reason = sources_to_check(root)
    assert sources == ALL
    assert "no commit 0000000000" in reason


def test_on_a_branch_what_changed_since_the_last_push_does_not_limit_the_check(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    git(root, "checkout", "--quiet", "-b", "branch")
    for file in ("solver/src/plugin.cpp", "README.md"):
        write(root, file, "// changed\n")
        commit(root)
    monkeypatch.setenv("CHANGED_SINCE", "HEAD^")
    assert sources_to_check(root)[0] == ["solver/src/plugin.cpp"]


def test_on_a_branch_everything_since_it_left_counts(root: Path) -> None:
    git(root, "checkout", "--quiet", "-b", "branch")
    for file in ("solver/src/plugin.cpp", "README.md"):
        write(root, file, "// changed\n")
        commit(root)
    sources, reason = sources_to_check(root)
    assert sources == ["solver/src/plugin.cpp"]
    assert "where this branch left main" in reason


def test_a_header_touches_those_that_include_it_installed_or_not(root: Path) -> None:
    git(root, "checkout", "--quiet", "-b", "branch")
    write(root, "engine/include/engine/chain.hpp", "#pragma once\n// changed\n")
    commit(root)
    assert sources_to_check(root)[0] == ["engine/src/chain.cpp", "solver/src/solver.cpp"]


def build_solver_at_a_time(root: Path) -> str:
    """As a unity build compiles it; the name of the source that includes them both."""
    both = "build/solver/CMakeFiles/solver.dir/Unity/unity_0_cxx.cxx"
    names = [str(root / "solver/src" / file) for file in ("solver.cpp", "plugin.cpp")]
    write(root, both, "".join(f'#include "{name}"\n' for name in names))
    rules = f"build unity_0_cxx.o: compile ../../{both}\n"
    write(root, "build/solver/build.ninja", NINJA.format("install/engine") + rules)
    (root / "build/solver/.ninja_deps").unlink()
    command = ["ninja", "-C", str(root / "build/solver")]
    subprocess.run(command, check=True, capture_output=True)
    return both


def test_a_source_touches_no_other_that_is_compiled_with_it(root: Path) -> None:
    build_solver_at_a_time(root)
    write(root, "solver/src/plugin.cpp", "// changed\n")
    sources, _ = sources_to_check(root)
    assert sources == ["engine/src/text.cpp", "solver/src/plugin.cpp"]


def test_a_header_touches_all_that_are_compiled_with_one_that_includes_it(root: Path) -> None:
    build_solver_at_a_time(root)
    write(root, "engine/include/engine/chain.hpp", "#pragma once\n// changed\n")
    assert sources_to_check(root)[0] == ALL


def test_clang_tidy_gets_each_source_by_itself(root: Path) -> None:
    both = root / build_solver_at_a_time(root)
    chain = root / "engine/src/chain.cpp"
    command = 'g++ -DNAME=\\"a\\" -flive-range-shrinkage -c {}'
    entries = [
        {"directory": str(root), "command": command.format(file), "file": str(file)}
        for file in (chain, both)
    ]
    write(root, "build/compile_commands.json", json.dumps(entries))
    write_database(root)
    database = json.loads((root / "build/clang_tidy/compile_commands.json").read_text())
    files = [str(chain), *(str(root / f"solver/src/{f}.cpp") for f in ("solver", "plugin"))]
    assert [entry["file"] for entry in database] == files
    assert [entry["command"] for entry in database] == [
        f"g++ '-DNAME=\"a\"' -c {file}" for file in files
    ]


def test_what_is_not_committed_counts(root: Path) -> None:
    write(root, "engine/src/new.cpp", "")
    write(root, "solver/src/plugin.cpp", "// changed\n")
    sources, _ = sources_to_check(root)
    assert sources == ["engine/src/new.cpp", "engine/src/text.cpp", "solver/src/plugin.cpp"]


def test_other_rules_touch_everything(root: Path) -> None:
    write(root, ".clang-tidy", "Checks: '*'\n")
    sources, reason = sources_to_check(root)
    assert sources == ALL
    assert ".clang-tidy changed" in reason


def test_another_lint_touches_everything(root: Path) -> None:
    write(root, "scripts/lint", "clang-tidy --other\n")
    sources, reason = sources_to_check(root)
    assert sources == ALL
    assert "scripts/lint changed" in reason


def test_other_flags_touch_the_sources_of_their_package(root: Path) -> None:
    write(root, "solver/CMakeLists.txt", "add_compile_options(-O3)\n")
    write(root, "engine/test/CMakeLists.txt", "\n")
    sources, _ = sources_to_check(root)
    assert sources == ["engine/src/text.cpp", "solver/src/plugin.cpp", "solver/src/solver.cpp"]


def test_all_means_all(root: Path) -> None:
    assert sources_to_check(root, everything=True) == (ALL, "all 4 sources")


def test_a_source_of_which_no_build_is_known_is_checked(root: Path) -> None:
    shutil.rmtree(root / "build/solver")
    sources, _ = sources_to_check(root)
    assert sources == ["engine/src/text.cpp", "solver/src/plugin.cpp", "solver/src/solver.cpp"]


def test_a_clone_without_history_checks_everything_and_says_so(root: Path, tmp_path: Path) -> None:
    shallow = tmp_path / "shallow"
    git(tmp_path, "clone", "--quiet", "--depth", "1", f"file://{root}", str(shallow))
    sources, reason = sources_to_check(shallow)
    assert sources == ALL
    assert "no commit to compare with" in reason


def test_a_clone_compares_with_the_branch_that_it_came_from(root: Path, tmp_path: Path) -> None:
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "--quiet", str(root), str(clone))
    git(clone, "checkout", "--quiet", "-b", "branch")
    build(clone)
    write(clone, "solver/src/solver.cpp", "")
    commit(clone)
    sources, reason = sources_to_check(clone)
    assert sources == ["solver/src/solver.cpp"]
    assert "where this branch left origin/HEAD" in reason
