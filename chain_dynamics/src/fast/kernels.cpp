// SPDX-License-Identifier: Apache-2.0

// The fast kernels of one instruction set. Compiled once for each, with CHAIN_DYNAMICS_KERNELS the
// name of the function that gives the table. Everything else has internal linkage, and no header
// but robot.hpp and math.h is used: the linker must not mix functions of different sets.

#include "elementary.hpp"
#include "recursion.hpp"

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
};

// Identified models with parameters for each row.
template <typename V>
constexpr Recursions<V> kRecursionsByRow[] = {
    {torquesByRow<AnyStructure, V>, gravityByRow<AnyStructure, V>, inertiaByRow<AnyStructure, V>},
    {torquesByRow<ParallelWrist, V>, gravityByRow<ParallelWrist, V>,
     inertiaByRow<ParallelWrist, V>},
};

int structureOf(const Robot& robot) {
  if (ParallelWrist::covers(robot)) return 1;
  if (robot.rows != nullptr) return 0;
  if (SphericalWrist::covers(robot)) return 2;
  if (RightAngles::covers(robot)) return 3;
  return AnySix::covers(robot) ? 4 : AnySeven::covers(robot) ? 5 : 0;
}

template <typename V>
FAST_INLINE const Recursions<V>& recursionsOf(const Robot& robot, int structure) {
  return robot.rows != nullptr ? kRecursionsByRow<V>[structure] : kRecursions<V>[structure];
}

// ---------------------------------------------------------------- angles

template <typename V>
FAST_INLINE void addOffset(const V& offset_cos, const V& offset_sin, V& s, V& c) {
  const V sum = s * offset_cos + c * offset_sin;
  c = c * offset_cos - s * offset_sin;
  s = sum;
}

template <typename V>
FAST_INLINE double* numbersOf(V* packs) {
  return reinterpret_cast<double*>(packs);
}
template <typename V>
FAST_INLINE const double* numbersOf(const V* packs) {
  return reinterpret_cast<const double*>(packs);
}

/// Memory for one number per joint, with room for a pack at the end.
struct JointNumbers {
  double values[kMaxJoints + kShortWidth];
};

// The pack at joint i: the last one overlaps the one before it, if there is one.
FAST_INLINE int firstOfPack(int i, int joints) {
  return i == 0 || i + kShortWidth <= joints ? i : joints - kShortWidth;
}

// Cosine and sine of all joints of one state, several joints at a time.
void turnsOfState(const Robot& robot, const double* q, double* c, double* s) {
  const int n = robot.joints;
  double padded[kShortWidth] = {};
  if (n < kShortWidth) {
    for (int i = 0; i < n; ++i) padded[i] = q[i];
    q = padded;
  }
  ShortBits beyond{};
  for (int i = 0; i < n; i += kShortWidth) {
    const int first = firstOfPack(i, n);
    Short sine;
    Short cosine;
    beyond |=
        sineCosine(load<Short>(q + first), load<Short>(robot.quarter_turns + first), sine, cosine);
    store(sine, s + first);
    store(cosine, c + first);
  }
  if (any<Short>(beyond)) {
    for (int i = 0; i < n; ++i) sineCosineOfAny(q[i], robot.quarter_turns[i], s[i], c[i]);
  }
  if (robot.general_offsets) {
    for (int i = 0; i < n; ++i) {
      addOffset(robot.placements[i].offset_cos, robot.placements[i].offset_sin, s[i], c[i]);
    }
  }
  if (robot.mixed) {
    for (int i = 0; i < n; ++i) {
      if (!robot.placements[i].prismatic) continue;
      c[i] = robot.placements[i].offset_cos;
      s[i] = robot.placements[i].offset_sin;
    }
  }
}

// Cosine and sine of all joints, a state in each lane.
FAST_INLINE void turnsOfPack(const Robot& robot, const Pack* q, Pack* c, Pack* s) {
  const int n = robot.joints;
  BitsOf<Pack> beyond{};
  for (int i = 0; i < n; ++i) {
    beyond |= sineCosine(q[i], all<Pack>(robot.quarter_turns[i]), s[i], c[i]);
  }
  if (any<Pack>(beyond)) {
    // numbers of a pack stand side by side in memory
    for (int k = 0; k < n * kWidth; ++k) {
      sineCosineOfAny(numbersOf(q)[k], robot.quarter_turns[k / kWidth], numbersOf(s)[k],
                      numbersOf(c)[k]);
    }
  }
  if (!robot.general_offsets && !robot.mixed) return;
  for (int i = 0; i < n; ++i) {
    const Placement& X = robot.placements[i];
    const Pack offset_cos = all<Pack>(X.offset_cos);
    const Pack offset_sin = all<Pack>(X.offset_sin);
    if (X.prismatic) {
      c[i] = offset_cos;
      s[i] = offset_sin;
    } else {
      addOffset(offset_cos, offset_sin, s[i], c[i]);
    }
  }
}

// ---------------------------------------------------------------- friction

// number(k) is the k-th of kFrictionNumbers.
template <typename V, typename Number>
FAST_INLINE V frictionOf(const V& qd, const Number& number) {
  const V zero{};
  const V one = all<V>(1.0);
  const V sign = (qd > 0.0 ? one : zero) - (qd < 0.0 ? one : zero);
  return number(0) * qd + (number(1) * sign + number(2)) +
         number(3) * (sigmoid<V>(number(4) * (qd + number(5))) - number(6));
}

// f has room for a pack at the end.
void frictionNumbers(const Robot& robot, const double* qd, double* f) {
  const int n = robot.joints;
  double padded[kShortWidth] = {};
  for (int i = 0; i < n; i += kShortWidth) {
    const int first = firstOfPack(i, n);
    const double* from = qd + first;
    if (n < kShortWidth) {
      for (int j = 0; j < n; ++j) padded[j] = qd[j];
      from = padded;
    }
    const auto number = [&](int k) {
      return load<Short>(robot.friction + k * robot.stride + first);
    };
    store(frictionOf(load<Short>(from), number), f + first);
  }
}

void frictionOfState(const Robot& robot, const double* qd, double* f) {
  if (robot.friction == nullptr) {
    for (int i = 0; i < robot.joints; ++i) f[i] = 0.0 * qd[i];  // keeps a NaN
    return;
  }
  JointNumbers numbers;
  frictionNumbers(robot, qd, numbers.values);
  for (int i = 0; i < robot.joints; ++i) f[i] = numbers.values[i];
}

FAST_INLINE Pack frictionOfPack(const Robot& robot, int i, const Pack& qd) {
  if (robot.friction == nullptr) return 0.0 * qd;
  return frictionOf(qd, [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); });
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

// ---------------------------------------------------------------- many states

/// The states of one pack: lanes beyond the last state repeat it.
struct Lanes {
  std::ptrdiff_t first;
  int count;

  std::ptrdiff_t operator[](int lane) const { return first + (lane < count ? lane : count - 1); }
};

// one(lanes) for packs of states from the first to the last.
template <typename One>
FAST_INLINE void forEachPack(std::ptrdiff_t states, const One& one) {
  for (std::ptrdiff_t k = 0; k < states; k += kWidth) {
    const std::ptrdiff_t left = states - k;
    one(Lanes{k, left < kWidth ? static_cast<int>(left) : kWidth});
  }
}

// The common cases have no branch per number: a full pack of states that stand apart, or side by
// side.
FAST_INLINE void gather(const Robot& robot, const Samples& from, const Lanes& lanes, Pack* to) {
  const std::ptrdiff_t step = from.state_step;
  const double* const first = from.data + lanes.first * step;
  const int n = robot.joints;
  if (lanes.count < kWidth) {
    for (int i = 0; i < n; ++i) {
      for (int lane = 0; lane < kWidth; ++lane) {
        to[i][lane] = from.data[lanes[lane] * step + i * from.joint_step];
      }
    }
  } else if (step == 1) {
    for (int i = 0; i < n; ++i) to[i] = load<Pack>(first + i * from.joint_step);
  } else {
    for (int i = 0; i < n; ++i) to[i] = loadSteps(first + i * from.joint_step, step);
  }
}

// packs[i] to the numbers of each state at to[i pack_step + state state_step].
FAST_INLINE void scatter(const Pack* packs, int count, const Lanes& lanes, double* to,
                         std::ptrdiff_t pack_step, std::ptrdiff_t state_step) {
  to += lanes.first * state_step;
  if (lanes.count < kWidth) {
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < lanes.count; ++k) to[i * pack_step + k * state_step] = packs[i][k];
    }
  } else if (state_step == 1) {
    for (int i = 0; i < count; ++i) store(packs[i], to + i * pack_step);
  } else {
    for (int i = 0; i < count; ++i) storeSteps(packs[i], to + i * pack_step, state_step);
  }
}

FAST_INLINE void scatter(const Robot& robot, const Pack* from, const Lanes& lanes,
                         const Samples& to) {
  scatter(from, robot.joints, lanes, to.data, to.joint_step, to.state_step);
}

/// Memory of one pack of states.
struct PackOfStates {
  Pack q[kMaxJoints], c[kMaxJoints], s[kMaxJoints], qd[kMaxJoints], qdd[kMaxJoints];
  State<Pack> state() const { return {c, s, q, qd, qdd}; }

  void readPositions(const Robot& robot, const Samples& from, const Lanes& lanes) {
    gather(robot, from, lanes, q);
    turnsOfPack(robot, q, c, s);
  }
};

/// Longest chain whose matrices of one pack of states fit on the stack.
constexpr int kPackedMatrixJoints = 16;

FAST_INLINE void inertiaOfPack(const Robot& robot, int structure, const State<Pack>& state,
                               const Lanes& lanes, const Matrices& H) {
  const int n = robot.joints;
  Pack entries[kPackedMatrixJoints * kPackedMatrixJoints];
  recursionsOf<Pack>(robot, structure).inertia(robot, state, Entries<Pack>{entries, 1, n});
  for (int j = 0; j < n; ++j) {
    scatter(entries + j * n, n, lanes, H.data + j * H.column_step, H.row_step, H.state_step);
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
    gather(robot, qd, lanes, x.qd);
    for (int i = 0; i < robot.joints; ++i) x.qdd[i] = Pack{};
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
    gather(robot, qd, lanes, x.qd);
    for (int i = 0; i < robot.joints; ++i) x.qdd[i] = Pack{};
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
    if (any<Pack>(sineCosine(all<Pack>(angle[k]), all<Pack>(quarter_turns[k]), s, c))) {
      sineCosineOfAny(angle[k], quarter_turns[k], sine[k], cosine[k]);
    } else {
      sine[k] = s[kWidth - 1];
      cosine[k] = c[kWidth - 1];
    }
  }
}

}  // namespace

const Kernels& CHAIN_DYNAMICS_KERNELS() {
  static constexpr Kernels kernels = {CHAIN_DYNAMICS_KERNELS_NAME,
                                      structureOf,
                                      torquesOfState,
                                      coriolisOfState,
                                      gravityOfState,
                                      inertiaOfState,
                                      componentsOfState,
                                      frictionOfState,
                                      torquesBatch,
                                      coriolisBatch,
                                      gravityBatch,
                                      inertiaBatch,
                                      componentsBatch,
                                      frictionBatch,
                                      sineCosineOfEach};
  return kernels;
}

}  // namespace chain_dynamics::fast
