// SPDX-License-Identifier: Apache-2.0

#include "contact_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

namespace fs = std::filesystem;
const std::vector<std::string> kJoints{"shoulder", "elbow"};

class ContactFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "contact_file_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& text) const {
    std::ofstream(folder_ / "contacts.json") << text;
    return folder_ / "contacts.json";
  }
  std::string refusalOf(const std::string& text) const {
    try {
      readContactFile(write(text), kJoints);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

// As `ids contact` writes them, without most keys.
const std::string kBegin = R"({
  "schema": 1,
  "bag": "recording: of \"today\"",
  "estimator": "MomentumObserver",
  "gain": 40.0,
)";
const std::string kEnd = R"(  "joints": [
    {
      "joint": "elbow",
      "unit": "N m",
      "torques": 2.5,
      "noise": 0.25,
      "scale": 1e-05
    },
    {
      "joint": "shoulder",
      "unit": "N m",
      "torques": 4,
      "noise": 0.5
    }
  ],
  "contacts": [],
  "notes": []
}
)";

TEST_F(ContactFileTest, JointsAreMatchedByName) {
  const ContactFile file = readContactFile(write(kBegin + kEnd), kJoints);
  EXPECT_EQ(file.gain, 40.0);
  EXPECT_FALSE(file.tracking);
  EXPECT_FALSE(file.measured_velocities);
  EXPECT_TRUE(file.friction_band.empty());
  EXPECT_EQ(file.thresholds, Eigen::Vector2d(4, 2.5));
  EXPECT_EQ(file.noise, Eigen::Vector2d(0.5, 0.25));
}

TEST_F(ContactFileTest, SaysWhatItsThresholdsBelongTo) {
  const ContactFile file = readContactFile(
      write(kBegin +
            R"("tracking": 90.0, "measured_velocities": true, "friction_band": [1.0, 2],)" + kEnd),
      kJoints);
  EXPECT_EQ(file.tracking, 90.0);
  EXPECT_TRUE(file.measured_velocities);
  EXPECT_EQ(file.friction_band, (std::vector<double>{1, 2}));
}

TEST_F(ContactFileTest, OthersAreRefused) {
  const std::string path = folder_ / "contacts.json";
  EXPECT_THROW(readContactFile(folder_ / "none.json", kJoints), UserError);
  EXPECT_NE(refusalOf("[").find(path), std::string::npos);
  EXPECT_NE(refusalOf(R"({"schema": 2, "gain": 40.0, "joints": []})")
                .find(":1: schema: expected 1, got "),
            std::string::npos);
  EXPECT_NE(refusalOf(R"({"schema": 1, "gain": 0, "joints": []})").find("a number above 0"),
            std::string::npos);
  EXPECT_EQ(
      refusalOf(R"({"schema": 1, "gain": 40.0,
"joints": [{"joint": "elbow", "torques": 1, "noise": 1}]})"),
      path +
          ":2: joints: expected thresholds of shoulder, elbow, got those of another robot; run "
          "`ids contact` with this one");
}

}  // namespace
}  // namespace inverse_dynamics_ros
