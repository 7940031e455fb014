// A compiled formula in x, y, z, t (muParser).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "scene/scene.hpp"

namespace barchan {

/// Compiles once, evaluates often; not to be shared between threads. Constants: pi, e. Throws SceneError when
/// malformed.
class Formula {
 public:
  explicit Formula(const Expression& expression);
  ~Formula();
  Formula(Formula&&) noexcept;
  Formula& operator=(Formula&&) noexcept;
  double operator()(const Vec3& x, double t = 0.0) const;
  /// The same of what cannot be negative: a negative value is a fault too.
  double not_negative(const Vec3& x, double t = 0.0) const;
  bool is_constant() const;  ///< a plain number: no evaluation needed
  double constant() const;   ///< its value when is_constant()

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  double value_ = 0.0;
};

/// A value that a formula gave and may not have: no finite number, or a negative one.
struct FormulaFault {
  std::string formula;
  double value = 0.0;  // inf, -inf, nan, or below 0 where that cannot be
  const char* expected = "";
  Vec3 x{};        // m
  double t = 0.0;  // s
};

/// The first fault of any formula in this process since forget_formula_fault(); nothing: there was none. Of several at
/// once, in other threads, any one.
std::optional<FormulaFault> formula_fault();
/// Before the formulas of the steps: those of shapes may have no number somewhere.
void forget_formula_fault();

/// What is wrong with a formula that may use `variables` (one letter each, blanks between) only; empty when it is fine.
std::string formula_problem(const std::string& formula, std::string_view variables = "x y z t");

}  // namespace barchan
