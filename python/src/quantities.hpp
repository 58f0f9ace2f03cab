// SPDX-License-Identifier: Apache-2.0
/// @file
/// Methods of Python that compute something of many states, each from one expression.
///
///     constexpr Quantity kGravityVector{
///         "gravity_vector", std::array{"q"}, std::array{kPerJoint},
///         {"g(q): what holds the robot still.", "(n,) or (N, n)", "arm.gravity_vector(q).shape\n(100, 6)"}};
///     Quantities<Solver>(solver).add(kGravityVector, [](const Solver& s, const PartOfCall& part) {
///       s.get().getGravityVectorBatch(part.in(0), part.states(0));
///     });
///     // solver.gravity_vector(q, *, out=None): (n,) or (N, n)
///
/// A class has `joints()`, the names of its joints, `links()`, the number of links, and `compute(call, of_part)`, which calls
/// `of_part(PartOfCall)` for all states of a SolverCall together, or shares them among threads;
/// `kExample` is how examples make one.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "frames.hpp"
#include "solver_call.hpp"

namespace inverse_dynamics_tools {

/// Names of arguments (n,) or (N, n).
template <std::size_t N>
using Inputs = std::array<const char*, N>;

/// The shape of a result for each state of n joints that move some links.
using ShapeOf = Shape (*)(pybind11::ssize_t n, pybind11::ssize_t links);

inline constexpr ShapeOf kScalar = [](auto /*n*/, auto /*links*/) { return Shape{}; };
inline constexpr ShapeOf kVector3 = [](auto /*n*/, auto /*links*/) { return Shape{3}; };
inline constexpr ShapeOf kRotation = [](auto /*n*/, auto /*links*/) { return Shape{3, 3}; };
inline constexpr ShapeOf kPerJoint = [](auto n, auto /*links*/) { return Shape{n}; };
inline constexpr ShapeOf kJointByJoint = [](auto n, auto /*links*/) { return Shape{n, n}; };
inline constexpr ShapeOf kJacobian = [](auto n, auto /*links*/) { return Shape{6, n}; };
inline constexpr ShapeOf kTenPerLink = [](auto n, auto links) { return Shape{n, 10 * links}; };

/// Parts of a result's docstring.
struct ResultText {
  const char* formula;
  const char* shape;
  const char* example;  ///< an expression of `arm`, q, qd and qdd, and what Python prints
};

/// A docstring in numpydoc's style.
std::string documented(const ResultText& text, const std::vector<std::string>& arguments,
                       const std::string& example);

template <std::size_t N, std::size_t M>
struct Quantity {
  const char* name;
  Inputs<N> inputs;
  std::array<ShapeOf, M> shapes;
  ResultText text;
};
template <std::size_t N, std::size_t M>
Quantity(const char*, Inputs<N>, std::array<ShapeOf, M>, ResultText) -> Quantity<N, M>;

template <class Class>
class Quantities {
 public:
  explicit Quantities(pybind11::class_<Class>& of) : class_(of) {}

  /// `name(inputs..., *, out=None)`; of several shapes `name(inputs...)`, a tuple of arrays.
  ///
  /// @param compute  (const Class&, const PartOfCall&): writes a result of each shape.
  template <class Result = Floats, std::size_t N, std::size_t M, class Compute>
  Quantities& add(const Quantity<N, M>& of, Compute compute) {
    const auto computed = [=](const Class& self, const MaybeFloats& out, const auto&... values) {
      SolverCall call(of.name, self.joints());
      std::size_t i = 0;
      (call.input(of.inputs[i++], values), ...);
      const auto n = static_cast<pybind11::ssize_t>(self.joints().size());
      for (const ShapeOf shape : of.shapes) call.result("out", out, shape(n, self.links()));
      self.compute(call, [&](const PartOfCall& part) { compute(self, part); });
      return call;
    };
    define<Result>(of, computed, std::make_index_sequence<N>());
    return *this;
  }

  /// `jacobian(q, frame="", *, out=None)`; of_tip: that of an empty frame.
  template <class Compute>
  Quantities& addJacobian(Compute of_tip) {
    namespace py = pybind11;
    const auto computed = [of_tip](const Class& self, const ArrayLike& q, const std::string& frame,
                                   const MaybeFloats& out) -> Floats {
      SolverCall call("jacobian", self.joints());
      call.input("q", q);
      call.result("out", out, {6, static_cast<py::ssize_t>(self.joints().size())});
      const Frames::Path* const path =
          frame.empty() ? nullptr : &self.frames().to(frame, "jacobian");
      self.compute(call, [&](const PartOfCall& part) {
        if (path == nullptr) return of_tip(self, part);
        path->jacobians(part.in(0), part.matrices(0));
      });
      return call.array(0);
    };
    const ResultText text{
        "J(q) of a frame: [v, w] = J qd is the velocity of its origin, linear first, in the axes\n"
        "of the root frame.",
        "(6, n) or (N, 6, n)", "arm.jacobian(q, frame=\"wrist_1_link\").shape\n(100, 6, 6)"};
    const std::string doc = documented(text, {"q", "link", "out"}, Class::kExample);
    class_.def("jacobian", computed, py::arg("q"), py::arg("frame") = "", py::kw_only(),
               py::arg("out") = py::none(), doc.c_str());
    return *this;
  }

  /// `pose(q, frame="")`; of_tip: that of an empty frame.
  template <class Compute>
  void addPose(Compute of_tip) {
    namespace py = pybind11;
    const auto computed = [of_tip](const Class& self, const ArrayLike& q,
                                   const std::string& frame) -> TwoFloats {
      SolverCall call("pose", self.joints());
      call.input("q", q);
      call.result("R", py::none(), {3, 3});
      call.result("p", py::none(), {3});
      const Frames::Path* const path = frame.empty() ? nullptr : &self.frames().to(frame, "pose");
      self.compute(call, [&](const PartOfCall& part) {
        if (path == nullptr) return of_tip(self, part);
        path->poses(part.in(0), part.matrices(0), part.states(1));
      });
      return {call.array(0), call.array(1)};
    };
    const ResultText text{"Pose of a frame in the root frame: rotation R and position p [m].",
                          "(3, 3) and (3,), or (N, 3, 3) and (N, 3)",
                          "R, p = arm.pose(q, frame=\"wrist_1_link\")\np.shape\n(100, 3)"};
    const std::string doc = documented(text, {"q", "link"}, Class::kExample);
    class_.def("pose", computed, py::arg("q"), py::arg("frame") = "", doc.c_str());
  }

 private:
  template <std::size_t>
  using Input = ArrayLike;

  template <class Result, std::size_t N, std::size_t M, class Computed, std::size_t... I>
  void define(const Quantity<N, M>& of, Computed computed, std::index_sequence<I...> /*inputs*/) {
    namespace py = pybind11;
    std::vector<std::string> arguments(of.inputs.begin(), of.inputs.end());
    if (M == 1) arguments.emplace_back("out");
    const std::string doc = documented(of.text, arguments, Class::kExample);
    if constexpr (M == 1) {
      class_.def(
          of.name,
          [=](const Class& self, const Input<I>&... values, const MaybeFloats& out) -> Result {
            py::object result = computed(self, out, values...).array(0);
            if constexpr (std::is_same_v<Result, FloatOrFloats>) {
              return result[py::tuple()];  // a number, of one state
            } else {
              return result;
            }
          },
          py::arg(of.inputs[I])..., py::kw_only(), py::arg("out") = py::none(), doc.c_str());
    } else {
      class_.def(
          of.name,
          [=](const Class& self, const Input<I>&... values) {
            const SolverCall call = computed(self, py::none(), values...);
            if constexpr (M == 2) return TwoFloats(call.array(0), call.array(1));
            if constexpr (M == 3) return ThreeFloats(call.array(0), call.array(1), call.array(2));
          },
          py::arg(of.inputs[I])..., doc.c_str());
    }
  }

  pybind11::class_<Class>& class_;
};

// Quantities of both Solver and FastModel.

inline constexpr Quantity kTorques{"torques",
                                   std::array{"q", "qd", "qdd"},
                                   std::array{kPerJoint},
                                   {"Joint torques tau = H(q) qdd + C(q, qd) qd + f(q, qd) + g(q).",
                                    "(n,) or (N, n)", "arm.torques(q, qd, qdd).shape\n(100, 6)"}};
inline constexpr Quantity kInertiaMatrix{
    "inertia_matrix",
    std::array{"q"},
    std::array{kJointByJoint},
    {"Inertia matrix H(q).", "(n, n) or (N, n, n)", "arm.inertia_matrix(q).shape\n(100, 6, 6)"}};
inline constexpr Quantity kCoriolisVector{
    "coriolis_vector",
    std::array{"q", "qd"},
    std::array{kPerJoint},
    {"Coriolis and centrifugal torques C(q, qd) qd.", "(n,) or (N, n)",
     "arm.coriolis_vector(q, qd).shape\n(100, 6)"}};
inline constexpr Quantity kGravityVector{
    "gravity_vector",
    std::array{"q"},
    std::array{kPerJoint},
    {"Gravity torques g(q): what holds the robot still.", "(n,) or (N, n)",
     "arm.gravity_vector(q).shape\n(100, 6)"}};
inline constexpr Quantity kTipPose{
    "tip_pose",
    std::array{"q"},
    std::array{kRotation, kVector3},
    {"Pose of the tip, of a tree the first, in the root frame: rotation R and position p [m].",
     "(3, 3) and (3,), or (N, 3, 3) and (N, 3)", "R, p = arm.tip_pose(q)\np.shape\n(100, 3)"}};
inline constexpr Quantity kTipJacobianDerivative{
    "tip_jacobian_derivative",
    std::array{"q", "qd"},
    std::array{kJacobian},
    {"dJ/dt of the tip's jacobian(): the tip's acceleration is J qdd + dJ/dt qd.",
     "(6, n) or (N, 6, n)", "arm.tip_jacobian_derivative(q, qd).shape\n(100, 6, 6)"}};
inline constexpr Quantity kCoriolisMatrix{
    "coriolis_matrix",
    std::array{"q", "qd"},
    std::array{kJointByJoint},
    {"C(q, qd) of Christoffel's symbols: C qd is the Coriolis vector, and dH/dt = C + C'.",
     "(n, n) or (N, n, n)", "arm.coriolis_matrix(q, qd).shape\n(100, 6, 6)"}};
inline constexpr Quantity kTorqueDerivatives{
    "torque_derivatives",
    std::array{"q", "qd", "qdd"},
    std::array{kJointByJoint, kJointByJoint, kJointByJoint},
    {"dtau/dq, dtau/dqd and dtau/dqdd = H, friction included: entry (i, j) is that of tau_i by\n"
     "joint j.",
     "three of (n, n) or (N, n, n)",
     "dtau_dq, dtau_dqd, H = arm.torque_derivatives(q, qd, qdd)\n"
     "np.allclose(H, arm.inertia_matrix(q))\nTrue"}};
inline constexpr Quantity kRegressor{
    "regressor",
    std::array{"q", "qd", "qdd"},
    std::array{kTenPerLink},
    {"Y(q, qd, qdd): torques of rigid bodies are Y p, with ten parameters of each link: l = n\n"
     "links, of a tree also those of joints that mimic others.",
     "(n, 10 l) or (N, n, 10 l)", "arm.regressor(q, qd, qdd).shape\n(100, 6, 60)"}};
inline constexpr Quantity kAccelerations{
    "accelerations",
    std::array{"q", "qd", "tau"},
    std::array{kPerJoint},
    {"Forward dynamics: qdd under these torques, friction subtracted.", "(n,) or (N, n)",
     "tau = arm.torques(q, qd, qdd)\n"
     "np.allclose(arm.accelerations(q, qd, tau), qdd)\nTrue"}};

}  // namespace inverse_dynamics_tools
