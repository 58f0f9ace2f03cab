// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/model_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "joint_frame.hpp"
#include "yaml_value.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

constexpr int kSchema = 1;

enum class Geometry { kModifiedDH, kStandardDH, kPlacements };
enum class Parameters { kAboutOrigin, kAboutCenterOfMass };
enum class Level { kTorque, kCurrent };

/// What the head of a file says about its joints.
struct Conventions {
  Geometry geometry;
  Parameters parameters;
  bool gains = false;  // whether `levels` is there, and so every joint has a drive gain
  Level parameters_level = Level::kTorque;
  Level friction_level = Level::kTorque;
};

/// One joint of a file, with the link it moves. The file's link frame is U, the chain's is E.
struct JointEntry {
  std::string where;
  Joint joint;                                             // placement: E in the previous link's U
  Transform<double> X_EU = Transform<double>::identity();  // differs from link to link
  std::vector<LinkParameters> own;                         // in U: one set, or none
  std::vector<LinkParameters> row;                         // in U: n links, or none
  std::vector<Eigen::Vector3d> gravity_first_moment;       // in U: one, or none
  std::vector<FrictionLaw> friction;                       // one, or none
  std::vector<double> drive_gain;                          // one, or none
};

Eigen::Vector3d vector(const YamlValue& value) { return Eigen::Vector3d(value.numbers(3).data()); }

// ---------------------------------------------------------------------------------------------
// Geometry

/// Sine and cosine of an angle; exact for angles in quarter turns.
struct Angle {
  double sine;
  double cosine;
};

/// The key `name` [rad] or `name_quarter_turns` (right angles, without the rounding of pi / 2).
Angle angle(YamlMap& map, const std::string& name) {
  const auto quarter_turns = map.optional(name + "_quarter_turns");
  if (!quarter_turns) {
    const double value = map.required(name).number();
    return {std::sin(value), std::cos(value)};
  }
  if (const auto both = map.optional(name)) {
    throw both->error("either this key or " + name + "_quarter_turns");
  }
  constexpr double kSine[] = {0, 1, 0, -1};
  const int turns = quarter_turns->wholeNumber() & 3;  // modulo 4, negative ones too
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

/// Modified (Craig): U_i = E_i, and U_(i-1) to U_i is RotX(alpha) TransX(a) RotZ(q + offset)
/// TransZ(d). Standard: U_(i-1) to U_i is RotZ(q + offset) TransZ(d) TransX(a) RotX(alpha): the
/// joint turns about z of U_(i-1), and E_i stands after the first half.
void readDH(YamlMap map, Geometry geometry, JointEntry& entry) {
  const double a = map.required("a").number();
  const double d = map.required("d").number();
  const auto X_alpha_a = turnAboutX(angle(map, "alpha")) * shift(a, 0, 0);
  const auto X_offset_d = turnAboutZ(angle(map, "offset")) * shift(0, 0, d);
  map.rejectOtherKeys();
  if (geometry == Geometry::kModifiedDH) {
    entry.joint.placement = X_alpha_a * X_offset_d;
  } else {
    entry.joint.placement = X_offset_d;
    entry.X_EU = X_alpha_a;
  }
}

Transform<double> pose(YamlMap& map) {
  const Eigen::Vector3d xyz = vector(map.required("xyz"));
  return {rotationFromRollPitchYaw(vector(map.required("rpy"))), xyz};
}

/// As in a URDF: U_i in U_(i-1) at q = 0, and the joint's axis in U_i.
void readPlacement(YamlMap map, JointEntry& entry) {
  const Transform<double> X = pose(map);
  const YamlValue axis = map.required("axis");
  map.rejectOtherKeys();
  const Eigen::Vector3d direction = vector(axis);
  if (direction.isZero(0)) {
    throw axis.error("a direction", "the zero vector has none; for example [0, 0, 1]");
  }
  const Matrix3<double> R_UE = rotationFromZ(direction.stableNormalized());
  entry.joint.placement = {X.R * R_UE, X.p};
  entry.X_EU = {R_UE.transpose(), Eigen::Vector3d::Zero()};
}

// ---------------------------------------------------------------------------------------------
// One joint

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

/// Every law with its figures by name; a new one is a new word and one more branch.
FrictionLaw readFriction(YamlMap map) {
  const auto number = [&map](const std::string& key) { return map.required(key).number(); };
  const std::size_t law = map.required("law").choice(
      {"none", "viscous_coulomb_offset", "viscous_offset_sigmoid", "centered_sigmoid"});
  FrictionLaw result;
  if (law == 1) {
    result = ViscousCoulombOffset{number("fv"), number("fc"), number("fo")};
  } else if (law == 2) {
    result = ViscousOffsetSigmoid{number("fv"), number("fo"), number("fc"), number("alpha"),
                                  number("nu")};
  } else if (law == 3) {
    result = CenteredSigmoid{number("A"), number("alpha"), number("delta")};
  }
  map.rejectOtherKeys();
  return result;
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

  if (conventions.geometry == Geometry::kPlacements) {
    readPlacement(YamlMap(map.required("placement")), entry);
  } else {
    readDH(YamlMap(map.required("dh")), conventions.geometry, entry);
  }
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
    entry.friction.push_back(readFriction(YamlMap(*friction)));
  }
  readParameters(map, conventions, joints, entry);
  if (const auto first_moment = map.optional("gravity_first_moment")) {
    entry.gravity_first_moment.push_back(vector(*first_moment));
  }
  map.rejectOtherKeys();
  return entry;
}

// ---------------------------------------------------------------------------------------------
// All joints

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
  if (allOrNone(entries, &JointEntry::gravity_first_moment, "gravity_first_moment", "") &&
      !entries[0].row.empty()) {
    throw ModelError(entries[0].where, "joint " + entries[0].joint.name + ": gravity_first_moment",
                     "no such key beside row", "one", "gravity has the masses of link");
  }
  return entries;
}

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
  Transform<double> X_EU = Transform<double>::identity();  // of the link before
  for (const JointEntry& entry : entries) {
    joints.push_back(entry.joint);
    joints.back().placement = X_EU * entry.joint.placement;
    links.push_back(entry.own.empty() ? LinkParameters::zero() : inChain(entry, entry.own[0]));
    X_EU = entry.X_EU;
  }
  return {name, std::move(joints), std::move(links), gravity, X_EU * X_U_tip};
}

/// Everything beyond the chain, in torques.
void addIdentified(const std::vector<JointEntry>& entries, const Conventions& conventions,
                   Model& model) {
  model.drive_gains.resize(conventions.gains ? model.chain.jointCount() : 0);
  for (std::size_t j = 0; j < entries.size(); ++j) {
    const JointEntry& entry = entries[j];
    const double gain = conventions.gains ? entry.drive_gain[0] : 1.0;
    const auto factor = [gain](Level level) { return level == Level::kCurrent ? gain : 1.0; };
    if (conventions.gains) {
      model.drive_gains[static_cast<Eigen::Index>(j)] = gain;
    }
    for (const FrictionLaw& law : entry.friction) {
      model.friction.push_back(scaled(law, factor(conventions.friction_level)));
    }
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
}

Model makeModel(const std::string& file, const std::string& name,
                const std::vector<JointEntry>& entries, const Conventions& conventions,
                const Eigen::Vector3d& gravity, const Transform<double>& X_U_tip) {
  try {
    Model model(makeChain(name, entries, gravity, X_U_tip));
    addIdentified(entries, conventions, model);
    checkModel(model);
    return model;
  } catch (const ModelError& error) {
    throw ModelError(file + ": " + error.what());  // which joint, but not which line
  }
}

// ---------------------------------------------------------------------------------------------
// The file

void verifyState(const YamlValue& value, double tolerance, const Model& model) {
  const auto count = static_cast<std::size_t>(model.chain.jointCount());
  YamlMap map(value);
  const auto read = [&map, count](const std::string& key) {
    const std::vector<double> numbers = map.required(key).numbers(count);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
        numbers.data(), static_cast<Eigen::Index>(numbers.size())));
  };
  const Eigen::VectorXd q = read("q");
  const Eigen::VectorXd qd = read("qd");
  const Eigen::VectorXd qdd = read("qdd");
  const Eigen::VectorXd expected = read("torques");
  map.rejectOtherKeys();

  Eigen::VectorXd tau(q.size());
  Eigen::VectorXd f(q.size());
  torques(model, q, qd, qdd, tau);
  frictionVector(model, qd, f);
  tau += f;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    if (!(std::abs(tau[j] - expected[j]) <= tolerance)) {
      std::ostringstream difference;
      difference << "one that is " << tau[j] - expected[j] << " off";
      throw ModelError(value.where(),
                       value.what() + ": torque of joint " +
                           model.chain.joints()[static_cast<std::size_t>(j)].name,
                       "the model's torque", difference.str(),
                       "a figure of the model or of this row is wrong");
    }
  }
}

void verifyChecks(YamlMap map, const Model& model) {
  const YamlValue tolerance = map.required("tolerance");
  if (tolerance.number() <= 0) {
    throw tolerance.error("a number > 0 [N m]");
  }
  for (const YamlValue& state : map.required("states").list()) {
    verifyState(state, tolerance.number(), model);
  }
  map.rejectOtherKeys();
}

Conventions readConventions(YamlMap& file) {
  Conventions conventions{};
  file.required("units").choice({"SI"});
  conventions.geometry = static_cast<Geometry>(
      file.required("geometry").choice({"modified_dh", "standard_dh", "placements"}));
  conventions.parameters = static_cast<Parameters>(
      file.required("parameters").choice({"about_origin", "about_center_of_mass"}));
  if (const auto levels = file.optional("levels")) {
    YamlMap map(*levels);
    conventions.gains = true;
    conventions.parameters_level =
        static_cast<Level>(map.required("parameters").choice({"torque", "current"}));
    conventions.friction_level =
        static_cast<Level>(map.required("friction").choice({"torque", "current"}));
    map.rejectOtherKeys();
  }
  return conventions;
}

Model readModel(const YamlValue& document) {
  YamlMap file(document, false);
  const YamlValue schema = file.required("schema");
  if (schema.wholeNumber() != kSchema) {
    throw schema.error(std::to_string(kSchema), "this program reads no other schema");
  }
  const std::string name = file.required("name").text();
  const std::string source = file.required("source").text();
  const std::string validity = file.required("validity").text();
  const Conventions conventions = readConventions(file);
  const Eigen::Vector3d gravity = vector(file.required("gravity"));
  Transform<double> X_U_tip = Transform<double>::identity();
  if (const auto tip = file.optional("tip")) {
    YamlMap map(*tip);
    X_U_tip = pose(map);
    map.rejectOtherKeys();
  }
  const std::vector<JointEntry> entries = readJoints(file.required("joints"), conventions);
  const auto checks = file.optional("checks");
  file.rejectOtherKeys();

  Model model = makeModel(document.file(), name, entries, conventions, gravity, X_U_tip);
  model.source = source;
  model.validity = validity;
  if (checks) {
    verifyChecks(YamlMap(*checks), model);
  }
  return model;
}

}  // namespace

Model modelFromYaml(const std::string& text, const std::string& where) {
  return readModel(YamlValue::ofText(text, where));
}

Model modelFromFile(const std::string& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw ModelError(path, "model file", "a file that can be read", file ? "a directory" : "none",
                     "correct the path, or its permissions");
  }
  // a device may have no end
  std::string text(YamlValue::kLongestText + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return modelFromYaml(text, path);
}

}  // namespace v2
}  // namespace chain_dynamics
