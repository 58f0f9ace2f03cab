# SPDX-License-Identifier: Apache-2.0
import json
import re
from pathlib import Path

import pytest

from inverse_dynamics.installation.ament import PackageNotFoundError, package_share
from inverse_dynamics_benchmarks import measure, page, read_measurement, write_measurement
from inverse_dynamics_benchmarks.measurement import measurement

DOCS = Path(__file__).parents[2] / "docs"


def fails(result, *expected):
    """The user is told, on stderr; exit code 2."""
    code, out, err = result
    assert (code, out) == (2, "")
    for part in expected:
        assert part in err


def entry(name, time, *, real=0.0, **more):
    """Of Google Benchmark's JSON, as random interleaving with aggregates writes it."""
    return {
        "name": f"{name}_min",
        "run_name": name,
        "run_type": "aggregate",
        "aggregate_name": "min",
        "real_time": real,
        "cpu_time": time,
        "time_unit": "ns",
        **more,
    }


def document(*entries, **context):
    return {"context": {"processor": "Abacus", **context}, "benchmarks": list(entries)}


@pytest.fixture
def speed_json(tmp_path):
    file = tmp_path / "speed.json"
    entries = [
        entry("ur10/torques/ours", 100.0),
        entry("ur10/torques/pinocchio", 900.0),
        entry("ur10/torques/kdl", 1500.0),
        entry("panda/torques/ours", 200.0),
        entry("panda/torques/pinocchio", 1400.0),
        entry("ur10/torques_batch/ours/real_time", 1.0, real=25_600.0, states=1024),
    ]
    file.write_text(json.dumps(document(*entries)))
    return file


def benchmarks_installed():
    try:
        prefix = package_share("inverse_dynamics_benchmarks").parents[1]
    except PackageNotFoundError:
        return False
    return (prefix / "bin/inverse_dynamics_benchmark").is_file()


needs_benchmarks = pytest.mark.skipif(
    not benchmarks_installed(),
    reason="without the benchmarks (./scripts/build; Debian: libbenchmark-dev)",
)


@needs_benchmarks
def test_one_command_measures_and_writes_everything(ids, tmp_path):
    options = ["--repetitions", "2", "--seconds", "1e-6", "--only", "^ur10/torques(_batch)?/"]
    files = ["--json", "out/a.json", "--markdown", "out/a.md", "--plot", "out/a.svg"]
    code, out, err = ids("bench", *options, "--latency", "--calls", "100", *files)
    assert (code, err) == (0, "")
    assert re.search(r"UR10 +torques +\d", out)
    result = read_measurement(tmp_path / "out/a.json")
    for library in ("ours", "kdl"):
        assert 1 < result.time("ur10", "torques", library) < 1e7
    assert 1 < result.time("ur10", "torques_batch", "ours") < 1e7
    assert result.context["repetitions"] == 2
    assert re.search(r"gcc|clang", result.context["compiler"])
    assert page(result) == (tmp_path / "out/a.md").read_text()
    for row in result.latency:
        assert row["calls"] == 100
        assert row["p50"] <= row["p99"] <= row["p99.99"] <= row["max"]
    names = [row["name"] for row in result.latency]
    assert names[:2] == ["system/nothing/none", "system/multiplications/none"]
    assert "ur10_identified/torques/ours" in names
    assert "<svg" in (tmp_path / "out/a.svg").read_text()


@needs_benchmarks
def test_a_name_that_no_benchmark_has_is_told(ids):
    fails(
        ids("bench", "--only", "nonsense"),
        "inverse_dynamics_benchmark failed: Failed to match any benchmarks against regex: nonsense; "
        "names are ROBOT/QUANTITY/LIBRARY, such as ur10/torques/ours",
    )


def test_without_the_benchmarks_the_remedy_is_told(ids, tmp_path, monkeypatch):
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    build = "`./scripts/build --packages-select inverse_dynamics_benchmarks`"
    fails(ids("bench"), "inverse_dynamics_benchmarks: not in any", f"only on request: {build}")

    marker = tmp_path / "share/ament_index/resource_index/packages/inverse_dynamics_benchmarks"
    marker.parent.mkdir(parents=True)
    marker.touch()
    fails(
        ids("bench"),
        "bin/inverse_dynamics_benchmark: not there",
        "apt install libbenchmark-dev",
        build,
    )


def test_a_benchmark_that_fails_is_told_by_its_last_words(tmp_path, monkeypatch):
    index = tmp_path / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "inverse_dynamics_benchmarks").touch()
    program = tmp_path / "bin/inverse_dynamics_benchmark"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\necho first >&2\necho ur10: no such robot >&2\nexit 1\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    with pytest.raises(
        Exception, match=r"benchmark: can't be run \(Permission denied\); build inv"
    ):
        measure()
    program.chmod(0o755)
    with pytest.raises(Exception, match="inverse_dynamics_benchmark failed: ur10: no such robot"):
        measure()


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--repetitions", "0"), "--repetitions: expected a whole number above zero, got '0'"),
        (("--repetitions", "1"), "--repetitions: expected two or more, got '1'"),
        (("--only", "("), "--only: expected a regular expression, got '('"),
        (("--from", "nothing.json"), "nothing.json: can't be read (No such file or directory)"),
        (("--plot", "speed.gif"), "speed.gif: expected a name that ends in .svg, .png or .pdf"),
        (
            ("--json", "a", "--plot", "./a"),
            "a: expected a file of its own for each result, got the same for --json and --plot; "
            "name another file with --plot",
        ),
        (("--from", "a", "--only", "b"), "--only: expected no such choice beside --from"),
        (
            ("--calls", "9"),
            "--calls: expected --latency beside it, got none; add --latency, or leave --calls out",
        ),
        (("--json", "text/a.json"), "text is not a directory); name another file with --json"),
    ],
)
def test_options_that_make_no_sense_are_told_before_anything_is_measured(
    ids, tmp_path, monkeypatch, arguments, expected
):
    monkeypatch.setattr("inverse_dynamics_benchmarks.measure", lambda **_: pytest.fail("measured"))
    (tmp_path / "text").write_text("by hand")
    fails(ids("bench", *arguments), expected)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{", "expected JSON of `ids bench --json`: Expecting"),
        ("[]", "expected a result of `ids bench --json`, got something else"),
        ('{"context": {}}', "got something else (no 'benchmarks'); measure again"),
        (json.dumps(document()), "no entry with the aggregate_name 'min', and no latency"),
        (
            json.dumps(document(entry("a/b/c", 1.0, time_unit="ms"))),
            "time_unit: expected ns, got ms",
        ),
    ],
)
def test_a_file_that_is_no_measurement_is_told(ids, tmp_path, text, expected):
    (tmp_path / "a.json").write_text(text)
    fails(ids("bench", "--from", "a.json"), "ids: error: a.json: ", expected)


def test_what_exists_is_replaced_only_if_told(ids, speed_json):
    before = speed_json.read_text()
    command = ("bench", "--from", "speed.json", "--json", "speed.json")
    fails(ids(*command), "speed.json: exists already; name another file with --json", "--overwrite")
    assert speed_json.read_text() == before
    assert ids(*command, "--overwrite")[0] == 0
    assert read_measurement(speed_json).time("ur10", "torques", "ours") == 100.0


def test_times_are_of_one_state_and_by_the_right_clock(speed_json):
    result = read_measurement(speed_json)
    assert result.time("ur10", "torques", "ours") == 100.0
    assert result.time("ur10", "torques_batch", "ours") == 25.0
    assert result.time("ur10", "inertia", "ours") is None


def test_tables_say_what_was_measured(speed_json):
    text = page(read_measurement(speed_json))
    assert "| UR10 | torques | 100 | 900 | 1500 |  | 9.0 |" in text
    assert "| UR10 | torques, batch | 25.0 |  |  |  | 36.0 |" in text
    assert "| UR10 | forward dynamics |" not in text
    assert "Abacus" in text


def test_long_calls_are_in_units_that_can_be_read():
    figures = {"slowest_state": 150.2, "p50": 160.0, "p99": 4538.4, "p99.99": 24807.0, "max": 2.4e7}
    counts = {"interruptions_per_second": 88.6, "context_switches": 9, "page_faults": 0}
    row = {"name": "ur10/torques/ours", "calls": 20_000, **figures, **counts}
    result = measurement({**document(), "latency": [row]}, "here")
    expected = "| 150 ns | 160 ns | 4538 ns | 24.8 µs | 24 ms | 89 | 9 | 0 |"
    assert f"| UR10, torques | this library {expected}" in page(result)
    assert "20 000 of each call.\n\n| call |" in page(result)


def test_a_build_without_optimisation_is_told():
    result = measurement(document(entry("ur10/torques/ours", 1.0), optimized="no"), "here")
    assert "**Compiled without optimisation: these times say nothing.**" in page(result)


def test_libraries_that_are_missing_are_told():
    result = measurement(document(entry("ur10/torques/ours", 1.0), kdl="1.5.1"), "here")
    text = page(result)
    assert "KDL 1.5.1" in text
    assert "Not found when the benchmarks were built: Pinocchio, MuJoCo." in text


def test_a_measurement_has_the_figures_of_its_file(tmp_path):
    result = measurement(document(entry("ur10/torques/ours", 1265.4999)), "here")
    write_measurement(result, tmp_path / "speed.json")
    assert read_measurement(tmp_path / "speed.json").times == result.times


def test_a_figure_is_the_same_for_the_same_figures(ids, speed_json, tmp_path):
    for name in ("a.svg", "b.svg"):
        assert ids("bench", "--from", speed_json, "--plot", name)[0] == 0
    svg = (tmp_path / "a.svg").read_bytes()
    assert svg == (tmp_path / "b.svg").read_bytes()
    assert b"this library" in svg
    assert b"900" in svg
