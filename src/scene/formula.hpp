// A compiled formula in x, y, z, t (muParser).
#pragma once

#include <memory>
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
  bool is_constant() const;  ///< a plain number: no evaluation needed
  double constant() const;   ///< its value when is_constant()

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  double value_ = 0.0;
};

/// What is wrong with a formula that may use `variables` (one letter each, blanks between) only; empty when it is fine.
std::string formula_problem(const std::string& formula, std::string_view variables = "x y z t");

}  // namespace barchan
