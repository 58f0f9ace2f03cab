// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model_file.hpp"
#include "springs.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

constexpr Eigen::Index kCheckedStates = 4;
constexpr double kTolerance = 1e-9;  // N m: rounding, of numbers up to 1e5

// ---------------------------------------------------------------------------------------------
// Values as YAML has them

/// The fewest digits that are read as the same number; a whole number as one.
std::string number(double value) {
  constexpr double kExact = 1e15;
  if (value == std::trunc(value) && std::abs(value) < kExact) {
    return std::to_string(static_cast<long long>(value));
  }
  char text[32];
  std::size_t size = 0;
  double read = 0;
  for (int digits = 1; read != value; ++digits) {
    char* const end =
        std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits).ptr;
    std::from_chars(text, end, read);
    size = static_cast<std::size_t>(end - text);
  }
  return {text, size};
}

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string text;
  for (const double value : numbers) text += (text.empty() ? "" : ", ") + number(value);
  return "[" + text + "]";
}

std::string list(const LinkParameters& link) { return list(link.toVector()); }

std::string list(const Interval& interval) {
  return list(std::vector<double>{interval.lower, interval.upper});
}

std::string pose(const Transform<double>& X) {
  return "xyz: " + list(X.p) + ", rpy: " + list(rollPitchYaw(X.R));
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (static_cast<unsigned char>(letter) < 0x20) {
      char code[5];
      std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned>(letter));
      result += code;
    } else {
      result += (letter == '"' || letter == '\\' ? "\\" : "") + std::string(1, letter);
    }
  }
  return result + "\"";
}

// ---------------------------------------------------------------------------------------------
// Joints

const char* typeText(JointType type) {
  return type == JointType::kPrismatic    ? "prismatic"
         : type == JointType::kContinuous ? "continuous"
                                          : "revolute";
}

/// `    key: {...}` of the limits that are stated; but for positions, zero states none.
std::string limitsLine(const JointLimits& limits) {
  std::string text;
  const auto add = [&text](const char* key, double value, bool stated) {
    if (!stated || !std::isfinite(value)) return;
    text += (text.empty() ? "" : ", ") + std::string(key) + ": " + number(value);
  };
  add("lower", limits.lower, true);
  add("upper", limits.upper, true);
  add("velocity", limits.velocity, limits.velocity > 0);
  add("effort", limits.effort, limits.effort > 0);
  add("acceleration", limits.acceleration, limits.acceleration > 0);
  add("deceleration", limits.deceleration, limits.deceleration > 0);
  add("jerk", limits.jerk, limits.jerk > 0);
  return text.empty() ? "" : "    limits: {" + text + "}\n";
}

/// With the optional coefficients that aren't zero.
std::string frictionText(const FrictionLaw& law) {
  return std::visit(
      [](const auto& named) {
        std::string text = std::string("friction: {law: ") + named.kName;
        for (const auto& coefficient : named.coefficients()) {
          const double value = named.*coefficient.value;
          if (coefficient.required || value != 0) {
            text += std::string(", ") + coefficient.name + ": " + number(value);
          }
        }
        return text + "}";
      },
      law);
}

std::string linkLines(const Model& model, std::size_t j) {
  if (model.row_parameters.empty()) return "    link: " + list(model.chain.links()[j]) + "\n";
  std::string text = "    row:\n";
  for (const LinkParameters& link : model.row_parameters[j]) text += "      - " + list(link) + "\n";
  return text;
}

std::string startLines(const Joint& joint) {
  return "  - name: " + quoted(joint.name) + "\n    type: " + typeText(joint.type) +
         "\n    placement: {" + pose(joint.placement) + ", axis: [0, 0, 1]}\n";
}

std::string rotorLine(double rotor_inertia) {
  return rotor_inertia == 0 ? "" : "    rotor_inertia: " + number(rotor_inertia) + "\n";
}

/// Of joint j, or of coordinate j of a mechanism: what stands behind its rotor and link.
std::string identifiedLines(const Model& model, std::size_t j, const std::string& links) {
  const auto entry = [j](const char* key, const OwnedVector& values) {
    if (values.size() == 0) return std::string();
    return std::string("    ") + key + ": " + number(values[static_cast<Eigen::Index>(j)]) + "\n";
  };
  std::string text = entry("drive_gain", model.drive_gains);
  const auto k = static_cast<Eigen::Index>(j);
  std::string spring;
  if (model.stiffness.size() > 0 && model.stiffness[k] != 0) {
    spring = "stiffness: " + number(model.stiffness[k]) + ", rest: " + number(model.rest[k]);
  }
  if (hasLever(model, k)) {
    spring += (spring.empty() ? "" : ", ") + std::string("lever_sin: ") +
              number(model.levers(0, k)) + ", lever_cos: " + number(model.levers(1, k));
  }
  if (!spring.empty()) text += "    spring: {" + spring + "}\n";
  if (!model.friction.empty()) text += "    " + frictionText(model.friction[j]) + "\n";
  if (model.coupling.size() > 0 && !model.friction.empty()) {
    text += "    coupling: " + list(model.coupling.row(static_cast<Eigen::Index>(j))) + "\n";
  }
  text += links;
  if (!model.gravity_parameters.empty()) {
    text += "    gravity_first_moment: " + list(model.gravity_parameters[j].first_moment) + "\n";
  }
  text += entry("torque_deviation", model.torque_deviation);
  if (model.seen.empty()) return text + "\n";
  const SeenRange& seen = model.seen[j];
  return text + "    seen: {q: " + list(seen.q) + ", qd: " + list(seen.qd) +
         ", qdd: " + list(seen.qdd) + "}\n\n";
}

std::string jointLines(const Model& model, std::size_t j) {
  const Joint& joint = model.chain.joints()[j];
  return startLines(joint) + limitsLine(joint.limits) + rotorLine(joint.rotor_inertia) +
         identifiedLines(model, j, linkLines(model, j));
}

// ---------------------------------------------------------------------------------------------
// Trees

/// `    mimic: ...` of a joint of a branch; empty: it is the coordinate.
std::string mimicLine(const Model& model, const Branch& branch, std::size_t i) {
  std::string text;
  const auto add = [&](Eigen::Index coordinate, double factor) {
    const bool first = text.empty();
    const std::string& name = model.chain.joints()[static_cast<std::size_t>(coordinate)].name;
    text += (first ? "{joint: " : ", {joint: ") + quoted(name) + ", multiplier: " + number(factor) +
            (first && branch.s[i] != 0 ? ", offset: " + number(branch.s[i]) : "") + "}";
  };
  for (const Follow& entry : branch.S) {
    if (entry.joint == static_cast<Eigen::Index>(i)) add(entry.coordinate, entry.factor);
  }
  if (text.empty()) add(0, 0);  // it stands still
  return "    mimic: [" + text + "]\n";
}

/// The joint of a branch is the coordinate that this gives; none: it follows some.
std::optional<std::size_t> coordinateOf(const Model& model, const Branch& branch, std::size_t i) {
  const std::vector<std::string> names = model.chain.jointNames();
  const auto place = std::find(names.begin(), names.end(), branch.chain.joints()[i].name);
  if (place == names.end()) return std::nullopt;
  return static_cast<std::size_t>(place - names.begin());
}

/// Where each link is first moved: branch and joint.
std::vector<std::pair<const Branch*, std::size_t>> movesOf(const std::vector<Branch>& branches) {
  std::vector<std::pair<const Branch*, std::size_t>> moves(
      static_cast<std::size_t>(linkCount(branches)), {nullptr, 0});
  for (const Branch& branch : branches) {
    for (std::size_t i = 0; i < branch.link.size(); ++i) {
      auto& move = moves[static_cast<std::size_t>(branch.link[i])];
      if (move.first == nullptr) move = {&branch, i};
    }
  }
  return moves;
}

/// A coordinate that is no joint, but moves some.
bool isMotor(const Model& model, std::size_t coordinate) {
  const std::string& name = model.chain.joints()[coordinate].name;
  for (const Branch& branch : model.branches) {
    for (const Joint& joint : branch.chain.joints()) {
      if (joint.name == name) return false;
    }
  }
  return true;
}

/// Those from `next` on that stand before a joint or at the end; `next` is then the joint's.
std::string motorLines(const Model& model, std::size_t& next) {
  std::string text;
  for (; next < model.chain.joints().size() && isMotor(model, next); ++next) {
    const Joint& joint = model.chain.joints()[next];
    text += "  - name: " + quoted(joint.name) +
            "\n    motor: true\n    type: " + typeText(joint.type) + "\n" +
            limitsLine(joint.limits) +
            rotorLine(model.motor_inertia.size() == 0
                          ? 0.0
                          : model.motor_inertia[static_cast<Eigen::Index>(next)]) +
            identifiedLines(model, next, "");
  }
  return text;
}

std::string treeLines(const Model& model) {
  std::string text = "tips:\n";
  for (const Branch& branch : model.branches) {
    text += "  - {name: " + quoted(branch.tip) +
            ", joint: " + quoted(branch.chain.joints().back().name) + ", " +
            pose(branch.chain.tip()) + "}\n";
  }
  text += "\njoints:\n";
  const std::vector<LinkParameters> links = linksOf({model.chain, model.branches});
  std::size_t next = 0;
  for (const auto& [branch, i] : movesOf(model.branches)) {
    const std::vector<Joint>& joints = branch->chain.joints();
    const std::string link =
        "    link: " + list(links[static_cast<std::size_t>(branch->link[i])]) + "\n";
    Joint joint = joints[i];
    const auto coordinate = coordinateOf(model, *branch, i);
    if (coordinate) {
      text += motorLines(model, next);
      ++next;
      // it may turn less far for those that follow it, and may have a motor
      joint.type = model.chain.joints()[*coordinate].type;
      joint.limits = model.chain.joints()[*coordinate].limits;
      if (model.motor_inertia.size() > 0) {
        joint.rotor_inertia += model.motor_inertia[static_cast<Eigen::Index>(*coordinate)];
      }
    }
    text += startLines(joint);
    if (i > 0) text += "    parent: " + quoted(joints[i - 1].name) + "\n";
    text += coordinate ? limitsLine(joint.limits) : mimicLine(model, *branch, i);
    text += rotorLine(joint.rotor_inertia);
    text += coordinate ? identifiedLines(model, *coordinate, link) : link + "\n";
  }
  return text + motorLines(model, next);
}

/// Refuses coordinates that aren't joints, in the order of the links that they move.
void checkWritableTree(const Model& model) {
  std::size_t next = 0;
  const auto skip_motors = [&] {
    while (next < model.chain.joints().size() && isMotor(model, next)) ++next;
  };
  skip_motors();
  for (const auto& [branch, i] : movesOf(model.branches)) {
    const auto coordinate = coordinateOf(model, *branch, i);
    if (!coordinate) continue;
    std::vector<Follow> S;
    for (const Follow& entry : branch->S) {
      if (entry.joint == static_cast<Eigen::Index>(i)) S.push_back(entry);
    }
    const bool is_joint = S.size() == 1 && S[0].factor == 1 && branch->s[i] == 0 &&
                          S[0].coordinate == static_cast<Eigen::Index>(*coordinate);
    if (is_joint && *coordinate == next) {
      ++next;
      skip_motors();
      continue;
    }
    break;
  }
  if (next == model.chain.joints().size()) return;
  throw ModelError("model " + model.name, "coordinate " + model.chain.joints()[next].name,
                   "a joint, in the order of the links that these move", "another",
                   "a model file states no other");
}

/// Friction beside the joints.
std::string frictionPlaceLines(const Model& model) {
  if (model.friction.empty() || model.friction_places.empty()) return "";
  std::string text = "friction_at:\n";
  const std::size_t n = model.chain.joints().size();
  for (std::size_t k = n; k < model.friction.size(); ++k) {
    std::string velocity;
    for (std::size_t j = 0; j < n; ++j) {
      const double factor =
          model.coupling(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j));
      if (factor == 0) continue;
      velocity += (velocity.empty() ? "" : ", ") + quoted(model.chain.joints()[j].name) + ": " +
                  number(factor);
    }
    text += "  - name: " + quoted(model.friction_places[k - n]) + "\n    velocity: {" + velocity +
            "}\n    " + frictionText(model.friction[k]) + "\n";
  }
  return text + "\n";
}

// ---------------------------------------------------------------------------------------------
// Check rows

/// State k: q, qd, qdd of each joint, spread over what was seen.
Eigen::MatrixXd checkedState(const Model& model, Eigen::Index k) {
  constexpr double kGolden = 0.6180339887498949;  // whose multiples fill [0, 1) evenly
  Eigen::MatrixXd state(model.chain.jointCount(), 3);
  for (Eigen::Index j = 0; j < state.rows(); ++j) {
    const SeenRange range = model.seen.empty() ? SeenRange{{-1, 1}, {-1, 1}, {-1, 1}}
                                               : model.seen[static_cast<std::size_t>(j)];
    const Interval* const intervals[] = {&range.q, &range.qd, &range.qdd};
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double steps = kGolden * static_cast<double>(1 + c + 3 * (j + state.rows() * k));
      const auto& [lower, upper] = *intervals[c];
      state(j, c) = lower + (upper - lower) * (steps - std::floor(steps));
    }
  }
  return state;
}

std::string checkLines(const Model& model) {
  std::string text = "checks:\n  tolerance: " + number(kTolerance) + "\n  states:\n";
  Eigen::VectorXd tau(model.chain.jointCount()), f(tau);
  for (Eigen::Index k = 0; k < kCheckedStates; ++k) {
    const Eigen::MatrixXd state = checkedState(model, k);
    torques(model, state.col(0), state.col(1), state.col(2), tau);
    frictionVector(model, state.col(0), state.col(1), f);
    text += "    - {q: " + list(state.col(0)) + ", qd: " + list(state.col(1)) +
            ", qdd: " + list(state.col(2)) + ", torques: " + list(tau + f) + "}\n";
  }
  return text;
}

/// Refuses what a file can't state.
void checkWritable(const Model& model) {
  checkModel(model);
  if (!model.branches.empty()) checkWritableTree(model);
  for (std::size_t i = 0; i < model.gravity_parameters.size(); ++i) {
    if (model.row_parameters.empty() &&
        model.gravity_parameters[i].mass == model.chain.links()[i].mass) {
      continue;
    }
    throw ModelError("model " + model.name, "gravity_parameters of joint " + std::to_string(i + 1),
                     "the masses of the links, and no row_parameters", "others",
                     "a model file states no other");
  }
}

}  // namespace

std::string modelFileText(const Model& model) {
  checkWritable(model);
  std::string text =
      "# SPDX-License-Identifier: Apache-2.0\n#\n"
      "# What each key means: docs/model_file.md. A row of `link` is\n"
      "# m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz.\n"
      "schema: 2\nname: " +
      quoted(model.name) + "\nsource: " + quoted(model.source) +
      "\nvalidity: " + quoted(model.validity) + "\nunits: SI\n" +
      (model.drive_gains.size() > 0 ? "levels: {parameters: torque, friction: torque}\n" : "") +
      "\ngeometry: placements\ngravity: " + list(model.chain.gravity()) +
      "\nparameters: about_origin\n";
  if (!model.branches.empty()) {
    return text + treeLines(model) + frictionPlaceLines(model) + checkLines(model);
  }
  text += "tip: {" + pose(model.chain.tip()) + "}\n\njoints:\n";
  for (std::size_t j = 0; j < model.chain.joints().size(); ++j) text += jointLines(model, j);
  return text + frictionPlaceLines(model) + checkLines(model);
}

}  // namespace v2
}  // namespace chain_dynamics
