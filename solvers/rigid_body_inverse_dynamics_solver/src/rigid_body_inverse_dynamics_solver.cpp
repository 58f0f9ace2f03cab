// SPDX-License-Identifier: Apache-2.0
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <exception>
#include <iomanip>
#include <ios>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/text.hpp"
#include "chain_dynamics/tip_kinematics.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/parameters.hpp"
#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

namespace rigid_body_inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::Chain;
using chain_dynamics::FastModel;
using chain_dynamics::joined;
using inverse_dynamics_solver::DescriptionFriction;
using inverse_dynamics_solver::Exception;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;
using inverse_dynamics_solver::ParameterValue;
using Sentences = std::vector<std::string>;

chain_dynamics::Model modelOfFile(const Configuration& configuration, const std::string& name) {
  try {
    return readModel(name);
  } catch (const Exception& e) {
    throw InvalidParameterValueException("parameter '" + configuration.fullName("model") +
                                         "': " + e.what());
  }
}

chain_dynamics::Mechanism robotOfDescription(const Configuration& configuration) {
  if (configuration.robot_description.empty()) {
    throw ParameterUninitializedException(
        "robot description", "missing", "the text of a URDF, or a model file", "neither",
        "pass a URDF to initialize() as third argument, or set the parameter "
        "'robot_description' (without namespace) or '" +
            configuration.fullName("model") + "'");
  }
  return mechanismFromDescription(configuration);
}

/// Warnings of parameters that have a meaning for robot descriptions only.
Sentences unusedParameters(const Configuration& configuration) {
  std::vector<std::string> names = {"allow_massless", "urdf_friction", "rotor_inertia", "motors",
                                    "motor_names"};
  std::vector<const char*> prefixes = {"rotor_inertia."};
  if (configuration.robot_description.empty()) {  // else: differences()
    names.insert(names.end(), {"root", "tip", "attached"});
    prefixes.push_back("locked_joints.");
  }
  for (const std::string& name : configuration.parameters.names()) {
    for (const char* const of_joints : prefixes) {
      if (name.rfind(configuration.fullName(of_joints), 0) != 0) continue;
      names.push_back(name.substr(configuration.fullName("").size()));
    }
  }

  Sentences sentences;
  for (const std::string& name : names) {
    const auto value = configuration.parameters.find(configuration.fullName(name));
    if (!value || *value == ParameterValue(std::string()) || *value == ParameterValue(false)) {
      continue;
    }
    sentences.push_back("parameter '" + configuration.fullName(name) +
                        "' isn't used: the model states its chain itself");
  }
  return sentences;
}

/// Links with mass that a robot description attaches to the links of a model: tools, payloads.
Sentences attachedLinks(const Configuration& configuration, const chain_dynamics::Model& model) {
  const chain_dynamics::RobotDescription robot =
      chain_dynamics::robotFromUrdf(configuration.robot_description);
  std::vector<std::string> joints = model.chain.jointNames();
  if (!model.branches.empty()) joints.clear();
  for (const chain_dynamics::Branch& branch : model.branches) {
    for (const std::string& name : branch.chain.jointNames()) joints.push_back(name);
  }
  std::set<std::size_t> links_of_model;
  for (const std::string& name : joints) {
    const std::size_t joint = robot.jointIndex(name);
    if (joint == robot.kNone)
      throw Exception("robot " + robot.name + " has no joint '" + name + "'");
    links_of_model.insert(robot.joints[joint].child);
  }

  for (const auto& joint : robot.joints) {  // held where the model was identified with it
    if (configuration.locked_position(joint.name)) links_of_model.insert(joint.child);
  }

  std::string bodies;
  for (const std::string& name : joints) {
    for (const std::size_t i : robot.linksBelow(robot.joints[robot.jointIndex(name)].child)) {
      const auto& link = robot.links[i];
      if (!links_of_model.insert(i).second || !link.inertial || link.inertial->mass == 0.0)
        continue;
      std::ostringstream mass;
      mass << link.inertial->mass;
      bodies += (bodies.empty() ? "" : ", ") + link.name + " (" + mass.str() + " kg)";
    }
  }
  if (bodies.empty()) return {};
  return {"the robot description attaches bodies that model " + model.name +
          " doesn't include in its torques: " + bodies + "; set parameters '" +
          configuration.fullName("payload") +
          ".NAME.mass' and so on, or call setPayload(), to add " +
          "them; if it was identified with them, set '" + configuration.fullName("attached") +
          "' to ignore"};
}

/// In metres and radians: more than what an identified model's lengths differ from its maker's.
constexpr double kOtherFrame = 0.01;

/// A sentence where the tip of a model isn't that of the chain between root and tip of a robot
/// description, whose joints are the same.
Sentences otherTip(const Chain& described, const chain_dynamics::Model& model) {
  const Eigen::Index n = described.jointCount();
  double distance = 0.0, angle = 0.0;
  for (const double position : {0.0, 0.7}) {
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(n, position);
    const auto expected = tipPose(described, q), got = tipPose(model.chain, q);
    distance = std::max(distance, (got.p - expected.p).norm());
    const Eigen::Matrix3d turned = expected.R.transpose() * got.R;
    angle = std::max(angle, Eigen::AngleAxisd(turned).angle());
  }
  if (distance < kOtherFrame && angle < kOtherFrame) return {};
  std::ostringstream found;
  found << std::fixed << std::setprecision(3) << distance << " m and " << angle << " rad";
  return {"root and tip have no effect: the tip of model " + model.name + " is up to " +
          found.str() + " from theirs; poses, wrenches, payloads and gravity are stated in the " +
          "model's frames"};
}

/// Warnings where a robot description, from which nothing is computed, differs from the model.
Sentences differences(const Configuration& configuration, const chain_dynamics::Model& model) {
  if (configuration.robot_description.empty()) return {};
  Sentences sentences;
  try {
    if (configuration.lump_attached) sentences = attachedLinks(configuration, model);
    if (configuration.root.empty() && configuration.tip.empty()) return sentences;
    const chain_dynamics::Mechanism robot = mechanismFromDescription(configuration);
    const Chain& described = robot.coordinates;
    if (described.jointNames() == model.chain.jointNames()) {
      if (!robot.branches.empty() || !model.branches.empty()) return sentences;
      for (std::string& sentence : otherTip(described, model)) sentences.push_back(sentence);
    } else {
      sentences.push_back(
          "root and tip have no effect: between them, the robot description has "
          "joints " +
          joined(described.jointNames()) + ", and model " + model.name + " has " +
          joined(model.chain.jointNames()));
    }
  } catch (const std::exception& e) {
    sentences.push_back(std::string("the robot description isn't used, and can't be compared with "
                                    "the model: ") +
                        e.what());
  }
  return sentences;
}

/// Warnings about a model.
std::vector<std::string> warningsOf(const chain_dynamics::Model& model, bool inertia_is_physical) {
  // Link by link, the numbers of a link of an identified model mean nothing.
  const bool from_file = !model.source.empty();
  std::vector<std::string> warnings;
  if (inertia_is_physical || !from_file) warnings = model.chain.warnings();
  if (!inertia_is_physical) {
    warnings.push_back("model " + model.name +
                       ": its inertia matrix isn't that of rigid bodies; fit for torques, unfit "
                       "for forward dynamics");
  }
  return warnings;
}

void requireFewEnough(const Chain& chain) {
  if (chain.jointCount() <= FastModel::kMaxJoints) return;
  throw inverse_dynamics_solver::InvalidRobotDescriptionException(
      "robot", "too many joints", "at most " + std::to_string(FastModel::kMaxJoints),
      std::to_string(chain.jointCount()),
      "name root and tip of a shorter chain, or use the solver of Pinocchio or KDL");
}

}  // namespace

auto InverseDynamicsSolverRigidBody::configure(const Configuration& configuration) -> JointInfo {
  const std::string name = configuration.get<std::string>("model").value_or("");
  if (!name.empty()) return use(modelOfFile(configuration, name), configuration);

  chain_dynamics::Model model(robotOfDescription(configuration));
  DescriptionFriction friction = descriptionFriction(configuration, model.chain);
  model.friction.assign(friction.laws.begin(), friction.laws.end());
  return keep(std::move(model), configuration, std::move(friction.warnings));
}

auto InverseDynamicsSolverRigidBody::use(chain_dynamics::Model model,
                                         const Configuration& configuration) -> JointInfo {
  Sentences warnings = unusedParameters(configuration);
  for (std::string& sentence : differences(configuration, model)) {
    warnings.push_back(std::move(sentence));
  }
  if (model.branches.empty() && configuration.tip != "*") model.tip = configuration.tip;
  if (configuration.gravity_given) model = withGravity(model, configuration.gravity);
  if (!configuration.friction) model.friction.clear();
  return keep(std::move(model), configuration, std::move(warnings));
}

auto InverseDynamicsSolverRigidBody::keep(chain_dynamics::Model model,
                                          const Configuration& configuration, Sentences warnings)
    -> JointInfo {
  requireFewEnough(model.chain);
  setSprings(configuration, model);
  const bool inertia_is_physical = model.inertiaIsPhysical();
  JointInfo info{model.chain.jointNames(), warningsOf(model, inertia_is_physical),
                 model.chain.jointTypes(), chain_dynamics::tipNames(model)};
  std::vector<std::unique_ptr<const RigidBodyTip>> other_tips;
  for (std::size_t i = 1; i < model.branches.size(); ++i) {
    other_tips.push_back(std::make_unique<const RigidBodyTip>(*this, model.branches[i]));
  }
  for (std::string& warning : warnings) info.warnings.push_back(std::move(warning));
  auto conditions = readConditions(configuration, model.chain.gravity());
  auto robot = std::make_unique<ReadyModel>(conditions->appliedTo(model));
  const Sentences& more = robot->fast.warnings();
  info.warnings.insert(info.warnings.end(), more.begin(), more.end());
  auto bare = std::make_unique<const chain_dynamics::Model>(std::move(model));
  configuration.rejectOthers();

  // Keep; nothing below can throw.
  beginWith(std::move(robot), std::move(conditions));
  model_ = std::move(bare);
  other_tips_ = std::move(other_tips);
  inertia_is_physical_ = inertia_is_physical;
  return info;
}

auto InverseDynamicsSolverRigidBody::robotUnder(const Conditions& conditions) const
    -> std::unique_ptr<const ReadyModel> {
  return std::make_unique<ReadyModel>(conditions.appliedTo(model()), initialRobot());
}

}  // namespace v2
}  // namespace rigid_body_inverse_dynamics_solver
