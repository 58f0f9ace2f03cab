// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the conformance tests share: the traits of a solver, random states, tolerances, the
/// fixture. Include conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <exception>
#include <functional>
#include <iomanip>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/model.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/load_friction.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"

namespace inverse_dynamics_solver::conformance {

/// Parameters by name, below the namespace.
using ParameterMap = std::map<std::string, ParameterValue>;

/// Rounding: some hundred operations of 1.1e-16 each along a chain of up to ten links, with
/// cancellation. Relative to the greatest entry.
constexpr double kRounding = 1e-12;

/// Five-point difference with step 1e-3 of a sum of sines: truncation 1e-3^4/30 = 3e-14 per unit of
/// frequency, rounding 1e-16/1e-3 = 1e-13. Relative to the natural size of the derivative, with a
/// margin.
constexpr double kDifference = 1e-10;
constexpr double kDifferenceStep = 1e-3;

/// Forward dynamics divides by inertias of which the greatest is some hundred times the least.
constexpr double kSolved = 1e-10;

/// The same difference of a friction law, which may turn within some milliradians per second: with
/// this step rounding is 1e-16/1e-5 = 1e-11, truncation of a sigmoid with slope 200 at most 1e-12,
/// times its derivatives' size.
constexpr double kSteepStep = 1e-5;
constexpr double kSteepDifference = 1e-8;

/// Number of random states in each test of a law.
constexpr int kStates = 20;

/// Describes a solver to the tests. Derive, add `kPlugin`, and replace what differs.
struct SolverTraits {
  // static constexpr const char* kPlugin = "my_solver/MySolver";   // required

  /// Parameters with which the solver is initialized.
  static ParameterMap parameters() { return {}; }

  /// Text of the URDF; empty for a solver that doesn't need one.
  static std::string robotDescription() { return ""; }

  /// The model that the solver computes with, where it isn't that of the robot description: its
  /// parameters are what the regressor is tested with.
  static std::optional<chain_dynamics::Model> model() { return {}; }

  /// For a model whose gravity torques aren't the gradient of a potential: the reason.
  static constexpr const char* kGravityIsNotConservative = nullptr;

  /// Random states are drawn from plus and minus these [rad, rad/s, rad/s^2].
  static constexpr double kPosition = 3.1;
  static constexpr double kVelocity = 2.0;
  static constexpr double kAcceleration = 4.0;

  /// Further arguments with which initialize() must throw: parameters, robot description.
  static std::vector<std::pair<ParameterMap, std::string>> badInitializations() { return {}; }
};

/// The same as values, which the tests are given: they are compiled once for all solvers.
struct TestedSolver {
  const char* plugin;
  ParameterMap (*parameters)();
  std::string (*robotDescription)();
  std::optional<chain_dynamics::Model> (*model)();
  std::vector<std::pair<ParameterMap, std::string>> (*badInitializations)();
  const char* gravity_is_not_conservative;
  double position, velocity, acceleration;
};

template <class Traits>
TestedSolver testedSolver() {
  return {Traits::kPlugin,   &Traits::parameters,         &Traits::robotDescription,
          &Traits::model,    &Traits::badInitializations, Traits::kGravityIsNotConservative,
          Traits::kPosition, Traits::kVelocity,           Traits::kAcceleration};
}

/// Defined beside the tests: GoogleTest prints parameters, so a program that instantiates the suite
/// links them.
std::ostream& operator<<(std::ostream& stream, const TestedSolver& solver);

/// Joint state; what each quantity depends on.
struct State {
  Eigen::VectorXd q, qd, qdd;
};

/// As C++, to be pasted into a test.
inline std::ostream& operator<<(std::ostream& stream, const State& state) {
  const auto write = [&stream](const char* name, const Eigen::VectorXd& values) {
    stream << name << " << " << std::setprecision(17);
    for (Eigen::Index i = 0; i < values.size(); ++i) stream << (i == 0 ? "" : ", ") << values[i];
    stream << ";\n";
  };
  write("q", state.q);
  write("qd", state.qd);
  write("qdd", state.qdd);
  return stream;
}

inline std::string toString(const State& state) {
  std::ostringstream stream;
  stream << "at\n" << state;
  return stream.str();
}

/// A method of the solver, its result as one column of numbers.
struct Quantity {
  std::string name;
  std::function<Eigen::VectorXd(const InverseDynamicsSolver&, const State&)> value;
};

inline Eigen::VectorXd flat(const Eigen::MatrixXd& matrix) {
  return Eigen::Map<const Eigen::VectorXd>(matrix.data(), matrix.size());
}

/// Every quantity, by value.
inline const std::vector<Quantity>& quantities() {
  using S = InverseDynamicsSolver;
  static const std::vector<Quantity> all = {
      {"getInertiaMatrix",
       [](const S& s, const State& x) { return flat(s.getInertiaMatrix(x.q)); }},
      {"getCoriolisVector",
       [](const S& s, const State& x) { return s.getCoriolisVector(x.q, x.qd); }},
      {"getFrictionVector",
       [](const S& s, const State& x) { return s.getFrictionVector(x.q, x.qd); }},
      {"getGravityVector", [](const S& s, const State& x) { return s.getGravityVector(x.q); }},
      {"getTorques", [](const S& s, const State& x) { return s.getTorques(x.q, x.qd, x.qdd); }},
      {"getDynamicComponents", [](const S& s, const State& x) {
         const auto [H, c, g] = s.getDynamicComponents(x.q, x.qd);
         Eigen::VectorXd all_of_them(H.size() + c.size() + g.size());
         all_of_them << flat(H), c, g;
         return all_of_them;
       }}};
  return all;
}

/// True if the numbers are the same bit for bit.
inline bool identical(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const auto bytes = static_cast<std::size_t>(a.size()) * sizeof(double);
  return a.size() == b.size() && (bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0);
}

/// Passes if a and b differ by at most `tolerance` times `size` in each entry; prints the worst.
inline ::testing::AssertionResult near(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                       double tolerance, double size) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    return ::testing::AssertionFailure() << "sizes differ";
  }
  const double allowed = tolerance * size;
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      // Written so that a NaN fails.
      if (!(std::abs(a(i, j) - b(i, j)) <= allowed)) {
        return ::testing::AssertionFailure()
               << "entry (" << i << ", " << j << "): " << std::setprecision(17) << a(i, j)
               << " and " << b(i, j) << " differ by " << std::abs(a(i, j) - b(i, j)) << ", allowed "
               << allowed;
      }
    }
  }
  return ::testing::AssertionSuccess();
}

/// Greatest absolute entry; at least one, so that a zero vector has a size to compare with.
inline double sizeOf(const Eigen::MatrixXd& values) {
  return values.size() == 0 ? 1.0 : std::max(1.0, values.cwiseAbs().maxCoeff());
}

/// The text of the E that `call` throws; a failure if it throws nothing or something else.
template <class E, class Call>
std::string errorOf(Call call) {
  try {
    call();
  } catch (const E& e) {
    return e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "another exception than promised: " << e.what();
    return "";
  }
  ADD_FAILURE() << "no exception";
  return "";
}

/// Passes if `text` contains all `parts`.
inline ::testing::AssertionResult contains(const std::string& text,
                                           const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos) {
      return ::testing::AssertionFailure() << "\"" << part << "\" is missing in: " << text;
    }
  }
  return ::testing::AssertionSuccess();
}

/// Fixture: a loaded solver, initialized as its traits say.
class SolverConformance : public ::testing::TestWithParam<TestedSolver> {
 protected:
  void SetUp() override {
    solver_ = make();
    initialize(*solver_);
  }

  /// A new solver, not initialized.
  static std::shared_ptr<InverseDynamicsSolver> make() {
    static const SolverLoader loader;
    return loader.load(GetParam().plugin);
  }

  /// Initializes with the parameters of the traits and, in their place, those given.
  static void initialize(InverseDynamicsSolver& solver, const ParameterMap& changed = {}) {
    ParameterMap parameters = GetParam().parameters();
    for (const auto& [name, value] : changed) parameters[name] = value;
    solver.initialize(parameters, "", GetParam().robotDescription());
  }

  /// The same as a new solver.
  static std::shared_ptr<InverseDynamicsSolver> makeInitialized(const ParameterMap& changed = {}) {
    std::shared_ptr<InverseDynamicsSolver> solver = make();
    initialize(*solver, changed);
    return solver;
  }

  Eigen::VectorXd randomVector(double range) {
    std::uniform_real_distribution<double> distribution(-range, range);
    Eigen::VectorXd result(solver_->jointCount());
    for (double& entry : result) entry = distribution(random_);
    return result;
  }

  /// n x count, one state per column, of numbers that are small enough for a velocity.
  Eigen::MatrixXd randomColumns(Eigen::Index count) {
    Eigen::MatrixXd result(solver_->jointCount(), count);
    for (Eigen::Index k = 0; k < count; ++k) result.col(k) = randomVector(GetParam().velocity);
    return result;
  }

  State randomState() {
    State state;
    state.q = randomVector(GetParam().position);
    state.qd = randomVector(GetParam().velocity);
    state.qdd = randomVector(GetParam().acceleration);
    return state;
  }

  std::vector<State> randomStates(int count) {
    std::vector<State> states(static_cast<std::size_t>(count));
    for (State& state : states) state = randomState();
    return states;
  }

  std::shared_ptr<InverseDynamicsSolver> solver_;
  std::mt19937 random_{4711};  // fixed: a failure can be repeated
};

/// No fixture: the first solver of the process is that of the test.
class SolverAlone : public ::testing::TestWithParam<TestedSolver> {};

}  // namespace inverse_dynamics_solver::conformance
