// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/robot_description.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/text.hpp"
#include "chain_dynamics/urdf.hpp"
#include "reference.hpp"
#include "urdf_texts.hpp"

namespace chain_dynamics::robot_description_test {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::string urdfError(const std::string& urdf) {
  return errorOf([&] { chainFromUrdf(urdf); });
}

std::vector<std::string> warnings(const std::string& urdf) {
  return chainFromUrdf(urdf).warnings();
}

/// The text with every occurrence of a part replaced; the part occurs.
std::string replaced(std::string text, const std::string& part, const std::string& by) {
  EXPECT_NE(text.find(part), std::string::npos) << part;
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + by.size())) {
    text.replace(at, part.size(), by);
  }
  return text;
}

/// One hinge with the given contents of its link and its joint.
std::string hinge(const std::string& body, const std::string& joint_content = "") {
  return robot(link("base", "") + link("bob", body) +
               joint("j", "continuous", "base", "bob", joint_content));
}

// --- the tree ---

TEST(RobotDescription, HoldsLinksAndJointsAsATree) {
  const RobotDescription tree = robotFromUrdf(arm());
  EXPECT_EQ(tree.name, "arm");
  ASSERT_THAT(tree.links, SizeIs(4));
  ASSERT_THAT(tree.joints, SizeIs(3));
  EXPECT_EQ(tree.links[tree.root].name, "base");
  EXPECT_EQ(tree.links[tree.root].parent_joint, RobotDescription::kNone);
  EXPECT_EQ(tree.links[1].line, 4);
  EXPECT_THAT(tree.warnings, IsEmpty());

  const RobotDescription::Joint& elbow = tree.joints[tree.jointIndex("elbow")];
  EXPECT_EQ(elbow.type, RobotDescription::JointType::kContinuous);
  EXPECT_EQ(tree.links[elbow.parent].name, "upper");
  EXPECT_EQ(tree.links[elbow.child].name, "lower");
  EXPECT_EQ(elbow.line, 8);
  EXPECT_EQ(elbow.axis, Eigen::Vector3d(0.6, 0, -0.8));
  EXPECT_EQ(elbow.placement.p, Eigen::Vector3d(0, 0.2, 0.5));
  EXPECT_TRUE(isMovable(elbow));
  EXPECT_FALSE(isMovable(tree.joints[tree.jointIndex("weld")]));
  EXPECT_EQ(tree.links[elbow.child].parent_joint, tree.jointIndex("elbow"));
  EXPECT_THAT(tree.links[elbow.child].child_joints, ElementsAre(tree.jointIndex("weld")));
  EXPECT_EQ(tree.jointIndex("knee"), RobotDescription::kNone);
  EXPECT_EQ(tree.linkIndex("elbow"), RobotDescription::kNone);

  ASSERT_TRUE(tree.links[3].inertial);
  EXPECT_EQ(tree.links[3].inertial->mass, 0.5);
  EXPECT_EQ(tree.links[3].inertial->inertia(1, 2), 0.03);
  EXPECT_EQ(tree.links[3].inertial->placement.p, Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST(RobotDescription, ListsTheLinksBelowALinkParentsFirst) {
  const RobotDescription tree = robotFromUrdf(
      robot(link("d") + link("c") + link("b") + link("a") + joint("z", "fixed", "a", "b", "") +
            joint("y", "fixed", "b", "c", "") + joint("x", "fixed", "b", "d", "")));
  std::vector<std::string> names;
  for (const std::size_t below : tree.linksBelow(tree.linkIndex("b"))) {
    names.push_back(tree.links[below].name);
  }
  EXPECT_THAT(names, ElementsAre("b", "d", "c"));  // joint x, then joint y
  EXPECT_THAT(tree.linksBelow(tree.root), SizeIs(4));
}

TEST(RobotDescription, MimicJointsReferToTheJointTheyFollow) {
  const RobotDescription tree =
      robotFromUrdf(robot(link("a") + link("b") + link("c") +
                          joint("left", "continuous", "a", "b",
                                "<mimic joint='right' multiplier='-2' offset=' 0.5 '/>") +
                          joint("right", "continuous", "a", "c", "")));
  ASSERT_TRUE(tree.joints[0].mimic);
  EXPECT_EQ(tree.joints[0].mimic->joint, tree.jointIndex("right"));
  EXPECT_EQ(tree.joints[0].mimic->multiplier, -2);
  EXPECT_EQ(tree.joints[0].mimic->offset, 0.5);
  EXPECT_FALSE(tree.joints[1].mimic);
}

TEST(RobotDescription, OriginsTurnByRollPitchYawOrByAQuaternion) {
  const auto turned = [](const std::string& origin) {
    return replaced(hinge(inertial(), "<origin " + origin + "/>"), "<robot",
                    "<robot version='1.1'");
  };
  const auto rotation = [&turned](const std::string& origin) {
    return robotFromUrdf(turned(origin)).joints[0].placement.R;
  };
  // yaw about z, after pitch about y, after roll about x
  const Eigen::Matrix3d R = rotation("rpy='0.1 0.2 0.3'");
  EXPECT_NEAR(R(2, 0), -std::sin(0.2), kRounding);
  EXPECT_NEAR(R(1, 0), std::sin(0.3) * std::cos(0.2), kRounding);
  EXPECT_NEAR(R(2, 1), std::cos(0.2) * std::sin(0.1), kRounding);

  // half a turn about (0.6, 0, 0.8), of any length
  const Eigen::Matrix3d half = rotation("quat_xyzw='6 0 8 0'");
  EXPECT_LT((half * Eigen::Vector3d(0.6, 0, 0.8) - Eigen::Vector3d(0.6, 0, 0.8)).norm(), kRounding);
  EXPECT_NEAR(half.trace(), -1, kRounding);
  EXPECT_THAT(urdfError(turned("quat_xyzw='0 0 0 0'")),
              HasSubstr("joint j: <origin> quat_xyzw: expected a rotation"));
  EXPECT_THAT(urdfError(turned("quat_xyzw='0 0 1'")),
              HasSubstr("expected 4 finite numbers, got 3"));
  EXPECT_THAT(urdfError(turned("quat_xyzw='0 0 0 1' rpy='0 0 0'")),
              HasSubstr("expected either rpy or quat_xyzw, got both"));
}

TEST(RobotDescription, QuaternionsCountFrom1Point1OnLimitsOfAccelerationFrom1Point2On) {
  const std::string urdf =
      replaced(hinge(inertial(),
                     "<origin quat_xyzw='0.5 0.5 0.5 0.5'/><limit effort='1' velocity='2' "
                     "acceleration='4' deceleration='3' jerk='20'/>"),
               "<robot", "<robot version='1.2'");
  const RobotDescription third = robotFromUrdf(urdf);
  EXPECT_NEAR(third.joints[0].placement.R(1, 0), 1, kRounding);  // x becomes y, y becomes z
  EXPECT_EQ(third.joints[0].limits.acceleration, 4);
  EXPECT_EQ(third.joints[0].limits.deceleration, 3);
  EXPECT_EQ(third.joints[0].limits.jerk, 20);
  EXPECT_THAT(third.warnings, IsEmpty());

  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  const RobotDescription second = robotFromUrdf(replaced(urdf, "'1.2'", "'1.1'"));
  EXPECT_NEAR(second.joints[0].placement.R(1, 0), 1, kRounding);
  EXPECT_EQ(second.joints[0].limits.acceleration, kNoLimit);
  EXPECT_EQ(second.joints[0].limits.jerk, kNoLimit);
  EXPECT_THAT(
      second.warnings,
      Contains(HasSubstr("joint j: <limit> jerk is ignored: URDF knows it from 1.2 on; state "
                         "<robot version=\"1.2\">")));

  // without a version, as in 1.0: rpy counts
  const RobotDescription first = robotFromUrdf(
      replaced(replaced(urdf, " version='1.2'", ""), "<origin", "<origin rpy='0.1 0 0'"));
  EXPECT_EQ(first.joints[0].rpy, Eigen::Vector3d(0.1, 0, 0));
  EXPECT_NEAR(first.joints[0].placement.R(2, 1), std::sin(0.1), kRounding);
  EXPECT_THAT(first.warnings, Contains(HasSubstr("<origin> quat_xyzw is ignored")));
}

TEST(RobotDescription, VersionsOfUrdf1AreRead) {
  for (const std::string version : {"1.0", "1", "1.1", "1.2"}) {
    const std::string urdf = replaced(arm(), "name='arm'", "name='arm' version='" + version + "'");
    EXPECT_EQ(urdfError(urdf), "no error") << version;
  }
  for (const std::string version : {"7", "2.0", "1.7", "0.9", "one", "", "1.0.0"}) {
    const std::string urdf = replaced(arm(), "name='arm'", "name='arm' version='" + version + "'");
    EXPECT_THAT(urdfError(urdf), HasSubstr("URDF:2: robot: <robot> version: expected 1.0, 1.1 or "
                                           "1.2, got '" +
                                           version + "'"));
  }
}

// --- numbers ---

TEST(RobotDescription, OnlyDecimalNumbersAreNumbers) {
  for (const std::string bad : {"0x10", "1e400", "1_0", "1:30", "1.5f", "1e", "--1", "infinity",
                                "1\xC2\xA0", "\xEF\xBC\x91", "1 2"}) {
    EXPECT_THAT(urdfError(hinge(inertial(bad))),
                HasSubstr("link bob: <mass> value: expected a finite number"))
        << bad;
  }
  EXPECT_THAT(urdfError(hinge(inertial("${mass}"))), HasSubstr("expand the file with xacro first"));
  EXPECT_THAT(urdfError(hinge(inertial(), "<origin xyz='1 2 3 4'/>")),
              HasSubstr("expected three finite numbers, got 4 in '1 2 3 4'"));
}

TEST(RobotDescription, NumbersBeyondARobotsSizeAreAWarningOrAnError) {
  const auto far = [](const std::string& x) {
    return hinge(inertial(), "<origin xyz='0 " + x + " 0'/>");
  };
  EXPECT_THAT(warnings(far("1000")), IsEmpty());
  EXPECT_THAT(warnings(far("2e6")),
              ElementsAre("URDF:5: joint j: <origin> xyz: 2e+06 m is beyond 1e+06 m; is the unit "
                          "right?"));
  EXPECT_EQ(urdfError(far("1e300")),
            "URDF:5: joint j: <origin> xyz: expected a number up to "
            "1e50, got 1e+300 m; correct it, or its unit");
  EXPECT_THAT(warnings(hinge(inertial("1e10"))), ElementsAre(HasSubstr("1e+10 kg is beyond")));
  EXPECT_THAT(urdfError(hinge(inertial("1e308"))), HasSubstr("link bob: <mass> value: expected"));
  EXPECT_THAT(urdfError(hinge(inertial("1", "-1e200"))), HasSubstr("<inertia> ixx: expected"));
  EXPECT_THAT(urdfError(hinge(inertial("1", "1", "<origin xyz='0 0 1e150'/>"))),
              HasSubstr("link bob: <origin> xyz: expected"));
  EXPECT_THAT(warnings(hinge(inertial(), "<origin rpy='0 90 0'/>")),
              ElementsAre(AllOf(HasSubstr("joint j: <origin> rpy"), HasSubstr("unit"))));

  // the greatest numbers that are taken give finite torques
  const std::string far_and_heavy = hinge(inertial("1e50"), "<origin xyz='1e50 1e50 1e50'/>");
  EXPECT_TRUE(someTorques(chainFromUrdf(far_and_heavy)).allFinite());
}

// --- transmissions ---

std::string transmission(const std::string& actuator,
                         const std::string& joints = "<joint name='j'/>") {
  return "<transmission name='t'><type>transmission_interface/SimpleTransmission</type>" + joints +
         "<actuator name='m'>" + actuator + "</actuator></transmission>\n";
}

RobotDescription driven(const std::string& transmissions) {
  return robotFromUrdf(robot(link("base") + link("a") + link("b") +
                             joint("j", "continuous", "base", "a", "") +
                             joint("k", "continuous", "a", "b", "") + transmissions));
}

TEST(RobotDescription, TransmissionsStateRotorInertia) {
  const auto rotor = [](const std::string& transmissions) {
    const RobotDescription tree = driven(transmissions);
    EXPECT_THAT(tree.warnings, IsEmpty());
    EXPECT_EQ(tree.joints[1].rotor_inertia, 0);
    return tree.joints[0].rotor_inertia;
  };
  const std::string ros =
      "<mechanicalReduction> 100 </mechanicalReduction><motorInertia>3e-5</motorInertia>";
  const std::string drake = "<drake:gear_ratio value='-50'/><drake:rotor_inertia value='2e-5'/>";
  EXPECT_DOUBLE_EQ(rotor(transmission(ros)), 0.3);
  EXPECT_DOUBLE_EQ(rotor(transmission(drake)), 0.05);
  EXPECT_DOUBLE_EQ(rotor(transmission("<motorInertia>3e-5</motorInertia>")), 3e-5);
  // the ratio on the joint, or on the transmission itself
  EXPECT_DOUBLE_EQ(rotor(transmission("<motorInertia>1</motorInertia>",
                                      "<joint name='j'><mechanicalReduction>3</mechanicalReduction>"
                                      "</joint>")),
                   9);
  EXPECT_DOUBLE_EQ(
      rotor(transmission("<motorInertia>1</motorInertia>",
                         "<joint name='j'/><mechanicalReduction>3</mechanicalReduction>")),
      9);
  EXPECT_DOUBLE_EQ(rotor(transmission(ros) + transmission(drake)), 0.35);  // two motors
  EXPECT_EQ(rotor(transmission("<mechanicalReduction>100</mechanicalReduction>")), 0);
}

TEST(RobotDescription, RotorInertiaThatCannotBeReadIsAWarning) {
  const auto warning = [](const std::string& transmissions) {
    const RobotDescription tree = driven(transmissions);
    EXPECT_EQ(tree.joints[0].rotor_inertia, 0);
    return tree.warnings.size() == 1 ? tree.warnings[0] : std::to_string(tree.warnings.size());
  };
  const std::string motor = "<motorInertia>3e-5</motorInertia>";
  EXPECT_EQ(warning(transmission(motor + "<mechanicalReduction>1:50</mechanicalReduction>")),
            "URDF:8: transmission t: <mechanicalReduction>: expected a finite number, got '1:50'; "
            "its rotor inertia isn't read");
  EXPECT_THAT(warning(transmission("<motorInertia/>")), HasSubstr("got ''"));
  EXPECT_THAT(warning(transmission("<motorInertia>-1</motorInertia>")), HasSubstr("got -1.0"));
  EXPECT_THAT(warning(transmission(motor + "<mechanicalReduction>1e40</mechanicalReduction>")),
              HasSubstr("expected a number >= 0"));
  EXPECT_THAT(warning(transmission(motor + "<drake:rotor_inertia value='4e-5'/>")),
              HasSubstr("expected the number stated before, got '4e-5'"));
  EXPECT_THAT(warning(transmission(motor, "<joint name='j'/><joint name='k'/>")),
              HasSubstr("<joint>: expected one, got 2"));
  EXPECT_THAT(warning(transmission(motor, "<joint name='x'/>")), HasSubstr("got 'x'"));
  EXPECT_THAT(warning(transmission(motor, "<joint/>")), HasSubstr("attribute 'name'"));
}

TEST(RobotDescription, NegativeDampingIsAWarning) {
  EXPECT_THAT(warnings(hinge(inertial(), "<dynamics damping='-0.1'/>")),
              ElementsAre(HasSubstr("URDF:5: joint j: <dynamics>: negative damping")));
}

// --- names that aren't understood ---

TEST(RobotDescription, MisspeltNamesAreAWarningWithTheNameThatWasMeant) {
  const std::string offset = inertial("2", "0.1", "<orgin xyz='0.1 0.2 0.3'/>");
  EXPECT_THAT(warnings(hinge(offset)),
              ElementsAre("URDF:4: link bob: <orgin> isn't read; did you mean <origin>?"));
  EXPECT_THAT(warnings(hinge(inertial() + "<inertal/>")),
              ElementsAre("URDF:4: link bob: <inertal> isn't read; did you mean <inertial>?"));
  EXPECT_THAT(warnings(hinge(inertial(), "<axes xyz='0 0 1'/>")),
              ElementsAre("URDF:5: joint j: <axes> isn't read; did you mean <axis>?"));
  EXPECT_THAT(warnings(hinge(inertial(), "<origin xzy='0 0 1'/>")),
              ElementsAre("URDF:5: joint j: <origin> xzy isn't read; did you mean xyz?"));
  EXPECT_THAT(warnings(hinge(replaced(inertial(), "<inertia ", "<inertia iyx='0' "))),
              ElementsAre("URDF:4: link bob: <inertia> iyx isn't read; did you mean ixy?"));
  EXPECT_THAT(warnings(hinge(inertial(), "<Origin xyz='0 0 1'/>")),
              ElementsAre("URDF:5: joint j: <Origin> isn't read; did you mean <origin>?"));
  EXPECT_THAT(warnings(hinge(inertial(), "<dynamics dampng='1'/>")),
              ElementsAre("URDF:5: joint j: <dynamics> dampng isn't read; did you mean damping?"));
  EXPECT_THAT(warnings(hinge(inertial(), "<limit effort='1' velocity='1' uper='1'/>")),
              ElementsAre("URDF:5: joint j: <limit> uper isn't read; did you mean upper?"));
  EXPECT_THAT(warnings(hinge(inertial(), "<mimick joint='j'/>")),
              ElementsAre("URDF:5: joint j: <mimick> isn't read; did you mean <mimic>?"));
  EXPECT_THAT(warnings(robot(link("base", "") + link("bob") + "<lnik name='x'/>\n" +
                             joint("j", "continuous", "base", "bob", ""))),
              ElementsAre("URDF:5: robot: <lnik> isn't read; did you mean <link>?"));
}

TEST(RobotDescription, UnknownNamesAreAWarningOnceEach) {
  EXPECT_THAT(
      warnings(hinge("<inertial><com xyz='1 0 0'/><mass value='1'/><inertia ixx='1' ixy='0' "
                     "ixz='0' iyy='1' iyz='0' izz='1'/></inertial>")),
      ElementsAre("URDF:4: link bob: <com> isn't read; read in <inertial>: <origin>, "
                  "<mass>, <inertia>"));
  EXPECT_THAT(warnings(hinge(inertial(), "<dynamics spring_stiffness='3'/>")),
              ElementsAre("URDF:5: joint j: <dynamics> spring_stiffness isn't read; read: damping, "
                          "friction"));
  const std::string odd = inertial() + "<wheel/><wheel/>";
  EXPECT_THAT(
      warnings(robot(link("base", odd) + link("bob", odd) +
                     joint("j", "continuous", "base", "bob", ""))),
      ElementsAre("URDF:3: link base: <wheel> isn't read; read in <link>: <inertial> (and 3 "
                  "more)"));
  EXPECT_THAT(warnings(hinge(inertial() + "left over -->")),
              ElementsAre("URDF:4: link bob: text in <link> isn't read"));
}

TEST(RobotDescription, NotTooManyWarningsAreKept) {
  std::string many;
  for (int i = 0; i < 1000; ++i) {
    many += "<wheel_" + std::to_string(i) + "/>";
  }
  const auto texts = warnings(hinge(inertial() + many));
  EXPECT_THAT(texts, SizeIs(101));
  EXPECT_EQ(texts.back(), "URDF: 900 more warnings aren't listed");
}

TEST(RobotDescription, WhatOthersReadIsNoWarning) {
  const std::string looks =
      "<visual><geometry><mesh/></geometry><orgin/></visual><collision/><sensor/><drake:x/>";
  const std::string urdf =
      robot(link("base", looks) + link("bob", looks + inertial()) +
            joint("j", "continuous", "base", "bob",
                  "<calibration rising='0'/><safety_controller k_velocity='1'/>"
                  "<limit effort='1' velocity='1'/><drake:controller_gains p='1'/>") +
            "<material name='m'/><gazebo><plugin/></gazebo><transmission/><ros2_control/>"
            "<!-- a comment --><drake:joint/>");
  EXPECT_THAT(warnings(replaced(urdf, "<robot ", "<robot xmlns:drake='d' xmlns='u' d:x='1' ")),
              IsEmpty());
}

TEST(RobotDescription, WhatAFixedJointDoesNotNeedIsNotRead) {
  const std::string urdf =
      robot(link("a") + link("b") + link("c") + joint("j", "continuous", "a", "b", "") +
            joint("weld", "fixed", "b", "c",
                  "<axis xyz='0 0 0'/><limit/><mimic/><dynamics damping='x'/>"));
  EXPECT_EQ(urdfError(urdf), "no error");
  EXPECT_THAT(warnings(urdf), IsEmpty());
}

TEST(RobotDescription, LeftOverXacroIsAWarning) {
  const std::string urdf = replaced(hinge(inertial()), "</robot>",
                                    "<xacro:property name='r' value='2'/>\n<xacro:wheel/></robot>");
  EXPECT_THAT(warnings(urdf), ElementsAre("URDF:6: robot: <xacro:property> isn't read; expand the "
                                          "file with xacro first (and 1 more)"));
  EXPECT_EQ(someTorques(chainFromUrdf(urdf)), someTorques(chainFromUrdf(hinge(inertial()))));
}

TEST(RobotDescription, MissingNamesAreFoundAmongTheMisspelt) {
  EXPECT_THAT(urdfError(hinge("<inertial><mass value='1'/><inertai/></inertial>")),
              HasSubstr("expected <inertia>, got none; is it misspelt as <inertai>?"));
  EXPECT_THAT(urdfError(hinge("<inertial><mass vlaue='1'/></inertial>")),
              HasSubstr("expected attribute 'value', got none; is it misspelt as 'vlaue'?"));
  EXPECT_THAT(urdfError(robot(link("base") + joint("j", "fixed", "bsae", "base", ""))),
              HasSubstr("expected a link of the robot, got 'bsae'; did you mean base?"));
}

TEST(RobotDescription, KnownAttributesAreNoMisspeltOnes) {
  const std::string urdf = hinge(inertial());
  const std::size_t at = urdf.find(" ixy=");
  const std::string without = urdf.substr(0, at) + urdf.substr(urdf.find(" ixz=", at));
  EXPECT_THAT(urdfError(without), HasSubstr("expected attribute 'ixy', got none; add it"));
  EXPECT_EQ(urdfError(without.substr(0, at) + " ixy='0'" + without.substr(at)), "no error");
}

TEST(RobotDescription, LimitsOfMinusOneAreNoLimits) {
  const auto of = [](const char* limit) {
    return hinge(inertial(), "<limit velocity='2' effort='" + std::string(limit) + "'/>");
  };
  const std::string urdf = of("-1");
  EXPECT_THAT(warnings(urdf),
              ElementsAre(HasSubstr("<limit> effort: -1 is taken as no limit; state "
                                    "the limit, or 0 where it is unknown")));
  EXPECT_EQ(chainFromUrdf(urdf).joints()[0].limits.effort, std::numeric_limits<double>::infinity());
  EXPECT_EQ(chainFromUrdf(urdf).joints()[0].limits.velocity, 2);
  EXPECT_THAT(warnings(of("0")), IsEmpty());
  EXPECT_THAT(warnings(of("5")), IsEmpty());
}

TEST(RobotDescription, LimitsOfZeroAreNotStated) {
  const std::string urdf =
      replaced(hinge(inertial(),
                     "<limit lower='0' upper='0' velocity='0' effort='0' acceleration='0' "
                     "deceleration='0' jerk='0'/>"),
               "<robot", "<robot version='1.2'");
  EXPECT_THAT(warnings(urdf), IsEmpty());
  const JointLimits limits = chainFromUrdf(urdf).joints()[0].limits;
  for (const double limit : {-limits.lower, limits.upper, limits.velocity, limits.effort,
                             limits.acceleration, limits.deceleration, limits.jerk}) {
    EXPECT_EQ(limit, std::numeric_limits<double>::infinity());
  }
}

TEST(RobotDescription, RepeatedAttributesAreAnError) {
  EXPECT_THAT(urdfError(replaced(hinge(inertial()), "mass value='2'", "mass value='2' value='3'")),
              HasSubstr("URDF:4: robot description: expected well-formed XML"));
}

// --- what is missing or malformed ---

TEST(RobotDescriptionError, NoUrdf) {
  EXPECT_EQ(urdfError(""),
            "URDF: robot description: expected the text of a URDF, got an empty text; give the "
            "robot's URDF");
  EXPECT_THAT(urdfError(" \n\t"), HasSubstr("got an empty text"));
  EXPECT_THAT(urdfError("/robots/ur10.urdf"),
              AllOf(HasSubstr("'/robots/ur10.urdf'"), HasSubstr("not its file name")));
}

TEST(RobotDescriptionError, BrokenXmlNamesTheLine) {
  EXPECT_THAT(urdfError("<robot name='r'>\n<link name='a'>\n"),
              AllOf(HasSubstr("URDF:2: "), HasSubstr("expected well-formed XML")));
  EXPECT_THAT(urdfError(arm().substr(0, 400)), HasSubstr("expected well-formed XML"));
}

TEST(RobotDescriptionError, TruncatedDescriptionIsNeverRead) {
  const std::string whole = arm();
  const std::size_t end = whole.rfind("</robot>");
  for (std::size_t size = 0; size < end + 7; size += 3) {
    EXPECT_THAT(urdfError(whole.substr(0, size)), HasSubstr("robot description: expected"))
        << "first " << size << " characters";
  }
}

TEST(RobotDescriptionError, OtherXml) {
  EXPECT_THAT(urdfError("<?xml version='1.0'?>\n<sdf version='1.6'/>"),
              HasSubstr("URDF:2: robot description: expected <robot>, got <sdf>"));
  EXPECT_THAT(urdfError("<robot name='r'/>"), HasSubstr("expected at least one <link>, got none"));
  EXPECT_THAT(urdfError("<robot><link name='a'/></robot>"),
              HasSubstr("robot: <robot>: expected attribute 'name', got none"));
}

TEST(RobotDescriptionError, XacroMustBeExpandedFirst) {
  EXPECT_THAT(urdfError("<robot name='r' xmlns:xacro='x'>\n<xacro:include filename='f'/></robot>"),
              AllOf(HasSubstr("expected at least one <link>, got none"),
                    HasSubstr("expand the file with xacro")));
}

TEST(RobotDescriptionError, NamesMustBeGivenAndUnique) {
  EXPECT_THAT(urdfError(robot(link(""))), HasSubstr("URDF:3: <link> name: expected a name"));
  EXPECT_THAT(urdfError(robot("<link/>")), HasSubstr("<link>: expected attribute 'name'"));
  EXPECT_THAT(urdfError(robot(link("a") + link("a"))),
              HasSubstr("URDF:4: link a: name: expected a name of its own, got the one of line 3"));
  EXPECT_THAT(urdfError(arm("", link("c") + joint("elbow", "fixed", "tool", "c", ""))),
              HasSubstr("joint elbow: name: expected a name of its own"));
}

TEST(RobotDescriptionError, LinksMustBeATree) {
  const std::string two = link("a") + link("b") + joint("ab", "fixed", "a", "b", "");
  EXPECT_THAT(urdfError(robot(two + link("c"))),
              AllOf(HasSubstr("root: expected one link"), HasSubstr("got 2: a, c")));
  EXPECT_THAT(urdfError(robot(two + joint("ba", "fixed", "b", "a", ""))), HasSubstr("got 0"));
  EXPECT_THAT(urdfError(robot(two + link("c") + joint("ba", "fixed", "b", "a", ""))),
              AllOf(HasSubstr("link a: place in the tree"), HasSubstr("got a loop of joints")));
  EXPECT_THAT(urdfError(robot(two + link("c") + joint("cb", "fixed", "c", "b", ""))),
              AllOf(HasSubstr("joint cb: <child>"), HasSubstr("'b', which has one")));
  EXPECT_THAT(urdfError(robot(two + joint("bx", "fixed", "b", "x", ""))),
              HasSubstr("joint bx: <child>: expected a link of the robot, got 'x'"));
  EXPECT_THAT(urdfError(robot(two + "<joint name='j' type='fixed'/>")),
              HasSubstr("joint j: <joint>: expected <parent>, got none"));
}

TEST(RobotDescriptionError, ZeroAxisNamesTheJoint) {
  EXPECT_THAT(urdfError(arm("<axis xyz='0 0 0'/>")),
              AllOf(HasSubstr("joint elbow: <axis> xyz: expected a direction, got the zero vector"),
                    HasSubstr("for example 0 0 1")));
  EXPECT_THAT(urdfError(arm("<axis/>")),
              HasSubstr("joint elbow: <axis>: expected attribute 'xyz', got none"));
}

TEST(RobotDescriptionError, NegativeMassNamesTheLink) {
  EXPECT_THAT(urdfError(robot(link("base") + link("a", inertial("-1.5")) +
                              joint("j", "continuous", "base", "a", ""))),
              HasSubstr("URDF:4: link a: mass: expected a number >= 0 [kg], got -1.5"));
}

TEST(RobotDescriptionError, NumbersMustNotBeMissing) {
  const auto with = [](const std::string& body) {
    return urdfError(
        robot(link("base") + link("a", body) + joint("j", "continuous", "base", "a", "")));
  };
  EXPECT_THAT(with("<inertial><mass value='1'/></inertial>"),
              HasSubstr("link a: <inertial>: expected <inertia>, got none"));
  EXPECT_THAT(with("<inertial><inertia ixx='1'/></inertial>"),
              HasSubstr("link a: <inertial>: expected <mass>, got none"));
  EXPECT_THAT(with("<inertial><mass/></inertial>"),
              HasSubstr("link a: <mass>: expected attribute 'value', got none"));
  EXPECT_THAT(with("<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>"),
              HasSubstr("link a: <inertia>: expected attribute 'ixy', got none"));
  EXPECT_THAT(with(inertial() + inertial()),
              HasSubstr("link a: <inertial>: expected at most one, got 2"));
}

TEST(RobotDescriptionError, LimitsOfRevoluteAndPrismaticJointsAreNeeded) {
  const auto with = [](const std::string& content) {
    return urdfError(
        robot(link("base") + link("a") + joint("j", "revolute", "base", "a", content)));
  };
  EXPECT_THAT(with(""), AllOf(HasSubstr("joint j: <joint>: expected <limit>, got none"),
                              HasSubstr("continuous")));
  EXPECT_THAT(with("<limit lower='0' upper='1' effort='1'/>"),
              HasSubstr("joint j: <limit>: expected attribute 'velocity', got none"));
  EXPECT_THAT(with("<limit lower='3' upper='1' effort='1' velocity='1'/>"),
              HasSubstr("joint j: position limits: expected lower <= upper"));
}

// --- texts that aren't a URDF, or hostile ones ---

TEST(RobotDescription, TextThatIsNoXmlIsNotQuoted) {
  for (const std::string secret : {"root:x:0:0:root:/root:/bin/bash\n", "password.xml\nroot:x"}) {
    EXPECT_THAT(urdfError(secret),
                AllOf(HasSubstr("a text that doesn't start with '<'"), Not(HasSubstr("root:"))));
  }
}

TEST(RobotDescription, NothingMayFollowTheRobot) {
  const std::string after = arm() + "<robot name='second'/>";
  EXPECT_THAT(urdfError(after), HasSubstr("expected nothing after </robot>, got <robot>"));
  EXPECT_THAT(urdfError(arm() + "more"), HasSubstr("expected "));
  EXPECT_THAT(urdfError(arm() + std::string("\0 <x/>", 6)),
              HasSubstr("URDF:11: robot description: expected XML in UTF-8, got a byte 0"));
  EXPECT_EQ(urdfError(arm() + "\n<!-- the end -->\n"), "no error");
}

TEST(RobotDescription, NamesWithControlCharactersAreAnError) {
  const std::string red = "&#27;[31m";
  EXPECT_THAT(urdfError(replaced(arm(), "elbow", "elbow" + red)),
              HasSubstr("joint: name: expected UTF-8 text without control characters, got "
                        "'elbow\\x1b[31m'"));
  EXPECT_THAT(urdfError(replaced(arm(), "'tool'", "'to\nol'")), HasSubstr("got 'to\\nol'"));
  EXPECT_THAT(urdfError(replaced(arm(), "'arm'", "'\xE4rm'")), HasSubstr("got '\\xe4rm'"));
  EXPECT_EQ(urdfError(replaced(arm(), "elbow", "\xC3\xA4llbogen")), "no error");
}

TEST(RobotDescription, MessagesAreShortAndPrintable) {
  const std::string name = "<b>" + std::string(100000, 'x') + "\x1b[2J";
  for (const std::string& urdf :
       {replaced(arm(), "revolute", "&lt;" + std::string(100000, 'x') + "&#27;[2J"),
        replaced(arm(), "'elbow'", "'" + std::string(100000, 'x') + "' tpye='1'"),
        replaced(arm(), "parent link='upper'", "parent link='" + std::string(100000, 'x') + "'"),
        replaced(arm(), "rpy='1 2 3'", "rpy='" + std::string(100000, '\t') + "x'")}) {
    std::string texts = urdfError(urdf);
    if (texts == "no error") {
      texts = joined(warnings(urdf));
      EXPECT_NE(texts, "");
    }
    EXPECT_LT(texts.size(), 3000U);
    EXPECT_TRUE(isPrintable(texts));
  }
}

/// Time of this process [s], which other processes don't lengthen.
double processorTime() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A hinge, then `count` links, each welded to the one before; of the given mass each.
std::string longChain(int count, const std::string& start, const std::string& prefix) {
  std::string urdf;
  for (int i = 0; i < count; ++i) {
    const std::string name = prefix + std::to_string(i);
    urdf +=
        "<link name='" + name +
        "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
        "izz='1'/></inertial></link>" +
        joint("weld_" + name, "fixed", i == 0 ? start : prefix + std::to_string(i - 1), name, "");
  }
  return urdf;
}

// Quadratic algorithms took half a minute, recursive ones overflowed the stack.
TEST(RobotDescription, LongChainsOfFixedJointsAreReadInLinearTime) {
  constexpr int kCount = 20000;
  constexpr double kSeconds = 10;  // measured: below 1
  const std::string urdf =
      robot(link("base", "") + link("bob") + joint("j", "continuous", "base", "bob", "") +
            longChain(kCount, "bob", "a") + longChain(kCount, "bob", "b"));
  const double before = processorTime();
  const Chain chain = chainFromUrdf(urdf);
  EXPECT_LT(processorTime() - before, kSeconds);
  EXPECT_NEAR(chain.links()[0].mass, 2 + 2 * kCount, 1e-6);
}

TEST(RobotDescription, LongChainsOfMimicJointsAreReadInLinearTime) {
  constexpr int kCount = 20000;
  constexpr double kSeconds = 10;
  std::string fingers;
  for (int i = 0; i < kCount; ++i) {
    const std::string name = std::to_string(i);
    fingers += link("finger" + name) +
               joint("follower" + name, "continuous", "bob", "finger" + name,
                     i == 0 ? "" : "<mimic joint='follower" + std::to_string(i - 1) + "'/>");
  }
  UrdfOptions options;
  options.tip = "bob";
  const std::string urdf =
      robot(link("base", "") + link("bob") + joint("j", "continuous", "base", "bob", "") + fingers);
  const double before = processorTime();
  EXPECT_NEAR(chainFromUrdf(urdf, options).links()[0].mass, 2 + 2 * kCount, 1e-6);
  EXPECT_LT(processorTime() - before, kSeconds);
}

TEST(RobotDescription, DeeplyNestedElementsAreAnError) {
  std::string nested;
  for (int i = 0; i < 100000; ++i) {
    nested += "<a>";
  }
  EXPECT_THAT(urdfError("<robot name='r'>" + nested), HasSubstr("expected well-formed XML"));
}

}  // namespace chain_dynamics::robot_description_test
