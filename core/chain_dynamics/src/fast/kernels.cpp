// SPDX-License-Identifier: Apache-2.0

// The fast kernels of one instruction set for one state. Compiled once for each set, with
// CHAIN_DYNAMICS_KERNELS the name of the function that gives the table. Everything else has internal
// linkage, and no header with functions but robot.hpp and math.h is used (coefficients.hpp has structs):
// the linker must not mix functions of different sets.

#include "one_state.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

constexpr Kernels kKernels = {CHAIN_DYNAMICS_KERNELS_NAME,
                              Structures::indexOf,
                              torquesOfState,
                              coriolisOfState,
                              gravityOfState,
                              inertiaOfState,
                              componentsOfState,
                              frictionOfState,
                              forwardDynamicsOfState,
                              regressorOfState,
                              torqueDerivativesOfState,
                              coriolisMatrixOfState,
                              tipPoseOfState,
                              tipJacobianOfState,
                              tipJacobianDerivativeOfState};

}  // namespace

const Kernels& CHAIN_DYNAMICS_KERNELS() { return kKernels; }

}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
