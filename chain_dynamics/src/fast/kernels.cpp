// SPDX-License-Identifier: Apache-2.0

// The fast kernels of one instruction set. Compiled once for each, with CHAIN_DYNAMICS_KERNELS the
// name of the function that gives the table. Everything else has internal linkage, and no header
// but robot.hpp and math.h is used: the linker must not mix functions of different sets.

#include "many_states.hpp"
#include "one_state.hpp"

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
constexpr Kernels kKernels = {CHAIN_DYNAMICS_KERNELS_NAME,
                              structureOf,
                              torquesOfState,
                              coriolisOfState,
                              gravityOfState,
                              inertiaOfState,
                              componentsOfState,
                              frictionOfState,
                              forwardDynamicsOfState,
                              regressorOfState,
                              torqueDerivativesOfState,
                              torquesBatch<N>,
                              coriolisBatch<N>,
                              gravityBatch<N>,
                              inertiaBatch<N>,
                              componentsBatch<N>,
                              frictionBatch<N>,
                              sineCosineOfEach};

}  // namespace

const Kernels& CHAIN_DYNAMICS_KERNELS(int joints) {
  return joints == 6 ? kKernels<6> : joints == 7 ? kKernels<7> : kKernels<0>;
}

}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
