// SPDX-License-Identifier: Apache-2.0
#include "quantities.hpp"

#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_tools {
namespace {

/// Type and meaning of an argument.
const std::map<std::string, std::pair<const char*, const char*>>& argumentTexts() {
  static const std::map<std::string, std::pair<const char*, const char*>> kTexts = {
      {"q", {"array_like, (n,) or (N, n)", "Positions, rad (prismatic m)."}},
      {"qd", {"array_like, (n,) or (N, n)", "Velocities, rad/s (prismatic m/s)."}},
      {"qdd", {"array_like, (n,) or (N, n)", "Accelerations, rad/s^2 (prismatic m/s^2)."}},
      {"tau", {"array_like, (n,) or (N, n)", "Torques, N m (prismatic N)."}},
      {"wrench",
       {"array_like, (6,) or (N, 6)",
        "Force [N] and torque [N m] about the tip's origin that the tip exerts."}},
      {"frame", {"{'root', 'tip'}, optional", "In whose axes the wrench is."}},
      {"tip", {"str, optional", "Which of tip_names; by default the first."}},
      {"link", {"str, optional", "A link or joint of the description; by default the tip."}},
      {"out",
       {"ndarray of float64, optional",
        "Takes the result; of any layout that shares no memory with an argument."}},
  };
  return kTexts;
}

}  // namespace

std::string documented(const ResultText& text, const std::vector<std::string>& arguments,
                       const std::string& example) {
  std::string doc = std::string(text.formula) + "\n\nParameters\n----------\n";
  for (const std::string& argument : arguments) {
    const auto& [type, meaning] = argumentTexts().at(argument);
    doc += (argument == "link" ? "frame" : argument) + " : " + type + "\n    " + meaning + "\n";
  }
  doc +=
      "\nReturns\n-------\nndarray, " + std::string(text.shape) + "\n\nExamples\n--------\n" +
      ">>> import numpy as np\n>>> from inverse_dynamics import FastModel, Solver, load_robot\n" +
      ">>> arm = " + example + "\n>>> q, qd, qdd = np.full((3, 100, 6), 0.5)\n";
  std::istringstream lines(text.example);  // the last is what Python prints
  for (std::string line; std::getline(lines, line);) {
    doc += (lines.eof() ? "" : ">>> ") + line + "\n";
  }
  return doc;
}

}  // namespace inverse_dynamics_tools
