// Formulas: values, constants, and what is said of malformed ones.
#include "scene/formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/errors.hpp"

namespace barchan {
namespace {

double value(const std::string& formula, const Vec3& x = {}, double t = 0.0) {
  return Formula(Expression{formula, 0.0})(x, t);
}

TEST(Formula, IsANumberOrAFormula) {
  const Formula number(Expression{"", 2.5});
  EXPECT_TRUE(number.is_constant());
  EXPECT_EQ(number.constant(), 2.5);
  EXPECT_EQ(number({1, 2, 3}, 4), 2.5);
  EXPECT_FALSE(Formula(Expression{"x", 0.0}).is_constant());
}

TEST(Formula, KnowsPlaceTimeAndConstants) {
  EXPECT_EQ(value("x + 10*y + 100*z + 1000*t", {1, 2, 3}, 4), 4321);
  EXPECT_DOUBLE_EQ(value("sin(2*pi*x)*cos(2*pi*y)", {0.1, 0.2, 0}),
                   std::sin(0.2 * std::numbers::pi) * std::cos(0.4 * std::numbers::pi));
  EXPECT_DOUBLE_EQ(value("ln(e)"), 1.0);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("x > 0.5 ? 7 : 8", {1, 0, 0}), 7);
  EXPECT_EQ(value("min(3, 1, 2) + max(3, 1) + abs(-4)"), 8);
  EXPECT_EQ(value("fmod(7, 4) + floor(2.7)"), 5);
}

TEST(Formula, CanBeMovedWithItsVariables) {
  Formula first(Expression{"x*t", 0.0});
  Formula second = std::move(first);
  EXPECT_EQ(second({3, 0, 0}, 5), 15);
}

TEST(Formula, RemembersTheFirstValueThatItMayNotHave) {
  forget_formula_fault();
  EXPECT_EQ(value("1/(x - 1)", {2, 0, 0}), 1.0);
  EXPECT_EQ(Formula(Expression{"x", 0.0}).not_negative({2, 0, 0}), 2.0);
  EXPECT_FALSE(formula_fault());
  EXPECT_EQ(Formula(Expression{"-x", 0.0}).not_negative({2, 0, 0}, 3.0), -2.0);
  EXPECT_TRUE(std::isinf(value("1/(x - 2)", {2, 0, 0})));
  ASSERT_TRUE(formula_fault());
  EXPECT_EQ(formula_fault()->formula, "-x");
  EXPECT_EQ(formula_fault()->value, -2.0);
  EXPECT_EQ(formula_fault()->t, 3.0);
  EXPECT_STREQ(formula_fault()->expected, "0 or more");
  forget_formula_fault();
  EXPECT_FALSE(formula_fault());
}

TEST(Formula, TellsWhatIsMalformed) {
  EXPECT_THROW(value("sin(x"), SceneError);
  EXPECT_EQ(formula_problem("sin(x)", "x y z"), "");
  EXPECT_EQ(formula_problem("", "x"), "the formula is empty");
  EXPECT_NE(formula_problem("t*x", "x y z"), "") << "t is not among the variables";
  EXPECT_NE(formula_problem("x +"), "");
  EXPECT_NE(formula_problem("x, y"), "");
  EXPECT_EQ(formula_problem("x >= 3 ? x == 4 : x != 5"), "");
  EXPECT_EQ(formula_problem("x = 3"), "the formula \"x = 3\" assigns a value") << "a formula changes nothing";
}

}  // namespace
}  // namespace barchan
