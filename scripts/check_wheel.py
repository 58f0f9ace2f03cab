# SPDX-License-Identifier: Apache-2.0
"""What a wheel must be, as ./scripts/wheel checks it.

python check_wheel.py file inverse_dynamics-*.whl     # size, contents, licences
python check_wheel.py installed DIR                   # version, ids demo into the directory
python check_wheel.py plugin PACKAGE/CLASS            # a solver that another wheel brings
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

ROOT = Path(__file__).resolve().parents[1]
ROBOTS = ROOT / "core/inverse_dynamics_robots"
MOST_MEGABYTES = 15.0  # of a wheel, without its dependencies

# What a user finds inside, below the module's directory; besides, headers of each library and what comes with a robot.
NEEDED = (
    "lib/libinverse_dynamics_solver.so",
    "lib/libkdl_inverse_dynamics_solver_plugin.so",
    "lib/cmake/inverse_dynamics/inverse_dynamicsConfig.cmake",
    "_core.pyi",
    "py.typed",
)


def needed(names: list[str]) -> list[str]:
    """What a user finds inside a wheel of these files."""
    found = list(NEEDED)
    for include in ROOT.glob("[cms]*/*_*/include"):  # core, methods, solvers
        package = include.parent.name
        if f"inverse_dynamics/lib/lib{package}.so" in names:
            headers = include.rglob("*.hpp")
            found += [f"include/{package}/{header.relative_to(include)}" for header in headers]
    data = [f for d in ("models", "recordings", "robots") for f in (ROBOTS / d).rglob("*")]
    return found + [f"share/{file.relative_to(ROBOTS.parent)}" for file in data if file.is_file()]


def faults_of_file(wheel: Path) -> list[str]:
    """What is wrong with a wheel, in words."""
    faults = []
    size = wheel.stat().st_size / 1e6
    if size > MOST_MEGABYTES:
        faults.append(f"{size:.1f} MB, expected at most {MOST_MEGABYTES:g} MB")
    with ZipFile(wheel) as archive:
        names = archive.namelist()
        notices = [n for n in names if n.endswith("/licenses/licenses/THIRD_PARTY.md")]
        text = archive.read(notices[0]).decode() if notices else ""
    faults += [f"no {name}" for name in needed(names) if f"inverse_dynamics/{name}" not in names]
    if not any(n.endswith("/licenses/licenses/LGPL-2.1.txt") for n in names):
        faults.append("the licence of Orocos KDL is missing")
    kdl = re.search(r"/liborocos-kdl(-[0-9a-f]{8})?\.so\.([0-9.]+)", "\n".join(names))
    if kdl and f"Orocos KDL {kdl[2]}" not in text:
        faults.append(f"licenses/THIRD_PARTY.md doesn't name the source of Orocos KDL {kdl[2]}")
    faults += [
        f"{library}: licenses/THIRD_PARTY.md doesn't name it"
        for library in sorted(bundled_libraries(names))
        if f"`{library}`" not in text
    ]
    return faults


def bundled_libraries(names: list[str]) -> set[str]:
    """Libraries of others, without the hash that auditwheel adds: `libyaml-cpp`."""
    files = [Path(n).name for n in names if n.startswith("inverse_dynamics.libs/") and ".so" in n]
    return {re.sub(r"(-[0-9a-f]{8})?\.so.*$", "", file) for file in files}


def faults_of_installation(out: Path) -> list[str]:
    """What is wrong with the installed package, in words."""
    faults = []
    ids = Path(sys.executable).with_name("ids")
    manifest = (ROOT / "python/package.xml").read_text()
    version = re.search("<version>(.*)</version>", manifest)
    told = subprocess.run([ids, "--version"], capture_output=True, text=True).stdout.split()
    if version is None or told != ["ids", version[1]]:
        faults.append(f"ids --version says {' '.join(told)}")
    demo = subprocess.run([ids, "demo", "--out", out, "--overwrite"])
    if demo.returncode != 0 or not (out / "report.html").is_file():
        faults.append(f"ids demo: exit status {demo.returncode}")
    return faults


def faults_of_plugin(name: str) -> list[str]:
    """What is wrong with the example of a plugin in a wheel of its own, in words."""
    import numpy as np

    from inverse_dynamics import Solver, available_solvers

    if name not in available_solvers():
        return [f"{name} isn't among {', '.join(available_solvers())}"]
    solver = Solver(name, parameters={"mass": 2.0, "length": 0.5})
    torque = float(solver.gravity_vector(np.array([np.pi / 2]))[0])
    expected = 2.0 * 9.81 * 0.5  # m g l, held horizontally
    return [] if abs(torque - expected) < 1e-12 else [f"{torque} N m, expected {expected}"]


def main(what: str, argument: str) -> int:
    """Print what is wrong; give the exit status."""
    if what == "file":
        faults = faults_of_file(Path(argument))
    elif what == "installed":
        faults = faults_of_installation(Path(argument))
    else:
        faults = faults_of_plugin(argument)
    for fault in faults:
        print(f"error: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
