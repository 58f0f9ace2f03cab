// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/model_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/located_yaml.hpp"
#include "model_file_joint.hpp"
#include "model_file_tree.hpp"
#include "plausibility.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

constexpr int kNewestSchema = 2;

// ---------------------------------------------------------------------------------------------
// The model

/// Parameters of link i, moved from the file's frame into the chain's.
LinkParameters inChain(const JointEntry& entry, const LinkParameters& link) {
  return symmetric(entry.X_EU * link);
}

LinkParameters scaled(const LinkParameters& link, double factor) {
  return {factor * link.mass, factor * link.first_moment, factor * link.inertia};
}

Chain makeChain(const std::string& name, const std::vector<JointEntry>& entries,
                const Eigen::Vector3d& gravity, const Transform<double>& X_U_tip) {
  std::vector<Joint> joints;
  std::vector<LinkParameters> links;
  Transform<double> X_EU = Transform<double>::identity();  // of the parent link
  for (const JointEntry& entry : entries) {
    joints.push_back(entry.joint);
    joints.back().placement = X_EU * entry.joint.placement;
    links.push_back(entry.own.empty() ? LinkParameters::zero() : inChain(entry, entry.own[0]));
    X_EU = entry.X_EU;
  }
  const Chain chain(name, std::move(joints), std::move(links), gravity, X_EU * X_U_tip);
  std::vector<std::string> warnings = chain.warnings();
  for (std::string& doubt : limitDoubts(chain)) warnings.push_back(std::move(doubt));
  return chain.withWarnings(std::move(warnings));
}

void addCoupling(const std::vector<JointEntry>& entries, const std::vector<FrictionPlace>& places,
                 Model& model) {
  const Eigen::Index n = model.chain.jointCount();
  Eigen::MatrixXd coupling =
      Eigen::MatrixXd::Identity(n + static_cast<Eigen::Index>(places.size()), n);
  const auto set = [&](Eigen::Index k, const std::vector<double>& row) {
    if (!row.empty()) coupling.row(k) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), n);
  };
  for (Eigen::Index j = 0; j < n; ++j) set(j, entries[static_cast<std::size_t>(j)].coupling);
  Eigen::Index next = n;
  for (const FrictionPlace& place : places) {
    set(next++, place.coupling);
    model.friction.push_back(place.law);
    model.friction_places.push_back(place.name);
  }
  if (!places.empty() || !coupling.isIdentity(0)) model.coupling = coupling;
}

void addSprings(const std::vector<JointEntry>& entries, Model& model) {
  const Eigen::Index n = model.chain.jointCount();
  for (Eigen::Index j = 0; j < n; ++j) {
    const JointEntry& entry = entries[static_cast<std::size_t>(j)];
    if (entry.stiffness != 0) {
      if (model.stiffness.size() == 0) model.rest = model.stiffness = Eigen::VectorXd::Zero(n);
      model.stiffness[j] = entry.stiffness;
      model.rest[j] = entry.rest;
    }
    if (entry.lever_sin != 0 || entry.lever_cos != 0) {
      if (model.levers.size() == 0) model.levers = Eigen::MatrixXd::Zero(2, n);
      model.levers.col(j) << entry.lever_sin, entry.lever_cos;
    }
  }
}

/// Everything beyond the chain, in torques.
void addIdentified(const std::vector<JointEntry>& entries, const std::vector<FrictionPlace>& places,
                   const Conventions& conventions, Model& model) {
  const bool has_deviation = !entries.front().torque_deviation.empty();
  addSprings(entries, model);
  model.drive_gains.resize(conventions.gains ? model.chain.jointCount() : 0);
  model.torque_deviation.resize(has_deviation ? model.chain.jointCount() : 0);
  for (std::size_t j = 0; j < entries.size(); ++j) {
    const JointEntry& entry = entries[j];
    const double gain = conventions.gains ? entry.drive_gain[0] : 1.0;
    const auto factor = [gain](Level level) { return level == Level::kCurrent ? gain : 1.0; };
    if (conventions.gains) model.drive_gains[static_cast<Eigen::Index>(j)] = gain;
    if (has_deviation) {
      model.torque_deviation[static_cast<Eigen::Index>(j)] = entry.torque_deviation[0];
    }
    for (const FrictionLaw& law : entry.friction) {
      model.friction.push_back(scaled(law, factor(conventions.friction_level)));
    }
    model.seen.insert(model.seen.end(), entry.seen.begin(), entry.seen.end());
    for (const Eigen::Vector3d& first_moment : entry.gravity_first_moment) {
      const LinkParameters& own = entry.own[0];
      model.gravity_parameters.push_back(inChain(entry, {own.mass, first_moment, own.inertia}));
    }
    if (!entry.row.empty()) {
      model.row_parameters.emplace_back();
      for (std::size_t i = 0; i < entries.size(); ++i) {
        model.row_parameters.back().push_back(
            scaled(inChain(entries[i], entry.row[i]), factor(conventions.parameters_level)));
      }
    }
  }
  addCoupling(entries, places, model);
}

Model makeModel(const std::string& file, const std::string& name,
                const std::vector<JointEntry>& entries, const Conventions& conventions,
                const Eigen::Vector3d& gravity, const std::vector<TipEntry>& tips,
                const std::vector<FrictionPlace>& places) {
  try {
    const auto chain = [&](const std::vector<JointEntry>& joints,
                           const Transform<double>& X_U_tip) {
      return makeChain(name, joints, gravity, X_U_tip);
    };
    Model model = conventions.tree ? Model(treeOf(name, entries, tips, gravity, chain))
                                   : Model(chain(entries, tips.front().X_U_tip));
    addIdentified(coordinatesOf(entries), places, conventions, model);
    checkModel(model);
    return model;
  } catch (const ModelError& error) {
    throw ModelError(file + ": " + error.what());  // which joint, but not which line
  }
}

// ---------------------------------------------------------------------------------------------
// The file

void verifyState(const LocatedValue& value, double tolerance, const Model& model) {
  const auto count = static_cast<std::size_t>(model.chain.jointCount());
  LocatedMap map = value.map();
  const auto read = [&map, count](const std::string& key) {
    const std::vector<double> numbers = map.required(key).numbers(count);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
        numbers.data(), static_cast<Eigen::Index>(numbers.size())));
  };
  const Eigen::VectorXd q = read("q");
  const Eigen::VectorXd qd = read("qd");
  const Eigen::VectorXd qdd = read("qdd");
  const Eigen::VectorXd expected = read("torques");
  map.rejectOthers();

  Eigen::VectorXd tau(q.size());
  Eigen::VectorXd f(q.size());
  torques(model, q, qd, qdd, tau);
  frictionVector(model, q, qd, f);
  tau += f;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    if (!(std::abs(tau[j] - expected[j]) <= tolerance)) {
      throw ModelError(value.where(),
                       "torque of joint " + model.chain.joints()[static_cast<std::size_t>(j)].name,
                       "the model's torque",
                       "one that is " + numberText(tau[j] - expected[j]) + " off",
                       "a number of the model or of this row is wrong");
    }
  }
}

void verifyChecks(LocatedMap map, const Model& model) {
  const LocatedValue tolerance = map.required("tolerance");
  if (tolerance.number() <= 0) tolerance.fail("a number > 0 [N m]");
  for (const LocatedValue& state : map.required("states").entries()) {
    verifyState(state, tolerance.number(), model);
  }
  map.rejectOthers();
}

int readSchema(const LocatedValue& schema) {
  const std::int64_t number = schema.integer();
  if (number < 1 || number > kNewestSchema) {
    schema.fail("1 or " + std::to_string(kNewestSchema), "this program reads no other schema");
  }
  return static_cast<int>(number);
}

Conventions readConventions(LocatedMap& file, int schema) {
  Conventions conventions{};
  conventions.schema = schema;
  file.required("units").choice({"SI"});
  conventions.geometry = static_cast<Geometry>(
      file.required("geometry").choice({"modified_dh", "standard_dh", "placements"}));
  conventions.parameters = static_cast<Parameters>(
      file.required("parameters").choice({"about_origin", "about_center_of_mass"}));
  if (const auto levels = file.optional("levels")) {
    LocatedMap map = levels->map();
    conventions.gains = true;
    conventions.parameters_level =
        static_cast<Level>(map.required("parameters").choice({"torque", "current"}));
    conventions.friction_level =
        static_cast<Level>(map.required("friction").choice({"torque", "current"}));
    map.rejectOthers();
  }
  return conventions;
}

Model readModel(const LocatedValue& document) {
  LocatedMap file = document.map();
  file.expect({"schema", "name", "source", "validity", "units", "geometry", "parameters", "gravity",
               "joints"});
  const int schema = readSchema(file.required("schema"));
  const std::string name = file.required("name").text();
  const std::string source = file.required("source").text();
  const std::string validity = file.required("validity").text();
  Conventions conventions = readConventions(file, schema);
  const Eigen::Vector3d gravity = readVector(file.required("gravity"));
  std::vector<TipEntry> tips{{"", "", "", Transform<double>::identity()}};
  if (const auto several = file.optional("tips")) {
    if (schema < 2)
      several->fail("no such key in schema 1", "write schema: 2 at the top of the file");
    tips = readTips(*several);
    conventions.tree = true;
  } else if (const auto tip = file.optional("tip")) {
    LocatedMap map = tip->map();
    tips.front().X_U_tip = readPose(map);
    map.rejectOthers();
  }
  const std::vector<JointEntry> entries = readJoints(file.required("joints"), conventions);
  std::vector<FrictionPlace> places;
  if (const auto more = file.optional("friction_at")) {
    places = readFrictionPlaces(*more, conventions, coordinatesOf(entries));
  }
  const auto checks = file.optional("checks");
  file.rejectOthers();

  Model model = makeModel(document.file(), name, entries, conventions, gravity, tips, places);
  model.source = source;
  model.validity = validity;
  if (checks) verifyChecks(checks->map(), model);
  return model;
}

}  // namespace

Model modelFromYaml(const std::string& text, const std::string& where) {
  return readModel(LocatedValue::ofText(text, where));
}

Model modelFromFile(const std::string& path) { return readModel(LocatedValue::ofFile(path)); }

}  // namespace v2
}  // namespace chain_dynamics
