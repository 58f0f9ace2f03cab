# SPDX-License-Identifier: Apache-2.0
"""A user's program with compiler flags of its own against the installed packages, built as a stranger builds it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from pages import REPOSITORY

PROGRAM = Path(__file__).resolve().parent / "users_program"
PENDULUM = REPOSITORY / "core/inverse_dynamics_solver/examples/pendulum_inverse_dynamics_solver"
PREFIXES = [Path(prefix) for prefix in os.environ["AMENT_PREFIX_PATH"].split(os.pathsep)]

# What the processor must have for a program's flags (names of /proc/cpuinfo).
NEEDED = {
    "avx2": {"avx2", "fma"},
    "avx512": {"avx2", "fma", "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}


def run(*command: str | Path, **environment: str) -> str:
    """Output of a command that succeeds; otherwise the test fails and shows it."""
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, **environment}
    )
    assert done.returncode == 0, f"{command}\n{done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def processor() -> set[str]:
    """What this processor has."""
    match = re.search(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return set(match[1].split()) if match else set()


@pytest.fixture(scope="module")
def configured(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Build folder of a compiler, configured when it is first asked for."""

    @cache
    def folder(compiler: str) -> Path:
        build = tmp_path_factory.mktemp("build")
        run("cmake", "-S", PROGRAM, "-B", build, f"-DCMAKE_CXX_COMPILER={compiler}")
        return build

    return folder


@pytest.mark.parametrize(
    ("compiler", "program"),
    [
        pytest.param("c++", "avx2", marks=pytest.mark.nightly),
        pytest.param("c++", "avx512", marks=pytest.mark.nightly),
        ("c++", "address_sanitizer"),
        pytest.param("clang++", "plain", marks=pytest.mark.nightly),
    ],
)
def test_program_runs_with_flags_of_its_own(
    configured: Callable[[str], Path], compiler: str, program: str
) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} isn't installed")
    if program in NEEDED and os.uname().machine != "x86_64":
        pytest.skip(f"{program} is of x86-64, this is {os.uname().machine}")
    build = configured(compiler)
    run("cmake", "--build", build, "--target", program)
    missing = NEEDED.get(program, set()) - processor()
    if missing:
        pytest.skip(f"built, not run: this processor lacks {', '.join(sorted(missing))}")
    assert "[  PASSED  ] 10 tests" in run(build / program)


def packages_libraries() -> list[Path]:
    """The shared libraries of the workspace that programs and plugins link."""
    ours = [prefix for prefix in PREFIXES if (prefix / "share/chain_dynamics").is_dir()]
    assert ours
    names = {path.name for path in REPOSITORY.iterdir() if (path / "package.xml").is_file()}
    return [
        library
        for prefix in PREFIXES
        for library in sorted((prefix / "lib").glob("lib*.so"))
        if library.name[3:-3] in names
    ]


@pytest.mark.parametrize("library", packages_libraries(), ids=lambda path: path.name)
def test_libraries_offer_no_copy_of_eigens_functions(library: Path) -> None:
    """They would be taken for the program's own, whose Eigen frees memory in another way."""
    symbols = run("nm", "--dynamic", "--demangle", "--defined-only", library).splitlines()
    assert any(" T " in symbol for symbol in symbols)
    assert [symbol for symbol in symbols if re.search(r" [WVu] .*Eigen::", symbol)] == []


def test_any_python_may_be_first_on_the_path(tmp_path: Path) -> None:
    """pyenv and conda put a python3 first that has no module ament_package."""
    python = tmp_path / "bin/python3"
    python.parent.mkdir()
    python.write_text("#!/bin/sh\nexit 1\n")
    python.chmod(0o755)
    path = f"{python.parent}:/usr/bin:/bin"
    for source in (PROGRAM, PENDULUM):
        run("cmake", "-S", source, "-B", tmp_path / source.name, PATH=path, VIRTUAL_ENV="")


def test_headers_of_a_release_in_the_underlay_never_come_first(tmp_path: Path) -> None:
    """Where packages of the underlay bring its include directory, which holds the release's headers."""
    for package in ("inverse_dynamics_solver", "kdl_inverse_dynamics_solver"):
        header = tmp_path / "include" / package / f"{package}.hpp"
        header.parent.mkdir(parents=True)
        header.write_text(f'#error "{package} of the release"\n')
    (tmp_path / "main.cpp").write_text(
        "#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>\n"
        "#include <kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp>\n"
    )
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(overlay LANGUAGES CXX)\n"
        "find_package(kdl_inverse_dynamics_solver REQUIRED)\n"
        "add_library(overlay OBJECT main.cpp)\n"
        "target_include_directories(overlay PRIVATE include)\n"
        "target_link_libraries(overlay PRIVATE kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver)\n"
    )
    build = tmp_path / "build"
    underlay = f"{os.environ['AMENT_PREFIX_PATH']}:{tmp_path}"
    run("cmake", "-S", tmp_path, "-B", build, AMENT_PREFIX_PATH=underlay)
    run("cmake", "--build", build)


def test_a_plugin_of_another_interface_version_is_refused(
    configured: Callable[[str], Path],
) -> None:
    """Built against headers whose layouts may be others: what the number of the namespace says."""
    build = configured("c++")
    other = build / "another_version"  # where CMakeLists.txt looks for them
    for prefix in PREFIXES:
        for package in ("chain_dynamics", "inverse_dynamics_solver"):
            if (prefix / "include" / package).is_dir():
                shutil.copytree(prefix / "include" / package, other / "include", dirs_exist_ok=True)
    for header in (other / "include").rglob("*.hpp"):
        header.write_text(
            re.sub(r"\binline namespace v\d+\b", "inline namespace v1", header.read_text())
        )

    name = "pendulum_inverse_dynamics_solver"
    share, index = other / "share", other / "share/ament_index/resource_index"
    for file in ("package.xml", f"{name}.xml"):
        (share / name).mkdir(parents=True, exist_ok=True)
        shutil.copy(PENDULUM / file, share / name)
    for resource, text in (
        ("packages", ""),
        ("inverse_dynamics_solver__pluginlib__plugin", f"share/{name}/{name}.xml\n"),
    ):
        (index / resource).mkdir(parents=True)
        (index / resource / name).write_text(text)

    run("cmake", "--build", build, "--target", "plugin_of_another_version", "load_solver")
    text = run(
        build / "load_solver",
        f"{name}/InverseDynamicsSolverPendulum",
        AMENT_PREFIX_PATH=f"{other}:{os.environ['AMENT_PREFIX_PATH']}",
    )
    assert "was built against another version of the interface" in text
    assert f"rebuild package {name} against this workspace" in text
