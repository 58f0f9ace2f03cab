// SPDX-License-Identifier: Apache-2.0

/// @file
/// Model files of small robots, put together by hand, for tests.
///
///     model(file("modified_dh", joint("one", withLink(dh("0.3", "0.4", "0", "0")))))

#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "chain_dynamics/model_file.hpp"
#include "reference.hpp"

namespace chain_dynamics {

inline const std::string kRobots = CHAIN_DYNAMICS_ROBOTS_DIR;

inline std::string replaced(std::string text, const std::string& old_part,
                            const std::string& new_part) {
  const std::size_t at = text.find(old_part);
  EXPECT_NE(at, std::string::npos) << "no '" << old_part << "' in:\n" << text;
  return at == std::string::npos ? text : text.replace(at, old_part.size(), new_part);
}

/// The file that docs/model_file.md shows.
inline std::string documentedFile() {
  const std::string page = textOf(CHAIN_DYNAMICS_DOCS_DIR "/model_file.md");
  const std::string fence = "```yaml\n";
  const std::size_t begin = page.find(fence) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

/// A model of one or more joints in schema 1, without check rows.
inline std::string file(const std::string& geometry, const std::string& joints,
                        const std::string& more = "") {
  return "schema: 1\nname: arm\nsource: made up\nvalidity: tests\nunits: SI\ngeometry: " +
         geometry + "\nparameters: about_origin\ngravity: [0, 0, -9.81]\n" + more + "joints:\n" +
         joints;
}

inline const char* const kLink = "[2, 0.2, 0.4, 0.6, 0.5, -0.03, -0.04, 0.6, -0.05, 0.7]";

inline std::string joint(const std::string& name, const std::string& content,
                         const std::string& type = "revolute") {
  return "- name: " + name + "\n  type: " + type + "\n  " + content + "\n";
}

inline std::string dh(const std::string& a, const std::string& alpha, const std::string& d,
                      const std::string& offset) {
  return "dh: {a: " + a + ", alpha: " + alpha + ", d: " + d + ", offset: " + offset + "}\n";
}

inline std::string withLink(const std::string& content) { return content + "  link: " + kLink; }

inline Model model(const std::string& text) { return modelFromYaml(text, "arm.yaml"); }

inline std::string fileError(const std::string& text) {
  return errorOf([&] { modelFromYaml(text, "arm.yaml"); });
}

inline Eigen::VectorXd someTorques(const Model& robot) {
  const Eigen::Index n = robot.chain.jointCount();
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(n, 0.3, 1.1);
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(n, -1.2, 2.0);
  const Eigen::VectorXd qdd = Eigen::VectorXd::LinSpaced(n, 3.0, -2.0);
  Eigen::VectorXd tau(n);
  torques(robot, q, qd, qdd, tau);
  return tau;
}

/// One joint in schema 2, with this law; `more` are lines of the joint.
inline std::string smoothFile(const std::string& figures, const std::string& more = "") {
  const std::string law = "  friction: {law: smooth_coulomb, " + figures + "}\n";
  return replaced(file("modified_dh", joint("one", withLink(dh("0", "0", "0", "0") + law + more))),
                  "schema: 1", "schema: 2");
}

/// Two joints identified in currents, each with a row of its own.
inline std::string rowsFile(
    const std::string& levels = "{parameters: current, friction: current}") {
  const auto row = [](const std::string& gain, const std::string& first,
                      const std::string& second) {
    return dh("0.1", "0.2", "0.3", "0.4") + "  drive_gain: " + gain +
           "\n  friction: {law: viscous_coulomb_offset, fv: 2, fc: 0, fo: 1}\n  row: [" + first +
           ", " + second + "]";
  };
  const std::string other = "[1, 0.3, 0.2, 0.1, 0.3, 0, 0, 0.3, 0, 0.3]";
  return file("standard_dh",
              joint("one", row("10", kLink, other)) + joint("two", row("5", other, kLink)),
              "levels: " + levels + "\n");
}

}  // namespace chain_dynamics
