// SPDX-License-Identifier: Apache-2.0
#include "generated_chain.hpp"

#include <array>
#include <cstdint>
#include <ostream>
#include <random>
#include <sstream>
#include <string>

namespace inverse_dynamics_benchmarks {
namespace {

class Writer {
 public:
  Writer(std::ostream& stream, std::uint32_t seed) : stream_(stream), engine_(seed) {}

  void link(int number) {
    const double mass = 3.0 + numberBetween(-2.0, 2.0);
    const std::array<double, 3> size = {numberBetween(0.05, 0.3), numberBetween(0.05, 0.3),
                                        numberBetween(0.05, 0.3)};
    const auto moment = [&](double a, double b) { return mass / 12.0 * (a * a + b * b); };
    stream_ << "  <link name=\"link" << number << "\">\n    <inertial>\n      ";
    origin(0.1);
    stream_ << "      <mass value=\"" << mass << "\"/>\n      <inertia ixx=\""
            << moment(size[1], size[2]) << "\" iyy=\"" << moment(size[0], size[2]) << "\" izz=\""
            << moment(size[0], size[1])
            << "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\n    </inertial>\n  </link>\n";
  }

  void joint(int number, bool slides) {
    stream_ << "  <joint name=\"joint" << number << "\" type=\""
            << (slides ? "prismatic" : "revolute") << "\">\n    <parent link=\"link" << number - 1
            << "\"/>\n    <child link=\"link" << number << "\"/>\n    ";
    origin(0.4);
    stream_ << "    <axis xyz=\"" << triple(1.0)
            << "\"/>\n    <limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"3\"/>\n"
            << "  </joint>\n";
  }

 private:
  double numberBetween(double low, double high) {
    return low + (high - low) * (engine_() / 4294967295.0);
  }

  std::string triple(double range) {
    std::ostringstream text;
    text << numberBetween(-range, range);
    text << ' ' << numberBetween(-range, range);
    text << ' ' << numberBetween(-range, range);
    return text.str();
  }

  void origin(double range) {
    stream_ << "<origin xyz=\"" << triple(range);
    stream_ << "\" rpy=\"" << triple(3.0) << "\"/>\n";
  }

  std::ostream& stream_;
  std::mt19937 engine_;
};

}  // namespace

std::string generatedChain(int joints, Joints kind) {
  std::ostringstream urdf;
  Writer writer(urdf, 2008U + static_cast<std::uint32_t>(joints));
  urdf << "<robot name=\"chain\">\n  <link name=\"link0\"/>\n";
  for (int i = 1; i <= joints; ++i) {
    writer.joint(i, kind == Joints::kTurningAndSliding && i % 3 == 2);
    writer.link(i);
  }
  urdf << "</robot>\n";
  return urdf.str();
}

}  // namespace inverse_dynamics_benchmarks
