# SPDX-License-Identifier: Apache-2.0
"""Compressed recordings: read, but not those of a few kilobytes that would fill memory or disk."""

import subprocess
import sys
from functools import cache

import pytest
from example_recordings import JOINT_STATE, STORE, joint_state
from lz4.frame import LZ4FrameCompressor
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.writer import zstd

from inverse_dynamics import read_joint_log
from inverse_dynamics.errors import BagError

HUGE = 1_500_000_000
KINDS = ["message sqlite3", "message mcap", "file sqlite3", "file mcap", "zstd chunk", "lz4 chunk"]


def frame(compressor, size, begin=b""):
    """What unpacks to that many zeros, made without having them."""
    block = bytes(2**20)
    parts = [begin, *(compressor.compress(block) for _ in range(size // len(block)))]
    return b"".join([*parts, compressor.flush()])


@cache
def bomb(compression):
    """1.5 GB of zeros; packing them takes a second, so they are packed once."""
    if compression == "lz4":
        compressor = LZ4FrameCompressor()
        return frame(compressor, HUGE, compressor.begin())
    return frame(zstd.ZstdCompressor(), HUGE)


def packed_recording(path, kind, packed=None):
    """Ten compressed joint states; packed: instead of what their compression gives."""
    storage = StoragePlugin.SQLITE3 if "sqlite3" in kind else StoragePlugin.MCAP
    writer = Writer(path, version=9, storage_plugin=storage)
    mode = CompressionMode[kind.partition(" ")[0].upper()] if "chunk" not in kind else None
    writer.set_compression(mode or CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        if kind == "lz4 chunk":
            writer.storage.compression = "lz4"
            writer.storage.compressor = lambda raw: frame_of(LZ4FrameCompressor(), raw)
        if packed and mode is None:
            writer.storage.compressor = lambda _: packed
        connection = writer.add_connection("/joint_states", JOINT_STATE, typestore=STORE)
        for k in range(10):
            message = joint_state(["a"], [0.1 * k], [1.0], [float(k)], (k + 1) * 10**7)
            raw = STORE.serialize_cdr(message, JOINT_STATE)
            if packed and mode is CompressionMode.MESSAGE:
                writer.compression_mode = CompressionMode.NONE
                raw = packed
            writer.write(connection, (k + 1) * 10**7, raw)
        if mode is not None:
            writer.compression_mode = mode
    if packed and mode is CompressionMode.FILE:
        (file,) = path.glob("*.zstd")
        file.write_bytes(packed)
    return path


def frame_of(compressor, raw):
    return compressor.begin() + compressor.compress(raw) + compressor.flush()


@pytest.mark.parametrize("kind", KINDS)
def test_compressed_recordings_are_read(tmp_path, kind):
    log = read_joint_log(packed_recording(tmp_path / "bag", kind))
    assert log.effort[:, 0].tolist() == list(range(10))


READ = """
import resource, sys
from inverse_dynamics import read_joint_log
from inverse_dynamics.errors import BagError
try:
    read_joint_log(sys.argv[1])
except BagError as error:
    print(error)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, "kB")
"""


@pytest.mark.parametrize("kind", KINDS)
def test_a_bomb_is_refused_before_it_fills_memory_or_disk(tmp_path, kind):
    packed = bomb("lz4" if kind == "lz4 chunk" else "zstd")
    path = packed_recording(tmp_path / "bag", kind, packed)
    finished = subprocess.run(
        [sys.executable, "-c", READ, str(path)], capture_output=True, text=True, check=True
    )
    text, memory = finished.stdout.splitlines()
    most = max(256, round(50 * len(packed) / 1e6))
    assert f"{path}: " in text
    assert f"of {len(packed)} bytes unpacks to more than {most} MB" in text
    assert "if you trust it, raise the limit with IDS_UNPACK_LIMIT_MB" in text
    assert int(memory.split()[0]) < 150_000 + 2.1 * most * 1000


def test_what_follows_a_small_frame_counts_too(tmp_path):
    packed = zstd.compress(b"small") + bomb("zstd")
    path = packed_recording(tmp_path / "bag", "message sqlite3", packed)
    with pytest.raises(BagError, match="unpacks to more than 256 MB"):
        read_joint_log(path)


def test_the_limit_can_be_set(tmp_path, monkeypatch):
    packed = zstd.compress(bytes(2_000_000))
    path = packed_recording(tmp_path / "bag", "message sqlite3", packed)
    with pytest.raises(BagError, match="message 1: can't be decoded"):
        read_joint_log(path)
    monkeypatch.setenv("IDS_UNPACK_LIMIT_MB", "1")
    with pytest.raises(BagError, match="unpacks to more than 1 MB"):
        read_joint_log(path)
    for text in ("-1", "1.5", "many", "٣", "9" * 19, "9" * 5000):
        monkeypatch.setenv("IDS_UNPACK_LIMIT_MB", text)
        with pytest.raises(
            BagError, match=r"IDS_UNPACK_LIMIT_MB: expected a whole number of .{,90}$"
        ):
            read_joint_log(path)


def test_chunks_that_are_in_memory_together_count_together(tmp_path, monkeypatch):
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/joint_states", JOINT_STATE, typestore=STORE)
        for k in range(60):  # about ten in each chunk, from the beginning to the end of the time
            message = joint_state(["a"], [0.0], [1.0], [0.0], 10**7, frame_id="x" * 100_000)
            raw = STORE.serialize_cdr(message, JOINT_STATE)
            writer.write(connection, 10**7 * (1 + 7 * k % 10), raw)
    assert len(read_joint_log(tmp_path / "bag")) == 60
    monkeypatch.setenv("IDS_UNPACK_LIMIT_MB", "3")
    with pytest.raises(BagError, match="an MCAP file of .* unpacks to more than 3 MB"):
        read_joint_log(tmp_path / "bag")
