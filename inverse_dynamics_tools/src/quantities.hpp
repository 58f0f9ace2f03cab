// SPDX-License-Identifier: Apache-2.0
/// @file
/// Methods of Python that compute something of many states, each from one expression.
///
///     Quantities<Solver>(solver).add(
///         "gravity_vector", std::array{"q"}, std::array{kPerJoint},
///         [](const Solver& s, const PartOfCall& part) {
///           s.get().getGravityVectorBatch(part.in(0), part.states(0));
///         },
///         "g(q): what holds the robot still.");
///     // solver.gravity_vector(q, *, out=None): (n,) or (N, n)
///
/// A class has `joints()`, the names of its joints, and `compute(call, of_part)`, which calls
/// `of_part(PartOfCall)` for all states of a SolverCall together, or shares them among threads.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "annotations.hpp"
#include "solver_call.hpp"

namespace inverse_dynamics_tools {

/// Names of arguments (n,) or (N, n).
template <std::size_t N>
using Inputs = std::array<const char*, N>;

/// The shape of a result for each state of n joints.
using ShapeOf = Shape (*)(pybind11::ssize_t n);

inline constexpr ShapeOf kScalar = [](pybind11::ssize_t /*n*/) { return Shape{}; };
inline constexpr ShapeOf kVector3 = [](pybind11::ssize_t /*n*/) { return Shape{3}; };
inline constexpr ShapeOf kRotation = [](pybind11::ssize_t /*n*/) { return Shape{3, 3}; };
inline constexpr ShapeOf kPerJoint = [](pybind11::ssize_t n) { return Shape{n}; };
inline constexpr ShapeOf kJointByJoint = [](pybind11::ssize_t n) { return Shape{n, n}; };
inline constexpr ShapeOf kJacobian = [](pybind11::ssize_t n) { return Shape{6, n}; };
inline constexpr ShapeOf kRegressor = [](pybind11::ssize_t n) { return Shape{n, 10 * n}; };

template <class Class>
class Quantities {
 public:
  explicit Quantities(pybind11::class_<Class>& of) : class_(of) {}

  /// `name(inputs..., *, out=None)`; of several shapes `name(inputs...)`, a tuple of arrays.
  ///
  /// @param compute  (const Class&, const PartOfCall&): writes a result of each shape.
  template <class Result = Floats, std::size_t N, std::size_t M, class Compute>
  Quantities& add(const char* name, const Inputs<N>& inputs, const std::array<ShapeOf, M>& shapes,
                  Compute compute, const char* doc) {
    const auto computed = [=](const Class& self, const MaybeFloats& out, const auto&... values) {
      SolverCall call(name, self.joints());
      std::size_t i = 0;
      (call.input(inputs[i++], values), ...);
      const auto n = static_cast<pybind11::ssize_t>(self.joints().size());
      for (const ShapeOf shape : shapes) call.result("out", out, shape(n));
      self.compute(call, [&](const PartOfCall& part) { compute(self, part); });
      return call;
    };
    define<Result>(name, inputs, computed, doc, shapes, std::make_index_sequence<N>());
    return *this;
  }

 private:
  template <std::size_t>
  using Input = ArrayLike;

  template <class Result, std::size_t N, class Computed, std::size_t M, std::size_t... I>
  void define(const char* name, const Inputs<N>& inputs, Computed computed, const char* doc,
              const std::array<ShapeOf, M>& /*shapes*/, std::index_sequence<I...> /*inputs*/) {
    namespace py = pybind11;
    if constexpr (M == 1) {
      class_.def(
          name,
          [=](const Class& self, const Input<I>&... values, const MaybeFloats& out) -> Result {
            py::object result = computed(self, out, values...).array(0);
            if constexpr (std::is_same_v<Result, FloatOrFloats>) {
              return result[py::tuple()];  // a number, of one state
            } else {
              return result;
            }
          },
          py::arg(inputs[I])..., py::kw_only(), py::arg("out") = py::none(), doc);
    } else {
      class_.def(
          name,
          [=](const Class& self, const Input<I>&... values) {
            const SolverCall call = computed(self, py::none(), values...);
            if constexpr (M == 2) return TwoFloats(call.array(0), call.array(1));
            if constexpr (M == 3) return ThreeFloats(call.array(0), call.array(1), call.array(2));
          },
          py::arg(inputs[I])..., doc);
    }
  }

  pybind11::class_<Class>& class_;
};

}  // namespace inverse_dynamics_tools
