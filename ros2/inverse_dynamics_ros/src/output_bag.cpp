// SPDX-License-Identifier: Apache-2.0

#include "output_bag.hpp"

#include <unistd.h>

#include <exception>
#include <filesystem>
#include <memory>
#include <rosbag2_storage/storage_options.hpp>
#include <string>
#include <system_error>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

UserError cannotWrite(const std::filesystem::path& target, const std::exception& error) {
  return {target.string(), "a place where a recording can be written",
          "an error (" + std::string(error.what()) + ")", "name another 'output_bag'"};
}

}  // namespace

void OutputBag::requireFree(const std::filesystem::path& target) {
  if (target.empty()) {
    throw UserError("parameter 'output_bag'", "the recording to write", "nothing", "set it");
  }
  if (std::filesystem::exists(std::filesystem::symlink_status(target))) {
    throw UserError(target.string(), "a name that is free", "something that exists",
                    "name another 'output_bag', or remove it");
  }
}

OutputBag::OutputBag(const std::filesystem::path& target)
    : target_(std::filesystem::absolute(target).lexically_normal()) {
  if (target_.filename().empty()) {
    target_ = target_.parent_path();  // of `result/`
  }
  requireFree(target_);
  const std::string name = target_.filename().string();
  work_ = target_.parent_path() / ("." + name + "." + std::to_string(::getpid()) + ".part");
  try {
    std::filesystem::create_directories(work_);
  } catch (const std::exception& error) {
    throw cannotWrite(target, error);
  }
}

OutputBag::OutputBag(const std::filesystem::path& target, const std::string& storage)
    : OutputBag(target) {  // so an error from here on removes what was made
  try {
    rosbag2_storage::StorageOptions options;
    options.uri = path().string();
    options.storage_id = storage;
    writer_ = std::make_unique<rosbag2_cpp::Writer>();
    writer_->open(options);
  } catch (const std::exception& error) {
    throw cannotWrite(target, error);
  }
}

OutputBag::~OutputBag() {
  writer_.reset();
  std::error_code ignored;
  std::filesystem::remove_all(work_, ignored);
}

void OutputBag::finish() {
  try {
    writer_.reset();  // writes the metadata
    requireFree(target_);
    std::filesystem::rename(path(), target_);
  } catch (const UserError&) {
    throw;
  } catch (const std::exception& error) {
    throw cannotWrite(target_, error);
  }
}

}  // namespace inverse_dynamics_ros
