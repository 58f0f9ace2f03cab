// SPDX-License-Identifier: Apache-2.0
#include "chain_dynamics/owned.hpp"

#include <gtest/gtest.h>

#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/states.hpp"

namespace chain_dynamics {
namespace {

const Eigen::VectorXd kValues = Eigen::VectorXd::LinSpaced(4, 1.0, 4.0);

TEST(Owned, IsMadeOfExpressionsAndBecomesThem) {
  OwnedVector v = 2.0 * kValues;
  EXPECT_EQ(v, 2.0 * kValues);
  v = kValues.transpose();
  const Eigen::VectorXd copy = v;
  EXPECT_EQ(copy, kValues);
  EXPECT_EQ(v.cwiseProduct(v).sum(), kValues.squaredNorm());

  OwnedMatrix diagonal = v.asDiagonal();
  diagonal = diagonal * diagonal;
  EXPECT_EQ(diagonal(3, 3), 16.0);
  EXPECT_EQ(diagonal.rows(), 4);
}

TEST(Owned, TakesTheSizeOfWhatIsAssigned) {
  OwnedVector v;
  EXPECT_EQ(v.size(), 0);
  v = kValues;
  v = v.head(2);
  EXPECT_EQ(v, kValues.head(2));
  OwnedMatrix without_rows = Eigen::MatrixXd(0, 3);
  EXPECT_EQ(without_rows.cols(), 3);
  without_rows = OwnedMatrix();
  EXPECT_EQ(without_rows.cols(), 0);
}

TEST(Owned, CopiesAreIndependentAndMovesTakeTheMemory) {
  OwnedVector first = kValues;
  OwnedVector copy = first;
  copy[0] = 9.0;
  EXPECT_EQ(first, kValues);
  first = copy;
  EXPECT_EQ(first[0], 9.0);

  const double* const memory = first.data();
  OwnedVector moved = std::move(first);
  EXPECT_EQ(moved.data(), memory);
  copy = std::move(moved);
  EXPECT_EQ(copy.data(), memory);
  const OwnedVector& itself = copy;
  copy = itself;
  EXPECT_EQ(copy[0], 9.0);

  std::vector<OwnedVector> many(3, copy);
  many.erase(many.begin());
  std::swap(many[0], copy);
  EXPECT_EQ(many[0].data(), memory);
}

TEST(Owned, AssigningTheSameSizeAllocatesNothing) {
  OwnedVector v = kValues, w = kValues;
  const test::AllocationGuard guard;
  v = 2.0 * w;
  w = v;
  v = std::move(w);
  EXPECT_EQ(guard.count(), 0);
}

TEST(Owned, HoldsTruthValuesOneByOne) {
  Owned<Eigen::Array<bool, Eigen::Dynamic, 1>> mask = kValues.array() > 2.5;
  mask = !mask;
  EXPECT_EQ(mask.count(), 2);
  EXPECT_TRUE(mask.data()[0]);
}

void fill(Eigen::Ref<Eigen::VectorXd> output) { output.setConstant(7.0); }

TEST(Owned, IsAnOutputUnlessItIsConstOrATemporary) {
  using Output = void (&)(Eigen::Ref<Eigen::VectorXd>);
  static_assert(std::is_invocable_v<Output, OwnedVector&>);
  static_assert(!std::is_invocable_v<Output, const OwnedVector&>);
  static_assert(!std::is_invocable_v<Output, OwnedVector>);
  using Matrices = void (&)(Eigen::Ref<Eigen::MatrixXd>);
  static_assert(std::is_invocable_v<Matrices, OwnedMatrix&>);
  static_assert(!std::is_invocable_v<Matrices, const OwnedMatrix&>);
  using Input = void (&)(const Eigen::Ref<const Eigen::VectorXd>&);
  static_assert(std::is_invocable_v<Input, const OwnedVector&>);
  static_assert(std::is_invocable_v<Input, OwnedVector>);

  OwnedVector v = kValues;
  const double* const memory = v.data();
  fill(v);
  EXPECT_EQ(v.data(), memory);
  EXPECT_EQ(v, Eigen::VectorXd::Constant(4, 7.0));
  fill(v.head(2));
}

TEST(Owned, RefusesASizeThatIsTooLarge) {
  constexpr Eigen::Index kHuge = Eigen::Index{1} << 40;
  EXPECT_THROW(OwnedMatrix(kHuge, kHuge), std::bad_alloc);
  EXPECT_THROW(OwnedVector(Eigen::Index{1} << 62), std::bad_alloc);
}

TEST(Owned, IsAnOutputOfBatchesUnlessItIsConstOrATemporary) {
  static_assert(std::is_constructible_v<States, OwnedMatrix&>);
  static_assert(!std::is_constructible_v<States, const OwnedMatrix&>);
  static_assert(!std::is_constructible_v<States, OwnedMatrix>);
  static_assert(std::is_constructible_v<ConstStates, const OwnedMatrix&>);
}

}  // namespace
}  // namespace chain_dynamics
