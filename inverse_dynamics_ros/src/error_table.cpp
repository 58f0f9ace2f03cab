// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "evaluation.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::JointMetrics;
using Row = std::vector<std::string>;

constexpr std::size_t kTextColumns = 2;  // joint, unit: to the left

std::string formatted(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

// Three decimals, or three significant digits where that says nothing.
std::string figure(double value) {
  return formatted(std::abs(value) >= 0.1 || value == 0 ? "%.3f" : "%.3g", value);
}

std::string unlessNan(const char* format, double value) {
  return std::isnan(value) ? "-" : formatted(format, value);
}

// Characters as they are seen: of UTF-8, bytes that begin one.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
}

double meanOf(const std::vector<JointMetrics>& errors, double JointMetrics::*field) {
  double sum = 0;
  for (const JointMetrics& joint : errors) {
    sum += joint.*field;
  }
  return sum / static_cast<double>(errors.size());
}

Row rowOf(const std::string& joint, const std::string& unit, const JointMetrics& error) {
  return {joint,
          unit,
          figure(error.mae),
          figure(error.rmse),
          unlessNan("%.2f %%", 100 * error.nrmse),
          formatted(std::abs(error.bias) < 0.1 ? "%+.3g" : "%+.3f", error.bias),
          unlessNan("%.4f", error.r2)};
}

std::string lineOf(const Row& row, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const std::string cell = i < row.size() ? row[i] : "";
    const std::string space(widths[i] - width(cell), ' ');
    line += (i == 0 ? "  " : "   ") + (i < kTextColumns ? cell + space : space + cell);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// Heading, a rule, and the rows; an empty row stays empty.
std::string tableOf(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], width(row[i]));
    }
  }
  std::string rule = " ";
  for (const std::size_t column : widths) {
    for (std::size_t i = 0; i < column + 2 + (&column != &widths.back() ? 1 : 0); ++i) {
      rule += "─";
    }
  }
  std::string text = lineOf(rows.front(), widths) + rule + "\n";
  for (auto row = rows.begin() + 1; row != rows.end(); ++row) {
    text += lineOf(*row, widths);
  }
  return text;
}

}  // namespace

std::string errorTable(const Evaluation& evaluation, const std::vector<std::string>& units) {
  if (evaluation.errors.empty()) {
    return "  no efforts are recorded: there is nothing to compare with\n";
  }
  const auto& kept = evaluation.table->kept;
  const bool some_left_out = !kept.all();
  std::vector<Row> rows = {{"joint", "unit", "MAE", "RMSE", "NRMSE", "bias", "R²"}};
  for (std::size_t j = 0; j < units.size(); ++j) {
    rows.push_back(rowOf(evaluation.joint_names[j], units[j], evaluation.errors[j]));
  }
  if (std::set<std::string>(units.begin(), units.end()).size() == 1 && units.size() > 1) {
    rows.emplace_back();
    rows.push_back({"mean", units[0], figure(meanOf(evaluation.errors, &JointMetrics::mae)),
                    figure(meanOf(evaluation.errors, &JointMetrics::rmse)), "", "", ""});
  }
  std::string caption;
  if (some_left_out) {
    rows[0].emplace_back("RMSE*");
    for (std::size_t j = 0; j < units.size(); ++j) {
      rows[j + 1].push_back(figure(evaluation.errors_of_kept[j].rmse));
    }
    if (rows.back()[0] == "mean") {
      rows.back().push_back(figure(meanOf(evaluation.errors_of_kept, &JointMetrics::rmse)));
    }
    caption = "* over the " + std::to_string(kept.count()) + " valid samples of " +
              std::to_string(kept.size()) + "\n";
  }
  return tableOf(rows) + caption;
}

}  // namespace inverse_dynamics_ros
