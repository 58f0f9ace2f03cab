// SPDX-License-Identifier: Apache-2.0

/// @file
/// Model files: an identified robot in about a hundred lines of YAML [docs/model_file.md].
///
///     Model ur10 = modelFromFile("ur10_identified.yaml");
///     Model mine = modelFromYaml("schema: 1\nname: mine\n...", "mine.yaml");
///     const std::string text = modelFileText(mine);          // every digit
///
/// Files are read strictly: an unknown, missing or repeated key, a wrong length or type and a
/// number that isn't finite are errors that name file, line and key. Check rows, states with the
/// torques that belong to them, are computed on loading, so a misread file can't go unnoticed.

#pragma once

#include <string>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// The model of a file.
///
/// @throws ModelError  `file:line: key: expected ..., got ...; remedy`.
Model modelFromFile(const std::string& path);

/// The model of a text.
///
/// @param text   YAML, schema 1 or 2.
/// @param where  what messages call it, usually a file name.
/// @throws ModelError  `where:line: key: expected ..., got ...; remedy`.
Model modelFromYaml(const std::string& text, const std::string& where);

/// The text of the file that modelFromYaml() reads as this model, in schema 2 and torques.
///
/// Links are in the frames of model.chain or of its branches, whose z is the joint's axis. Check rows are
/// of states within `seen`, of any where that isn't known.
/// @throws ModelError  a model that checkModel() refuses, or with what no file states: parameters of
///     gravity beside rows, or with masses of their own, a coordinate of branches that is no joint.
std::string modelFileText(const Model& model);

}  // namespace v2
}  // namespace chain_dynamics
