# SPDX-License-Identifier: Apache-2.0
"""`ids data` against a real HTTP server of this machine."""

import hashlib
import http.server
import os
import socket
import threading
from functools import partial
from pathlib import Path

import pytest

from inverse_dynamics.demo.demo import find_recordings
from inverse_dynamics.errors import RecordingsError, UserError
from inverse_dynamics.public_recordings import public_recordings

UR10 = "ur10_exciting_trajectory"


class Server(http.server.ThreadingHTTPServer):
    """Serves `files`; `cut` says after how many bytes a path breaks off."""

    daemon_threads = True

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.files, self.cut, self.asked = {}, {}, []

    @property
    def url(self):
        return f"http://127.0.0.1:{self.server_port}/base"


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        path = self.path.removeprefix("/base/")
        self.server.asked.append(path)
        content = self.server.files.get(path)
        if content is None:
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content[: self.server.cut.get(path, len(content))])

    def log_message(self, *_):
        pass


@pytest.fixture
def server(monkeypatch):
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    server = Server()
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.server_close()


TABLE = """\
schema: 1
repository: https://example.org/repository
commit: abc
url: {url}
license: MIT
recordings:
  - name: one
    files:
      - {{source: a/one.db3, name: one.db3, size: {size}, sha256: {sha256}}}
  - name: two
    files:
      - {{source: b/two.db3, name: two.db3, size: 3, sha256: {abc}}}
"""
ONE = bytes(range(256)) * 1000
ABC = b"abc"


def sha256(content):
    return hashlib.sha256(content).hexdigest()


@pytest.fixture
def table(tmp_path, monkeypatch, server):
    """Two small recordings instead of the real ones, which the server has."""
    share = tmp_path / "share"
    for name in ("one", "two"):
        (share / "recordings" / name).mkdir(parents=True)
        (share / "recordings" / name / "metadata.yaml").write_text(f"of: {name}\n")
    text = TABLE.format(url=server.url, size=len(ONE), sha256=sha256(ONE), abc=sha256(ABC))
    (share / "recordings/public.yaml").write_text(text)
    monkeypatch.setattr(public_recordings, "package_share", lambda _: share)
    server.files.update({"a/one.db3": ONE, "b/two.db3": ABC})
    return share / "recordings/public.yaml"


@pytest.fixture
def ids(ids, table):
    """`ids data --out out`; gives exit code, stdout, stderr."""
    return partial(ids, "data", "--out", "out")


def files(directory):
    return sorted(str(f.relative_to(directory)) for f in directory.rglob("*") if f.is_file())


ALL = [
    "bags/one/metadata.yaml",
    "bags/one/one.db3",
    "bags/two/metadata.yaml",
    "bags/two/two.db3",
]


def test_recordings_are_fetched_whole_and_their_size_is_said_first(ids, tmp_path, server):
    code, out, err = ids()
    assert code == 0
    assert out == "out/bags/one\nout/bags/two\n"
    assert err.splitlines()[0] == f"ids: fetching 0.26 MB (MIT) from {server.url}"
    assert files(tmp_path / "out") == ALL
    assert (tmp_path / "out/bags/one/one.db3").read_bytes() == ONE
    assert (tmp_path / "out/bags/one/metadata.yaml").read_text() == "of: one\n"


def test_what_is_there_and_intact_is_left_alone(ids, tmp_path, server):
    ids()
    server.asked.clear()
    code, _, err = ids()
    assert code == 0
    assert server.asked == []
    assert err.count("already there and intact") == 2
    assert "fetching" not in err


def test_only_what_is_missing_is_fetched(ids, tmp_path, server):
    del server.files["b/two.db3"]
    assert ids()[0] == 2
    assert files(tmp_path / "out") == ALL[:2]
    server.files["b/two.db3"] = ABC
    server.asked.clear()
    assert ids()[0] == 0
    assert server.asked == ["b/two.db3"]
    assert files(tmp_path / "out") == ALL


def test_a_dry_run_says_everything_and_does_nothing(ids, tmp_path, server):
    code, out, _ = ids("--dry-run")
    assert code == 0
    assert f"{len(ONE)} bytes  a/one.db3" in out
    assert sha256(ONE) in out
    assert "to fetch: 0.26 MB; nothing was fetched" in out
    assert server.asked == []
    assert not (tmp_path / "out").exists()


def nothing_is_kept(result, tmp_path, *expected):
    code, _, err = result
    assert code == 2
    assert "Traceback" not in err
    for text in expected:
        assert text in err
    assert not (tmp_path / "out").exists() or files(tmp_path / "out") == []


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"files": {"a/one.db3": ONE[:-1] + b"x"}}, ("a/one.db3: expected SHA-256", sha256(ONE))),
        ({"files": {"a/one.db3": ONE + b"x"}}, ("expected 256000 bytes, got more",)),
        ({"files": {}}, ("the server says 404 Not Found", "git checkout abc", "--from")),
        ({"cut": {"a/one.db3": 100_000}}, ("expected 256000 bytes, got 100000", "cut off; try")),
    ],
    ids=["another", "longer", "missing", "cut off"],
)
def test_a_file_that_is_not_as_published_is_refused(ids, tmp_path, server, change, expected):
    vars(server).update(change)
    nothing_is_kept(ids(), tmp_path, *expected)


def test_a_server_that_refuses_is_said(ids, tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{free.getsockname()[1]}"
    result = ids("--from", url)
    nothing_is_kept(result, tmp_path, "can't be reached (Connection refused)", "git clone")


def test_a_place_that_can_not_be_written_is_said(ids, tmp_path):
    (tmp_path / "out").write_text("a file")
    code, _, err = ids()
    assert code == 2
    assert "out is not a directory); name another directory with --out" in err


def test_a_recording_that_is_not_as_published_is_replaced_only_on_demand(ids, tmp_path):
    ids()
    one = tmp_path / "out/bags/one/one.db3"
    one.write_bytes(b"mine")
    code, _, err = ids()
    assert code == 2
    assert "checksum mismatch, or files are missing" in err
    assert one.read_bytes() == b"mine"
    assert ids("--overwrite")[0] == 0
    assert one.read_bytes() == ONE


def test_a_clone_serves_without_network(ids, tmp_path, server):
    for name, content in server.files.items():
        file = tmp_path / "clone" / name
        file.parent.mkdir(parents=True)
        file.write_bytes(content)
    assert ids("--from", tmp_path / "clone")[0] == 0
    assert files(tmp_path / "out") == ALL
    assert server.asked == []


def test_a_clone_that_is_not_there_is_said(ids, tmp_path):
    nothing_is_kept(
        ids("--from", tmp_path / "no"), tmp_path, "--from: expected a URL or a directory"
    )


def test_a_damaged_table_is_an_error_with_its_line(ids, table):
    table.write_text(table.read_text().replace("size: 3", "size: three"))
    with pytest.raises(RecordingsError, match=r"public.yaml:12: .*size: expected an integer"):
        public_recordings.public_recordings()


def test_demo_finds_what_was_fetched_and_the_variable_wins(tmp_path, monkeypatch):
    monkeypatch.delenv("IDS_DATA_DIR", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "xdg"))
    assert find_recordings() is None
    (tmp_path / "xdg/inverse_dynamics/bags/ur10_exciting_trajectory").mkdir(parents=True)
    assert find_recordings() == tmp_path / "xdg/inverse_dynamics/bags"
    monkeypatch.setenv("IDS_DATA_DIR", str(tmp_path / "other"))
    with pytest.raises(UserError, match="IDS_DATA_DIR: expected a directory"):
        find_recordings()
    (tmp_path / "other/bags/mine").mkdir(parents=True)
    assert find_recordings() == tmp_path / "other/bags"


def test_the_real_table_names_two_recordings_of_one_commit():
    table = public_recordings.public_recordings()
    assert {r.name for r in table.recordings} == {UR10, "panda_exciting_trajectory"}
    assert table.commit in table.url
    for recording in table.recordings:
        assert recording.metadata.is_file()
        assert all(len(f.sha256) == 64 for f in recording.files)


def test_the_published_files_give_the_published_errors(tmp_path):
    from inverse_dynamics import evaluate

    data = os.environ.get("IDS_DATA_DIR")
    if not data:
        pytest.skip("IDS_DATA_DIR is not set: no recordings of real robots")
    table = public_recordings.public_recordings()
    for recording in table.recordings:
        for file in recording.files:
            if file.name == "LICENSE":
                there = Path(data, "bags/LICENSE.inverse-dynamics-solver")
            else:
                there = Path(data, "bags", recording.name, file.name)
            target = tmp_path / "clone" / file.source
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(there.read_bytes())
    fetched = public_recordings.fetch_recordings(tmp_path / "data", source=str(tmp_path / "clone"))
    result = evaluate(fetched[0], "ur10_real", accelerations="backward-difference")
    rmse = " ".join(f"{e.rmse:.2f}" for e in result.errors)
    assert rmse == "4.26 4.71 1.77 0.76 0.75 1.32"
