// SPDX-License-Identifier: Apache-2.0

#include "model_file_joint.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "chain_dynamics/joint_frame.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

// ---------------------------------------------------------------------------------------------
// Geometry: the file's frame of a link is U, the chain's is E, whose z is the joint's axis

/// Sine and cosine of an angle; exact for angles in quarter turns.
struct Angle {
  double sine;
  double cosine;
};

/// The key `name` [rad] or `name_quarter_turns` (right angles, without the rounding of pi / 2).
Angle angle(LocatedMap& map, const std::string& name) {
  const auto quarter_turns = map.optional(name + "_quarter_turns");
  if (!quarter_turns) {
    const double value = map.required(name).number();
    return {std::sin(value), std::cos(value)};
  }
  if (const auto both = map.optional(name)) {
    both->fail("either this key or " + name + "_quarter_turns");
  }
  constexpr double kSine[] = {0, 1, 0, -1};
  const std::int64_t turns = quarter_turns->integer() & 3;  // modulo 4, negative ones too
  return {kSine[turns], kSine[(turns + 1) & 3]};
}

Transform<double> turnAboutX(const Angle& a) {
  Matrix3<double> R;
  R << 1, 0, 0, 0, a.cosine, -a.sine, 0, a.sine, a.cosine;
  return {R, Eigen::Vector3d::Zero()};
}

Transform<double> turnAboutZ(const Angle& a) {
  Matrix3<double> R;
  R << a.cosine, -a.sine, 0, a.sine, a.cosine, 0, 0, 0, 1;
  return {R, Eigen::Vector3d::Zero()};
}

Transform<double> shift(double x, double y, double z) {
  return {Matrix3<double>::Identity(), Eigen::Vector3d(x, y, z)};
}

/// Where a joint sits.
struct JointGeometry {
  Transform<double> placement = Transform<double>::identity();  // E in the previous link's U
  Transform<double> X_EU = Transform<double>::identity();       // differs from link to link
};

/// Modified (Craig): U_i = E_i, and U_(i-1) to U_i is RotX(alpha) TransX(a) RotZ(q + offset)
/// TransZ(d). Standard: U_(i-1) to U_i is RotZ(q + offset) TransZ(d) TransX(a) RotX(alpha): the
/// joint turns about z of U_(i-1), and E_i stands after the first half.
JointGeometry readDH(LocatedMap map, Geometry geometry) {
  map.expect({"a", "d"});
  const double a = map.required("a").number();
  const double d = map.required("d").number();
  const auto X_alpha_a = turnAboutX(angle(map, "alpha")) * shift(a, 0, 0);
  const auto X_offset_d = turnAboutZ(angle(map, "offset")) * shift(0, 0, d);
  map.rejectOthers();
  if (geometry == Geometry::kModifiedDH) {
    return {X_alpha_a * X_offset_d, Transform<double>::identity()};
  }
  return {X_offset_d, X_alpha_a};
}

/// As in a URDF: U_i in U_(i-1) at q = 0, and the joint's axis in U_i.
JointGeometry readPlacement(LocatedMap map) {
  map.expect({"xyz", "rpy", "axis"});
  const Transform<double> X = readPose(map);
  const LocatedValue axis = map.required("axis");
  map.rejectOthers();
  const Eigen::Vector3d direction = readVector(axis);
  if (direction.isZero(0)) {
    axis.fail("a direction", "the zero vector has none; for example [0, 0, 1]");
  }
  const Matrix3<double> R_UE = rotationFromZ(direction.stableNormalized());
  return {{X.R * R_UE, X.p}, {R_UE.transpose(), Eigen::Vector3d::Zero()}};
}

// ---------------------------------------------------------------------------------------------
// Links, limits, friction

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
    if (const auto value = map.optional(key)) limit = value->number();
  };
  if (type != JointType::kContinuous) {
    read("lower", limits.lower);
    read("upper", limits.upper);
  }
  read("velocity", limits.velocity);
  read("effort", limits.effort);
  read("acceleration", limits.acceleration);
  read("deceleration", limits.deceleration);
  read("jerk", limits.jerk);
  map.rejectOthers();
  return limits;
}

/// The error of a file of schema 1 that has a key or law of schema 2.
[[noreturn]] void refuseNewer(const LocatedValue& value, const std::string& expected) {
  value.fail(expected + " in schema 1", "write schema: 2 at the top of the file");
}

double readInRange(const LocatedValue& value, CoefficientRange range) {
  const double number = value.number();
  if (range == CoefficientRange::kNotNegative && number < 0) value.fail("a number >= 0");
  if (range == CoefficientRange::kPositive && number <= 0) value.fail("a number > 0");
  return number;
}

/// Whether the coefficient has a meaning: not where the one it is required with is zero.
template <class Law>
bool isUsed(LocatedMap& map, const Coefficient<Law>& coefficient) {
  if (coefficient.required_with == nullptr) return true;
  const auto other = map.optional(coefficient.required_with);
  return other && other->number() != 0;
}

/// A law with its coefficients by name.
template <class Law>
Law readLaw(LocatedMap& map) {
  std::vector<std::string> required;
  for (const Coefficient<Law>& coefficient : Law::coefficients()) {
    if (coefficient.required) required.emplace_back(coefficient.name);
  }
  map.expect(required);
  Law law;
  for (const Coefficient<Law>& coefficient : Law::coefficients()) {
    const auto value =
        coefficient.required ? map.required(coefficient.name) : map.optional(coefficient.name);
    if (value) {
      law.*coefficient.value = readInRange(
          *value, isUsed(map, coefficient) ? coefficient.range : CoefficientRange::kAny);
    } else if (coefficient.required_with != nullptr && map.optional(coefficient.required_with)) {
      map.value().refuse(std::string("the key ") + coefficient.name +
                         " is missing; it belongs to " + coefficient.required_with);
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
    entry.torque_deviation.push_back(readInRange(*deviation, CoefficientRange::kNotNegative));
  }
  if (seen) {
    LocatedMap ranges = seen->map();
    ranges.expect({"q", "qd", "qdd"});
    entry.seen.push_back({readInterval(ranges.required("q")), readInterval(ranges.required("qd")),
                          readInterval(ranges.required("qdd"))});
    ranges.rejectOthers();
  }
}

void readSpring(const LocatedValue& value, int schema, JointEntry& entry) {
  if (schema < 2) refuseNewer(value, "no such key");
  LocatedMap map = value.map();
  const auto has = [&map](const char* key) { return map.optional(key).has_value(); };
  const bool is_lever = has("lever_sin") || has("lever_cos");
  if (!is_lever || has("stiffness") || has("rest")) {
    map.expect({"stiffness", "rest"});
    entry.stiffness = map.required("stiffness").number();
    entry.rest = map.required("rest").number();
  }
  if (is_lever) {
    map.expect({"lever_sin", "lever_cos"});
    entry.lever_sin = map.required("lever_sin").number();
    entry.lever_cos = map.required("lever_cos").number();
  }
  map.rejectOthers();
}

/// The parameters of the link: one set of ten numbers, or for this row one set per link.
void readParameters(LocatedMap& map, const Conventions& conventions, std::size_t joints,
                    JointEntry& entry) {
  if (const auto row = map.optional("row")) {
    for (const LocatedValue& value : row->entries(joints)) {
      entry.row.push_back(link(value, conventions.parameters));
    }
    if (const auto both = map.optional("link")) both->fail("either this key or row");
    return;
  }
  const LocatedValue own = map.required("link");
  if (conventions.parameters_level == Level::kCurrent) {
    own.fail("a row of links, as parameters are in currents",
             "with one drive gain per joint, each row of torques has parameters of its own");
  }
  entry.own.push_back(link(own, conventions.parameters));
}

/// Where the joint is in a tree, and what it follows.
void readPlaceInTree(LocatedMap& map, JointEntry& entry) {
  if (const auto parent = map.optional("parent")) entry.parent = parent->text();
  const auto mimic = map.optional("mimic");
  if (!mimic) return;
  const std::vector<LocatedValue> all =
      mimic->isList() ? mimic->entries() : std::vector<LocatedValue>{*mimic};
  if (all.empty()) mimic->fail("at least one joint that it follows");
  for (const LocatedValue& one : all) {
    LocatedMap followed = one.map();
    entry.mimics.push_back({followed.required("joint").text(), 1});
    if (const auto factor = followed.optional("multiplier")) {
      entry.mimics.back().multiplier = factor->number();
    }
    if (const auto offset = followed.optional("offset")) entry.offset += offset->number();
    followed.rejectOthers();
  }
  for (const char* const key : {"limits", "drive_gain", "spring", "friction", "row",
                                "gravity_first_moment", "torque_deviation", "seen"}) {
    if (const auto value = map.optional(key)) {
      value->fail("no such key of a joint that mimics another one",
                  "state it of joint " + entry.mimics.front().joint);
    }
  }
}

JointEntry readJoint(const LocatedValue& value, const Conventions& conventions,
                     std::size_t joints) {
  JointEntry entry;
  entry.joint.name = value.map().required("name").text();
  const LocatedValue named = value.named("joint " + entry.joint.name);
  entry.where = named.where();
  LocatedMap map = named.map();
  if (const auto motor = conventions.tree ? map.optional("motor") : std::nullopt) {
    entry.is_motor = motor->truth();
  }
  const bool placed = conventions.geometry == Geometry::kPlacements;
  std::vector<std::string> keys = {"name", "type"};
  if (!entry.is_motor) keys.emplace_back(placed ? "placement" : "dh");
  map.expect(keys);
  map.required("name");
  entry.joint.type = std::vector<JointType>{
      JointType::kRevolute, JointType::kContinuous,
      JointType::kPrismatic}[map.required("type").choice({"revolute", "continuous", "prismatic"})];

  JointGeometry geometry;
  if (entry.is_motor) {
    // of no place
  } else if (placed) {
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
  if (const auto spring = map.optional("spring")) readSpring(*spring, conventions.schema, entry);
  if (conventions.tree && !entry.is_motor) readPlaceInTree(map, entry);
  if (conventions.gains && entry.mimics.empty()) {
    entry.drive_gain.push_back(map.required("drive_gain").number());
  } else if (const auto gain = map.optional("drive_gain")) {
    gain->fail("no such key without levels",
               "say in levels whether parameters and friction are torques or currents");
  }
  if (const auto friction = map.optional("friction")) {
    entry.friction.push_back(readFriction(friction->map(), conventions.schema));
    if (const auto coupling = map.optional("coupling")) entry.coupling = coupling->numbers(joints);
  }
  readExperience(map, conventions.schema, entry);
  if (!entry.is_motor) readParameters(map, conventions, joints, entry);
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

Eigen::Vector3d readVector(const LocatedValue& value) {
  return Eigen::Vector3d(value.numbers(3).data());
}

Transform<double> readPose(LocatedMap& map) {
  map.expect({"xyz", "rpy"});
  const Eigen::Vector3d xyz = readVector(map.required("xyz"));
  return {rotationFromRollPitchYaw(readVector(map.required("rpy"))), xyz};
}

std::vector<JointEntry> coordinatesOf(const std::vector<JointEntry>& entries) {
  std::vector<JointEntry> coordinates;
  for (const JointEntry& entry : entries) {
    if (entry.mimics.empty()) coordinates.push_back(entry);
  }
  return coordinates;
}

std::vector<JointEntry> readJoints(const LocatedValue& value, const Conventions& conventions) {
  const std::vector<LocatedValue> list = value.entries();
  const auto mimics = [&](const LocatedValue& joint) {
    return conventions.tree && joint.map().optional("mimic").has_value();
  };
  const auto count =
      list.size() - static_cast<std::size_t>(std::count_if(list.begin(), list.end(), mimics));
  if (count == 0)
    value.fail("at least one joint" + std::string(conventions.tree ? " that mimics no other" : ""));
  std::vector<JointEntry> all;
  all.reserve(list.size());
  for (const LocatedValue& joint : list) all.push_back(readJoint(joint, conventions, count));
  const std::vector<JointEntry> entries = coordinatesOf(all);
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
  return all;
}

std::vector<FrictionPlace> readFrictionPlaces(const LocatedValue& value,
                                              const Conventions& conventions,
                                              const std::vector<JointEntry>& coordinates) {
  if (conventions.schema < 2) refuseNewer(value, "no such key");
  if (coordinates.front().friction.empty()) {
    value.fail("friction of each joint beside it",
               "where a joint has no friction, write {law: none}");
  }
  if (conventions.friction_level == Level::kCurrent) {
    value.fail("no such key, as friction is in currents", "state friction as torque");
  }
  std::vector<FrictionPlace> places;
  for (const LocatedValue& one : value.entries()) {
    const std::string name = one.map().required("name").text();
    LocatedMap map = one.named(name).map();
    map.expect({"name", "velocity", "friction"});
    map.required("name");
    FrictionPlace& place = places.emplace_back();
    place.where = one.named(name).where();
    place.name = name;
    LocatedMap velocity = map.required("velocity").map();
    for (const JointEntry& coordinate : coordinates) {
      const auto factor = velocity.optional(coordinate.joint.name);
      place.coupling.push_back(factor ? factor->number() : 0.0);
    }
    velocity.rejectOthers();
    place.law = readFriction(map.required("friction").map(), conventions.schema);
    map.rejectOthers();
  }
  return places;
}

}  // namespace v2
}  // namespace chain_dynamics
