// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <inverse_dynamics_evaluation/metrics.hpp>
#include <string>
#include <vector>

#include "evaluation.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::JointMetrics;

std::string formatted(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return std::isnan(number) ? "-" : text;
}

// Three decimals, or three significant digits of what is smaller.
std::string value(double number) {
  return formatted(std::abs(number) >= 0.1 || number == 0 ? "%.3f" : "%.3g", number);
}

double meanOf(const std::vector<JointMetrics>& errors, double JointMetrics::*field) {
  double sum = 0;
  for (const JointMetrics& joint : errors) sum += joint.*field;
  return sum / static_cast<double>(errors.size());
}

// To the left the joint and its unit, to the right numbers; empty ones at the end are left out.
std::string lineOf(std::size_t width, const std::string& joint, const std::string& unit,
                   const std::array<std::string, 6>& numbers) {
  constexpr std::size_t kUnit = 4, kNumber = 8;
  const auto blanks = [](std::size_t all, const std::string& text) {
    return std::string(all - std::min(all, text.size()), ' ');
  };
  std::string line = "  " + joint + blanks(width, joint) + "  " + unit + blanks(kUnit, unit);
  for (const std::string& number : numbers) line += " " + blanks(kNumber, number) + number;
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

std::string errorTable(const Evaluation& evaluation, const std::vector<std::string>& units) {
  const std::vector<JointMetrics>& errors = evaluation.errors;
  if (errors.empty()) return "  no efforts are recorded: there is nothing to compare with\n";
  const auto& kept = evaluation.table->kept;
  const auto of_kept = [&kept](double rmse) { return kept.all() ? "" : value(rmse); };
  std::size_t width = std::string("joint").size();
  for (const std::string& name : evaluation.joint_names) width = std::max(width, name.size());
  std::string text = lineOf(width, "joint", "unit",
                            {"MAE", "RMSE", "NRMSE", "bias", "R2", kept.all() ? "" : "RMSE*"});
  for (std::size_t j = 0; j < units.size(); ++j) {
    const JointMetrics& error = errors[j];
    text += lineOf(width, evaluation.joint_names[j], units[j],
                   {value(error.mae), value(error.rmse), formatted("%.2f %%", 100 * error.nrmse),
                    value(error.bias), formatted("%.4f", error.r2),
                    of_kept(evaluation.errors_of_kept[j].rmse)});
  }
  if (units.size() > 1 && std::count(units.begin(), units.end(), units[0]) ==
                              static_cast<std::ptrdiff_t>(units.size())) {
    text += lineOf(
        width, "mean", units[0],
        {value(meanOf(errors, &JointMetrics::mae)), value(meanOf(errors, &JointMetrics::rmse)), "",
         "", "", of_kept(meanOf(evaluation.errors_of_kept, &JointMetrics::rmse))});
  }
  if (kept.all()) return text;
  return text + "* over the " + std::to_string(kept.count()) + " valid samples of " +
         std::to_string(kept.size()) + "\n";
}

}  // namespace inverse_dynamics_ros
