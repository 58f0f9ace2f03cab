// SPDX-License-Identifier: Apache-2.0

// The fast kernels of one instruction set. Compiled once for each, with CHAIN_DYNAMICS_KERNELS the
// name of the function that gives the table. Everything else has internal linkage, and no header
// but robot.hpp and math.h is used: the linker must not mix functions of different sets.

#include "friction.hpp"
#include "gravity_vector.hpp"
#include "inertia_matrix.hpp"
#include "lanes.hpp"
#include "linear_solve.hpp"
#include "regressor.hpp"
#include "torque_derivatives.hpp"
#include "torques.hpp"
#include "turns.hpp"

namespace chain_dynamics::fast {
namespace {

// ---------------------------------------------------------------- structures

/// Joints 2, 3, 4 (the first is 1) are parallel, and right angles elsewhere: Universal Robots.
/// Their description's right angles have nine digits.
using ParallelWrist = Known<6, 0x020022, 0x001100, 0x010010>;

/// Six joints, 2 and 3 parallel, right angles elsewhere: most industrial robots.
using SphericalWrist = Known<6, 0x010111, 0x011100, 0x010110>;

/// Seven joints at right angles: Panda, FR3, iiwa, Gen3.
using RightAngles = Known<7, 0x0111111, 0x0001101, 0x0111110>;

/// Six or seven joints that turn about any axes.
using AnySix = Known<6, 0x033333, 0x011111, 0x011111>;
using AnySeven = Known<7, 0x0333333, 0x0111111, 0x0111111>;

/// Six or seven joints that turn or slide.
using MixedSix = Known<6, 0x033333, 0x011111, 0x011111, true>;
using MixedSeven = Known<7, 0x0333333, 0x0111111, 0x0111111, true>;

template <typename V>
struct Recursions {
  void (*torques)(const Robot&, const State<V>&, const double* root, V* tau);
  void (*gravity)(const Robot&, const State<V>&, V* g);
  void (*inertia)(const Robot&, const State<V>&, const Entries<V>& H);
};

template <typename V>
constexpr Recursions<V> kRecursions[] = {
    {torques<AnyStructure, V>, gravity<AnyStructure, V>, inertia<AnyStructure, V>},
    {torques<ParallelWrist, V>, gravity<ParallelWrist, V>, inertia<ParallelWrist, V>},
    {torques<SphericalWrist, V>, gravity<SphericalWrist, V>, inertia<SphericalWrist, V>},
    {torques<RightAngles, V>, gravity<RightAngles, V>, inertia<RightAngles, V>},
    {torques<AnySix, V>, gravity<AnySix, V>, inertia<AnySix, V>},
    {torques<AnySeven, V>, gravity<AnySeven, V>, inertia<AnySeven, V>},
    {torques<MixedSix, V>, gravity<MixedSix, V>, inertia<MixedSix, V>},
    {torques<MixedSeven, V>, gravity<MixedSeven, V>, inertia<MixedSeven, V>},
};

// Identified models with parameters for each row.
template <typename V>
constexpr Recursions<V> kRecursionsByRow[] = {
    {torquesByRow<AnyStructure, V>, gravityByRow<AnyStructure, V>, inertiaByRow<AnyStructure, V>},
    {torquesByRow<ParallelWrist, V>, gravityByRow<ParallelWrist, V>,
     inertiaByRow<ParallelWrist, V>},
};

// Of one state, with one set of parameters or one for each row.
using Derivatives = void (*)(const Robot&, const State<double>&, const double* root,
                             const DerivativeEntries&);
constexpr Derivatives kDerivatives[] = {
    torqueDerivatives<AnyStructure>,   torqueDerivatives<ParallelWrist>,
    torqueDerivatives<SphericalWrist>, torqueDerivatives<RightAngles>,
    torqueDerivatives<AnySix>,         torqueDerivatives<AnySeven>,
    torqueDerivatives<AnyStructure>,   torqueDerivatives<AnyStructure>};

int structureOf(const Robot& robot) {
  if (ParallelWrist::covers(robot)) return 1;
  if (robot.rows != nullptr) return 0;
  if (SphericalWrist::covers(robot)) return 2;
  if (RightAngles::covers(robot)) return 3;
  if (AnySix::covers(robot)) return 4;
  if (AnySeven::covers(robot)) return 5;
  return MixedSix::covers(robot) ? 6 : MixedSeven::covers(robot) ? 7 : 0;
}

template <typename V>
FAST_INLINE const Recursions<V>& recursionsOf(const Robot& robot, int structure) {
  return robot.rows != nullptr ? kRecursionsByRow<V>[structure] : kRecursions<V>[structure];
}

// ---------------------------------------------------------------- one state, or a pack of states

constexpr double kAtRest[kMaxJoints] = {};
constexpr double kNoGravity[3] = {};

template <typename V>
FAST_INLINE void gravityOf(const Robot& robot, int structure, const State<V>& state, V* g) {
  // parameters of gravity's own are those of all rows
  const bool by_row = robot.rows != nullptr && robot.gravity_bodies == nullptr;
  (by_row ? kRecursionsByRow<V> : kRecursions<V>)[structure].gravity(robot, state, g);
}

template <typename V>
FAST_INLINE void torquesOf(const Robot& robot, int structure, const State<V>& state, V* tau) {
  const Recursions<V>& recursions = recursionsOf<V>(robot, structure);
  if (robot.gravity_bodies == nullptr) {
    recursions.torques(robot, state, robot.root, tau);
    return;
  }
  V g[kMaxJoints];
  recursions.torques(robot, state, kNoGravity, tau);
  gravityOf(robot, structure, state, g);
  for (int i = 0; i < robot.joints; ++i) tau[i] += g[i];
}

template <typename V>
FAST_INLINE void coriolisOf(const Robot& robot, int structure, const State<V>& state, V* c) {
  recursionsOf<V>(robot, structure).torques(robot, state, kNoGravity, c);
}

// ---------------------------------------------------------------- one state

void torquesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                    const double* qdd, double* tau) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  if (robot.friction == nullptr) {
    torquesOf(robot, structure, State<double>{c.values, s.values, q, qd, qdd}, tau);
    return;
  }
  JointNumbers f;
  frictionNumbers(robot, qd, f.values);
  torquesOf(robot, structure, State<double>{c.values, s.values, q, qd, qdd}, tau);
  for (int i = 0; i < robot.joints; ++i) tau[i] += f.values[i];
}

void coriolisOfState(const Robot& robot, int structure, const double* q, const double* qd,
                     double* coriolis) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  coriolisOf(robot, structure, state, coriolis);
}

void gravityOfState(const Robot& robot, int structure, const double* q, double* g) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  gravityOf(robot, structure, State<double>{c.values, s.values, q, nullptr, nullptr}, g);
}

void inertiaOfState(const Robot& robot, int structure, const double* q, Matrices H) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, nullptr, nullptr};
  recursionsOf<double>(robot, structure)
      .inertia(robot, state, Entries<double>{H.data, H.row_step, H.column_step});
}

void componentsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                       Matrices H, double* coriolis, double* g) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  recursionsOf<double>(robot, structure)
      .inertia(robot, state, Entries<double>{H.data, H.row_step, H.column_step});
  coriolisOf(robot, structure, state, coriolis);
  gravityOf(robot, structure, state, g);
}

void forwardDynamicsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                            const double* tau, double* qdd) {
  const int n = robot.joints;
  JointNumbers c;
  JointNumbers s;
  JointNumbers bias;
  double H[kMaxJoints * kMaxJoints];
  double accelerating[kMaxJoints];
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  torquesOf(robot, structure, state, bias.values);
  for (int i = 0; i < n; ++i) accelerating[i] = tau[i] - bias.values[i];
  if (robot.friction != nullptr) {
    frictionNumbers(robot, qd, bias.values);
    for (int i = 0; i < n; ++i) accelerating[i] -= bias.values[i];
  }
  recursionsOf<double>(robot, structure).inertia(robot, state, Entries<double>{H, n, 1});
  (robot.rows != nullptr ? solveGeneral : solveSymmetric)(n, H, accelerating);
  for (int i = 0; i < n; ++i) qdd[i] = accelerating[i];
}

void regressorOfState(const Robot& robot, const double* q, const double* qd, const double* qdd,
                      double* Y, std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  regressor(robot, State<double>{c.values, s.values, q, qd, qdd}, Y, outer_step);
}

void torqueDerivativesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                              const double* qdd, double* by_q, double* by_qd, double* by_qdd,
                              std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, qdd};
  const bool own_gravity = robot.gravity_bodies != nullptr;
  kDerivatives[structure](robot, state, own_gravity ? kNoGravity : robot.root,
                          DerivativeEntries{by_q, by_qd, by_qdd, outer_step});
  if (own_gravity) addGravityDerivatives(robot, state, by_q, outer_step);
  if (robot.friction != nullptr) {
    frictionSlopes(robot, qd, c.values);
    for (int i = 0; i < robot.joints; ++i) by_qd[i + i * outer_step] += c.values[i];
  }
}

// ---------------------------------------------------------------- many states

/// Memory of one pack of states.
struct PackOfStates {
  Pack q[kMaxJoints], c[kMaxJoints], s[kMaxJoints], qd[kMaxJoints], qdd[kMaxJoints];
  State<Pack> state() const { return {c, s, q, qd, qdd}; }

  FAST_INLINE void readPositions(const Robot& robot, const Samples& from, const Lanes& lanes) {
    gather(robot, from, lanes, q);
    turnsOfPack(robot, q, c, s);
  }
  FAST_INLINE void readAtRest(const Robot& robot, const Samples& from, const Lanes& lanes) {
    gather(robot, from, lanes, qd);
    for (int i = 0; i < robot.joints; ++i) qdd[i] = Pack{};
  }
};

/// Longest chain whose matrices of one pack of states fit on the stack.
constexpr int kPackedMatrixJoints = 16;

FAST_INLINE void inertiaOfPack(const Robot& robot, int structure, const State<Pack>& state,
                               const Lanes& lanes, const Matrices& H) {
  const int n = robot.joints;
  Pack entries[kPackedMatrixJoints * kPackedMatrixJoints];

  // columns in turn, or rows, whichever stand side by side
  const bool columns = H.column_step != 1;
  const std::ptrdiff_t major_step = columns ? H.column_step : H.row_step;
  const std::ptrdiff_t minor_step = columns ? H.row_step : 1;
  recursionsOf<Pack>(robot, structure)
      .inertia(robot, state, Entries<Pack>{entries, columns ? 1 : n, columns ? n : 1});
  if (minor_step == 1 && major_step == n) {
    scatter(entries, n * n, lanes, H.data, 1, H.state_step);
    return;
  }
  for (int j = 0; j < n; ++j) {
    scatter(entries + std::ptrdiff_t{j} * n, n, lanes, H.data + j * major_step, minor_step,
            H.state_step);
  }
}

// For longer chains.
void inertiaOneByOne(const Robot& robot, int structure, std::ptrdiff_t states, const Samples& q,
                     Matrices H) {
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    double position[kMaxJoints];
    for (int i = 0; i < robot.joints; ++i) {
      position[i] = q.data[i * q.joint_step + k * q.state_step];
    }
    inertiaOfState(robot, structure, position, H);
    H.data += H.state_step;
  }
}

void torquesBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                  Samples qdd, Samples tau) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    gather(robot, qd, lanes, x.qd);
    gather(robot, qdd, lanes, x.qdd);
    x.readPositions(robot, q, lanes);
    torquesOf(robot, structure, x.state(), result);
    if (robot.friction != nullptr) {
      for (int i = 0; i < robot.joints; ++i) result[i] += frictionOfPack(robot, i, x.qd[i]);
    }
    scatter(robot, result, lanes, tau);
  });
}

void coriolisBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples c) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readAtRest(robot, qd, lanes);
    x.readPositions(robot, q, lanes);
    coriolisOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, c);
  });
}

void gravityBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples g) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readPositions(robot, q, lanes);
    gravityOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, g);
  });
}

void inertiaBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices H) {
  if (robot.joints > kPackedMatrixJoints) return inertiaOneByOne(robot, structure, states, q, H);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    x.readPositions(robot, q, lanes);
    inertiaOfPack(robot, structure, x.state(), lanes, H);
  });
}

void componentsBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                     Samples qd, Matrices H, Samples c, Samples g) {
  const bool packed = robot.joints <= kPackedMatrixJoints;
  if (!packed) inertiaOneByOne(robot, structure, states, q, H);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readAtRest(robot, qd, lanes);
    x.readPositions(robot, q, lanes);
    if (packed) inertiaOfPack(robot, structure, x.state(), lanes, H);
    coriolisOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, c);
    gravityOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, g);
  });
}

void frictionBatch(const Robot& robot, std::ptrdiff_t states, Samples qd, Samples f) {
  forEachPack(states, [&](const Lanes& lanes) {
    Pack x[kMaxJoints];
    gather(robot, qd, lanes, x);
    for (int i = 0; i < robot.joints; ++i) x[i] = frictionOfPack(robot, i, x[i]);
    scatter(robot, x, lanes, f);
  });
}

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

}  // namespace

const Kernels& CHAIN_DYNAMICS_KERNELS() {
  static constexpr Kernels kKernels = {CHAIN_DYNAMICS_KERNELS_NAME,
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
                                       torquesBatch,
                                       coriolisBatch,
                                       gravityBatch,
                                       inertiaBatch,
                                       componentsBatch,
                                       frictionBatch,
                                       sineCosineOfEach};
  return kKernels;
}

}  // namespace chain_dynamics::fast
