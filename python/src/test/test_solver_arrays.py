# SPDX-License-Identifier: Apache-2.0
"""Solvers on numpy arrays: layouts, the caller's memory, copies, the GIL, errors."""

import resource
import sys
import threading
import tracemalloc
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from example_robots import UR10

from inverse_dynamics import Solver, errors

STATES = 601

ARGUMENTS = {
    "torques": ("q", "qd", "qdd"),
    "inertia_matrix": ("q",),
    "coriolis_vector": ("q", "qd"),
    "gravity_vector": ("q",),
    "friction_vector": ("qd",),
    "dynamic_components": ("q", "qd"),
}


@pytest.fixture(scope="module")
def ur10():
    return Solver(UR10)


def motion(count=STATES):
    values = np.random.default_rng(7).uniform(-2, 2, size=(3, count, 6))
    return dict(zip(("q", "qd", "qdd"), values, strict=True))


def arguments(quantity, states):
    return [states[name] for name in ARGUMENTS[quantity]]


def place_for(quantity, shape=(STATES, 6)):
    """Memory for a result."""
    vectors, matrices = np.full(shape, np.nan), np.full((*shape, 6), np.nan)
    if quantity == "dynamic_components":
        return matrices, vectors, vectors.copy()
    return matrices if quantity == "inertia_matrix" else vectors


def as_record(a):
    """Columns of a packed record that begins with a byte: doubles at odd addresses."""
    record = np.zeros(a.shape, np.dtype([("flag", "u1"), ("value", "<f8")]))
    record["value"] = a
    return record["value"]


LAYOUTS = {
    "columns": np.asfortranarray,
    "every second": lambda a: np.repeat(a, 2, axis=0)[::2],
    "reversed": lambda a: a[::-1, ::-1].copy()[::-1, ::-1],
    "one of several": lambda a: np.stack([a, a], axis=-1)[..., 0],
    "unaligned": as_record,
    "big endian": lambda a: a.astype(">f8"),
    "list": np.ndarray.tolist,
}


@pytest.mark.parametrize("quantity", ARGUMENTS)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same_bits(ur10, quantity, layout):
    states = motion()
    method = getattr(ur10, quantity)
    results = method(*(LAYOUTS[layout](a) for a in arguments(quantity, states)))
    np.testing.assert_equal(results, method(*arguments(quantity, states)))


@pytest.mark.parametrize("quantity", ARGUMENTS)
@pytest.mark.parametrize("shape", [(6,), (STATES, 6)], ids=["one state", "many"])
def test_results_are_written_into_the_callers_arrays(ur10, quantity, shape):
    states = motion() if len(shape) == 2 else {k: v[0] for k, v in motion().items()}
    method = getattr(ur10, quantity)
    out = place_for(quantity, shape)
    result = method(*arguments(quantity, states), out=out)
    expected = method(*arguments(quantity, states))
    if quantity == "dynamic_components":
        assert all(given is returned for given, returned in zip(out, result, strict=True))
    else:
        assert result is out
    np.testing.assert_equal(out, expected)


def test_arguments_and_result_may_stand_side_by_side(ur10):
    states = motion()
    log = np.zeros((STATES, 4, 6))
    log[:, :3] = np.stack(list(states.values()), axis=1)
    ur10.torques(log[:, 0], log[:, 1], log[:, 2], out=log[:, 3])
    np.testing.assert_array_equal(log[:, 3], ur10.torques(*states.values()))


# Copies. An array larger than what malloc may have at hand (64 MB) always needs new address space.
LARGE = 2_000_000


@contextmanager
def no_more_memory_than(extra):
    """Address space for `extra` bytes more: numpy's and Eigen's copies fail alike beyond it."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    before = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * resource.getpagesize() + extra
    resource.setrlimit(resource.RLIMIT_AS, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.parametrize("layout", [np.ascontiguousarray, np.asfortranarray])
def test_doubles_are_not_copied(ur10, layout):
    q, out = layout(np.ones((LARGE, 6))), layout(np.zeros((LARGE, 6)))
    with no_more_memory_than(q.nbytes // 4):
        ur10.gravity_vector(q, out=out)
    assert np.ptp(out, axis=0).max() == 0


@pytest.mark.parametrize("quantity", ARGUMENTS)
def test_no_array_is_made_where_the_caller_brings_one(ur10, quantity):
    given, out = arguments(quantity, motion()), place_for(quantity)
    method = getattr(ur10, quantity)
    tracemalloc.start()
    try:
        method(*given, out=out)
        with_out = tracemalloc.get_traced_memory()[1]
        method(*given)
        without = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert with_out < STATES * 8  # a sixth of the smallest array
    assert without > STATES * 6 * 8


@pytest.mark.parametrize("quantity", ARGUMENTS)
def test_threads_that_share_a_batch_give_the_same_bits(ur10, quantity):
    given = arguments(quantity, motion(10_001))
    shared = Solver(UR10, parameters={"batch_threads": 3})
    np.testing.assert_equal(getattr(shared, quantity)(*given), getattr(ur10, quantity)(*given))


def strided(shape, strides):
    return np.lib.stride_tricks.as_strided(
        np.zeros(100_000)[50_000:], shape, [8 * s for s in strides]
    )


@pytest.mark.parametrize("strides", [(0, 1), (1, 0), (3, 1), (-5, 1), (2, 4), (6, 9), (0, 0)])
def test_a_place_whose_numbers_overlap_is_an_error(ur10, strides):
    out = strided((100, 6), strides)
    message = (
        r"^gravity_vector: argument out: expected a place in memory for each number, got an array "
        rf"whose entries overlap, with strides \({8 * strides[0]}, {8 * strides[1]}\) bytes$"
    )
    with pytest.raises(errors.InvalidParameterError, match=message):
        ur10.gravity_vector(np.zeros((100, 6)), out=out)


@pytest.mark.parametrize("strides", [(30, 6, 1), (36, 1, 1), (36, 6, 0), (0, 6, 1), (1, 6, 600)])
def test_a_place_whose_matrices_overlap_is_an_error(ur10, strides):
    with pytest.raises(errors.InvalidParameterError, match="whose entries overlap"):
        ur10.inertia_matrix(np.zeros((100, 6)), out=strided((100, 6, 6), strides))


@pytest.mark.parametrize("quantity", ARGUMENTS)
def test_other_threads_run_while_a_solver_computes(ur10, quantity):
    """Python would take the GIL from a thread every 1000 s only: what runs, was let run."""
    given, out = arguments(quantity, motion(20_000)), place_for(quantity, (20_000, 6))
    method = getattr(ur10, quantity)
    begin, ran = threading.Lock(), []
    begin.acquire()
    interval = sys.getswitchinterval()

    def run():
        with begin:
            ran.append(True)

    thread = threading.Thread(target=run)
    thread.start()
    sys.setswitchinterval(1000)
    try:
        begin.release()
        for _ in range(1000):  # as often as a busy machine needs to let the other thread begin
            method(*given, out=out)
            if ran:
                break
        let_run = bool(ran)
    finally:
        sys.setswitchinterval(interval)
    thread.join()
    assert let_run


# Errors: method, argument, what was expected and what was found.


@pytest.mark.parametrize(
    ("q", "message"),
    [
        (np.zeros(5), r"got \(5,\); the joints are shoulder_pan_joint .* wrist_3_joint$"),
        (np.zeros((2, 2, 6)), r"got \(2, 2, 6\); the joints are"),
        (3.0, r"got \(\); the joints are"),
        (np.zeros((6, 100)), r"got \(6, 100\); states are rows: transpose it \(\.T\)$"),
    ],
)
def test_wrong_shapes_are_errors(ur10, q, message):
    expected = (
        r"gravity_vector: argument q: wrong shape: expected \(6,\) or \(N, 6\), one state per row"
    )
    with pytest.raises(errors.SizeMismatchError, match=f"^{expected}, {message}"):
        ur10.gravity_vector(q)


def test_shapes_that_differ_are_errors(ur10):
    message = (
        r"^torques: argument qdd: wrong shape: expected \(4, 6\), that of qd, or \(6,\), one state "
        r"for all, got \(3, 6\)$"
    )
    with pytest.raises(errors.SizeMismatchError, match=message):
        ur10.torques(np.zeros(6), np.zeros((4, 6)), np.zeros((3, 6)))


@pytest.mark.parametrize(
    ("q", "got"),
    [
        (["a"] * 6, "<U1"),
        (np.zeros(6, dtype=complex), "complex128"),
        ([[0.0] * 6, [0.0] * 5], "list"),
        (None, "object"),
    ],
)
def test_what_are_no_real_numbers_is_an_error(ur10, q, got):
    message = f"^gravity_vector: argument q: expected an array of real numbers, got {got}$"
    with pytest.raises(errors.InvalidParameterError, match=message):
        ur10.gravity_vector(q)


def read_only(shape):
    array = np.zeros(shape)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("out", "message"),
    [
        ([0.0] * 6, "expected an array of float64, got list"),
        (np.zeros((4, 6), dtype=np.float32), "expected an array of float64, got float32"),
        (np.zeros((4, 5)), r"wrong shape: expected \(4, 6\), got \(4, 5\)"),
        (read_only((4, 6)), "expected an array that may be written to, got a read-only one"),
        (
            as_record(np.zeros((4, 6))),
            "expected an array at addresses of doubles, got fields of a packed record",
        ),
    ],
)
def test_arrays_that_can_not_take_a_result_are_errors(ur10, out, message):
    with pytest.raises(ValueError, match=f"^gravity_vector: argument out: {message}$") as caught:
        ur10.gravity_vector(np.zeros((4, 6)), out=out)
    assert isinstance(caught.value, errors.SolverError)


def test_results_that_overlap_are_errors(ur10):
    memory = np.zeros((5, 6))
    message = "^torques: argument out: expected memory of its own, got that of qd$"
    with pytest.raises(errors.InvalidParameterError, match=message):
        ur10.torques(np.zeros((4, 6)), memory[1:], np.zeros((4, 6)), out=memory[:-1])
    with pytest.raises(errors.InvalidParameterError, match=message.replace("qd", "q")):
        ur10.torques(memory[3::-1], np.zeros((4, 6)), np.zeros((4, 6)), out=memory[:-1])
    c = np.zeros(6)
    message = r"argument out\[2\]: expected memory of its own, got that of out\[1\]$"
    with pytest.raises(errors.InvalidParameterError, match=message):
        ur10.dynamic_components(np.zeros(6), np.zeros(6), out=(np.zeros((6, 6)), c, c))


@pytest.mark.parametrize("out", [np.zeros(6), (np.zeros((6, 6)), np.zeros(6))])
def test_components_need_three_arrays(ur10, out):
    got = type(out).__name__
    message = (
        rf"^dynamic_components: argument out: expected a tuple \(H, c, g\) of arrays, got {got}$"
    )
    with pytest.raises(errors.InvalidParameterError, match=message):
        ur10.dynamic_components(np.zeros(6), np.zeros(6), out=out)


@pytest.mark.parametrize("quantity", ["torques", "coriolis_vector", "dynamic_components"])
@pytest.mark.parametrize("single", [0, 1])
def test_one_state_among_many_is_that_of_all(ur10, quantity, single):
    given = arguments(quantity, motion())
    repeated = list(given)
    given[single] = given[single][3]
    repeated[single] = np.broadcast_to(given[single], (STATES, 6)).copy()
    method = getattr(ur10, quantity)
    for one, other in zip(method(*given), method(*repeated), strict=True):
        np.testing.assert_array_equal(one, other)


def test_masked_numbers_are_refused(ur10):
    q = np.ma.masked_array(np.zeros((2, 6)), np.zeros((2, 6), bool))
    np.testing.assert_array_equal(ur10.gravity_vector(q), ur10.gravity_vector(q.data))
    q[1, 2] = np.ma.masked
    with pytest.raises(errors.InvalidParameterError, match="argument q: .*masked"):
        ur10.gravity_vector(q)


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_columns_of_a_table_are_taken_by_name(ur10, library):
    frame = pytest.importorskip(library).DataFrame
    q, swapped = motion(5)["q"], [3, 0, 5, 1, 4, 2]
    names = [ur10.joint_names[j] for j in swapped]
    expected = ur10.gravity_vector(q)
    table = frame(dict(zip(names, q[:, swapped].T, strict=True)))
    np.testing.assert_array_equal(ur10.gravity_vector(table), expected)
    by_place = frame({f"column {j}": q[:, j] for j in range(6)})
    np.testing.assert_array_equal(ur10.gravity_vector(by_place), expected)
    with pytest.raises(errors.ArgumentError, match="argument q: .*got none for wrist_3_joint"):
        ur10.gravity_vector(frame(dict.fromkeys(ur10.joint_names[:-1], q[:, 0])))
