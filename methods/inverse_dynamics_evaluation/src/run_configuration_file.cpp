// SPDX-License-Identifier: Apache-2.0

// Run configurations as files have them.

#include <algorithm>
#include <array>
#include <chain_dynamics/located_yaml.hpp>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <inverse_dynamics_solver/parameters.hpp>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/package_share.hpp"
#include "inverse_dynamics_evaluation/run_configuration.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

namespace fs = std::filesystem;
using chain_dynamics::joined;
using chain_dynamics::LocatedMap;
using chain_dynamics::LocatedValue;

constexpr std::int64_t kSchema = 1;
constexpr const char* kRobotsPackage = "inverse_dynamics_robots";

/// Whether it can be a file name: results are named after the robot.
bool isPlainName(const std::string& text) {
  return !text.empty() && text != "." && text != ".." && text.find('/') == std::string::npos &&
         chain_dynamics::isPrintable(text);
}

std::string stripped(const std::string& text) {
  const char* const blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks);
  return begin == std::string::npos ? ""
                                    : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

// A path can't contain NUL; a system call would ignore everything after it.
bool isFile(const std::string& path) {
  std::error_code ignored;
  return path.find('\0') == std::string::npos && fs::is_regular_file(path, ignored);
}

// ---------------------------------------------------------------------------------------------
// Values

std::string textOf(const std::optional<LocatedValue>& value, const std::string& otherwise = "",
                   const std::vector<std::string>& one_of = {}) {
  return value ? value->text(one_of) : otherwise;
}

std::string existingFile(const std::optional<LocatedValue>& value) {
  if (!value) return "";
  const std::string directory = fs::path(value->file()).parent_path();
  std::string path = value->text();
  try {
    path = resolvedPath(path, directory);
  } catch (const ConfigurationError& error) {
    value->fail("a file", error.what());
  }
  if (!isFile(path)) value->fail("a file", path + " isn't there");
  return path;
}

/// A name, not a path: one of the models of the project.
std::string modelFile(const std::optional<LocatedValue>& value) {
  if (!value) return "";
  const fs::path name = value->text();
  if (name.has_extension() || name.has_parent_path()) return existingFile(value);
  const fs::path file =
      fs::path(packageShare(kRobotsPackage)) / "models" / (name.string() + ".yaml");
  if (!isFile(file)) value->fail("a file, or the name of a model", file.string() + " isn't there");
  return file;
}

std::optional<std::array<double, 3>> gravityOf(const std::optional<LocatedValue>& value) {
  if (!value) return std::nullopt;
  const std::vector<LocatedValue> entries = value->entries(3);
  return std::array<double, 3>{entries[0].number(), entries[1].number(), entries[2].number()};
}

std::vector<double> driveGainsOf(const std::optional<LocatedValue>& value) {
  std::vector<double> gains;
  if (!value) return gains;
  for (const LocatedValue& entry : value->entries()) {
    gains.push_back(entry.number());
    if (gains.back() <= 0) {
      entry.fail("a drive gain above zero, in N m/A", "change the sign of the efforts instead");
    }
  }
  if (gains.empty()) value->fail("a number per joint");
  return gains;
}

std::vector<std::string> namesOf(const std::optional<LocatedValue>& value) {
  std::vector<std::string> names;
  if (!value) return names;
  for (const LocatedValue& entry : value->entries()) names.push_back(entry.text());
  if (std::set<std::string>(names.begin(), names.end()).size() != names.size()) {
    value->refuse("expected each name once, got " + joined(names));
  }
  return names;
}

/// One text: names of several tips stand with commas between them.
std::string tipOf(const std::optional<LocatedValue>& value) {
  return value && value->isList() ? joined(namesOf(value)) : textOf(value);
}

void readAccelerations(const std::optional<LocatedValue>& value, RunConfiguration& robot) {
  if (!value) return;
  LocatedMap map = value->map();
  std::vector<std::string> methods;
  for (const auto method : {AccelerationMethod::kAuto, AccelerationMethod::kLowPass,
                            AccelerationMethod::kGiven, AccelerationMethod::kBackwardDifference}) {
    methods.push_back(inverse_dynamics_evaluation::name(method));
  }
  robot.accelerations = textOf(map.optional("method"), robot.accelerations, methods);
  if (const auto cutoff = map.optional("cutoff")) {
    robot.cutoff = cutoff->number();
    if (*robot.cutoff <= 0) cutoff->fail("a frequency in Hz above zero");
  }
  map.rejectOthers();
}

// Format of a recorded table; its reader checks the values.
void readTable(const std::optional<LocatedValue>& value, RunConfiguration& robot) {
  if (!value) return;
  LocatedMap map = value->map();
  robot.columns = textOf(map.optional("columns"));
  if (const auto scale = map.optional("scale")) {
    for (const LocatedValue& entry : scale->entries()) robot.scale.push_back(entry.text());
  }
  if (const auto sign = map.optional("sign")) {
    for (const LocatedValue& entry : sign->entries()) robot.sign.push_back(entry.number());
  }
  if (const auto gears = map.optional("gears")) {
    for (const LocatedValue& entry : gears->entries()) robot.gears.push_back(entry.number());
  }
  if (const auto rate = map.optional("rate")) {
    robot.rate = rate->number();
    if (*robot.rate <= 0) rate->fail("samples per second, above zero");
  }
  map.rejectOthers();
}

// What `ids identify` fits beside friction of the joints.
void readFitted(LocatedMap& top, RunConfiguration& robot) {
  if (const auto places = top.optional("friction_at")) {
    const LocatedMap all = places->map();
    for (const auto& [name, velocity] : all.entries()) {
      std::map<std::string, double>& factors = robot.friction_at[name];
      const LocatedMap of_joints = velocity.map();
      for (const auto& [joint, factor] : of_joints.entries()) factors[joint] = factor.number();
      if (factors.empty()) velocity.fail("a factor of at least one joint's velocity");
    }
  }
  if (const auto springs = top.optional("fit_springs")) {
    const LocatedMap all = springs->map();
    for (const auto& [joint, kind] : all.entries()) {
      robot.fit_springs[joint] = kind.text({"linear", "lever"});
    }
  }
}

// ---------------------------------------------------------------------------------------------
// Files

void throwConfigurationError(const std::string& text) {
  throw ConfigurationError(chain_dynamics::printable(text, 8000));
}

RunConfiguration readFile(const std::string& file) {
  LocatedMap top = LocatedValue::ofFile(file, &throwConfigurationError).map();
  top.expect({"schema", "name", "description", "plugin"});
  const LocatedValue schema = top.required("schema");
  if (schema.integer() != kSchema) {
    schema.fail(std::to_string(kSchema), "it was written for another version of this command");
  }
  RunConfiguration robot;
  robot.file = file;
  const LocatedValue name = top.required("name");
  robot.name = name.text();
  if (!isPlainName(robot.name)) {
    name.fail("a plain name: results are called after it", "leave out / and control characters");
  }
  robot.description = stripped(top.required("description").text());
  const LocatedValue plugin = top.required("plugin");
  robot.plugin = plugin.text();
  if (std::count(robot.plugin.begin(), robot.plugin.end(), '/') != 1) {
    plugin.fail("package/Class", "`ids robots --plugins` lists what is installed");
  }
  readAccelerations(top.optional("accelerations"), robot);
  robot.urdf = existingFile(top.optional("urdf"));
  robot.model = modelFile(top.optional("model"));
  robot.root = textOf(top.optional("root"));
  robot.tip = tipOf(top.optional("tip"));
  robot.gravity = gravityOf(top.optional("gravity"));
  const auto friction = top.optional("friction");
  robot.friction = friction ? friction->truth() : robot.friction;
  robot.topic = textOf(top.optional("topic"), robot.topic);
  robot.joints = namesOf(top.optional("joints"));
  robot.effort = textOf(top.optional("effort"), robot.effort,
                        {kTorque, kCurrent, kTorqueWithoutGravity, kAutomatic});
  robot.drive_gains = driveGainsOf(top.optional("drive_gains"));
  if (const auto parameters = top.optional("parameters")) {
    robot.parameters = readSolverParameters(parameters->map());
  }
  readTable(top.optional("table"), robot);
  readFitted(top, robot);
  robot.source = stripped(textOf(top.optional("source")));
  if (const auto simulation = top.optional("simulation")) {
    simulation->map();  // the simulator reads its contents
  }
  top.rejectOthers();
  return robot;
}

[[noreturn]] void refuseName(const std::string& name) {
  constexpr std::size_t kLongest = 60;
  const std::vector<std::string> known = robotNames();
  const std::string nearest = chain_dynamics::nearestName(name, known);
  const std::string shown = name.size() > kLongest ? name.substr(0, kLongest) + "..." : name;
  throw ConfigurationError(
      chain_dynamics::errorText("robot '" + shown + "'", "",
                                "one of " + joined(known) + ", or a file ending in .yaml or .urdf",
                                "", nearest.empty() ? "" : "did you mean " + nearest + "?"));
}

std::string namesIfAny() {
  try {
    return joined(robotNames());
  } catch (const PackageNotFoundError&) {
    return "(no workspace is sourced)";
  }
}

}  // namespace

std::vector<std::string> robotNames() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(fs::path(packageShare(kRobotsPackage)) / "robots", ignored)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

SolverParameters readSolverParameters(const LocatedMap& map) {
  const std::vector<std::string> keys = {"root",     "tip",   "gravity",
                                         "friction", "model", "robot_description"};
  SolverParameters found;
  for (const auto& [name, value] : map.leaves()) {
    if (std::find(keys.begin(), keys.end(), name) != keys.end()) {
      value.refuse("is a key of its own: put " + name + " at the top of the run configuration");
    }
    found.emplace(name, inverse_dynamics_solver::parameterOf(value));
  }
  return found;
}

RunConfiguration robotOfDescription(const std::string& urdf) {
  RunConfiguration robot;
  const std::string name = fs::path(urdf).filename();
  robot.name = name.substr(0, name.find('.'));
  robot.plugin = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";
  robot.file = robot.urdf = urdf;
  robot.effort = kAutomatic;
  return robot;
}

RunConfiguration readRunConfiguration(const std::string& name_or_file) {
  const fs::path path(name_or_file);
  if (path.extension() == ".urdf") return robotOfDescription(name_or_file);
  const bool is_file =
      path.extension() == ".yaml" || path.extension() == ".yml" || path.filename() != path;
  if (is_file) {
    const std::string file = resolvedPath(name_or_file, "");
    if (!isFile(file)) {
      throwConfigurationError(name_or_file +
                              ": no such file; expected a run configuration, or one of the names " +
                              namesIfAny());
    }
    return readFile(file);
  }
  const std::string file =
      fs::path(packageShare(kRobotsPackage)) / "robots" / (name_or_file + ".yaml");
  if (!isFile(file)) refuseName(name_or_file);
  return readFile(file);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
