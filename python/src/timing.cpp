// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_timing/path.hpp>
#include <inverse_dynamics_timing/retime.hpp>
#include <inverse_dynamics_timing/trajectory.hpp>
#include <string>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "fields.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace inverse_dynamics_timing;
using Stops = std::vector<Eigen::Index>;

/// q and its first and second derivative, (N, n) each: `evaluate(x, q, first, second)` at N numbers.
template <class Evaluate>
ThreeFloats statesAt(const Eigen::VectorXd& at, Eigen::Index joints, const Evaluate& evaluate) {
  Array arrays[] = {Array({at.size(), joints}), Array({at.size(), joints}),
                    Array({at.size(), joints})};
  Map q = columns(arrays[0]), first = columns(arrays[1]), second = columns(arrays[2]);
  unlocked([&] {
    for (Eigen::Index k = 0; k < at.size(); ++k) {
      evaluate(at[k], q.col(k), first.col(k), second.col(k));
    }
  });
  return {Floats(arrays[0]), Floats(arrays[1]), Floats(arrays[2])};
}

void bindPath(py::module_& module) {
  py::class_<Path>(module, "JointPath",
                   "Where joints go, without time: q(s), a piecewise polynomial.")
      .def_static(
          "spline",
          [](const Array& waypoints, const Stops& stops) {
            return Path::spline(states(waypoints, "waypoints"), stops);
          },
          "waypoints"_a, "stops"_a = Stops(), R"(Cubic spline through waypoints.

Parameters
----------
waypoints : array_like, (m, n)
    rad (prismatic m).
stops : sequence of int, optional
    Numbers of waypoints, from 0, to stand still at.

Returns
-------
JointPath)")
      .def_static(
          "lines",
          [](const Array& waypoints, double deviation, const Stops& stops) {
            return Path::lines(states(waypoints, "waypoints"), deviation, stops);
          },
          "waypoints"_a, "deviation"_a, "stops"_a = Stops(),
          R"(Straight lines between waypoints, with rounded corners.

Parameters
----------
waypoints : array_like, (m, n)
    rad (prismatic m).
deviation : float
    rad, by which curves pass corners at most; 0: the robot stops there.
stops : sequence of int, optional
    Numbers of waypoints, from 0, to stand still at.

Returns
-------
JointPath)")
      .def_property_readonly("joint_count", &Path::jointCount, "n.")
      .def_property_readonly(
          "knots", [](const Path& path) { return arrayOf(path.knots()); },
          "Ends of the polynomial pieces, of the path's parameter s.")
      .def_property_readonly(
          "stops", [](const Path& path) { return arrayOf(path.stops()); },
          "s where the robot stands still on its way.")
      .def_property_readonly(
          "position_ranges", [](const Path& path) { return rowsOf(path.positionRanges()); },
          "(2, n) the least and the greatest position of each joint.")
      .def(
          "states",
          [](const Path& path, const Eigen::VectorXd& s) {
            return statesAt(s, path.jointCount(), [&](double at, auto q, auto dq, auto ddq) {
              path.evaluate(at, q, dq, ddq);
            });
          },
          "s"_a, R"(q, dq/ds and d2q/ds2.

Parameters
----------
s : array_like, (N,)
    The path's parameter.

Returns
-------
tuple of three ndarray, (N, n) each
    rad (prismatic m), and by powers of the parameter.)")
      .def("__repr__",
           [](const Path& path) {
             return "<JointPath: " + std::to_string(path.jointCount()) + " joints, s from " +
                    shown(py::float_(path.start())) + " to " + shown(py::float_(path.end())) + ">";
           })
      .def(py::pickle(
          [](const Path& path) {
            return py::make_tuple(Eigen::MatrixXd(path.coefficients()), arrayOf(path.knots()),
                                  arrayOf(path.stops()));
          },
          [](const py::tuple& state) {
            return Path::polynomials(state[0].cast<Eigen::MatrixXd>(),
                                     state[1].cast<Eigen::VectorXd>(),
                                     state[2].cast<Eigen::VectorXd>());
          }));
}

Trajectory retimed(const SolverObject& solver, const Path& path, const MotionLimits& limits,
                   const RetimeOptions& options) {
  const auto held = solverOf(solver);
  Retimed result = unlocked([&] { return retime(*held, path, limits, options); });
  if (!result) {
    throw inverse_dynamics_solver::Exception("path: " + text(result.refusal, held->jointNames()));
  }
  return std::move(result.trajectory);
}

}  // namespace

void bindTiming(py::module_& module) {
  bindPath(module);
  using L = MotionLimits;
  bindOptions<0>(
      module, "MotionLimits", "Limits of the joints' sizes, both directions.",
      "(n,) each; empty: unlimited.", Field{"torque", &L::torque, "(n,) N m."},
      Field{"velocity", &L::velocity, "(n,) rad/s."},
      Field{"acceleration", &L::acceleration, "(n,) rad/s^2."},
      Field{"jerk", &L::jerk, "(n,) rad/s^3."},
      Field{"torque_rate", &L::torque_rate, "(n,) N m/s."},
      Field{"knee_velocity", &L::knee_velocity, "(n,) rad/s, above which a motor's torque falls."},
      Field{"no_load_velocity", &L::no_load_velocity,
            "(n,) rad/s, at which a motor has none left."},
      Field{"tip_speed", &L::tip_speed, "m/s; infinite: unlimited."});
  using O = RetimeOptions;
  bindOptions<0>(
      module, "RetimeOptions", "How a path is timed.", "",
      Field{"points", &O::points, "of the grid, about."},
      Field{"start_speed", &O::start_speed, "ds/dt at the path's start."},
      Field{"end_speed", &O::end_speed, "ds/dt at its end."},
      Field{"margin", &O::margin, "share of measured torques within limits; 0: computed ones."});
  using T = Trajectory;
  py::class_<T>(module, "TimedPath", "A path with its time.")
      .def_property_readonly("duration", &T::duration, "s.")
      .def_property_readonly("path", &T::path, "The JointPath.")
      .def_property_readonly(
          "time", [](const T& t) { return arrayOf(t.time()); }, "(K,) s, of the grid's points.")
      .def_property_readonly(
          "s", [](const T& t) { return arrayOf(t.s()); }, "(K,) the path's parameter.")
      .def_property_readonly(
          "speed", [](const T& t) { return arrayOf(t.speed()); }, "(K,) ds/dt.")
      .def(
          "states",
          [](const T& t, const Eigen::VectorXd& time) {
            return statesAt(time, t.path().jointCount(), [&](double at, auto q, auto qd, auto qdd) {
              t.evaluate(at, q, qd, qdd);
            });
          },
          "time"_a, R"(q, qd and qdd.

Parameters
----------
time : array_like, (N,)
    s, 0 to duration.

Returns
-------
tuple of three ndarray, (N, n) each
    rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).)")
      .def("__repr__",
           [](const T& t) {
             return "<TimedPath: " + std::to_string(t.path().jointCount()) + " joints, " +
                    shown(py::float_(t.duration())) + " s>";
           })
      .def(py::pickle(
          [](const T& t) { return py::make_tuple(t.path(), arrayOf(t.s()), arrayOf(t.speed())); },
          [](const py::tuple& state) {
            return T(state[0].cast<Path>(), state[1].cast<Eigen::VectorXd>(),
                     state[2].cast<Eigen::VectorXd>());
          }))
      .def("slowed", &slowed, "factor"_a, R"(The same motion, slower.

Parameters
----------
factor : float
    At least 1: of the duration.

Returns
-------
TimedPath)");
  module.def(
      "sample_times",
      [](double duration, double rate) { return arrayOf(sampleTimes(duration, rate)); },
      "duration"_a, "rate"_a,
      R"(0, 1 / rate, ..., duration; the last step is half a period at least.

Parameters
----------
duration : float
    s.
rate : float
    Hz.

Returns
-------
ndarray, (N,)
    s, rising.)");
  module.def("retime_path", &retimed, "solver"_a, "path"_a, "limits"_a, "options"_a = O(),
             "The fastest motion along a path within limits: TimedPath.");
  module.def(
      "torque_band",
      [](const SolverObject& solver, double margin) {
        return arrayOf(torqueBand(*solverOf(solver), margin));
      },
      "solver"_a, "margin"_a,
      "(n,) N m, half the width of the band that holds a share of the measured torques; 0: zeros.");
  module.def(
      "speed_limit",
      [](const SolverObject& solver, const T& trajectory, const L& limits, const O& options) {
        const auto held = solverOf(solver);
        return arrayOf(unlocked([&] { return speedLimit(*held, trajectory, limits, options); }));
      },
      "solver"_a, "trajectory"_a, "limits"_a, "options"_a = O(),
      "(K,) the greatest ds/dt for which limits can be kept for an instant, at a grid's points.");
}

}  // namespace inverse_dynamics_tools
