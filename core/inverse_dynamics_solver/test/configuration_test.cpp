// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/configuration.hpp"

#include <gtest/gtest.h>

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver::configuration_test {

using conformance::errorOf;
using Values = std::map<std::string, ParameterValue>;

/// A shoulder and, beside the arm, a gripper finger that slides out by its joint position.
const char* const kArm = R"(<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><mass value="2"/><origin xyz="0 0 -0.5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <link name="finger"><inertial><mass value="1"/><origin xyz="0 0 0"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="flange" type="fixed"><parent link="upper"/><child link="tool"/></joint>
  <joint name="slide" type="prismatic"><parent link="tool"/><child link="finger"/>
    <axis xyz="0 0 -1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
</robot>)";

TEST(Configuration, HasDefaults) {
  const Configuration configuration = readConfiguration({}, "ids", "");
  EXPECT_EQ(configuration.robot_description, "");
  EXPECT_EQ(configuration.root, "");
  EXPECT_EQ(configuration.tip, "");
  EXPECT_EQ(configuration.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_FALSE(configuration.gravity_given);
  EXPECT_TRUE(configuration.lump_attached);
  EXPECT_TRUE(configuration.friction);
  EXPECT_FALSE(configuration.urdf_friction);
  EXPECT_EQ(configuration.batch_threads, 1);
  EXPECT_EQ(configuration.locked_position("finger"), std::nullopt);
}

TEST(Configuration, IsReadBelowTheNamespace) {
  const Parameters parameters = {{"ids.root", "base"},
                                 {"ids.tip", "tool"},
                                 {"ids.gravity", std::vector<double>{1.0, 2.0, 3.0}},
                                 {"ids.attached", "ignore"},
                                 {"ids.friction", false},
                                 {"ids.locked_joints.finger", 0.25},
                                 {"ids.max_threads", 3},
                                 {"ids.batch_threads", 2},
                                 {"tip", "another"}};
  const Configuration configuration = readConfiguration(parameters, "ids", "");
  EXPECT_EQ(configuration.root, "base");
  EXPECT_EQ(configuration.tip, "tool");
  EXPECT_EQ(configuration.gravity, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(configuration.gravity_given);
  EXPECT_FALSE(configuration.lump_attached);
  EXPECT_FALSE(configuration.friction);
  EXPECT_EQ(configuration.batch_threads, 2);
  EXPECT_EQ(configuration.locked_position("finger"), 0.25);
  EXPECT_EQ(configuration.get<std::int64_t>("max_threads"), 3);
  EXPECT_EQ(readConfiguration(parameters, "", "").tip, "another");
}

TEST(Configuration, RobotDescriptionComesFromTheArgumentElseFromTheParameterWithoutNamespace) {
  const Parameters parameters = {{"robot_description", "<a/>"}, {"ids.robot_description", "<b/>"}};
  EXPECT_EQ(readConfiguration(parameters, "ids", "").robot_description, "<a/>");
  EXPECT_EQ(readConfiguration(parameters, "ids", "<c/>").robot_description, "<c/>");
}

TEST(Configuration, MistakesNameTheParameterWithItsNamespace) {
  const auto error = [](const std::string& name, const ParameterValue& value) {
    return errorOf<InvalidParameterValueException>([&] {
      readConfiguration({{"ids." + name, value}}, "ids", "");
    });
  };
  EXPECT_EQ(error("gravity", std::vector<double>{1.0, 2.5}),
            "parameter 'ids.gravity': wrong value: expected 3 finite numbers up to 1e6 [m/s^2] in "
            "the frame of the root link, got 2 (1, 2.5); for a robot that stands upright: [0.0, "
            "0.0, -9.81]");
  EXPECT_NE(error("gravity", std::vector<double>{0.0, 0.0, std::nan("")}).find("got 3 (0, 0, nan)"),
            std::string::npos);
  EXPECT_NE(error("gravity", std::vector<double>{0.0, 0.0, 1e308}).find("got 3 (0, 0, 1e+308)"),
            std::string::npos);
  EXPECT_EQ(error("attached", "keep"),
            "parameter 'ids.attached': wrong value: expected \"lump\" or \"ignore\", got \"keep\"; "
            "lump: bodies attached beside or beyond the chain are included; ignore: they aren't");
  EXPECT_EQ(error("batch_threads", 0),
            "parameter 'ids.batch_threads': wrong value: expected 1 to 4096, got 0; give how many "
            "threads may share a batch; 1: the library starts none");
  EXPECT_NE(error("batch_threads", 4097).find("got 4097"), std::string::npos);
  EXPECT_EQ(error("batch_threads", 2.0),
            "parameter 'ids.batch_threads': wrong type: expected integer, got double; correct it "
            "where it is set");
  EXPECT_EQ(error("friction", "off"),
            "parameter 'ids.friction': wrong type: expected bool, got string; correct it where it "
            "is set");
  EXPECT_EQ(error("tip", 3),
            "parameter 'ids.tip': wrong type: expected string, got integer; correct it where it is "
            "set");
}

TEST(ChainFromDescription, TakesRootTipGravityAndWhatHangsOnTheChain) {
  const auto chain = [](Parameters parameters) {
    return chainFromDescription(readConfiguration(parameters, "", kArm));
  };
  const chain_dynamics::Chain lumped =
      chain({{"tip", "tool"}, {"gravity", std::vector<double>{1.0, 2.0, 3.0}}});
  EXPECT_EQ(lumped.jointNames(), std::vector<std::string>{"shoulder"});
  EXPECT_EQ(lumped.gravity(), Eigen::Vector3d(1, 2, 3));
  EXPECT_DOUBLE_EQ(lumped.links()[0].mass, 3.0);
  EXPECT_DOUBLE_EQ(chain({{"tip", "tool"}, {"attached", "ignore"}}).links()[0].mass, 2.0);

  // The finger slides from the pivot down to 0.5 m below: first moment 2 * 0.5, and 1 * 0.5 more.
  const auto moment = [&](Parameters parameters) {
    return chain(std::move(parameters)).links()[0].first_moment.norm();
  };
  EXPECT_NEAR(moment({{"tip", "tool"}}), 1.0, 1e-15);
  EXPECT_NEAR(moment({{"tip", "tool"}, {"locked_joints.slide", 0.5}}), 1.5, 1e-15);
}

TEST(ChainFromDescription, RotorInertiaIsThatOfParametersElseOfTheDescriptionWhereAskedFor) {
  std::string urdf = kArm;
  const std::string end = "</robot>";
  urdf.replace(urdf.find(end), end.size(),
               "<transmission name='t'><joint name='shoulder'/><actuator name='m'><motorInertia>"
               "3e-5</motorInertia><mechanicalReduction>100</mechanicalReduction></actuator>"
               "</transmission></robot>");
  const auto chain = [&](Values parameters, const std::string& text) {
    parameters["tip"] = "tool";
    return chainFromDescription(readConfiguration(parameters, "", text));
  };
  const auto rotor = [&](const Values& parameters) {
    return chain(parameters, urdf).joints()[0].rotor_inertia;
  };
  const auto warnings = [&](const Values& parameters, const std::string& text) {
    const auto texts = chain(parameters, text).warnings();
    return texts.empty() ? std::string() : texts.size() == 1 ? texts[0] : "several";
  };
  EXPECT_EQ(rotor({}), 0.0);
  EXPECT_DOUBLE_EQ(rotor({{"rotor_inertia", true}}), 0.3);
  EXPECT_EQ(rotor({{"rotor_inertia.shoulder", 0.25}}), 0.25);
  EXPECT_EQ(rotor({{"rotor_inertia", true}, {"rotor_inertia.shoulder", 0.0}}), 0.0);

  EXPECT_EQ(warnings({}, urdf),
            "the rotor inertia that the robot description states in <transmission> (joints "
            "shoulder) isn't used; set parameter 'rotor_inertia' to true to add it to the inertia "
            "matrix");
  EXPECT_EQ(warnings({{"rotor_inertia", true}}, urdf), "");
  EXPECT_EQ(warnings({{"rotor_inertia.shoulder", 0.25}}, urdf), "");
  EXPECT_EQ(warnings({}, kArm), "");
  EXPECT_EQ(warnings({{"rotor_inertia", true}}, kArm),
            "parameter 'rotor_inertia' has no effect: no <transmission> of the robot description "
            "states rotor inertia of a joint that has none by parameter");
  EXPECT_EQ(errorOf<InvalidParameterValueException>([&] {
              rotor({{"rotor_inertia.shoulder", -0.1}});
            }),
            "parameter 'rotor_inertia.shoulder': wrong value: expected a finite number >= 0 [kg "
            "m^2; prismatic kg], got -0.100000; give the inertia of the rotor times the square of "
            "the gear ratio");
}

TEST(ChainFromDescription, RefusesSeveralTipsThatAMechanismTakes) {
  using Names = std::vector<std::string>;
  for (const ParameterValue& tips :
       {ParameterValue(std::string("tool, finger")), ParameterValue(Names{"tool", "finger"})}) {
    const Configuration configuration = readConfiguration({{"ids.tip", tips}}, "ids", kArm);
    const std::string error =
        errorOf<InvalidParameterValueException>([&] { chainFromDescription(configuration); });
    EXPECT_NE(error.find("'ids.tip'"), std::string::npos) << error;
    EXPECT_NE(error.find("tool, finger"), std::string::npos) << error;
    EXPECT_NE(error.find("rigid_body_inverse_dynamics_solver"), std::string::npos) << error;
    const chain_dynamics::Mechanism robot = mechanismFromDescription(configuration);
    EXPECT_EQ(robot.coordinates.jointNames(), (Names{"shoulder", "slide"}));
    EXPECT_EQ(robot.branches.size(), 2U);
  }
  errorOf<InvalidParameterValueException>([&] {
    chainFromDescription(readConfiguration({{"tip", std::string("*")}}, "", kArm));
  });
  const Configuration one = readConfiguration({{"tip", Names{"tool"}}}, "", kArm);
  EXPECT_EQ(chainFromDescription(one).jointNames(), Names{"shoulder"});
}

using Doubles = std::vector<double>;
using Strings = std::vector<std::string>;

chain_dynamics::Mechanism mechanism(const std::map<std::string, ParameterValue>& values) {
  return mechanismFromDescription(readConfiguration(values, "", kArm));
}

TEST(Motors, AreCoordinatesByParameter) {
  const auto names = [](const chain_dynamics::Mechanism& robot) {
    return robot.coordinates.jointNames();
  };
  // of a chain, and of a tree
  const auto geared = mechanism({{"tip", std::string("tool")}, {"motors", Doubles{-0.01}}});
  EXPECT_EQ(names(geared), Strings{"motor_1"});
  ASSERT_EQ(geared.branches.size(), 1U);
  EXPECT_EQ(geared.branches[0].tip, "tool");
  EXPECT_EQ(geared.branches[0].S[0].factor, -0.01);
  const std::map<std::string, ParameterValue> both = {{"tip", std::string("*")},
                                                      {"motors", Doubles{1, 0.5, 0, 2}},
                                                      {"rotor_inertia.b", 0.3},
                                                      {"motor_names", Strings{"a", "b"}},
                                                      {"rotor_inertia.shoulder", 0.2}};
  const auto shared = mechanism(both);
  EXPECT_EQ(names(shared), (Strings{"a", "b"}));
  EXPECT_EQ(shared.motor_inertia, (std::vector<double>{0, 0.3}));
  EXPECT_EQ(shared.branches[0].chain.joints()[0].rotor_inertia, 0.2);
  // a name that is of a motor isn't that of a joint
  auto renamed = both;
  renamed["motor_names"] = Strings{"shoulder", "b"};
  EXPECT_EQ(mechanism(renamed).motor_inertia, (std::vector<double>{0.2, 0.3}));
  EXPECT_EQ(mechanism(renamed).branches[0].chain.joints()[0].rotor_inertia, 0);
}

TEST(Motors, OfTheDescriptionAreThoseOfItsTransmissions) {
  std::string urdf = kArm;
  urdf.insert(urdf.find("</robot>"),
              "<ros2_control name='arm' type='system'><transmission name='gear'>"
              "<plugin>transmission_interface/SimpleTransmission</plugin>"
              "<actuator name='motor' role='actuator1'/><joint name='shoulder' role='joint1'>"
              "<mechanical_reduction>50</mechanical_reduction></joint></transmission>"
              "</ros2_control>");
  const auto robot =
      mechanismFromDescription(readConfiguration({{"tip", std::string("*")},
                                                  {"motors", std::string("description")},
                                                  {"rotor_inertia.motor", 0.1}},
                                                 "", urdf));
  EXPECT_EQ(robot.coordinates.jointNames(), (Strings{"motor", "slide"}));
  EXPECT_EQ(robot.motor_inertia, (std::vector<double>{0.1, 0}));
  EXPECT_EQ(robot.branches[0].S[0].factor, 1.0 / 50);
}

TEST(Motors, AreRefusedByName) {
  const auto error = [](std::map<std::string, ParameterValue> values) {
    values["tip"] = std::string("*");
    return errorOf<InvalidParameterValueException>([&] { mechanism(values); });
  };
  EXPECT_NE(error({{"motors", Doubles{1, 0, 1}}}).find("2 joints shoulder, slide one per motor"),
            std::string::npos);
  EXPECT_NE(error({{"motors", Doubles{1, 0, 0, 1}}, {"motor_names", Strings{"a"}}}).find("1 by"),
            std::string::npos);
  EXPECT_NE(error({{"motor_names", Strings{"a"}}}).find("'motor_names'"), std::string::npos);
  EXPECT_NE(error({{"motors", std::string("transmissions")}}).find("'motors'"), std::string::npos);
  errorOf<InvalidRobotDescriptionException>([&] {
    mechanism({{"tip", std::string("*")}, {"motors", Doubles{1, 1, 2, 2}}});  // without full rank
  });
}

TEST(Springs, AreSetByParameterInPlaceOfTheModels) {
  chain_dynamics::Model model(mechanism({{"tip", std::string("*")}}));
  const auto set = [&](const std::map<std::string, ParameterValue>& values) {
    setSprings(readConfiguration(values, "", kArm), model);
  };
  set({});
  EXPECT_EQ(model.stiffness.size(), 0);
  set({{"springs.slide.stiffness", 30.0}, {"springs.slide.rest", 0.2}});
  EXPECT_EQ(model.stiffness[1], 30);
  EXPECT_EQ(model.rest[1], 0.2);
  set({{"springs.slide.stiffness", 40}});
  EXPECT_EQ(model.stiffness[0], 0);
  EXPECT_EQ(model.stiffness[1], 40);
  EXPECT_EQ(model.rest[1], 0);
  for (const std::map<std::string, ParameterValue>& wrong :
       {std::map<std::string, ParameterValue>{{"springs.slide.rest", 1.0}},
        {{"springs.slide.stiffness", std::nan("")}}}) {
    EXPECT_NE(errorOf<InvalidParameterValueException>([&] { set(wrong); }).find("springs.slide."),
              std::string::npos);
  }
}

TEST(ChainFromDescription, RefusesWhatIsNoRobot) {
  const auto error = [](Parameters parameters, const std::string& text) {
    return errorOf<InvalidRobotDescriptionException>(
        [&] { chainFromDescription(readConfiguration(parameters, "ids", text)); });
  };
  EXPECT_EQ(error({}, "no robot").rfind("robot description: ", 0), 0U) << error({}, "no robot");
  EXPECT_NE(error({{"ids.tip", "tol"}}, kArm).find("tol"), std::string::npos);
  EXPECT_NE(error({{"ids.root", "bas"}}, kArm).find("bas"), std::string::npos);
  EXPECT_EQ(errorOf<ParameterUninitializedException>(
                [&] { chainFromDescription(readConfiguration({}, "ids", "")); }),
            "robot description: missing: expected the text of a URDF, got nothing; pass it to "
            "initialize() as third argument, or set the parameter 'robot_description' (without "
            "namespace)");
  EXPECT_EQ(errorOf<InvalidParameterValueException>([&] {
              chainFromDescription(readConfiguration(
                  {{"ids.tip", "tool"}, {"ids.locked_joints.slide", std::nan("")}}, "ids", kArm));
            }),
            "parameter 'ids.locked_joints.slide': wrong value: expected a finite position [rad; "
            "prismatic m], got nan; give the position at which the joint is held");
}

}  // namespace inverse_dynamics_solver::configuration_test
