// SPDX-License-Identifier: Apache-2.0

// The fast kernels of one instruction set for many states: see kernels.cpp. A source of its own, so
// that both are compiled at the same time.

#include "gram.hpp"
#include "many_dynamics.hpp"
#include "many_kinematics.hpp"
#include "many_states.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

void sineCosineOfEach(int count, const double* angle, const double* quarter_turns, double* sine,
                      double* cosine) {
  for (int k = 0; k < count; ++k) {
    Pack s;
    Pack c;
    BitsOf<Pack> beyond{};
    sineCosine<Scheme::kHorner>(all<Pack>(angle[k]), all<Pack>(quarter_turns[k]), s, c, beyond);
    sine[k] = s[kWidth - 1];
    cosine[k] = c[kWidth - 1];
    if (anyBeyond<Pack>(beyond)) {
      sineCosineBeyond(1, angle + k, quarter_turns + k, 1, sine + k, cosine + k);
    }
  }
}

template <int N>
constexpr ManyKernels kKernels = {torquesBatch<N>,
                                  coriolisBatch<N>,
                                  gravityBatch<N>,
                                  inertiaBatch,
                                  componentsBatch<N>,
                                  frictionBatch<N>,
                                  forwardDynamicsBatch<N>,
                                  regressorBatch<N>,
                                  torqueDerivativesBatch,
                                  coriolisMatrixBatch,
                                  tipPoseBatch,
                                  tipJacobianBatch,
                                  tipJacobianDerivativeBatch,
                                  gramOfStates,
                                  sineCosineOfEach};

}  // namespace

const ManyKernels& CHAIN_DYNAMICS_MANY_KERNELS(int joints) {
  return joints == 6 ? kKernels<6> : joints == 7 ? kKernels<7> : kKernels<0>;
}

}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
