// SPDX-License-Identifier: Apache-2.0

#include "model_file_joint.hpp"

#include <utility>
#include <variant>

namespace chain_dynamics {
inline namespace v2 {
namespace {

LinkParameters link(const LocatedValue& value, Parameters parameters) {
  const std::vector<double> numbers = value.numbers(10);
  const auto given = LinkParameters::fromVector(Vector10<double>(numbers.data()));
  return parameters == Parameters::kAboutOrigin
             ? given
             : LinkParameters::fromCenterOfMass(given.mass, given.first_moment, given.inertia);
}

JointLimits readLimits(LocatedMap map, JointType type) {
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
  map.rejectOthers();
  return limits;
}

/// The error of a file of schema 1 that has a key or law of schema 2.
[[noreturn]] void refuseNewer(const LocatedValue& value, const std::string& expected) {
  value.fail(expected + " in schema 1", "write schema: 2 at the top of the file");
}

double readInRange(const LocatedValue& value, FigureRange range) {
  const double number = value.number();
  if (range == FigureRange::kNotNegative && number < 0) value.fail("a number >= 0");
  if (range == FigureRange::kPositive && number <= 0) value.fail("a number > 0");
  return number;
}

/// Whether the figure has a meaning: not where the one it is required with is zero.
template <class Law>
bool isUsed(LocatedMap& map, const Figure<Law>& figure) {
  if (figure.required_with == nullptr) return true;
  const auto other = map.optional(figure.required_with);
  return other && other->number() != 0;
}

/// A law with its figures by name.
template <class Law>
Law readLaw(LocatedMap& map) {
  Law law;
  for (const Figure<Law>& figure : Law::figures()) {
    const auto value = figure.required ? map.required(figure.name) : map.optional(figure.name);
    if (value) {
      law.*figure.value =
          readInRange(*value, isUsed(map, figure) ? figure.range : FigureRange::kAny);
    } else if (figure.required_with != nullptr && map.optional(figure.required_with)) {
      map.value().refuse(std::string("the key ") + figure.name + " is missing; it belongs to " +
                         figure.required_with);
    }
  }
  return law;
}

/// The k-th law of the variant.
template <class... Laws>
FrictionLaw readLaw(std::size_t k, const LocatedValue& name, int schema, LocatedMap& map,
                    const std::variant<Laws...>* /*all*/) {
  FrictionLaw result;
  const auto read = [&](auto law) {
    if (k-- != 0) return;
    if (decltype(law)::kSchema > schema) refuseNewer(name, "another law");
    result = readLaw<decltype(law)>(map);
  };
  (read(Laws()), ...);
  return result;
}

template <class... Laws>
std::vector<std::string> namesOf(const std::variant<Laws...>* /*all*/) {
  return {"none", Laws::kName...};
}

FrictionLaw readFriction(LocatedMap map, int schema) {
  constexpr const FrictionLaw* kAllLaws = nullptr;
  const LocatedValue name = map.required("law");
  const std::size_t law = name.choice(namesOf(kAllLaws));
  FrictionLaw result;
  if (law > 0) result = readLaw(law - 1, name, schema, map, kAllLaws);
  map.rejectOthers();
  return result;
}

Interval readInterval(const LocatedValue& value) {
  const std::vector<double> numbers = value.numbers(2);
  if (numbers[0] > numbers[1]) {
    value.refuse("expected the least number first, got the greatest first");
  }
  return {numbers[0], numbers[1]};
}

/// What the data of identification say about the joint.
void readExperience(LocatedMap& map, int schema, JointEntry& entry) {
  const auto deviation = map.optional("torque_deviation");
  const auto seen = map.optional("seen");
  for (const auto& value : {deviation, seen}) {
    if (value && schema < 2) refuseNewer(*value, "no such key");
  }
  if (deviation) {
    entry.torque_deviation.push_back(readInRange(*deviation, FigureRange::kNotNegative));
  }
  if (seen) {
    LocatedMap ranges = seen->map();
    entry.seen.push_back({readInterval(ranges.required("q")), readInterval(ranges.required("qd")),
                          readInterval(ranges.required("qdd"))});
    ranges.rejectOthers();
  }
}

/// The parameters of the link: one set of ten numbers, or for this row one set per link.
void readParameters(LocatedMap& map, const Conventions& conventions, std::size_t joints,
                    JointEntry& entry) {
  if (const auto row = map.optional("row")) {
    for (const LocatedValue& value : row->entries(joints)) {
      entry.row.push_back(link(value, conventions.parameters));
    }
    if (const auto both = map.optional("link")) {
      both->fail("either this key or row");
    }
    return;
  }
  const LocatedValue own = map.required("link");
  if (conventions.parameters_level == Level::kCurrent) {
    own.fail("a row of links, as parameters are in currents",
             "with one drive gain per joint, each row of torques has parameters of its own");
  }
  entry.own.push_back(link(own, conventions.parameters));
}

JointEntry readJoint(const LocatedValue& value, const Conventions& conventions,
                     std::size_t joints) {
  JointEntry entry;
  entry.joint.name = value.map().required("name").text();
  const LocatedValue named = value.named("joint " + entry.joint.name);
  entry.where = named.where();
  LocatedMap map = named.map();
  map.required("name");
  entry.joint.type = std::vector<JointType>{
      JointType::kRevolute, JointType::kContinuous,
      JointType::kPrismatic}[map.required("type").choice({"revolute", "continuous", "prismatic"})];

  JointGeometry geometry;
  if (conventions.geometry == Geometry::kPlacements) {
    geometry = readPlacement(map.required("placement").map());
  } else {
    geometry = readDH(map.required("dh").map(), conventions.geometry);
  }
  entry.joint.placement = geometry.placement;
  entry.X_EU = geometry.X_EU;
  if (const auto limits = map.optional("limits")) {
    entry.joint.limits = readLimits(limits->map(), entry.joint.type);
  }
  if (const auto rotor_inertia = map.optional("rotor_inertia")) {
    entry.joint.rotor_inertia = rotor_inertia->number();
  }
  if (conventions.gains) {
    entry.drive_gain.push_back(map.required("drive_gain").number());
  } else if (const auto gain = map.optional("drive_gain")) {
    gain->fail("no such key without levels",
               "say in levels whether parameters and friction are torques or currents");
  }
  if (const auto friction = map.optional("friction")) {
    entry.friction.push_back(readFriction(friction->map(), conventions.schema));
  }
  readExperience(map, conventions.schema, entry);
  readParameters(map, conventions, joints, entry);
  if (const auto first_moment = map.optional("gravity_first_moment")) {
    entry.gravity_first_moment.push_back(readVector(*first_moment));
  }
  map.rejectOthers();
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
          entry.where, key,
          expected ? "this key, as in the first joint" : "no such key, as in the first joint",
          has ? "one" : "none", remedy);
    }
  }
  return expected;
}

}  // namespace

std::vector<JointEntry> readJoints(const LocatedValue& value, const Conventions& conventions) {
  const std::vector<LocatedValue> list = value.entries();
  if (list.empty()) {
    value.fail("at least one joint");
  }
  std::vector<JointEntry> entries;
  for (const LocatedValue& joint : list) {
    entries.push_back(readJoint(joint, conventions, list.size()));
  }
  allOrNone(entries, &JointEntry::row, "row", "give every joint a row, or every joint a link");
  allOrNone(entries, &JointEntry::friction, "friction",
            "where a joint has no friction, write {law: none}");
  allOrNone(entries, &JointEntry::torque_deviation, "torque_deviation", "");
  allOrNone(entries, &JointEntry::seen, "seen", "");
  if (allOrNone(entries, &JointEntry::gravity_first_moment, "gravity_first_moment", "") &&
      !entries[0].row.empty()) {
    throw ModelError(entries[0].where, "gravity_first_moment", "no such key beside row", "one",
                     "gravity has the masses of link");
  }
  return entries;
}

}  // namespace v2
}  // namespace chain_dynamics
