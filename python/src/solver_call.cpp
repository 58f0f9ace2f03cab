// SPDX-License-Identifier: Apache-2.0
#include "solver_call.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/states.hpp>
#include <string>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;
/// Doubles at addresses of doubles.
// NOLINTNEXTLINE(bugprone-suspicious-enum-usage): pybind11 has these flags in two enumerations
using Doubles = py::array_t<double, py::array::forcecast | py::detail::npy_api::NPY_ARRAY_ALIGNED_>;

Shape shapeOf(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

Shape stridesOf(const py::array& array) {
  return {array.strides(), array.strides() + array.ndim()};
}

std::string typeName(const py::handle& object) {
  return py::str(py::type::handle_of(object).attr("__name__"));
}

/// For results: outOf() has made sure that they may be written.
double* memoryOf(const py::array& array) {
  return static_cast<double*>(const_cast<void*>(array.data()));
}

/// Distance between neighbours along an axis, in doubles; zero for an absent axis.
std::ptrdiff_t stepOf(const py::array& array, py::ssize_t axis) {
  return axis < 0 ? 0 : array.strides(axis) / static_cast<py::ssize_t>(sizeof(double));
}

/// First byte of an array, and the byte after its last.
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

/// Whether they share a number: one may lie in the gaps of the other.
bool overlap(const py::array& a, const py::array& b) {
  const auto [a_first, a_last] = extent(a);
  const auto [b_first, b_last] = extent(b);
  if (a_first >= b_last || b_first >= a_last) return false;
  return py::module_::import("numpy").attr("shares_memory")(a, b).cast<bool>();
}

/// Whether two entries of an array may share memory: unless each axis steps over everything that the axes
/// with smaller steps reach. Also true for axes that interleave without sharing memory.
bool mayOverlapItself(const py::array& array) {
  std::vector<std::pair<py::ssize_t, py::ssize_t>> axes;  // bytes of a step, number of steps
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    if (array.shape(i) > 1) axes.emplace_back(std::abs(array.strides(i)), array.shape(i) - 1);
  }
  std::sort(axes.begin(), axes.end());
  py::ssize_t reached = array.itemsize();
  for (const auto& [step, count] : axes) {
    if (step < reached) return array.size() > 0;
    reached += step * count;
  }
  return false;
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
    throw ids::SizeMismatchException(ids::errorText(
        place(name), "wrong shape", "(" + n + ",) or (N, " + n + "), one state per row",
        shapeText(shape), remedy));
  }
  if (shape.size() == 2 && shape_.size() == 2 && shape != shape_) {
    throw ids::SizeMismatchException(ids::errorText(
        place(name), "wrong shape",
        shapeText(shape_) + ", that of " + shaped_ + ", or (" + n + ",), one state for all",
        shapeText(shape)));
  }
}

py::object SolverCall::byJoint(const char* name, const py::object& values) const {
  const bool is_table = !isPlainArray(values) &&  // of pandas or polars
                        (py::hasattr(values, "iloc") || py::hasattr(values, "get_columns"));
  if (!is_table) return values;
  return py::module_::import("inverse_dynamics.arrays")
      .attr("by_joint")(values, tupleOf(joint_names_), place(name));
}

py::array SolverCall::numbersFrom(const char* name, const py::object& values) const {
  if (isMasked(values)) {
    refuse(name, "a number in each place", "an array with masked ones");
  }
  py::array array = py::array::ensure(values);
  if (!array) refuse(name, "an array of real numbers", typeName(values));
  if (std::strchr("biuf", array.dtype().kind()) == nullptr) {
    refuse(name, "an array of real numbers", py::str(array.dtype()));
  }
  return array;
}

void SolverCall::input(const char* name, const py::object& values) {
  py::array array = numbersFrom(name, byJoint(name, values));
  requireShape(name, array);
  array = Doubles(array);

  if (inputs_.empty() || (array.ndim() == 2 && shape_.size() == 1)) {
    shape_ = shapeOf(array);
    shaped_ = name;
    count_ = array.ndim() == 1 ? 1 : array.shape(0);
  }
  inputs_.push_back({name, array});
}

void SolverCall::wrench(const char* name, const py::object& values) {
  py::array array = numbersFrom(name, values);
  const Shape shape = shapeOf(array);
  if (shape != Shape{6} && shape != perState({6})) {
    throw ids::SizeMismatchException(ids::errorText(
        place(name), "wrong shape",
        shape_.size() == 1 ? "(6,), force and torque"
                           : "(6,) or " + shapeText(perState({6})) + ", force and torque",
        shapeText(shape)));
  }
  inputs_.push_back({name, Doubles(array)});
}

// ---------------------------------------------------------------- results

py::array SolverCall::outOf(const std::string& name, const py::object& out,
                            const Shape& shape) const {
  if (!py::isinstance<py::array>(out)) refuse(name, "an array of float64", typeName(out));
  auto array = py::reinterpret_borrow<py::array>(out);
  if (!py::isinstance<Doubles>(array)) refuse(name, "an array of float64", py::str(array.dtype()));
  if (shapeOf(array) != shape) {
    throw ids::SizeMismatchException(
        ids::errorText(place(name), "wrong shape", shapeText(shape), shapeText(shapeOf(array))));
  }
  if (!array.writeable()) refuse(name, "an array that may be written to", "a read-only one");
  if ((array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) == 0) {
    refuse(name, "an array at addresses of doubles", "fields of a packed record");
  }
  if (mayOverlapItself(array)) {
    refuse(
        name, "a place in memory for each number",
        "an array whose entries overlap, with strides " + shapeText(stridesOf(array)) + " bytes");
  }
  return array;
}

void SolverCall::requireOwnMemory(const Argument& result) const {
  for (const auto* const others : {&inputs_, &results_}) {
    for (const Argument& other : *others) {
      if (overlap(result.array, other.array)) {
        refuse(result.name, "memory of its own", "that of " + other.name);
      }
    }
  }
}

/// The shape of results that have this one for each state.
Shape SolverCall::perState(const Shape& of_each) const {
  Shape shape(shape_.begin(), shape_.end() - 1);
  shape.insert(shape.end(), of_each.begin(), of_each.end());
  return shape;
}

void SolverCall::result(const std::string& name, const py::object& out, const Shape& of_each) {
  const Shape shape = perState(of_each);
  if (out.is_none()) {
    results_.push_back({name, py::array_t<double>(shape)});
    return;
  }
  Argument result{name, outOf(name, out, shape)};
  requireOwnMemory(result);
  results_.push_back(std::move(result));
}

// ---------------------------------------------------------------- memory, as solvers see it

ids::ConstStates SolverCall::in(std::size_t i) const {
  const py::array& array = inputs_[i].array;
  const py::ssize_t last = array.ndim() - 1;
  return {static_cast<const double*>(array.data()), array.shape(last), count_, stepOf(array, last),
          stepOf(array, last - 1)};
}

ids::States SolverCall::states(std::size_t i) const {
  const py::array& array = results_[i].array;
  const py::ssize_t axis_of_states = static_cast<py::ssize_t>(shape_.size()) - 2;
  const bool are_numbers = array.ndim() == axis_of_states + 1;
  return {memoryOf(array), are_numbers ? 1 : array.shape(axis_of_states + 1), count_,
          are_numbers ? 1 : stepOf(array, axis_of_states + 1), stepOf(array, axis_of_states)};
}

ids::StridedMatrices SolverCall::matrices(std::size_t i) const {
  const py::array& array = results_[i].array;
  const py::ssize_t last = array.ndim() - 1;
  return {memoryOf(array),         array.shape(last - 1), array.shape(last),      count_,
          stepOf(array, last - 1), stepOf(array, last),   stepOf(array, last - 2)};
}

}  // namespace inverse_dynamics_tools
