// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/strict_initialization.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"
#include "node_parameters_stand_in.hpp"

namespace inverse_dynamics_solver::strict_initialization_test {

class StrictInitialization : public ::testing::Test {
 protected:
  /// The text of the refusal.
  std::string refusal(const std::string& param_namespace) {
    try {
      solver->initialize(Parameters(node).strict(), param_namespace);
    } catch (const InvalidParameterValueException& error) {
      return error.what();
    }
    ADD_FAILURE() << "no exception";
    return "";
  }
  double massTimesLength() const {
    const Eigen::VectorXd horizontal = Eigen::VectorXd::Constant(1, 1.5707963267948966);
    return solver->getGravityVector(horizontal)[0] / 9.81;
  }

  const std::shared_ptr<stand_in::NodeParameters> node =
      std::make_shared<stand_in::NodeParameters>();
  const std::shared_ptr<InverseDynamicsSolver> solver =
      SolverLoader().load("pendulum_inverse_dynamics_solver/InverseDynamicsSolverPendulum");
};

TEST_F(StrictInitialization, TakesWhatTheSolverKnows) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}, {"mas", 3.0}, {"idsmas", 3.0}};
  solver->initialize(Parameters(node).strict(), "ids");
  EXPECT_NEAR(massTimesLength(), 1.0, 1e-12);
}

TEST_F(StrictInitialization, RefusesWhatTheSolverDoesNotKnow) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  EXPECT_EQ(refusal("ids"),
            "parameter 'ids.lenght': the solver doesn't know it: expected one of "
            "ids.allow_massless, ids.attached, ids.batch_threads, ids.damping, ids.friction, "
            "ids.gravity, ids.length, ids.mass, ids.root, ids.tip, ids.urdf_friction; did you mean "
            "'ids.length'?");
  EXPECT_FALSE(solver->isInitialized());
}

TEST_F(StrictInitialization, RefusesWhatIsSetFromOutsideAndNotDeclared) {
  node->values = {{"ids.mass", 2.0}, {"ids.length", 0.5}};
  node->overrides = {{"ids.dampng", {0.7}}};
  EXPECT_NE(refusal("ids").find("did you mean 'ids.damping'?"), std::string::npos);
}

TEST_F(StrictInitialization, LeavesTheSolverAsItWas) {
  solver->initialize({{"mass", 2.0}, {"length", 0.5}});
  node->values = {{"ids.mass", 6.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  refusal("ids");
  ASSERT_TRUE(solver->isInitialized());
  EXPECT_NEAR(massTimesLength(), 1.0, 1e-12);
}

/// A node has parameters of its own there.
TEST_F(StrictInitialization, RefusesWithoutANamespaceWhatIsNearToWhatTheSolverKnows) {
  node->values = {{"mass", 2.0}, {"length", 0.5}, {"use_sim_time", true}, {"rate", 100.0}};
  solver->initialize(Parameters(node).strict(), "");
  node->values["dampng"] = 0.7;
  EXPECT_NE(refusal("").find("parameter 'dampng': the solver doesn't know it"), std::string::npos);
}

TEST_F(StrictInitialization, LeavesToTheSolverWhatItRefusesItself) {
  node->values = {{"ids.mass", -2.0}, {"ids.length", 0.5}, {"ids.lenght", 0.7}};
  EXPECT_NE(refusal("ids").find("ids.mass, ids.length: wrong value"), std::string::npos);
  EXPECT_FALSE(solver->isInitialized());
}

TEST_F(StrictInitialization, OtherwiseAnUnknownParameterIsAWarning) {
  solver->initialize({{"mass", 2.0}, {"length", 0.5}, {"dampng", 0.7}, {"x", 1}});
  EXPECT_EQ(solver->warnings(),
            (std::vector<std::string>{
                "parameter 'dampng' isn't used, the solver doesn't know it; did you mean "
                "'damping'?",
                "parameter 'x' isn't used, the solver doesn't know it; correct or remove it"}));
}

struct NotDeclared : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct NamedParameter {
  std::string name;
  const std::string& get_name() const { return name; }
};

/// A node as rclcpp's from jazzy on.
class NodeThatAsksBeforeSetting : public stand_in::NodeParameters {
 public:
  using Callback = std::function<void(std::vector<NamedParameter>&)>;

  std::shared_ptr<Callback> add_pre_set_parameters_callback(Callback callback) {
    auto handle = std::make_shared<Callback>(std::move(callback));
    before_setting_ = handle;
    return handle;
  }

  /// As its service does: why it was refused, or "".
  std::string set(const std::string& name) {
    std::vector<NamedParameter> parameters = {{name}};
    try {
      if (const auto callback = before_setting_.lock()) (*callback)(parameters);
      if (!has_parameter(name)) throw NotDeclared("rclcpp's own words");
    } catch (const NotDeclared& error) {
      return error.what();
    }
    return "";
  }

 private:
  std::weak_ptr<Callback> before_setting_;
};

class UndeclaredParameters : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name :
         {"cutoff", "gains.damping_ratio", "gains.natural_frequency", "ids.tip", "limits.effort",
          "limits.effort_rate", "limits.velocity", "use_sim_time"}) {
      node.values[name] = 1.0;
    }
  }

  /// Why a parameter file with this name is refused, or "".
  std::string refusal(const std::string& name) {
    node.overrides = {{"cutoff", {}}, {"ids.tip", {}}, {"use_sim_time", {}}, {name, {}}};
    try {
      rejectUndeclared(node);
    } catch (const InvalidParameterValueException& error) {
      return error.what();
    }
    return "";
  }

  NodeThatAsksBeforeSetting node;
};

TEST_F(UndeclaredParameters, AreRefusedWithTheNameThatWasMeant) {
  const std::map<std::string, std::string> meant = {
      {"cutof", "cutoff"},
      {"gains.natural_freq", "gains.natural_frequency"},
      {"limit.velocity", "limits.velocity"},
      {"limits.effrot", "limits.effort"},
  };
  for (const auto& [name, right] : meant) {
    EXPECT_EQ(refusal(name), "parameter '" + name +
                                 "': the node doesn't declare it; did you mean '" + right + "'?");
  }
  EXPECT_EQ(refusal("speed"),
            "parameter 'speed': the node doesn't declare it; correct or remove it");
}

TEST_F(UndeclaredParameters, AreNoneWhereAllIsDeclaredOrRclcppDeclaresItLater) {
  EXPECT_EQ(refusal("limits.effort"), "");
  EXPECT_EQ(refusal("qos_overrides./clock.subscription.depth"), "");
}

TEST_F(UndeclaredParameters, AreRefusedWhenSetWithTheNameThatWasMeant) {
  EXPECT_EQ(node.set("gains.natural_freq"), "rclcpp's own words");
  const auto kept = suggestDeclared<NotDeclared>(node);
  EXPECT_EQ(node.set("gains.natural_freq"),
            "parameter 'gains.natural_freq': the node doesn't declare it; did you mean "
            "'gains.natural_frequency'?");
  EXPECT_EQ(node.set("gains.natural_frequency"), "");
}

TEST_F(UndeclaredParameters, AreLeftToRclcppWhereItCantAskBefore) {
  stand_in::NodeParameters humble;
  EXPECT_EQ(suggestDeclared<NotDeclared>(humble), nullptr);
}

}  // namespace inverse_dynamics_solver::strict_initialization_test
