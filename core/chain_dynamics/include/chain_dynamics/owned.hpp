// SPDX-License-Identifier: Apache-2.0

/// @file
/// Vectors and matrices that may be made in one library and freed in another.
///
///     OwnedVector damping = Eigen::VectorXd::Constant(6, 5.0);    // from any Eigen expression
///     tau -= damping.cwiseProduct(qd);                       // in any Eigen expression
///     const Eigen::VectorXd copy = damping;
///
/// Eigen takes memory from another allocator where a program is compiled with -mavx2, -march=native
/// or AddressSanitizer, and frees it by another function. So an Eigen::VectorXd that a library made
/// and such a program resizes, moves or destroys crashes it, and the other way round. These types
/// take their memory from malloc, whatever the flags are, and their layout doesn't depend on them
/// either. Public structs and results of this workspace hold them instead.

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace chain_dynamics {
inline namespace v2 {

/// An Eigen::Map of memory of its own: a vector, matrix or array of dynamic size.
///
/// Assigning an expression of the same size allocates nothing; another size resizes. As arguments of
/// functions, take `Eigen::Ref<const Eigen::VectorXd>` for inputs and `Eigen::Ref<Eigen::VectorXd>`
/// for outputs: a `const Eigen::VectorXd&` would be a copy. As an output neither a const object nor a
/// temporary is accepted.
///
/// @tparam Plain  what it behaves like: Eigen::VectorXd, Eigen::MatrixXd, ...
template <class Plain>
class Owned : public Eigen::Map<Plain> {
  using View = Eigen::Map<Plain>;
  using Number = typename Plain::Scalar;
  static constexpr bool kIsVector = Plain::IsVectorAtCompileTime;
  static_assert(std::is_arithmetic_v<Number>);

 public:
  /// Empty.
  Owned() : View(nullptr, 0, kIsVector ? 1 : 0) {}

  /// A vector of `size` numbers, not initialised.
  explicit Owned(Eigen::Index size) : Owned(size, 1) {
    static_assert(kIsVector, "a matrix has rows and columns");
  }

  /// A matrix, not initialised.
  explicit Owned(Eigen::Index rows, Eigen::Index cols) : Owned() { resize(rows, cols); }

  /// The values of an expression.
  template <class Expression>
  Owned(const Eigen::EigenBase<Expression>& values)  // NOLINT(google-explicit-constructor)
      : Owned() {
    *this = values;
  }

  Owned(const Owned& other) : Owned() { *this = other; }
  Owned(Owned&& other) noexcept : Owned() { exchange(other); }
  ~Owned() = default;

  // NOLINTNEXTLINE(bugprone-unhandled-self-assignment): the assignment of an expression handles it
  Owned& operator=(const Owned& other) {
    return *this = static_cast<const Eigen::EigenBase<View>&>(other);
  }
  Owned& operator=(Owned&& other) noexcept {
    exchange(other);
    return *this;
  }

  template <class Expression>
  Owned& operator=(const Eigen::EigenBase<Expression>& values) {
    const Eigen::Index rows = kIsVector ? values.size() : values.rows();
    const Eigen::Index cols = kIsVector ? 1 : values.cols();
    if (rows == this->rows() && cols == this->cols()) {
      View::operator=(values.derived());
    } else {
      Owned resized(rows, cols);  // the values may be made of this object's
      resized.View::operator=(values.derived());
      exchange(resized);
    }
    return *this;
  }

  /// An output of functions. Without these Eigen would make one of const objects and temporaries too.
  operator Eigen::Ref<Plain>() & {  // NOLINT(google-explicit-constructor)
    return Eigen::Ref<Plain>(static_cast<View&>(*this));
  }
  operator Eigen::Ref<Plain>() const& = delete;
  operator Eigen::Ref<Plain>() && = delete;

  /// Another size; the numbers are lost unless it is the same.
  void resize(Eigen::Index rows, Eigen::Index cols) {
    if (rows != this->rows() || cols != this->cols()) allocate(rows, cols);
  }
  void resize(Eigen::Index size) {
    static_assert(kIsVector, "a matrix has rows and columns");
    resize(size, 1);
  }

  /// @name As of Eigen::VectorXd, for vectors
  /// @{
  using View::setConstant;
  using View::setZero;
  Owned& setConstant(Eigen::Index size, Number value) {
    return *this = Plain::Constant(size, value);
  }
  Owned& setZero(Eigen::Index size) { return setConstant(size, Number(0)); }
  /// @}

  /// A temporary isn't an output, nor a const one [states.hpp].
  friend std::true_type ownsMemory(const Owned*) { return {}; }

 private:
  struct Free {
    void operator()(void* memory) const noexcept { std::free(memory); }
  };

  void allocate(Eigen::Index rows, Eigen::Index cols) {
    constexpr auto kMost = static_cast<std::size_t>(PTRDIFF_MAX) / sizeof(Number);
    if (cols > 0 && static_cast<std::size_t>(rows) > kMost / static_cast<std::size_t>(cols)) {
      throw std::bad_alloc();
    }
    const auto bytes = static_cast<std::size_t>(rows * cols) * sizeof(Number);
    void* const memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr) throw std::bad_alloc();
    memory_.reset(static_cast<Number*>(memory));
    view(rows, cols);
  }

  // How Eigen documents that a Map is made to look elsewhere, and what Eigen::Ref does itself.
  void view(Eigen::Index rows, Eigen::Index cols) {
    new (viewed()) View(memory_.get(), rows, cols);
  }
  void* viewed() { return static_cast<View*>(this); }

  void exchange(Owned& other) noexcept {
    const Eigen::Index rows = this->rows(), cols = this->cols();
    memory_.swap(other.memory_);
    view(other.rows(), other.cols());
    other.view(rows, cols);
  }

  std::unique_ptr<Number[], Free> memory_;
};

using OwnedVector = Owned<Eigen::VectorXd>;
using OwnedMatrix = Owned<Eigen::MatrixXd>;

}  // namespace v2
}  // namespace chain_dynamics
