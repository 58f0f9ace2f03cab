// SPDX-License-Identifier: Apache-2.0
#include "fast_model.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model_file.hpp>
#include <chain_dynamics/regressor.hpp>
#include <chain_dynamics/share_states.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cstdint>
#include <future>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "description.hpp"
#include "initialized.hpp"
#include "solver_call.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;
using chain_dynamics::GramSamples;
using chain_dynamics::RegressorGram;
using Eigen::Index;

constexpr Index kParameters = 10;

class FastModel {
 public:
  FastModel(const chain_dynamics::Model& model, std::int64_t threads)
      : chain_(model.chain), names_(chain_.jointNames()), threads_(threads), fast_(model) {
    if (threads < 1) {
      throw ids::InvalidParameterValueException(
          ids::errorText("FastModel: argument threads", "", "1 or more", std::to_string(threads)));
    }
  }

  const std::vector<std::string>& names() const { return names_; }
  Index jointCount() const { return chain_.jointCount(); }
  py::array_t<double> parameters() const {
    const Eigen::VectorXd p = chain_dynamics::parameters(chain_);
    return py::array_t<double>(p.size(), p.data());
  }

  Floats forwardDynamics(const ArrayLike& q, const ArrayLike& qd, const ArrayLike& tau,
                         const MaybeFloats& out) const {
    SolverCall call("forward_dynamics", names_);
    call.input("q", q);
    call.input("qd", qd);
    call.input("tau", tau);
    call.vectors("out", out);
    share(call, [&](Index first, Index size) {
      fast_.forwardDynamicsBatch(call.in(0).middle(first, size), call.in(1).middle(first, size),
                                 call.in(2).middle(first, size),
                                 call.states(0).middle(first, size));
    });
    return call.result(0);
  }

  ThreeFloats torqueDerivatives(const ArrayLike& q, const ArrayLike& qd,
                                const ArrayLike& qdd) const {
    SolverCall call = motion("torque_derivatives", q, qd, qdd);
    for (const char* name : {"dtau_dq", "dtau_dqd", "dtau_dqdd"}) {
      call.matrices(name, py::none(), jointCount(), jointCount());
    }
    share(call, [&](Index first, Index size) {
      fast_.torqueDerivativesBatch(
          call.in(0).middle(first, size), call.in(1).middle(first, size),
          call.in(2).middle(first, size), call.matricesOf(0).middle(first, size),
          call.matricesOf(1).middle(first, size), call.matricesOf(2).middle(first, size));
    });
    return {call.result(0), call.result(1), call.result(2)};
  }

  Floats coriolisMatrix(const ArrayLike& q, const ArrayLike& qd, const MaybeFloats& out) const {
    SolverCall call("coriolis_matrix", names_);
    call.input("q", q);
    call.input("qd", qd);
    call.matrices("out", out, jointCount(), jointCount());
    share(call, [&](Index first, Index size) {
      fast_.coriolisMatrixBatch(call.in(0).middle(first, size), call.in(1).middle(first, size),
                                call.matricesOf(0).middle(first, size));
    });
    return call.result(0);
  }

  TwoFloats tipPose(const ArrayLike& q) const {
    SolverCall call("tip_pose", names_);
    call.input("q", q);
    call.matrices("R", py::none(), 3, 3);
    call.vectors("p", py::none(), 3);
    share(call, [&](Index first, Index size) {
      fast_.tipPoseBatch(call.in(0).middle(first, size), call.matricesOf(0).middle(first, size),
                         call.states(1).middle(first, size));
    });
    return {call.result(0), call.result(1)};
  }

  Floats tipJacobian(const ArrayLike& q, const MaybeFloats& out) const {
    SolverCall call("tip_jacobian", names_);
    call.input("q", q);
    call.matrices("out", out, 6, jointCount());
    share(call, [&](Index first, Index size) {
      fast_.tipJacobianBatch(call.in(0).middle(first, size),
                             call.matricesOf(0).middle(first, size));
    });
    return call.result(0);
  }

  Floats tipJacobianDerivative(const ArrayLike& q, const ArrayLike& qd,
                               const MaybeFloats& out) const {
    SolverCall call("tip_jacobian_derivative", names_);
    call.input("q", q);
    call.input("qd", qd);
    call.matrices("out", out, 6, jointCount());
    share(call, [&](Index first, Index size) {
      fast_.tipJacobianDerivativeBatch(call.in(0).middle(first, size),
                                       call.in(1).middle(first, size),
                                       call.matricesOf(0).middle(first, size));
    });
    return call.result(0);
  }

  Floats regressor(const ArrayLike& q, const ArrayLike& qd, const ArrayLike& qdd,
                   const MaybeFloats& out) const {
    SolverCall call = motion("regressor", q, qd, qdd);
    call.matrices("out", out, jointCount(), kParameters * jointCount());
    share(call, [&](Index first, Index size) {
      fast_.regressorBatch(call.in(0).middle(first, size), call.in(1).middle(first, size),
                           call.in(2).middle(first, size), call.matricesOf(0).middle(first, size));
    });
    return call.result(0);
  }

  Array regressorGram(const ArrayLike& q, const ArrayLike& qd, const ArrayLike& qdd,
                      const ArrayLike& tau, const std::vector<ArrayLike>& own_columns,
                      const MaybeArrayLike& weights) const {
    SolverCall call = motion("regressor_gram", q, qd, qdd);
    call.input("tau", tau);
    for (std::size_t c = 0; c < own_columns.size(); ++c) {
      call.input(("own_columns[" + std::to_string(c) + "]").c_str(), own_columns[c]);
    }
    if (!weights.is_none()) call.input("weights", weights);
    const auto part = [&](Index first, Index size) {
      const auto in = [&](std::size_t i) { return call.in(i).middle(first, size); };
      GramSamples samples{in(0), in(1), in(2), in(3)};
      for (std::size_t c = 0; c < own_columns.size(); ++c) {
        samples.own_columns.push_back(in(4 + c));
      }
      if (!weights.is_none()) samples.weights = in(4 + own_columns.size());
      return samples;
    };
    const auto n = static_cast<Index>(names_.size());
    RegressorGram gram(n, static_cast<Index>(own_columns.size()));
    call.run([&] { addParts(call.count(), part, gram); });
    const Index size = gram.rowSize();
    Array result(std::vector<py::ssize_t>{n, size, size});
    for (Index j = 0; j < n; ++j) {
      gram.rowGram(j, Map(result.mutable_data() + j * size * size, size, size));
    }
    return result;
  }

 private:
  SolverCall motion(const char* method, const ArrayLike& q, const ArrayLike& qd,
                    const ArrayLike& qdd) const {
    SolverCall call(method, names_);
    call.input("q", q);
    call.input("qd", qd);
    call.input("qdd", qdd);
    return call;
  }

  template <class Compute>
  void share(const SolverCall& call, const Compute& compute) const {
    call.run([&] { chain_dynamics::shareStates(call.count(), threads_, compute); });
  }

  /// Each thread sums one part of the samples; the sums are added in the order of the parts.
  template <class Part>
  void addParts(Index count, const Part& part, RegressorGram& gram) const {
    const Index parts =
        std::max<Index>(1, std::min<Index>(threads_, count / chain_dynamics::kStatesOfAPart));
    std::vector<std::future<RegressorGram>> others;
    const auto first = [&](Index p) { return p * count / parts; };
    for (Index p = 1; p < parts; ++p) {
      others.push_back(std::async(std::launch::async | std::launch::deferred, [&, p] {
        RegressorGram sum(gram.joints(), gram.ownColumns());
        fast_.addToGram(part(first(p), first(p + 1) - first(p)), sum);
        return sum;
      }));
    }
    fast_.addToGram(part(0, first(1)), gram);
    for (std::future<RegressorGram>& other : others) gram.add(other.get());
  }

  chain_dynamics::Chain chain_;
  std::vector<std::string> names_;
  std::int64_t threads_;
  chain_dynamics::FastModel fast_;
};

using Numbers3 = std::array<double, 3>;

std::unique_ptr<FastModel> fromUrdf(const Description& urdf, const std::string& root,
                                    const std::string& tip, const std::optional<Numbers3>& gravity,
                                    std::int64_t threads) {
  chain_dynamics::UrdfOptions options;
  options.root = root;
  options.tip = tip;
  if (gravity) options.gravity = Eigen::Vector3d(gravity->data());
  return std::make_unique<FastModel>(
      chain_dynamics::Model(chain_dynamics::chainFromUrdf(urdf.text, options)), threads);
}

std::unique_ptr<FastModel> fromFile(const std::string& path, std::int64_t threads) {
  return std::make_unique<FastModel>(chain_dynamics::modelFromFile(path), threads);
}

/// Rows (n, 3, 3), (n, 3) and (n, 10) of the joints.
std::unique_ptr<FastModel> fromJoints(const std::vector<std::string>& names,
                                      const std::vector<bool>& prismatic, const Array& rotations,
                                      const Array& offsets, const Array& links,
                                      const Numbers3& gravity, std::int64_t threads) {
  const auto n = static_cast<py::ssize_t>(names.size());
  if (static_cast<py::ssize_t>(prismatic.size()) != n || rotations.size() != 9 * n ||
      offsets.size() != 3 * n || links.size() != kParameters * n) {
    throw ids::SizeMismatchException(ids::errorText(
        "FastModel.from_joints", "wrong shape",
        "for n names n of prismatic, (n, 3, 3) rotations, (n, 3) offsets and (n, 10) "
        "links",
        "others"));
  }
  std::vector<chain_dynamics::Joint> joints;
  std::vector<chain_dynamics::LinkParameters> parameters;
  for (py::ssize_t i = 0; i < n; ++i) {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    chain_dynamics::Joint joint;
    joint.name = names[static_cast<std::size_t>(i)];
    joint.type = prismatic[static_cast<std::size_t>(i)] ? chain_dynamics::JointType::kPrismatic
                                                        : chain_dynamics::JointType::kContinuous;
    joint.placement.R = Eigen::Map<const RowMajor>(rotations.data() + 9 * i);
    joint.placement.p = Eigen::Map<const Eigen::Vector3d>(offsets.data() + 3 * i);
    joints.push_back(joint);
    const double* const p = links.data() + kParameters * i;
    chain_dynamics::LinkParameters link = chain_dynamics::LinkParameters::zero();
    link.mass = p[0];
    link.first_moment = Eigen::Vector3d(p[1], p[2], p[3]);
    link.inertia << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
    parameters.push_back(link);
  }
  const chain_dynamics::Chain chain("joints", joints, parameters, Eigen::Vector3d(gravity.data()));
  return std::make_unique<FastModel>(chain_dynamics::Model(chain), threads);
}

}  // namespace
}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::FastModel)

namespace inverse_dynamics_tools {

void bindFastModel(py::module_& module) {
  const auto none = py::none();
  py::class_<FastModel>(
      module, "FastModel",
      "The engine without a plugin, of many states at a time, and Gram matrices.\n\n"
      "Arrays are (n,), one state, or (N, n), one row per state.\n"
      "threads: among how many a large batch is shared. Threads: safe; the GIL\n"
      "is released.")
      .def_static("from_urdf", &fromUrdf, py::arg("urdf"), py::kw_only(), py::arg("root") = "",
                  py::arg("tip") = "", py::arg("gravity") = none, py::arg("threads") = 1,
                  "Of a URDF: its text, or the path of a .urdf or .xacro file; without the "
                  "friction that it\n"
                  "states.")
      .def_static("from_file", &fromFile, py::arg("path"), py::kw_only(), py::arg("threads") = 1,
                  "Of a model file, with its friction.")
      .def_static("from_joints", &fromJoints, py::arg("names"), py::arg("prismatic"),
                  py::arg("rotations"), py::arg("offsets"), py::arg("links"), py::arg("gravity"),
                  py::kw_only(), py::arg("threads") = 1,
                  "Of joints about or along z of their links' frames: (n, 3, 3) and (n, 3), of\n"
                  "each frame in the one before, and (n, 10) parameters of the links.")
      .def_property_readonly(
          "joint_names", [](const FastModel& m) { return tupleOf(m.names()); },
          "Names of the joints, from root to tip: the order of all arrays.")
      .def_property_readonly("parameters", &FastModel::parameters,
                             "(10 n,) of the rigid bodies: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy,\n"
                             "Iyz, Izz of each link, in its frame and about its origin.")
      .def("forward_dynamics", &FastModel::forwardDynamics, py::arg("q"), py::arg("qd"),
           py::arg("tau"), py::kw_only(), py::arg("out") = none,
           "Accelerations under these torques, friction subtracted.")
      .def("torque_derivatives", &FastModel::torqueDerivatives, py::arg("q"), py::arg("qd"),
           py::arg("qdd"),
           "dtau/dq, dtau/dqd and dtau/dqdd = H, (n, n) or (N, n, n): entry (i, j) is that of\n"
           "tau_i by joint j.")
      .def("coriolis_matrix", &FastModel::coriolisMatrix, py::arg("q"), py::arg("qd"),
           py::kw_only(), py::arg("out") = none,
           "C of Christoffel's symbols, (n, n) or (N, n, n): C qd is the Coriolis vector, and\n"
           "dH/dt = C + C'.")
      .def(
          "tip_pose", &FastModel::tipPose, py::arg("q"),
          "Rotation R, (3, 3) or (N, 3, 3), and position p [m], (3,) or (N, 3), of the tip in the\n"
          "root frame.")
      .def("tip_jacobian", &FastModel::tipJacobian, py::arg("q"), py::kw_only(),
           py::arg("out") = none,
           "J, (6, n) or (N, 6, n): J qd is the velocity of the tip's origin, then its angular\n"
           "velocity, in the axes of the root frame.")
      .def("tip_jacobian_derivative", &FastModel::tipJacobianDerivative, py::arg("q"),
           py::arg("qd"), py::kw_only(), py::arg("out") = none,
           "Derivative of J by time: the tip's acceleration is J qdd + dJ qd.")
      .def("regressor", &FastModel::regressor, py::arg("q"), py::arg("qd"), py::arg("qdd"),
           py::kw_only(), py::arg("out") = none,
           "Y, (n, 10 n) or (N, n, 10 n): tau = Y parameters + rotor inertia qdd + friction.")
      .def("regressor_gram", &FastModel::regressorGram, py::arg("q"), py::arg("qd"), py::arg("qdd"),
           py::arg("tau"), py::kw_only(), py::arg("own_columns") = std::vector<ArrayLike>(),
           py::arg("weights") = none,
           "Gram matrix of the rows [Y_j, own columns, tau_j] of each joint, summed over the\n"
           "samples: (n, m, m), m = 10 n + own columns + 1. own_columns: arrays like q, of what\n"
           "else a joint's torque is linear in. weights: an array like q.");
}

}  // namespace inverse_dynamics_tools
