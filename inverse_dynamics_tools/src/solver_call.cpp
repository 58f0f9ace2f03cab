// SPDX-License-Identifier: Apache-2.0
#include "solver_call.hpp"

#include <cstdint>
#include <cstring>
#include <utility>

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;
using Doubles = py::array_t<double, 0>;
using Eigen::Index;
using Shape = std::vector<py::ssize_t>;

Shape shapeOf(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

/// As Python writes it: (4, 6), (6,).
std::string text(const Shape& shape) {
  py::tuple numbers(shape.size());
  for (std::size_t i = 0; i < shape.size(); ++i) numbers[i] = shape[i];
  return py::str(numbers);
}

std::string typeName(const py::handle& object) {
  return py::str(py::type::handle_of(object).attr("__name__"));
}

bool isAligned(const void* data) {
  return reinterpret_cast<std::uintptr_t>(data) % alignof(double) == 0;
}

bool isRowAfterRow(const py::array& array) {
  return (array.flags() & py::array::c_style) != 0 && isAligned(array.data());
}

/// The same memory with the last two axes exchanged.
py::array exchanged(const py::array& array) { return array.attr("swapaxes")(-1, -2); }

/// Bytes from the first to behind the last that an array holds.
std::pair<const char*, const char*> extent(const py::array& array) {
  const auto* first = static_cast<const char*>(array.data());
  if (array.size() == 0) return {first, first};
  const auto* last = first;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    const py::ssize_t reach = (array.shape(i) - 1) * array.strides(i);
    (reach < 0 ? first : last) += reach;
  }
  return {first, last + array.itemsize()};
}

bool overlap(const py::array& a, const py::array& b) {
  const auto [a_first, a_last] = extent(a);
  const auto [b_first, b_last] = extent(b);
  return a_first < b_last && b_first < a_last;
}

}  // namespace

// ---------------------------------------------------------------- arguments

std::string SolverCall::place(const std::string& argument) const {
  return std::string(method_) + ": argument " + argument;
}

void SolverCall::refuse(const std::string& name, const std::string& expected,
                        const std::string& got) const {
  throw ids::InvalidParameterValueException(ids::errorText(place(name), "", expected, got));
}

void SolverCall::requireShape(const char* name, const py::array& array) const {
  const Shape shape = shapeOf(array);
  const auto n = std::to_string(n_);
  if (shape.empty() || shape.size() > 2 || shape.back() != n_) {
    std::string remedy = "the joints are";
    for (const std::string& joint : joint_names_) remedy += " " + joint;
    if (shape.size() == 2 && shape.front() == n_) remedy = "states are rows: transpose it (.T)";
    throw ids::SizeMismatchException(ids::errorText(place(name), "wrong shape",
                                                    "(" + n + ",) or (N, " + n + "), a state a row",
                                                    text(shape), remedy));
  }
  if (!inputs_.empty() && shape != shape_) {
    throw ids::SizeMismatchException(ids::errorText(
        place(name), "wrong shape", text(shape_) + ", that of " + inputs_[0].name, text(shape)));
  }
}

void SolverCall::input(const char* name, const py::object& values) {
  py::array array = py::array::ensure(values);
  if (!array) refuse(name, "an array of real numbers", typeName(values));
  if (std::strchr("biuf", array.dtype().kind()) == nullptr) {
    refuse(name, "an array of real numbers", py::str(array.dtype()));
  }
  requireShape(name, array);
  if (!py::isinstance<Doubles>(array)) array = py::array_t<double>(array);

  const bool single = array.ndim() == 1;
  if (inputs_.empty()) {
    shape_ = shapeOf(array);
    count_ = single ? 1 : array.shape(0);
  }
  const Index state_stride = single ? 0 : array.strides(0);
  inputs_.push_back({name, array, static_cast<const char*>(array.data()), state_stride,
                     array.strides(array.ndim() - 1), isRowAfterRow(array), Eigen::MatrixXd()});
}

// ---------------------------------------------------------------- results

void SolverCall::requireShapeOfResult(const std::string& name, const py::array& array,
                                      const Shape& shape) const {
  if (shapeOf(array) == shape) return;
  throw ids::SizeMismatchException(
      ids::errorText(place(name), "wrong shape", text(shape), text(shapeOf(array))));
}

py::array SolverCall::outOf(const std::string& name, const py::object& out,
                            const Shape& shape) const {
  if (!py::isinstance<py::array>(out)) refuse(name, "an array of float64", typeName(out));
  auto array = py::reinterpret_borrow<py::array>(out);
  if (!py::isinstance<Doubles>(array)) refuse(name, "an array of float64", py::str(array.dtype()));
  requireShapeOfResult(name, array, shape);
  if (!array.writeable()) refuse(name, "an array that may be written to", "a read-only one");
  return array;
}

void SolverCall::requireOwnMemory(const Result& result) const {
  const auto require = [&](const auto& other) {
    if (overlap(result.array, other.array)) {
      refuse(result.name, "memory of its own", std::string("that of ") + other.name);
    }
  };
  for (const Input& input : inputs_) require(input);
  for (const Result& other : results_) require(other);
}

void SolverCall::vectors(const std::string& name, const py::object& out) {
  if (out.is_none()) {
    py::array_t<double> array(shape_);
    results_.push_back({name, array, array.mutable_data(), 1, false});
    return;
  }
  py::array array = outOf(name, out, shape_);
  if (!isRowAfterRow(array)) refuse(name, "an array row after row (C order)", "another layout");
  Result result{name, array, static_cast<double*>(array.mutable_data()), 1, false};
  requireOwnMemory(result);
  results_.push_back(std::move(result));
}

void SolverCall::matrices(const std::string& name, const py::object& out) {
  Shape shape = shape_;
  shape.push_back(n_);
  if (out.is_none()) {
    // H[k, i, j] is at row i, column k n + j of what is computed: nothing is turned round.
    py::array_t<double> array(shape);
    results_.push_back({name, exchanged(array), array.mutable_data(), n_, false});
    return;
  }
  py::array array = outOf(name, out, shape);
  const bool columns = isRowAfterRow(exchanged(array));
  if (!columns && !isRowAfterRow(array)) {
    refuse(name, "matrices row after row (C order) or column after column", "another layout");
  }
  Result result{name, array, static_cast<double*>(array.mutable_data()), n_, !columns};
  requireOwnMemory(result);
  results_.push_back(std::move(result));
}

// ---------------------------------------------------------------- computing, without the GIL

bool SolverCall::isContiguous() const {
  return std::all_of(inputs_.begin(), inputs_.end(), [](const Input& i) { return i.contiguous; });
}

SolverCall::Inputs SolverCall::inputsAt(Index first, Index count) {
  Inputs maps;
  maps.reserve(inputs_.size());
  for (Input& input : inputs_) {
    if (input.contiguous) {
      maps.emplace_back(reinterpret_cast<const double*>(input.data) + first * n_, n_, count);
      continue;
    }
    input.tile.resize(n_, count);
    for (Index k = 0; k < count; ++k) {
      const char* const state = input.data + (first + k) * input.state_stride;
      // By bytes: a field of a record may stand at any address.
      for (Index j = 0; j < n_; ++j) {
        std::memcpy(&input.tile(j, k), state + j * input.joint_stride, sizeof(double));
      }
    }
    maps.emplace_back(input.tile.data(), n_, count);
  }
  return maps;
}

SolverCall::Results SolverCall::resultsAt(Index first, Index count) {
  Results maps;
  maps.reserve(results_.size());
  for (const Result& result : results_) {
    maps.emplace_back(result.data + first * n_ * result.columns, n_, count * result.columns);
  }
  return maps;
}

void SolverCall::turnMatrices() {
  for (const Result& result : results_) {
    if (!result.turned) continue;
    for (Index k = 0; k < count_; ++k) {
      Eigen::Map<Eigen::MatrixXd>(result.data + k * n_ * n_, n_, n_).transposeInPlace();
    }
  }
}

}  // namespace inverse_dynamics_tools
