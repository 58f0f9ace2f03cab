// SPDX-License-Identifier: Apache-2.0

// Model files that are refused, with place and remedy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>

#include "model_file_texts.hpp"

namespace chain_dynamics::model_file_error_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(ModelFileError, FileThatCannotBeRead) {
  EXPECT_THAT(errorOf([] { modelFromFile("/no/such/model.yaml"); }),
              AllOf(HasSubstr("/no/such/model.yaml"),
                    HasSubstr("can't be read (No such file or directory)")));
  EXPECT_THAT(errorOf([] { modelFromFile(kRobots); }), HasSubstr("can't be read (Is a directory)"));
}

TEST(ModelFileError, NamesWithControlCharacters) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "- name: cart", "- name: \"cart\\e[31m\"")),
              HasSubstr("expected UTF-8 text without control characters, got 'cart\\x1b[31m'"));
  EXPECT_THAT(
      fileError(replaced(file("modified_dh", joint("one", withLink("dh: {a: 0, alpha: 0, d: "
                                                                   "0, offset: 0}\n"))),
                         "name: arm", "name: \"a\\rm\"")),
      HasSubstr("name: expected UTF-8 text without control characters, got 'a\\rm'"));
}

/// A waist with two arms, of which the second one follows the first.
std::string treeFile() {
  const auto one = [](const std::string& name, const std::string& more) {
    return "  - name: " + name +
           "\n    type: revolute\n    placement: {xyz: [0, 0, 1], rpy: [0, 0, 0], axis: [0, 1, "
           "0]}\n"
           "    link: [1, 0, 0, 0, 0.1, 0, 0, 0.1, 0, 0.1]\n" +
           more;
  };
  return "schema: 2\nname: torso\nsource: x\nvalidity: x\nunits: SI\ngeometry: placements\n"
         "gravity: [0, 0, -9.81]\nparameters: about_center_of_mass\ntips:\n"
         "  - {name: left_tool, joint: left, xyz: [0, 0, 1], rpy: [0, 0, 0]}\n"
         "  - {name: right_tool, joint: right, xyz: [0, 0, 1], rpy: [0, 0, 0]}\njoints:\n" +
         one("waist", "") + one("left", "    parent: waist\n") +
         one("right", "    parent: waist\n    mimic: {joint: left, multiplier: -1}\n");
}

TEST(ModelFileError, TreesThatAreNone) {
  EXPECT_EQ(fileError(treeFile()), "no error");
  const auto error = [](const std::string& from, const std::string& to) {
    return fileError(replaced(treeFile(), from, to));
  };
  EXPECT_THAT(error("parent: waist", "parent: wiast"),
              AllOf(HasSubstr("joint left: parent: expected a joint of the file, got 'wiast'"),
                    HasSubstr("did you mean 'waist'?")));
  EXPECT_THAT(error("parent: waist", "parent: left"),
              HasSubstr("joint left: parent: expected a joint that isn't below this one"));
  EXPECT_THAT(error("{joint: left, m", "{joint: elbow, m"),
              HasSubstr("joint right: mimic.joint: expected a joint of the file, got 'elbow'"));
  EXPECT_THAT(error("{joint: left, m", "{joint: right, m"),
              HasSubstr("joint right: mimic: expected a joint that doesn't follow this one"));
  EXPECT_THAT(error("joint: right, xyz", "joint: rihgt, xyz"),
              AllOf(HasSubstr("arm.yaml:11"), HasSubstr("did you mean 'right'?")));
  EXPECT_THAT(error("joint: right, xyz", "joint: left, xyz"),
              HasSubstr("joint right: tips: expected one beyond this joint, got none"));
  EXPECT_THAT(error("- name: right\n", "- name: left\n"), HasSubstr("expected one that no other"));
  EXPECT_THAT(error("multiplier: -1}", "multiplier: -1}\n    limits: {lower: 1}"),
              HasSubstr("limits: expected no such key of a joint that mimics another one"));
  EXPECT_THAT(error("multiplier: -1}", "multiplier: -1}\n    gravity_first_moment: [0, 0, 1]"),
              HasSubstr("gravity_first_moment: expected no such key of a joint that mimics"));
  EXPECT_THAT(error("schema: 2", "schema: 1"), HasSubstr("tips: expected no such key in schema 1"));
  EXPECT_THAT(error("tips:\n", "tip: {xyz: [0, 0, 1], rpy: [0, 0, 0]}\ntips:\n"),
              HasSubstr("tip: unknown key"));
  EXPECT_THAT(fileError(documentedFile() + "    parent: cart\n"), HasSubstr("arm.yaml"));
}

// YAML cut off between two lines is YAML still: what is missing must be noticed, or was optional.
TEST(ModelFileError, TruncatedFileIsNeverReadAsAnotherRobot) {
  const std::string whole = documentedFile();
  const std::size_t optional_rest = whole.find("  - name: hinge");
  for (std::size_t size = 0; size < optional_rest; ++size) {
    const std::string error = fileError(whole.substr(0, size));
    // the first joint is a robot, too, once it is complete
    if (size < whole.find("link: [3") + 30) {
      EXPECT_THAT(error, StartsWith("arm.yaml")) << whole.substr(0, size);
    }
  }
}

TEST(ModelFileError, UnknownKeysNameLineAndKnownKeys) {
  EXPECT_THAT(fileError(documentedFile() + "mass: 3\n"),
              AllOf(HasSubstr("mass: unknown key; "), HasSubstr("known here: schema, ")));
  EXPECT_EQ(
      fileError(file("modified_dh",
                     joint("one", withLink("dh: {a: 0, alpha: 0, d: 0, offset: 0, e: 1}\n")))),
      "arm.yaml:12: joint one: dh.e: unknown key; known here: "
      "a, d, alpha_quarter_turns, alpha, offset_quarter_turns, offset");
  EXPECT_THAT(fileError(replaced(documentedFile(), "fo: 0", "fo: 0, alpha: 1")),
              HasSubstr("joint cart: friction.alpha: unknown key"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "    rotor_inertia", "    rotor_inertai")),
              HasSubstr("joint hinge: rotor_inertai: unknown key"));
}

TEST(ModelFileError, MissingKeysNameLineAndKey) {
  for (const std::string key : {"schema", "name", "source", "validity", "units", "geometry",
                                "gravity", "parameters", "joints"}) {
    YAML::Node node = YAML::Load(documentedFile());
    node.remove(key);
    EXPECT_THAT(fileError(YAML::Dump(node)),
                HasSubstr("arm.yaml:1: the key " + key + " is missing; keys: "));
  }
  for (const std::string key : {"name", "type", "placement", "link"}) {
    YAML::Node node = YAML::Load(documentedFile());
    node["joints"][1].remove(key);
    EXPECT_THAT(fileError(YAML::Dump(node)),
                AllOf(HasSubstr("joint"), HasSubstr("the key " + key + " is missing")));
  }
  YAML::Node node = YAML::Load(documentedFile());
  node["joints"][1].remove("type");
  node["joints"][1].remove("placement");
  EXPECT_THAT(fileError(YAML::Dump(node)), HasSubstr("the keys type, placement are missing"));
  EXPECT_THAT(fileError(replaced(documentedFile(), ", fo: 0", "")),
              HasSubstr("joint cart: friction: the key fo is missing"));
  EXPECT_THAT(fileError(replaced(documentedFile(), ", axis: [1, 0, 0]", "")),
              HasSubstr("joint cart: placement: the key axis is missing"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "  tolerance: 1e-12\n", "")),
              HasSubstr("checks: the key tolerance is missing"));
}

TEST(ModelFileError, WrongLength) {
  EXPECT_EQ(fileError(file("modified_dh", joint("one", dh("0", "0", "0", "0") + "  link: [1, 2]"))),
            "arm.yaml:13: joint one: link: expected 10 numbers, got a list of 2");
  EXPECT_THAT(fileError(replaced(documentedFile(), "[0, 0, -9.81]", "[0, -9.81]")),
              HasSubstr("arm.yaml:8: gravity: expected 3 numbers, got a list of 2"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "[0, 0, -9.81]", "[0, 0, 0, -9.81]")),
              HasSubstr("arm.yaml:8: gravity: expected 3 numbers, got a list of 4"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "q: [0.2, 0]", "q: [0.2]")),
              HasSubstr("checks.states[0].q: expected 2 numbers, got a list of 1"));
  EXPECT_THAT(fileError(replaced(rowsFile(), std::string("[") + kLink + ", ", "[")),
              HasSubstr("joint one: row: expected a list of 2, got a list of 1"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "joints:", "joints: []\nold:")),
              HasSubstr("joints: expected at least one joint, got a list of 0"));
}

TEST(ModelFileError, WrongTypesAndWords) {
  for (const std::string other : {"0", "3", "-1"}) {
    EXPECT_THAT(fileError(replaced(documentedFile(), "schema: 1", "schema: " + other)),
                HasSubstr("arm.yaml:1: schema: expected 1 or 2, got '" + other + "'"));
  }
  EXPECT_THAT(fileError(replaced(documentedFile(), "schema: 1", "schema: 1.5")),
              HasSubstr("schema: expected an integer, got '1.5'"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "units: SI", "units: imperial")),
              HasSubstr("units: expected one of SI, got 'imperial'"));
  EXPECT_THAT(
      fileError(replaced(documentedFile(), "placements ", "screws ")),
      HasSubstr("geometry: expected one of modified_dh, standard_dh, placements, got 'scr"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "type: continuous", "type: planar")),
              HasSubstr("joint hinge: type: expected one of revolute, continuous, prismatic"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "law: none", "law: stribeck")),
              AllOf(HasSubstr("joint hinge: friction.law: expected one of none, "),
                    HasSubstr("got 'stribeck'")));
  EXPECT_THAT(fileError(replaced(smoothFile("fv: 1, fc: 1, width: 1"), "smooth_", "smoth_")),
              HasSubstr("got 'smoth_coulomb'; did you mean smooth_coulomb?"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "source: worked by hand", "source: [a]")),
              HasSubstr("source: expected a text, got a list of 1"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "source: worked by hand", "source: ")),
              HasSubstr("source: expected a value, got nothing"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "[0, 1, 0]}", "[0, 0, 0]}")),
              HasSubstr("joint hinge: placement.axis: expected a direction"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "friction: {law: none}", "friction: none")),
              HasSubstr("joint hinge: friction: expected keys with values, got 'none'"));
}

TEST(ModelFileError, WhatOneJointHasAllMustHave) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "    friction: {law: none}\n", "")),
              AllOf(HasSubstr("joint hinge: friction: expected this key, as in the first joint"),
                    HasSubstr("{law: none}")));
  EXPECT_THAT(
      fileError(replaced(documentedFile(), "    friction: {law: none}\n",
                         "    friction: {law: none}\n    gravity_first_moment: [1, 2, 3]\n")),
      HasSubstr("joint hinge: gravity_first_moment: expected no such key"));
  EXPECT_THAT(fileError(replaced(rowsFile(), "  drive_gain: 5\n", "")),
              HasSubstr("joint two: the key drive_gain is missing"));
}

TEST(ModelFileError, KeysThatExcludeEachOther) {
  EXPECT_THAT(fileError(rowsFile() + "  link: " + kLink + "\n"),
              HasSubstr("joint two: link: expected either this key or row"));
  EXPECT_THAT(fileError(rowsFile() + "  gravity_first_moment: [1, 2, 3]\n"),
              HasSubstr("gravity_first_moment"));
  EXPECT_THAT(fileError(file("modified_dh",
                             joint("one", withLink("dh: {a: 0, alpha: 0, alpha_quarter_turns: 0, "
                                                   "d: 0, offset: 0}\n")))),
              HasSubstr("alpha: expected either this key or alpha_quarter_turns"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "    rotor_inertia",
                                 "    drive_gain: 3\n    rotor_inertia")),
              HasSubstr("joint hinge: drive_gain: expected no such key without levels"));
  EXPECT_THAT(fileError(file("modified_dh",
                             joint("one", withLink(dh("0", "0", "0", "0") + "  drive_gain: 3\n")),
                             "levels: {parameters: current, friction: torque}\n")),
              HasSubstr("joint one: link: expected a row of links, as parameters are in currents"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "    rotor_inertia",
                                 "    limits: {lower: 1}\n    rotor_inertia")),
              HasSubstr("joint hinge: limits.lower: unknown key"));
}

TEST(ModelFileError, FiguresThatFrictionCantHave) {
  EXPECT_EQ(fileError(smoothFile("fv: -1, fc: 1, width: 1")),
            "arm.yaml:13: joint one: friction.fv: expected a number >= 0, got '-1'");
  for (const std::string figure : {"fc: -1, fv: 1, width: 1", "fl: -0.1, fv: 1, fc: 1, width: 1",
                                   "fs: -2, fv: 1, fc: 1, width: 1, vs: 1"}) {
    EXPECT_THAT(fileError(smoothFile(figure)),
                HasSubstr("friction." + figure.substr(0, 2) + ": expected a number >= 0, got '-"));
  }
  for (const std::string zero : {"0", "-0.1"}) {
    EXPECT_THAT(fileError(smoothFile("fv: 1, fc: 1, width: " + zero)),
                HasSubstr("friction.width: expected a number > 0, got '" + zero + "'"));
    EXPECT_THAT(fileError(smoothFile("fv: 1, fc: 1, width: 1, fs: 1, vs: " + zero)),
                HasSubstr("friction.vs: expected a number > 0, got '" + zero + "'"));
  }
  EXPECT_THAT(fileError(smoothFile("fv: 1, fc: 1")),
              HasSubstr("joint one: friction: the key width is missing"));
  EXPECT_THAT(fileError(smoothFile("fv: 1, fc: 1, width: 1, fs: 1")),
              HasSubstr("joint one: friction: the key vs is missing; it belongs to fs"));
  EXPECT_THAT(fileError(smoothFile("fv: 1, fc: 1, width: 1, alpha: 1")),
              HasSubstr("friction.alpha: unknown key"));
}

TEST(ModelFileError, WhatSchemaOneDoesntHaveNamesTheRemedy) {
  const auto one = [](const std::string& text) { return replaced(text, "schema: 2", "schema: 1"); };
  const std::string figures = "fv: 1, fc: 1, width: 1";
  EXPECT_EQ(fileError(one(smoothFile(figures))),
            "arm.yaml:13: joint one: friction.law: expected another law in schema 1, got "
            "'smooth_coulomb'; write schema: 2 at the top of the file");
  const std::string plain = file("modified_dh", joint("one", withLink(dh("0", "0", "0", "0"))));
  for (const std::string key : {"torque_deviation: 1", "seen: {q: [0, 1], qd: [0, 1], qdd: [0, 1]}",
                                "spring: {stiffness: 1, rest: 0}"}) {
    EXPECT_THAT(fileError(plain + "  " + key + "\n"),
                AllOf(StartsWith("arm.yaml:14: joint one: " + key.substr(0, key.find(':')) +
                                 ": expected no such key in schema 1, got"),
                      HasSubstr("write schema: 2 at the top of the file")));
  }
}

TEST(ModelFileError, ExperienceThatCantBe) {
  const auto with = [](const std::string& line) {
    return fileError(smoothFile("fv: 1, fc: 1, width: 1", "  " + line + "\n"));
  };
  EXPECT_THAT(with("torque_deviation: -1"),
              HasSubstr("joint one: torque_deviation: expected a number >= 0, got '-1'"));
  EXPECT_THAT(with("seen: {q: [0, 1], qd: [0, 1]}"),
              HasSubstr("joint one: seen: the key qdd is missing"));
  EXPECT_THAT(with("seen: {q: [2, 1], qd: [0, 1], qdd: [0, 1]}"),
              HasSubstr("joint one: seen.q: expected the least number first"));
  EXPECT_THAT(with("seen: {q: [1], qd: [0, 1], qdd: [0, 1]}"),
              HasSubstr("joint one: seen.q: expected 2 numbers"));
  const std::string two =
      replaced(replaced(documentedFile(), "schema: 1", "schema: 2"), "    rotor_inertia",
               "    torque_deviation: 1\n    rotor_inertia");
  EXPECT_THAT(fileError(two),
              HasSubstr("joint hinge: torque_deviation: expected no such key, as in "
                        "the first joint, got one"));
}

TEST(ModelFileError, WhatCannotBeARobotNamesFileAndJoint) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "link: [2,", "link: [-2,")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("joint hinge"), HasSubstr("mass")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "name: hinge", "name: cart")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("'cart' twice")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "lower: -2", "lower: 5")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("joint cart: position limits")));
  EXPECT_THAT(fileError(replaced(rowsFile(), "drive_gain: 5", "drive_gain: 0")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("drive gain of joint two")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "tolerance: 1e-12", "tolerance: 0")),
              HasSubstr("checks.tolerance: expected a number > 0"));
}

}  // namespace chain_dynamics::model_file_error_test
