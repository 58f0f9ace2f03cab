// SPDX-License-Identifier: Apache-2.0

#include "model_file_joint.hpp"

#include <utility>
#include <variant>

namespace chain_dynamics {
inline namespace v2 {
namespace {

LinkParameters link(const YamlValue& value, Parameters parameters) {
  const std::vector<double> numbers = value.numbers(10);
  const auto given = LinkParameters::fromVector(Vector10<double>(numbers.data()));
  return parameters == Parameters::kAboutOrigin
             ? given
             : LinkParameters::fromCenterOfMass(given.mass, given.first_moment, given.inertia);
}

JointLimits readLimits(YamlMap map, JointType type) {
  JointLimits limits;
  const auto read = [&map](const std::string& key, double& limit) {
    if (const auto value = map.optional(key)) {
      limit = value->number();
    }
  };
  if (type != JointType::kContinuous) {
    read("lower", limits.lower);
    read("upper", limits.upper);
  }
  read("velocity", limits.velocity);
  read("effort", limits.effort);
  map.rejectOtherKeys();
  return limits;
}

/// An error where a file of schema 1 has what came with schema 2.
ModelError newer(const YamlValue& value, const std::string& expected) {
  return value.error(expected + " in schema 1", "write schema: 2 at the top of the file");
}

double readInRange(const YamlValue& value, FigureRange range) {
  const double number = value.number();
  if (range == FigureRange::kNotNegative && number < 0) throw value.error("a number >= 0");
  if (range == FigureRange::kPositive && number <= 0) throw value.error("a number > 0");
  return number;
}

/// Whether the figure has a meaning: not where the one it is required with is zero.
template <class Law>
bool isUsed(YamlMap& map, const Figure<Law>& figure) {
  if (figure.required_with == nullptr) return true;
  const auto other = map.optional(figure.required_with);
  return other && other->number() != 0;
}

/// A law with its figures by name.
template <class Law>
Law readLaw(YamlMap& map) {
  Law law;
  for (const Figure<Law>& figure : Law::figures()) {
    const auto value = figure.required ? map.required(figure.name) : map.optional(figure.name);
    if (value) {
      law.*figure.value =
          readInRange(*value, isUsed(map, figure) ? figure.range : FigureRange::kAny);
    } else if (figure.required_with != nullptr && map.optional(figure.required_with)) {
      throw ModelError(map.value().where(), map.value().what() + ": " + figure.name,
                       std::string("this key beside ") + figure.required_with, "none", "add it");
    }
  }
  return law;
}

/// The k-th law of the variant.
template <class... Laws>
FrictionLaw readLaw(std::size_t k, const YamlValue& name, int schema, YamlMap& map,
                    const std::variant<Laws...>* /*all*/) {
  FrictionLaw result;
  const auto read = [&](auto law) {
    if (k-- != 0) return;
    if (decltype(law)::kSchema > schema) throw newer(name, "another law");
    result = readLaw<decltype(law)>(map);
  };
  (read(Laws()), ...);
  return result;
}

template <class... Laws>
std::vector<std::string> namesOf(const std::variant<Laws...>* /*all*/) {
  return {"none", Laws::kName...};
}

FrictionLaw readFriction(YamlMap map, int schema) {
  constexpr const FrictionLaw* kAllLaws = nullptr;
  const YamlValue name = map.required("law");
  const std::size_t law = name.choice(namesOf(kAllLaws));
  FrictionLaw result;
  if (law > 0) result = readLaw(law - 1, name, schema, map, kAllLaws);
  map.rejectOtherKeys();
  return result;
}

Interval readInterval(const YamlValue& value) {
  const std::vector<double> numbers = value.numbers(2);
  if (numbers[0] > numbers[1]) {
    throw ModelError(value.where(), value.what(), "the least number first", "the greatest first",
                     "");
  }
  return {numbers[0], numbers[1]};
}

/// What the data of identification say about the joint.
void readExperience(YamlMap& map, int schema, JointEntry& entry) {
  const auto deviation = map.optional("torque_deviation");
  const auto seen = map.optional("seen");
  for (const auto& value : {deviation, seen}) {
    if (value && schema < 2) throw newer(*value, "no such key");
  }
  if (deviation) {
    entry.torque_deviation.push_back(readInRange(*deviation, FigureRange::kNotNegative));
  }
  if (seen) {
    YamlMap ranges(*seen);
    entry.seen.push_back({readInterval(ranges.required("q")), readInterval(ranges.required("qd")),
                          readInterval(ranges.required("qdd"))});
    ranges.rejectOtherKeys();
  }
}

/// The parameters of the link: one set of ten numbers, or for this row one set per link.
void readParameters(YamlMap& map, const Conventions& conventions, std::size_t joints,
                    JointEntry& entry) {
  if (const auto row = map.optional("row")) {
    for (const YamlValue& value : row->list(joints)) {
      entry.row.push_back(link(value, conventions.parameters));
    }
    if (const auto both = map.optional("link")) {
      throw both->error("either this key or row");
    }
    return;
  }
  const YamlValue own = map.required("link");
  if (conventions.parameters_level == Level::kCurrent) {
    throw own.error("a row of links, as parameters are in currents",
                    "with one drive gain per joint, each row of torques has parameters of its own");
  }
  entry.own.push_back(link(own, conventions.parameters));
}

JointEntry readJoint(const YamlValue& value, const Conventions& conventions, std::size_t joints) {
  JointEntry entry;
  entry.joint.name = YamlMap(value).required("name").text();
  entry.where = value.where();
  YamlMap map(value.named("joint " + entry.joint.name));
  map.required("name");
  entry.joint.type = std::vector<JointType>{
      JointType::kRevolute, JointType::kContinuous,
      JointType::kPrismatic}[map.required("type").choice({"revolute", "continuous", "prismatic"})];

  JointGeometry geometry;
  if (conventions.geometry == Geometry::kPlacements) {
    geometry = readPlacement(YamlMap(map.required("placement")));
  } else {
    geometry = readDH(YamlMap(map.required("dh")), conventions.geometry);
  }
  entry.joint.placement = geometry.placement;
  entry.X_EU = geometry.X_EU;
  if (const auto limits = map.optional("limits")) {
    entry.joint.limits = readLimits(YamlMap(*limits), entry.joint.type);
  }
  if (const auto rotor_inertia = map.optional("rotor_inertia")) {
    entry.joint.rotor_inertia = rotor_inertia->number();
  }
  if (conventions.gains) {
    entry.drive_gain.push_back(map.required("drive_gain").number());
  } else if (const auto gain = map.optional("drive_gain")) {
    throw gain->error("no such key without levels",
                      "say in levels whether parameters and friction are torques or currents");
  }
  if (const auto friction = map.optional("friction")) {
    entry.friction.push_back(readFriction(YamlMap(*friction), conventions.schema));
  }
  readExperience(map, conventions.schema, entry);
  readParameters(map, conventions, joints, entry);
  if (const auto first_moment = map.optional("gravity_first_moment")) {
    entry.gravity_first_moment.push_back(readVector(*first_moment));
  }
  map.rejectOtherKeys();
  return entry;
}

/// What one joint has, all must have: what isn't known of one joint isn't zero there.
template <typename Member>
bool allOrNone(const std::vector<JointEntry>& entries, Member member, const std::string& key,
               const std::string& remedy) {
  const bool expected = !(entries.front().*member).empty();
  for (const JointEntry& entry : entries) {
    const bool has = !(entry.*member).empty();
    if (has != expected) {
      throw ModelError(
          entry.where, "joint " + entry.joint.name + ": " + key,
          expected ? "this key, as in the first joint" : "no such key, as in the first joint",
          has ? "one" : "none", remedy);
    }
  }
  return expected;
}

}  // namespace

std::vector<JointEntry> readJoints(const YamlValue& value, const Conventions& conventions) {
  const std::vector<YamlValue> list = value.list();
  if (list.empty()) {
    throw value.error("at least one joint");
  }
  std::vector<JointEntry> entries;
  for (std::size_t j = 0; j < list.size(); ++j) {
    entries.push_back(
        readJoint(list[j].named("joint " + std::to_string(j + 1)), conventions, list.size()));
  }
  allOrNone(entries, &JointEntry::row, "row", "give every joint a row, or every joint a link");
  allOrNone(entries, &JointEntry::friction, "friction",
            "where a joint has no friction, write {law: none}");
  allOrNone(entries, &JointEntry::torque_deviation, "torque_deviation", "");
  allOrNone(entries, &JointEntry::seen, "seen", "");
  if (allOrNone(entries, &JointEntry::gravity_first_moment, "gravity_first_moment", "") &&
      !entries[0].row.empty()) {
    throw ModelError(entries[0].where, "joint " + entries[0].joint.name + ": gravity_first_moment",
                     "no such key beside row", "one", "gravity has the masses of link");
  }
  return entries;
}

}  // namespace v2
}  // namespace chain_dynamics
