// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <array>
#include <inverse_dynamics_identification/arm_uncertainty.hpp>
#include <inverse_dynamics_identification/friction_step.hpp>
#include <inverse_dynamics_identification/payload_estimator.hpp>
#include <inverse_dynamics_identification/residual_noise.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "fields.hpp"
#include "friction.hpp"
#include "solver_payload.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {

/// An estimator that several threads of Python may call: each call waits for the others.
class SharedEstimator {
 public:
  SharedEstimator(std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
                  const inverse_dynamics_identification::PayloadOptions& options)
      : estimator_(std::move(solver), options), arm_deviations_(options.arm.factor.cols()) {}

  Eigen::Index jointCount() const { return estimator_.jointCount(); }
  Eigen::Index armDeviations() const { return arm_deviations_; }

  /// Returns `call(estimator)`, called without the GIL.
  template <class Call>
  auto during(Call call) {
    const pybind11::gil_scoped_release release;
    const std::lock_guard<std::mutex> alone(busy_);
    return call(estimator_);
  }

 private:
  inverse_dynamics_identification::PayloadEstimator estimator_;
  Eigen::Index arm_deviations_;
  std::mutex busy_;
};

namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace inverse_dynamics_identification;
using Vector = Eigen::VectorXd;

/// q, qd, qdd: (N, n) each.
using Motion = std::tuple<Array, Array, Array>;
/// The same, (n,) each.
using State = std::tuple<Vector, Vector, Vector>;

/// Columns of N samples of n joints.
std::array<ConstMap, 3> columnsOf(const Motion& motion, py::ssize_t count, Eigen::Index joints) {
  const auto& [q, qd, qdd] = motion;
  requireShape("q", q, {count, joints});
  requireShape("qd", qd, {count, joints});
  requireShape("qdd", qdd, {count, joints});
  return {states(q, "q"), states(qd, "qd"), states(qdd, "qdd")};
}

/// All samples, one after the other, without the GIL; how many were added.
Eigen::Index run(SharedEstimator& shared, const Vector& time, const Motion& motion,
                 const Array& measured) {
  const auto [q, qd, qdd] = columnsOf(motion, time.size(), shared.jointCount());
  requireShape("measured", measured, {time.size(), shared.jointCount()});
  const ConstMap torques = states(measured, "measured");
  return shared.during([&, &q = q, &qd = qd, &qdd = qdd](PayloadEstimator& estimator) {
    Eigen::Index added = 0;
    for (Eigen::Index k = 0; k < time.size(); ++k) {
      const PayloadStatus status =
          estimator.update(time[k], q.col(k), qd.col(k), qdd.col(k), torques.col(k));
      added += status == PayloadStatus::kOk ? 1 : 0;
    }
    return added;
  });
}

PayloadStatus update(SharedEstimator& shared, double time, const State& state,
                     const Vector& measured) {
  return shared.during([&](PayloadEstimator& estimator) {
    const auto& [q, qd, qdd] = state;
    return estimator.update(time, q, qd, qdd, measured);
  });
}

std::pair<PayloadEstimate, PayloadStatus> estimate(SharedEstimator& shared) {
  PayloadEstimate found(shared.jointCount(), shared.armDeviations());
  const PayloadStatus status =
      shared.during([&](PayloadEstimator& estimator) { return estimator.estimate(found); });
  return {std::move(found), status};
}

void restart(SharedEstimator& shared) {
  shared.during([](PayloadEstimator& estimator) { estimator.restart(); });
}

void bindNoise(py::module_& module) {
  using R = ResidualNoise;
  bindOptions<2>(module, "ResidualNoise",
                 "Noise of the torques of n joints: white, and correlated in time.",
                 "(n,) standard deviations, N m; s.", Field{"white", &R::white, "(n,) N m."},
                 Field{"correlated", &R::correlated, "(n,) N m."},
                 Field{"correlation_time", &R::correlation_time, "s."});
  module.def(
      "residual_noise",
      [](const Vector& time, const Array& residuals, double correlation_time) {
        const ConstMap columns = states(residuals, "residuals");
        const py::gil_scoped_release release;
        return residualNoise(time, columns, correlation_time);
      },
      "time"_a, "residuals"_a, py::kw_only(),
      "correlation_time"_a = ResidualNoise().correlation_time,
      "Noise of measured minus computed torques (N, n) [N m], at times (N,) [s].");
}

std::unique_ptr<ArmUncertainty> makeUncertainty(const std::vector<StepFriction>& friction,
                                                const Array& factor,
                                                const std::optional<Array>& coupling,
                                                const std::vector<int>& springs) {
  if (factor.ndim() != 2) throw py::value_error("factor: expected an array (m, K)");
  auto made = std::make_unique<ArmUncertainty>(
      ArmUncertainty{friction, states(factor, "factor").transpose()});
  if (coupling) made->coupling = states(*coupling, "coupling").transpose();
  for (const int columns : springs) {
    made->springs.push_back(static_cast<inverse_dynamics_identification::SpringTerms>(columns));
  }
  return made;
}

/// Reduces the deviations (K, n) at each of N states: (N, n).
template <typename Reduce>
Array ofDeviations(const ArmUncertainty& arm, const SolverObject& solver, const Motion& motion,
                   const Reduce& reduce) {
  ArmDeviations deviations(solverOf(solver), arm);
  const Array& like_q = std::get<0>(motion);
  const Eigen::Index n = arm.coupling.size() > 0 ? arm.coupling.cols()
                                                 : static_cast<Eigen::Index>(arm.friction.size());
  const auto [q, qd, qdd] = columnsOf(motion, like_q.ndim() == 2 ? like_q.shape(0) : 0, n);
  Array result = like(like_q);
  Map out = columns(result);
  Eigen::MatrixXd D(deviations.count(), n);
  for (Eigen::Index k = 0; k < q.cols(); ++k) {
    deviations.compute(q.col(k), qd.col(k), qdd.col(k), D);
    out.col(k) = reduce(D);
  }
  return result;
}

Array armTorques(const ArmUncertainty& arm, const SolverObject& solver, const Vector& z,
                 const Motion& motion) {
  if (z.size() != arm.factor.cols()) {
    throw py::value_error("z: expected " + std::to_string(arm.factor.cols()) + " numbers, got " +
                          std::to_string(z.size()));
  }
  return ofDeviations(arm, solver, motion, [&](const Eigen::MatrixXd& D) -> Eigen::VectorXd {
    return D.transpose() * z;
  });
}

Array armVariances(const ArmUncertainty& arm, const SolverObject& solver, const Motion& motion) {
  return ofDeviations(arm, solver, motion, [](const Eigen::MatrixXd& D) -> Eigen::VectorXd {
    return D.colwise().squaredNorm().transpose();
  });
}

void bindArm(py::module_& module) {
  py::class_<ArmUncertainty>(
      module, "ArmUncertainty",
      "What the identified model of an arm may be wrong by: arm_uncertainty.hpp.")
      .def(py::init(&makeUncertainty), "friction"_a, "factor"_a, "coupling"_a = py::none(),
           "springs"_a = std::vector<int>(),
           "friction: smooth_coulomb of each of n joints and of other laws, by the keys of the "
           "model file; factor: (m, K), the\n"
           "covariance of the m unknowns is factor factor'. coupling: (r, n) as ArmFitter has it; "
           "springs: of each joint 0, 1 of a\n"
           "linear one, 2 of a lever.")
      .def("torques", &armTorques, "solver"_a, "z"_a, "motion"_a,
           R"(Torques by which an arm differs from its model.

Parameters
----------
solver : Solver
z : array_like, (K,)
    Deviations of the arm, in standard deviations.
motion : tuple of three array_like, (N, n) each
    q, qd, qdd: rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).

Returns
-------
ndarray, (N, n)
    N m (prismatic N).)")
      .def("variances", &armVariances, "solver"_a, "motion"_a,
           R"(Variances of the torques by which an arm may differ from its model.

Parameters
----------
solver : Solver
motion : tuple of three array_like, (N, n) each
    q, qd, qdd: rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).

Returns
-------
ndarray, (N, n)
    N^2 m^2 (prismatic N^2).)");
}

void bindEstimate(py::module_& module) {
  py::enum_<PayloadStatus>(module, "PayloadStatus", "What happened to a sample, or to an estimate.")
      .value("OK", PayloadStatus::kOk)
      .value("NOT_LATER", PayloadStatus::kNotLater)
      .value("NOT_FINITE", PayloadStatus::kNotFinite)
      .value("TOO_SHORT", PayloadStatus::kTooShort)
      .value("SOLVER_FAILED", PayloadStatus::kSolverFailed)
      .value("WRONG_SIZE", PayloadStatus::kWrongSize)
      .def_property_readonly(
          "text", [](PayloadStatus status) { return text(status); }, "What happened, in words.");
  using E = PayloadEstimate;
  bindRecord(
      module, "PayloadEstimate",
      "A body in the tip frame, with the half widths of its 95 % intervals.",
      Field{"mass", &E::mass, "kg"}, Field{"mass_half_width", &E::mass_half_width, "kg"},
      Field{"center_of_mass", &E::center_of_mass, "(3,) m"},
      Field{"center_of_mass_half_width", &E::center_of_mass_half_width, "(3,) m"},
      Field{"inertia", &E::inertia, "(3, 3) about the center of mass, kg m^2"},
      Field{"inertia_half_width", &E::inertia_half_width,
            "(3, 3) kg m^2, of what the data alone tell"},
      Field{"inertia_is_known", &E::inertia_is_known, "whether the data tell the inertia"},
      Field{"offset", &E::offset, "(n,) N m (prismatic N)"},
      Field{"arm", &E::arm, "(K,) deviations of the arm from its model, in standard deviations"},
      Field{"covariance", &E::covariance, "(10, 10) of m, mc, I about the origin of the tip frame"},
      Field{"blocks", &E::blocks, "of time, that the intervals rest on"},
      Field{"duration", &E::duration, "s, from the first sample to the last"});
}

}  // namespace

void bindPayload(py::module_& module) {
  bindNoise(module);
  bindArm(module);
  bindEstimate(module);
  using O = PayloadOptions;
  bindOptions(
      module, "PayloadOptions", "What the estimate rests on.", "",
      Field{"noise", &O::noise, "of the torques"},
      Field{"offset", &O::offset, "(n,) N m, what is known of the offsets"},
      Field{"offset_deviation", &O::offset_deviation, "(n,) N m, of the offsets"},
      Field{"arm", &O::arm, "what the arm's model may be wrong by"},
      Field{"carried", &O::carried, "body among solver.payloads that belongs to the estimate"},
      Field{"extent", &O::extent, "m"}, Field{"block", &O::block, "s"},
      Field{"model_error", &O::model_error,
            "variance of what the arm's model is wrong by, in units of what the noise gives"});
  py::class_<SharedEstimator>(module, "PayloadEstimator",
                              "Mass, center of mass and inertia of what the tip carries. Threads: "
                              "safe; the GIL is released, and each call waits for those of other "
                              "threads.")
      .def(ofSolver<SharedEstimator, PayloadOptions>(), "solver"_a, "options"_a)
      .def("update", &update, "time"_a, "state"_a, "measured"_a,
           R"(Adds a sample.

Parameters
----------
time : float
    s, later than that of the sample before.
state : tuple of three array_like, (n,) each
    q, qd, qdd: rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).
measured : array_like, (n,)
    Torques, N m (prismatic N).

Returns
-------
PayloadStatus)")
      .def("run", &run, "time"_a, "motion"_a, "measured"_a,
           R"(Adds N samples, as update() does.

Parameters
----------
time : array_like, (N,)
    s.
motion : tuple of three array_like, (N, n) each
    q, qd, qdd: rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).
measured : array_like, (N, n)
    Torques, N m (prismatic N).

Returns
-------
int
    How many samples were added.)")
      .def("estimate", &estimate, R"(The body that explains the samples best.

Returns
-------
tuple of PayloadEstimate and PayloadStatus
    kg, m, kg m^2, in the tip frame; meaningless unless the status is OK.)")
      .def("restart", &restart, "Forgets all samples.");
}

}  // namespace inverse_dynamics_tools
