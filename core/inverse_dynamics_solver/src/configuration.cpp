// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/configuration.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/gravity.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/text.hpp"
#include "chain_dynamics/urdf.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

const std::string kRotorInertia = "rotor_inertia";

std::string describe(const std::vector<double>& numbers) {
  std::ostringstream text;
  text << numbers.size() << " (";
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i == 0 ? "" : ", ") << numbers[i];
  text << ")";
  return text.str();
}

void readGravity(Configuration& configuration) {
  const auto gravity = configuration.get<std::vector<double>>("gravity");
  if (!gravity) return;

  bool valid = gravity->size() == 3;
  for (const double component : *gravity) {
    valid = valid && std::abs(component) <= chain_dynamics::kGreatestGravity;  // false for a NaN
  }
  if (!valid) {
    configuration.refuse("gravity",
                         "3 finite numbers up to 1e6 [m/s^2] in the frame of the root link",
                         describe(*gravity), "for a robot that stands upright: [0.0, 0.0, -9.81]");
  }
  configuration.gravity = Eigen::Vector3d((*gravity)[0], (*gravity)[1], (*gravity)[2]);
  configuration.gravity_given = true;
}

void readAttached(Configuration& configuration) {
  const std::string attached = configuration.get<std::string>("attached").value_or("lump");
  if (attached != "lump" && attached != "ignore") {
    configuration.refuse(
        "attached", R"("lump" or "ignore")", "\"" + attached + "\"",
        "lump: bodies attached beside or beyond the chain are included; ignore: they aren't");
  }
  configuration.lump_attached = attached == "lump";
}

std::string readTip(const Configuration& configuration) {
  const auto value = configuration.parameters.find(configuration.fullName("tip"));
  if (!value || !std::holds_alternative<std::vector<std::string>>(*value)) {
    return configuration.get<std::string>("tip").value_or("");
  }
  return chain_dynamics::joined(std::get<std::vector<std::string>>(*value));
}

void readBatchThreads(Configuration& configuration) {
  constexpr std::int64_t kMost = 4096;
  const std::int64_t threads = configuration.get<std::int64_t>("batch_threads").value_or(1);
  if (threads < 1 || threads > kMost) {
    configuration.refuse("batch_threads", "1 to " + std::to_string(kMost), std::to_string(threads),
                         "give how many threads may share a batch; 1: the library starts none");
  }
  configuration.batch_threads = threads;
}

/// Reader of `locked_joints.<joint>`.
std::function<std::optional<double>(const std::string&)> lockedPositions(
    const Configuration& configuration) {
  return [parameters = configuration.parameters,
          prefix = configuration.fullName("locked_joints.")](const std::string& joint) {
    const auto position = parameters.get<double>(prefix + joint);
    if (position && !std::isfinite(*position)) {
      throw InvalidParameterValueException("parameter '" + prefix + joint + "'", "wrong value",
                                           "a finite position [rad; prismatic m]",
                                           std::to_string(*position),
                                           "give the position at which the joint is held");
    }
    return position;
  };
}

/// Rotor inertia of the joints of a chain: `rotor_inertia.<joint>`, else what the robot description
/// states where `rotor_inertia` is true, else none.
class RotorInertia {
 public:
  explicit RotorInertia(const Configuration& configuration)
      : configuration_(configuration),
        use_stated_(configuration.get<bool>(kRotorInertia).value_or(false)) {}

  double of(const chain_dynamics::RobotDescription::Joint& joint) {
    if (motors.count(joint.name) == 0) {
      if (const auto given = byParameter(joint.name)) return *given;
    }
    if (joint.rotor_inertia > 0.0) stated_.push_back(joint.name);
    return use_stated_ ? joint.rotor_inertia : 0.0;
  }

  std::optional<double> byParameter(const std::string& joint) const {
    const std::string name = kRotorInertia + "." + joint;
    const auto given = configuration_.get<double>(name);
    if (!given || (*given >= 0.0 && std::isfinite(*given))) return given;
    configuration_.refuse(name, "a finite number >= 0 [kg m^2; prismatic kg]",
                          std::to_string(*given),
                          "give the inertia of the rotor times the square of the gear ratio");
  }

  std::set<std::string> motors;  ///< names that aren't of joints

  /// The chain, with a warning if what the description states isn't used, or if it states nothing.
  chain_dynamics::Chain warnedOf(const chain_dynamics::Chain& chain) const {
    if (use_stated_ == !stated_.empty()) return chain;
    const std::string parameter = "'" + configuration_.fullName(kRotorInertia) + "'";
    std::vector<std::string> warnings = chain.warnings();
    warnings.push_back(
        use_stated_
            ? "parameter " + parameter + " has no effect: no <transmission> of the robot " +
                  "description states rotor inertia of a joint that has none by parameter"
            : "the rotor inertia that the robot description states in <transmission> (joints " +
                  chain_dynamics::joined(stated_) + ") isn't used; set parameter " + parameter +
                  " to true to add it to the inertia matrix");
    return chain.withWarnings(std::move(warnings));
  }

 private:
  const Configuration& configuration_;
  const bool use_stated_;
  std::vector<std::string> stated_;  // joints
};

}  // namespace

void Configuration::refuse(const std::string& name, const std::string& expected,
                           const std::string& got, const std::string& remedy) const {
  throw InvalidParameterValueException("parameter '" + fullName(name) + "'", "wrong value",
                                       expected, got, remedy);
}

Configuration readConfiguration(const Parameters& parameters, const std::string& param_namespace,
                                const std::string& robot_description) {
  Configuration configuration;
  const auto asked = std::make_shared<std::set<std::string>>();
  configuration.asked = asked;
  configuration.parameters =
      parameters.watched([asked](const std::string& name) { asked->insert(name); });
  configuration.param_namespace = param_namespace;
  asked->insert("robot_description");  // known, where the argument is given too
  configuration.robot_description =
      robot_description.empty() ? parameters.get<std::string>("robot_description").value_or("")
                                : robot_description;

  configuration.root = configuration.get<std::string>("root").value_or("");
  configuration.tip = readTip(configuration);
  configuration.allow_massless = configuration.get<bool>("allow_massless").value_or(false);
  configuration.friction = configuration.get<bool>("friction").value_or(true);
  configuration.urdf_friction = configuration.get<bool>("urdf_friction").value_or(false);
  readGravity(configuration);
  readAttached(configuration);
  readBatchThreads(configuration);
  configuration.locked_position = lockedPositions(configuration);
  return configuration;
}

namespace {

/// The robot description, and how it is taken.
struct Description {
  explicit Description(const Configuration& configuration) : rotors(configuration) {
    robot = chain_dynamics::robotFromUrdf(configuration.robot_description);
    options.root = configuration.root;
    if (configuration.gravity_given) options.gravity = configuration.gravity;
    options.lump_attached = configuration.lump_attached;
    options.allow_massless = configuration.allow_massless;
    options.locked_position = configuration.locked_position;
    options.rotor_inertia = [this](const auto& joint) { return rotors.of(joint); };
    tips = tipsNamed(robot, configuration.tip);
  }

  RotorInertia rotors;
  chain_dynamics::RobotDescription robot;
  chain_dynamics::UrdfOptions options;
  std::vector<std::string> tips;
};

/// The motors that the parameter `motors` asks for, if any.
class MotorParameters {
 public:
  explicit MotorParameters(const Configuration& configuration)
      : configuration_(configuration),
        names_(configuration.get<std::vector<std::string>>("motor_names")
                   .value_or(std::vector<std::string>())) {
    const auto value = configuration.parameters.find(configuration.fullName("motors"));
    described_ = value && *value == ParameterValue(std::string("description"));
    if (value && !described_ && *value != ParameterValue(std::string())) {
      numbers_ = configuration.require<std::vector<double>>("motors");
    }
    if (!names_.empty() && numbers_.empty()) {
      configuration.refuse("motor_names", "none without a matrix 'motors'",
                           chain_dynamics::joined(names_), "give the matrix, or no names");
    }
  }

  bool given() const { return described_ || !numbers_.empty(); }

  /// Names that are motors' alone.
  std::set<std::string> names(const chain_dynamics::RobotDescription& robot) const {
    std::set<std::string> names(names_.begin(), names_.end());
    for (const auto& transmission : robot.transmissions) {
      if (described_) names.insert(transmission.motors.begin(), transmission.motors.end());
    }
    return names;
  }

  chain_dynamics::Motors of(const chain_dynamics::RobotDescription& robot,
                            const chain_dynamics::Chain& coordinates) const {
    const std::vector<std::string> joints = coordinates.jointNames();
    if (described_) return motorsFromRobot(robot, joints);
    const std::size_t n = joints.size(), m = numbers_.size() / n;
    if (m * n != numbers_.size() || m > n || (!names_.empty() && names_.size() != m)) {
      configuration_.refuse(
          "motors",
          "numbers of M in q = M q_motors, row by row: for each of the " + std::to_string(n) +
              " joints " + chain_dynamics::joined(joints) + " one per motor, of up to " +
              std::to_string(n) + " motors" +
              (names_.empty()
                   ? ""
                   : ", which are " + std::to_string(names_.size()) + " by 'motor_names'"),
          std::to_string(numbers_.size()) + " numbers", "state a row for each joint");
    }
    chain_dynamics::Motors motors;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    motors.M = Eigen::Map<const Rows>(numbers_.data(), static_cast<Eigen::Index>(n),
                                      static_cast<Eigen::Index>(m));
    motors.names = names_;
    return motors;
  }

 private:
  const Configuration& configuration_;
  std::vector<std::string> names_;
  std::vector<double> numbers_;
  bool described_ = false;
};

/// The mechanism behind its motors, which have rotor inertia by the parameters of their names.
chain_dynamics::Mechanism driven(const chain_dynamics::Mechanism& mechanism,
                                 const MotorParameters& parameters,
                                 const Description& description) {
  chain_dynamics::Motors motors = parameters.of(description.robot, mechanism.coordinates);
  for (const std::string& name : withMotors(mechanism, motors).coordinates.jointNames()) {
    const bool is_joint =
        description.robot.jointIndex(name) != chain_dynamics::RobotDescription::kNone;
    const bool is_read = is_joint && description.rotors.motors.count(name) == 0;
    motors.rotor_inertia.push_back(is_read ? 0 : description.rotors.byParameter(name).value_or(0));
  }
  return withMotors(mechanism, motors);
}

/// What `take` makes of the description.
template <class Take>
auto fromDescription(const Configuration& configuration, const Take& take) {
  if (configuration.robot_description.empty()) {
    throw ParameterUninitializedException(
        "robot description", "missing", "the text of a URDF", "nothing",
        "pass it to initialize() as third argument, or set the parameter "
        "'robot_description' (without namespace)");
  }
  try {
    Description description(configuration);
    return take(description);
  } catch (const chain_dynamics::ModelError& e) {
    throw InvalidRobotDescriptionException(std::string("robot description: ") + e.what());
  }
}

}  // namespace

chain_dynamics::Chain chainFromDescription(const Configuration& configuration) {
  return fromDescription(configuration, [&](Description& description) {
    if (description.tips.size() > 1 || configuration.tip == "*") {
      configuration.refuse("tip", "one link, as the solver computes chains", configuration.tip,
                           "name one tip, or take rigid_body_inverse_dynamics_solver");
    }
    if (!description.tips.empty()) description.options.tip = description.tips[0];
    return description.rotors.warnedOf(chainFromRobot(description.robot, description.options));
  });
}

chain_dynamics::Mechanism mechanismFromDescription(const Configuration& configuration) {
  return fromDescription(configuration, [&](Description& description) {
    const MotorParameters parameters(configuration);
    description.rotors.motors = parameters.names(description.robot);
    auto mechanism = mechanismFromRobot(description.robot, description.options, description.tips,
                                        parameters.given());
    if (parameters.given()) mechanism = driven(mechanism, parameters, description);
    mechanism.coordinates = description.rotors.warnedOf(mechanism.coordinates);
    return mechanism;
  });
}

void setSprings(const Configuration& configuration, chain_dynamics::Model& model) {
  const Eigen::Index n = model.chain.jointCount();
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::string spring =
        "springs." + model.chain.joints()[static_cast<std::size_t>(j)].name + ".";
    const auto stiffness = configuration.get<double>(spring + "stiffness");
    const auto rest = configuration.get<double>(spring + "rest");
    const auto lever_sin = configuration.get<double>(spring + "lever_sin");
    const auto lever_cos = configuration.get<double>(spring + "lever_cos");
    if (!stiffness && !rest && !lever_sin && !lever_cos) continue;
    if (rest && !stiffness) {
      configuration.refuse(spring + "rest", "none without a stiffness", std::to_string(*rest),
                           "state '" + configuration.fullName(spring) + "stiffness'");
    }
    if (stiffness) {
      if (model.stiffness.size() == 0) model.rest = model.stiffness = Eigen::VectorXd::Zero(n);
      model.stiffness[j] = *stiffness;
      model.rest[j] = rest.value_or(0.0);
    }
    if (lever_sin || lever_cos) {
      if (model.levers.size() == 0) model.levers = Eigen::MatrixXd::Zero(2, n);
      model.levers.col(j) << lever_sin.value_or(0.0), lever_cos.value_or(0.0);
    }
    try {
      checkModel(model);
    } catch (const chain_dynamics::ModelError& e) {
      throw InvalidParameterValueException("parameters '" + configuration.fullName(spring) +
                                           "*': " + e.what());
    }
  }
}

void refuseMotorsAndSprings(const Configuration& configuration) {
  const auto refuse = [&configuration](const std::string& name, const char* what) {
    configuration.refuse(name, std::string("none, as the solver takes no ") + what, "one",
                         "take rigid_body_inverse_dynamics_solver");
  };
  if (MotorParameters(configuration).given()) refuse("motors", "motors");
  const std::string prefix = configuration.fullName("springs.");
  for (const std::string& name : configuration.parameters.names()) {
    if (name.rfind(prefix, 0) == 0) refuse("springs." + name.substr(prefix.size()), "springs");
  }
}

DescriptionFriction descriptionFriction(const Configuration& configuration,
                                        const chain_dynamics::Chain& chain) {
  DescriptionFriction result;
  if (!configuration.friction) return result;

  std::vector<std::string> stated;  // joints
  for (const chain_dynamics::Joint& joint : chain.joints()) {
    if (joint.damping != 0.0 || joint.friction != 0.0) stated.push_back(joint.name);
    result.laws.push_back({joint.damping, joint.friction, 0.0});
  }
  if (!configuration.urdf_friction) result.laws.clear();
  if (configuration.urdf_friction == !stated.empty()) return result;

  const std::string parameter = "'" + configuration.fullName("urdf_friction") + "'";
  result.warnings.push_back(
      stated.empty()
          ? "parameter " + parameter +
                " has no effect: the robot description states no <dynamics> of a joint"
          : "<dynamics> of the robot description (joints " + chain_dynamics::joined(stated) +
                ") isn't used; set parameter " + parameter + " to add its damping and friction");
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
