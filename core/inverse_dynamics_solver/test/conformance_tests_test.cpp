// SPDX-License-Identifier: Apache-2.0
/// @file
/// The conformance tests find what they are there for: for each fault, the test that must fail
/// does.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <string>

namespace {

struct Fault {
  const char* fault;
  const char* test;  // empty: all tests pass
};

std::ostream& operator<<(std::ostream& stream, const Fault& fault) { return stream << fault.fault; }

class ConformanceTests : public ::testing::TestWithParam<Fault> {};
class ConformanceTestsOfPayloads : public ::testing::TestWithParam<Fault> {};

/// Runs the test that must fail, or all of them, with the fault.
void expectFound(const std::string& program, const std::string& suite, const Fault& fault) {
  const std::string command = "FAULT=\"" + std::string(fault.fault) + "\" " + program +
                              " --gtest_output= --gtest_filter='*." +
                              (fault.test[0] == '\0' ? "" : fault.test + std::string("/")) +
                              "*' 2>&1";
  FILE* const pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) output.push_back(static_cast<char>(c));
  const int status = pclose(pipe);
  ASSERT_TRUE(WIFEXITED(status)) << output;

  // Allocations can't be counted under a sanitizer.
  if (fault.test[0] != '\0' && output.find("[  SKIPPED ] " + suite) != std::string::npos) {
    GTEST_SKIP() << output;
  }
  const bool found = output.find("[  FAILED  ] " + suite) != std::string::npos;
  EXPECT_EQ(found, fault.test[0] != '\0') << output;
  EXPECT_EQ(WEXITSTATUS(status) != 0, found) << output;
}

/// The name of a test is its fault in letters: `NanIsSwallowed`.
std::string nameOf(const ::testing::TestParamInfo<Fault>& fault) {
  std::string name = fault.param.fault[0] == '\0' ? "none" : "";
  bool upper = false;
  for (const char* c = fault.param.fault; *c != '\0'; ++c) {
    if (std::isalpha(*c)) name.push_back(upper ? static_cast<char>(std::toupper(*c)) : *c);
    upper = *c == ' ';
  }
  return name;
}

TEST_P(ConformanceTests, FindTheFault) {
  expectFound(TWO_LINK_TEST_PROGRAM, "TwoLink", GetParam());
}

TEST_P(ConformanceTestsOfPayloads, FindTheFault) {
  expectFound(CARRYING_TEST_PROGRAM, "Carrying", GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Faults, ConformanceTests,
    ::testing::Values(
        Fault{"", ""},  //
        Fault{"two joints of one name", "JointNamesAreDistinctAndCounted"},
        Fault{"torques change with a turn", "ContinuousJointsAreTheSameAfterATurn"},
        Fault{"a result is not finite", "ResultsHaveTheSizesOfTheRobotAndAreFinite"},
        Fault{"an entry is not written", "ResultsByValueEqualResultsInMemoryOfTheCaller"},
        Fault{"last state of a batch is missed", "BatchEqualsSingleCalls"},
        Fault{"layouts are ignored", "BatchesOfAnyLayoutGiveTheBitsOfColumns"},
        Fault{"parts of a batch differ", "ThreadsThatShareABatchGiveTheBitsOfOne"},
        Fault{"allocates", "CallsIntoMemoryOfTheCallerDoNotAllocate"},
        Fault{"currents allocate", "CallsIntoMemoryOfTheCallerDoNotAllocate"},
        Fault{"state is shared", "ManyThreadsGetTheNumbersOfOne"},
        Fault{"NaN is swallowed", "NanGoesToEveryEntryThatDependsOnIt"},
        Fault{"members set before checks", "FailedInitializeLeavesTheSolverAsItWas"},
        Fault{"unknown parameters are refused too late", "UnknownParameterIsAWarningOrARefusal"},
        Fault{"first gravity is kept", "InitializingAgainTakesEffect"},
        Fault{"namespace is ignored", "ParametersAreReadBelowTheNamespace"},
        Fault{"any description will do", "RobotDescriptionComesFromArgumentOrParameter"},
        Fault{"torques lack a term", "TorquesAreTheSumOfTheirTerms"},
        Fault{"components differ", "ComponentsEqualTheSingleMethods"},
        Fault{"torques are not linear", "TorquesAreLinearInAcceleration"},
        Fault{"Coriolis torques are linear", "CoriolisTorquesAreQuadraticInVelocity"},
        Fault{"gravity torques have an offset", "GravityTorquesAreProportionalToGravity"},
        Fault{"another default gravity", "GravityPointsDownByDefault"},
        Fault{"gravity torques have no potential", "GravityTorquesHaveASymmetricJacobian"},
        Fault{"inertia is not symmetric", "PhysicalInertiaIsSymmetricPositiveDefinite"},
        Fault{"inertia is not positive", "PhysicalInertiaIsSymmetricPositiveDefinite"},
        Fault{"Coriolis torques with the wrong sign", "PowerIsTheRateOfKineticEnergy"},
        Fault{"friction can't be switched off", "FrictionCanBeSwitchedOff"},
        Fault{"friction overflows", "FrictionIsFiniteAtAnyVelocity"},
        Fault{"a drive gain is zero", "MotorCurrentsTimesDriveGainsAreTorques"},
        Fault{"tip is that of the first link", "TipJacobianIsTheDerivativeOfTheTipPose"},
        Fault{"Jacobian has angular rows first", "TipJacobianIsTheDerivativeOfTheTipPose"},
        Fault{"derivative of the Jacobian for the first joint alone",
              "TipJacobianDerivativeIsItsRate"},
        Fault{"frame of a wrench is ignored", "WrenchAddsItsPowerPerVelocity"},
        Fault{"wrench acts on the tip", "WrenchAddsItsPowerPerVelocity"},
        Fault{"NaN in a wrench is swallowed", "NanInAWrenchGivesNan"},
        Fault{"Coriolis matrix is another one with the same product",
              "CoriolisMatrixIsThatOfChristoffelsSymbols"},
        Fault{"Coriolis matrix is doubled", "RateOfInertiaIsTheCoriolisMatrixPlusItsTranspose"},
        Fault{"Coriolis matrix is transposed", "CoriolisMatrixIsThatOfChristoffelsSymbols"},
        Fault{"kinetic energy is doubled", "EnergyGrowsWithThePowerOfTheTorques"},
        Fault{"energies are refused without a reason", "EnergyGrowsWithThePowerOfTheTorques"},
        Fault{"potential energy falls", "EnergyGrowsWithThePowerOfTheTorques"},
        Fault{"derivatives lack gravity", "TorqueDerivativesAreThoseOfTheTorques"},
        Fault{"derivatives lack friction", "TorqueDerivativesIncludeFriction"},
        Fault{"regressor lacks gravity", "RegressorTimesParametersAreTheTorques"},
        Fault{"regressor has columns of another order", "RegressorTimesParametersAreTheTorques"},
        Fault{"accelerations without friction", "AccelerationsInvertTorques"}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Faults, ConformanceTestsOfPayloads,
    ::testing::Values(
        Fault{"", ""},  //
        Fault{"bodies interact", "BodiesAddWhatEachAddsAlone"},
        Fault{"bodies leave a trace", "NumbersDependOnTheBodiesThatAreThereAlone"},
        Fault{"parameters state no body", "BodyOfParametersEqualsOneThatIsSet"},
        Fault{"inertia of a body is negative", "InertiaWithABodyIsAsPhysicalAsWithout"},
        Fault{"the base accelerates backwards", "GravityThatIsSetEqualsThatOfInitialize"},
        Fault{"allocates with a body", "CallsWithABodyNeitherAllocateNorMakeASystemCall"},
        Fault{"allocates while the robot changes",
              "CallsDoNotAllocateWhileAnotherThreadChangesTheRobot"},
        Fault{"a call mixes two robots",
              "ThreadsThatComputeWhileTheRobotChangesGetOldOrNewNumbers"},
        Fault{"states of a batch mix two robots",
              "ThreadsThatComputeWhileTheRobotChangesGetOldOrNewNumbers"},
        Fault{"threads of a batch mix two robots", "ThreadsThatShareABatchComputeWithOneRobot"}),
    nameOf);

}  // namespace
