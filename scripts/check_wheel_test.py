# SPDX-License-Identifier: Apache-2.0
from pathlib import Path
from zipfile import ZipFile

import check_wheel

ROOT = Path(__file__).resolve().parents[1]
LIBRARIES = ("libyaml-cpp-30f08faf.so.0.7.0", "liborocos-kdl-0dc34d62.so.1.5.1", "libzstd.so.1")


def wheel(directory: Path, *left_out: str, libraries: tuple[str, ...] = LIBRARIES) -> Path:
    """A file with the names of a wheel."""
    licenses = "inverse_dynamics-0.1.0.dist-info/licenses/licenses"
    contents = {f"inverse_dynamics/{needed}": "" for needed in check_wheel.NEEDED}
    contents |= {f"inverse_dynamics.libs/{library}": "" for library in libraries}
    contents[f"{licenses}/THIRD_PARTY.md"] = (ROOT / "licenses/THIRD_PARTY.md").read_text()
    contents[f"{licenses}/LGPL-2.1.txt"] = ""
    file = directory / "inverse_dynamics-0.1.0-cp311-cp311-linux_x86_64.whl"
    with ZipFile(file, "w") as archive:
        for name, text in contents.items():
            if not name.endswith(left_out):
                archive.writestr(name, text)
    return file


def test_a_complete_wheel_has_no_fault(tmp_path: Path) -> None:
    assert check_wheel.faults_of_file(wheel(tmp_path), 15) == []


def test_what_is_missing_is_named(tmp_path: Path) -> None:
    file = wheel(tmp_path, "py.typed", "LGPL-2.1.txt")
    assert check_wheel.faults_of_file(file, 15) == [
        "no py.typed",
        "the licence of Orocos KDL is missing",
    ]


def test_a_library_without_a_notice_is_named(tmp_path: Path) -> None:
    file = wheel(tmp_path, libraries=("libpython3-0a1b2c3d.11.so.1.0", *LIBRARIES))
    assert check_wheel.faults_of_file(file, 15) == [
        "libpython3-0a1b2c3d.11: licenses/THIRD_PARTY.md doesn't name it"
    ]


def test_a_version_of_kdl_whose_source_is_not_named_is_a_fault(tmp_path: Path) -> None:
    file = wheel(tmp_path, libraries=("liborocos-kdl-0dc34d62.so.1.5.3",))
    assert check_wheel.faults_of_file(file, 15) == [
        "licenses/THIRD_PARTY.md doesn't name the source of Orocos KDL 1.5.3"
    ]


def test_a_large_wheel_is_a_fault(tmp_path: Path) -> None:
    (fault,) = check_wheel.faults_of_file(wheel(tmp_path), 0.001)
    assert fault.endswith("MB, expected at most 0.001 MB")


def test_names_of_libraries_lose_their_hash_and_version() -> None:
    names = [f"inverse_dynamics.libs/{name}" for name in LIBRARIES]
    assert check_wheel.bundled_libraries([*names, "inverse_dynamics/lib/libchain_dynamics.so"]) == {
        "libyaml-cpp",
        "liborocos-kdl",
        "libzstd",
    }
