// SPDX-License-Identifier: Apache-2.0

#include "contact_file.hpp"

#include <algorithm>
#include <chain_dynamics/located_yaml.hpp>
#include <cmath>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <vector>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using chain_dynamics::LocatedMap;
using chain_dynamics::LocatedValue;

double positive(const LocatedValue& value) {
  const double number = value.number();
  if (!(number > 0)) {
    value.fail("a number above 0", "give the file as `ids contact` has written it");
  }
  return number;
}

void readEstimator(LocatedMap& map, ContactFile& file) {
  file.gain = positive(map.required("gain"));
  if (const auto tracking = map.optional("tracking")) file.tracking = positive(*tracking);
  if (const auto measured = map.optional("measured_velocities")) {
    file.measured_velocities = measured->truth();
  }
  if (const auto band = map.optional("friction_band")) {
    for (const LocatedValue& entry : band->entries()) file.friction_band.push_back(entry.number());
  }
}

}  // namespace

ContactFile readContactFile(const std::string& path, const std::vector<std::string>& joint_names) {
  LocatedMap map =  // JSON is YAML, too
      LocatedValue::ofFile(path, [](const std::string& text) { throw UserError(text); }).map();
  const LocatedValue schema = map.required("schema");
  if (schema.integer() != 1) {
    schema.fail("1", "this release reads the files of `ids contact` of the same release");
  }
  ContactFile file;
  readEstimator(map, file);
  const auto n = static_cast<Eigen::Index>(joint_names.size());
  file.thresholds.setConstant(n, std::nan(""));
  file.noise = file.thresholds;
  const LocatedValue joints = map.required("joints");
  for (const LocatedValue& entry : joints.entries()) {
    LocatedMap joint = entry.map();
    const auto found =
        std::find(joint_names.begin(), joint_names.end(), joint.required("joint").text());
    if (found != joint_names.end()) {
      const auto j = static_cast<Eigen::Index>(found - joint_names.begin());
      file.thresholds[j] = positive(joint.required("torques"));
      file.noise[j] = positive(joint.required("noise"));
    }
  }
  if (!file.thresholds.allFinite()) {
    throw UserError(joints.where(),
                    "thresholds of " + inverse_dynamics_evaluation::listed(joint_names),
                    "those of another robot", "run `ids contact` with this one");
  }
  return file;
}

}  // namespace inverse_dynamics_ros
