// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "inverse_dynamics_identification/arm_fit.hpp"
#include "measured_arm.hpp"

namespace inverse_dynamics_identification::arm_fit_test {

TEST(LeftOut, IsAFitToTheOtherBlocks) {
  const ArmFitter fitter(threeJointArm(0.6));
  for (const FrictionTerms terms : {FrictionTerms::kStep, FrictionTerms::kStribeck}) {
    SCOPED_TRACE(static_cast<int>(terms));
    std::vector<Motion> motions;
    std::vector<ArmSamples> blocks;
    for (unsigned seed = 1; seed <= 4; ++seed) motions.push_back(measured(terms, 500, seed));
    for (const Motion& motion : motions) blocks.push_back(samplesOf(motion));
    ArmFitOptions options;
    options.terms = terms;
    const ArmData data = fitter.data(blocks);
    const ArmFit all = fitter.fit(data, options);
    const std::vector<ArmFit> found = fitter.leftOut(all, data, options);
    ASSERT_EQ(found.size(), blocks.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      std::vector<ArmSamples> others = blocks;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const ArmFit fit = fitter.fit(others, options);
      const double error = errorOf(fitter, fit, motions[k]);
      const double gained = error - errorOf(fitter, all, motions[k]);  // by knowing the block
      EXPECT_GT(gained, 0);
      EXPECT_NEAR(errorOf(fitter, found[k], motions[k]), error, 0.2 * gained) << k;
    }
  }
}

}  // namespace inverse_dynamics_identification::arm_fit_test
