// SPDX-License-Identifier: Apache-2.0
/// @file
/// numpy arrays as Eigen matrices, without a copy: states are rows there, columns here.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <chain_dynamics/owned.hpp>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_tools {

/// Doubles, row after row; an array of another type or layout is copied into one.
using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Whether an object is an array of no derived class.
inline bool isPlainArray(pybind11::handle object) {
  return Py_TYPE(object.ptr()) == pybind11::detail::npy_api::get().PyArray_Type_;
}

/// Whether an array has masked entries, whose numbers mean nothing.
inline bool isMasked(pybind11::handle object) {
  return !isPlainArray(object) && pybind11::isinstance<pybind11::array>(object) &&
         pybind11::hasattr(object, "mask") && object.attr("mask").attr("any")().cast<bool>();
}

/// Whether an object is a number, or an array or sequence of numbers: numpy would read texts as
/// numbers, and take the real parts of complex ones.
inline bool hasNumbers(pybind11::handle object) {
  if (isMasked(object)) return false;
  const auto array = pybind11::array::ensure(object);
  return array && std::strchr("biuf", array.dtype().kind()) != nullptr;
}

/// Integers, for stamps in ns.
using Integers =
    pybind11::array_t<std::int64_t, pybind11::array::c_style | pybind11::array::forcecast>;

using ConstMap = Eigen::Map<const Eigen::MatrixXd>;
using Map = Eigen::Map<Eigen::MatrixXd>;

/// The states of an array (n,) or (N, n) as columns of an n x N matrix.
///
/// @throws pybind11::value_error  another number of dimensions; `name` is what the text calls it.
inline ConstMap states(const Array& array, const char* name) {
  if (array.ndim() != 1 && array.ndim() != 2) {
    throw pybind11::value_error(std::string(name) +
                                ": expected an array (n,) or (N, n), one state per row, got " +
                                std::to_string(array.ndim()) + " dimensions");
  }
  const auto n = array.shape(array.ndim() - 1);
  return {array.data(), n, array.ndim() == 1 ? 1 : array.shape(0)};
}

/// As Python writes it: (4, 6), (6,).
inline std::string shapeText(const std::vector<pybind11::ssize_t>& shape) {
  return pybind11::str(pybind11::tuple(pybind11::cast(shape)));
}

/// @throws pybind11::value_error  an array of another shape; `name` is what the text calls it.
inline void requireShape(const char* name, const pybind11::array& array,
                         const std::vector<pybind11::ssize_t>& shape) {
  if (shape == std::vector(array.shape(), array.shape() + array.ndim())) return;
  throw pybind11::value_error(std::string(name) + ": expected an array " + shapeText(shape) +
                              ", got " + std::string(pybind11::str(array.attr("shape"))));
}

/// A new array of the same shape.
inline Array like(const Array& array) {
  return Array(std::vector<pybind11::ssize_t>(array.shape(), array.shape() + array.ndim()));
}

/// The columns of a new array that is written to.
inline Map columns(Array& array) {
  const auto n = array.shape(array.ndim() - 1);
  return {array.mutable_data(), n, array.ndim() == 1 ? 1 : array.shape(0)};
}

/// Returns compute(), called without the interpreter's lock.
template <class Compute>
auto unlocked(const Compute& compute) {
  const pybind11::gil_scoped_release release;
  return compute();
}

/// A copy.
inline pybind11::array_t<double> arrayOf(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  return pybind11::array_t<double>(vector.size(), vector.data());
}

/// A matrix, one state per column, as an array, one state per row; its memory changes hands.
inline Array rowsOf(chain_dynamics::OwnedMatrix matrix) {
  using chain_dynamics::OwnedMatrix;
  auto* owned = new OwnedMatrix(std::move(matrix));
  const pybind11::capsule owner(owned, [](void* p) { delete static_cast<OwnedMatrix*>(p); });
  return Array({owned->cols(), owned->rows()}, owned->data(), owner);
}

}  // namespace inverse_dynamics_tools

namespace pybind11::detail {

/// Accepts only numbers as arguments.
template <>
struct type_caster<inverse_dynamics_tools::Array> : pyobject_caster<inverse_dynamics_tools::Array> {
  bool load(handle source, bool convert) {
    return inverse_dynamics_tools::hasNumbers(source) &&
           pyobject_caster<inverse_dynamics_tools::Array>::load(source, convert);
  }
};

}  // namespace pybind11::detail
