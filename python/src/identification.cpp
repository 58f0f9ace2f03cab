// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/owned.hpp>
#include <chain_dynamics/text.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cstddef>
#include <inverse_dynamics_identification/arm_fit.hpp>
#include <inverse_dynamics_identification/friction_step.hpp>
#include <inverse_dynamics_identification/pseudo_inertia.hpp>
#include <inverse_dynamics_identification/residual_noise.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <map>
#include <memory>
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
#include "tips.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {

/// q, qd, qdd, tau of a block, (N, n) each.
using Block = std::tuple<Array, Array, Array, Array>;

/// Blocks, and the arrays that they are views of.
struct HeldData {
  std::vector<Block> arrays;
  std::vector<Array> before;
  inverse_dynamics_identification::ArmData data;
};

}  // namespace inverse_dynamics_tools

namespace pybind11::detail {

/// Friction terms by the name of their law.
template <>
class type_caster<inverse_dynamics_identification::FrictionTerms> {
  using Terms = inverse_dynamics_identification::FrictionTerms;
  static constexpr std::array<const char*, 4> kLaws = {"step", "load", "stribeck", "memory"};

 public:
  PYBIND11_TYPE_CASTER(Terms, const_name("str"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<str>(source)) return false;
    const auto law = source.cast<std::string>();
    const auto found = std::find(kLaws.begin(), kLaws.end(), law);
    if (found == kLaws.end()) {
      throw chain_dynamics::ModelError("ArmFitter", "law", "step, load, stribeck or memory",
                                       "'" + law + "'", "name one of them");
    }
    value = static_cast<Terms>(found - kLaws.begin());
    return true;
  }

  static handle cast(Terms terms, return_value_policy /*policy*/, handle /*parent*/) {
    return str(kLaws[static_cast<std::size_t>(terms)]).release();
  }
};

}  // namespace pybind11::detail

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace identification = inverse_dynamics_identification;
using identification::ArmFit;
using identification::ArmFitOptions;
using identification::ArmFitter;
using identification::ArmSamples;
using identification::FrictionTerms;
using identification::LinkPrior;
using Vector = Eigen::VectorXd;

/// Factors of the velocities of joints, by place and joint.
using FrictionAt = std::map<std::string, std::map<std::string, double>>;

Eigen::Index placeOf(const std::string& joint, const std::vector<std::string>& joints,
                     const std::string& what) {
  const auto place = std::find(joints.begin(), joints.end(), joint);
  if (place != joints.end()) return place - joints.begin();
  throw chain_dynamics::ModelError(what, "joint", "one of " + chain_dynamics::joined(joints),
                                   "'" + joint + "'", "");
}

/// What is fitted of the springs of joints, by name.
std::vector<identification::SpringTerms> springTerms(const std::vector<std::string>& joints,
                                                     const std::map<std::string, std::string>& of) {
  std::vector<identification::SpringTerms> springs;
  if (of.empty()) return springs;
  springs.resize(joints.size(), identification::SpringTerms::kNone);
  for (const auto& [joint, kind] : of) {
    if (kind != "linear" && kind != "lever") {
      throw chain_dynamics::ModelError("spring", "kind of joint " + joint, "linear or lever",
                                       "'" + kind + "'", "");
    }
    springs[static_cast<std::size_t>(placeOf(joint, joints, "spring"))] =
        kind == "linear" ? identification::SpringTerms::kLinear
                         : identification::SpringTerms::kLever;
  }
  return springs;
}

std::unique_ptr<ArmFitter> fitterFromUrdf(const std::string& urdf, const std::string& root,
                                          const Tips& tip,
                                          const std::optional<std::array<double, 3>>& gravity,
                                          const std::map<std::string, double>& locked_joints,
                                          const std::optional<Array>& coupling,
                                          const FrictionAt& friction_at,
                                          const std::map<std::string, std::string>& springs,
                                          const ParameterDict& motors) {
  const auto mechanism =
      mechanismFrom(urdf, root, tip, gravity, locked_joints, parametersOf(motors));
  const std::vector<std::string> joints = mechanism.coordinates.jointNames();
  const auto n = static_cast<Eigen::Index>(joints.size());
  Eigen::MatrixXd laws;
  if (coupling) laws = states(*coupling, "coupling").transpose();
  if (!friction_at.empty() && !coupling) laws.setIdentity(n, n);
  std::vector<std::string> places;
  for (const auto& [place, velocity] : friction_at) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(n);
    for (const auto& [joint, factor] : velocity) row[placeOf(joint, joints, place)] = factor;
    laws.conservativeResize(laws.rows() + 1, n);
    laws.bottomRows(1) = row;
    places.push_back(place);
  }
  return std::make_unique<ArmFitter>(mechanism, identification::LinkFloor{}, laws,
                                     springTerms(joints, springs), places);
}

/// The known body at the tip in each block, as arguments of set_payload(), or none.
using Carried = std::vector<std::optional<inverse_dynamics_solver::RigidBody>>;

std::vector<ArmSamples> samplesOf(const std::vector<Block>& blocks, const Carried& carried) {
  if (!carried.empty() && carried.size() != blocks.size()) {
    throw py::value_error("carried: expected one for each of " + std::to_string(blocks.size()) +
                          " blocks, got " + std::to_string(carried.size()));
  }
  std::vector<ArmSamples> samples;
  samples.reserve(blocks.size());
  for (const auto& [q, qd, qdd, tau] : blocks) {
    samples.push_back({states(q, "q"), states(qd, "qd"), states(qdd, "qdd"), states(tau, "tau")});
    if (carried.empty()) continue;
    const auto& body = carried[samples.size() - 1];
    if (body) samples.back().carried = inverse_dynamics_solver::inTipFrame(*body);
  }
  return samples;
}

std::unique_ptr<HeldData> dataOf(const ArmFitter& fitter, std::vector<Block> blocks,
                                 const Carried& carried, const std::vector<Vector>& times,
                                 std::vector<Array> before) {
  std::vector<ArmSamples> samples = samplesOf(blocks, carried);
  for (std::size_t b = 0; b < std::min(before.size(), samples.size()); ++b) {
    if (before[b].size() > 0) samples[b].before = states(before[b], "before");
  }
  for (std::size_t b = 0; b < std::min(times.size(), samples.size()); ++b) {
    samples[b].time = times[b];
  }
  const py::gil_scoped_release release;
  return std::make_unique<HeldData>(
      HeldData{std::move(blocks), std::move(before), fitter.data(std::move(samples))});
}

Array torques(const ArmFitter& fitter, const ArmFit& of, const Array& q, const Array& qd,
              const Array& qdd, const std::optional<Array>& before) {
  const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd"), qdd_in = states(qdd, "qdd");
  const auto n = fitter.description().jointCount();
  for (const ConstMap& in : {q_in, qd_in, qdd_in}) {
    if (in.rows() != n || in.cols() != q_in.cols()) {
      throw chain_dynamics::ModelError(
          "ArmFitter.torques", "q, qd, qdd", "(N, " + std::to_string(n) + ") each",
          "(" + std::to_string(in.cols()) + ", " + std::to_string(in.rows()) + ")",
          "give one state per row");
    }
  }
  Array result = like(q);
  Map out = columns(result);
  const py::gil_scoped_release release;
  chain_dynamics::ConstStates earlier{nullptr, 0, 0, 1, 0};
  if (before && before->size() > 0) {
    requireShape("before", *before, {before->shape(0), n});
    earlier = states(*before, "before");
  }
  fitter.torques(of, q_in, qd_in, qdd_in, out, earlier);
  return result;
}

std::tuple<Array, Array, Array> information(const ArmFitter& fitter, const ArmFit& of,
                                            const HeldData& held, const ArmFitOptions& options) {
  auto found = unlocked([&] { return fitter.information(of, held.data, options); });
  return {rowsOf(std::move(found.data)), rowsOf(std::move(found.prior)),
          rowsOf(std::move(found.scores))};
}

Array whitenedInformation(const ArmFitter& fitter, const ArmFit& of, const HeldData& held,
                          FrictionTerms law, const identification::ResidualNoise& noise) {
  return rowsOf(unlocked([&] { return fitter.whitenedInformation(of, law, held.data, noise); }));
}

/// (l, 10).
Array rowsOfLinks(const std::vector<LinkPrior>& priors) {
  chain_dynamics::OwnedMatrix rows(10, static_cast<Eigen::Index>(priors.size()));
  Eigen::Index i = 0;
  for (const LinkPrior& prior : priors) rows.col(i++) = prior.link.toVector();
  return rowsOf(std::move(rows));
}

void bindFit(py::module_& module) {
  py::class_<ArmFit>(module, "ArmFit", "A model of an arm: arm_fit.hpp.")
      .def_property_readonly(
          "parameters", [](const ArmFit& f) { return rowsOf(f.parameters); },
          "(l, 10) m, mc, I of each link, in its frame and about its origin.")
      .def_property_readonly(
          "rotor_inertia", [](const ArmFit& f) { return arrayOf(f.rotor_inertia); },
          "(n,) kg m^2 (prismatic kg).")
      .def_readonly("friction", &ArmFit::friction,
                    "smooth_coulomb of each joint and then of each other row of the coupling, by "
                    "the keys of the model file.")
      .def_property_readonly(
          "springs",
          [](const ArmFit& f) -> std::optional<Array> {
            if (f.springs.size() == 0) return std::nullopt;
            return rowsOf(chain_dynamics::OwnedMatrix(f.springs));
          },
          "(n, 2): k [N m/rad] and 0 of linear springs, a and b [N m] of levers; None: without "
          "springs.")
      .def_property_readonly(
          "noise", [](const ArmFit& f) { return arrayOf(f.noise); },
          "(n,) root mean squares of the errors of the samples that it was fitted to.")
      .def_property_readonly(
          "drive_gains",
          [](const ArmFit& f) -> std::optional<Array> {
            if (f.drive_gains.size() == 0) return std::nullopt;
            return arrayOf(f.drive_gains);
          },
          "(n,) N m/A (prismatic N/A) that were fitted; None: of measured torques.")
      .def_readonly("cost", &ArmFit::cost, "What was minimised, up to a constant.")
      .def_readonly("passes", &ArmFit::passes, "How often the samples were gone through.");
}

}  // namespace

void bindIdentification(py::module_& module) {
  bindFit(module);
  using O = ArmFitOptions;
  bindOptions(module, "ArmFitOptions", "How to fit.", "",
              Field{"law", &O::terms, "of friction: step, load, stribeck, memory"},
              Field{"prior_strength", &O::prior_strength, "of the description's links"},
              Field{"most_passes", &O::most_passes, "over the samples"},
              Field{"shift", &O::shift, "whether the step of friction may be off zero velocity"},
              Field{"drive_gains", &O::drive_gains,
                    "(n,) N m/A, about: tau are currents [A], and the gains are fitted"});
  py::class_<HeldData>(module, "ArmData", "Blocks of samples for any number of fits.")
      .def("__len__", [](const HeldData& held) { return held.arrays.size(); });
  py::class_<ArmFitter>(module, "ArmFitter",
                        "Fits models of one arm: arm_fit.hpp. Threads: safe; the GIL is released.")
      .def_static(
          "from_urdf", &fitterFromUrdf, "urdf"_a, py::kw_only(), "root"_a = "", "tip"_a = "",
          "gravity"_a = py::none(), "locked_joints"_a = std::map<std::string, double>(),
          "coupling"_a = py::none(), "friction_at"_a = FrictionAt(),
          "springs"_a = std::map<std::string, std::string>(), "motors"_a = dictOf({}),
          "Of a URDF's text, whose links are the prior. tip: of several, or of \"*\", a tree.\n"
          "locked_joints: positions of joints beside chain or tree, else 0. coupling: (n, n), "
          "laws of friction act at\n"
          "`coupling qd`. friction_at: further places with friction, by name, each with the "
          "factors "
          "of the joints' velocities.\n"
          "springs: linear or lever by joint, to be fitted. motors: as "
          "FastModel.from_urdf() takes them.")
      .def_property_readonly(
          "coupling",
          [](const ArmFitter& f) -> std::optional<Array> {
            if (f.coupling().size() == 0) return std::nullopt;
            return rowsOf(chain_dynamics::OwnedMatrix(f.coupling().transpose()));
          },
          "(r, n); None: each joint has a law of its own.")
      .def_property_readonly(
          "friction_places", [](const ArmFitter& f) { return tupleOf(f.frictionPlaces()); },
          "Names of the places beside the joints where friction acts: of the last rows of "
          "coupling.")
      .def_property_readonly(
          "springs",
          [](const ArmFitter& f) {
            std::vector<int> columns;
            for (const auto spring : f.springs()) columns.push_back(static_cast<int>(spring));
            return columns;
          },
          "Of each joint 0, 1 of a linear spring that is fitted, 2 of a lever; empty: none.")
      .def_property_readonly(
          "joint_names", [](const ArmFitter& f) { return tupleOf(f.description().jointNames()); },
          "Names of the joints, from root to tip: the order of all arrays.")
      .def_property_readonly(
          "link_joints", [](const ArmFitter& f) { return tupleOf(linkJoints(f.robot())); },
          "Names of the joints that move the l links; of a chain joint_names.")
      .def_property_readonly(
          "prior", [](const ArmFitter& f) { return rowsOfLinks(f.prior()); },
          "(l, 10) parameters of the links that fits are drawn to.")
      .def_property_readonly(
          "changes",
          [](const ArmFitter& f) {
            std::vector<std::string> changes;
            for (const LinkPrior& prior : f.prior()) changes.push_back(prior.changes);
            return changes;
          },
          "What the prior has changed about each described link, in words; empty: nothing.")
      .def("data", &dataOf, "blocks"_a, py::kw_only(), "carried"_a = Carried(),
           "times"_a = std::vector<Vector>(), "before"_a = std::vector<Array>(),
           "Samples of blocks, q, qd, qdd, tau, (N, n) each. carried: a known body of each block, "
           "by\n"
           "the arguments of set_payload(), or None; times: (N,) s of each block, for\n"
           "whitened_information(); before: (K, n) positions before each block, which friction\n"
           "remembers: where joints turned round suffices.")
      .def(
          "fit",
          [](const ArmFitter& f, const HeldData& held, const ArmFitOptions& options,
             const std::optional<ArmFit>& start) {
            return f.fit(held.data, options, start ? &*start : nullptr);
          },
          py::call_guard<py::gil_scoped_release>(), "data"_a, "options"_a, "start"_a = py::none(),
          "A fit to the samples of all blocks. start: another one to begin with.")
      .def(
          "left_out",
          [](const ArmFitter& f, const ArmFit& fit, const HeldData& held,
             const ArmFitOptions& options) { return f.leftOut(fit, held.data, options); },
          py::call_guard<py::gil_scoped_release>(), "fit"_a, "data"_a, "options"_a,
          "Of each block, a fit to the others: one Gauss-Newton step from a fit to all blocks.\n"
          "options: those of the fit; the strength of the prior may be another.")
      .def("torques", &torques, "fit"_a, "q"_a, "qd"_a, "qdd"_a, "before"_a = py::none(),
           "Torques of a fit, friction included: (n,) or (N, n) in the order of time.\n"
           "before: (K, n) positions before, as in data().")
      .def("whitened_information", &whitenedInformation, "fit"_a, "data"_a, "law"_a, "noise"_a,
           "What samples say of the m unknowns where errors are like this noise, (m, m).")
      .def("information", &information, "fit"_a, "data"_a, "options"_a,
           "What data and prior say of the m unknowns, (m, m) each, and scores (blocks, m).");
}

}  // namespace inverse_dynamics_tools
