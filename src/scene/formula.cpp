#include "scene/formula.hpp"

#include <muParser.h>

#include <cmath>
#include <mutex>
#include <numbers>

#include "base/errors.hpp"
#include "scene/controls.hpp"

namespace barchan {
namespace {

double modulo(double a, double b) { return std::fmod(a, b); }
double floor_of(double a) { return std::floor(a); }

/// What a scene's formulas know beside muParser's own functions and operators.
void define_constants(mu::Parser& parser) {
  parser.ClearConst();
  parser.DefineConst("pi", std::numbers::pi);
  parser.DefineConst("e", std::numbers::e);
  parser.DefineFun("fmod", modulo);
  parser.DefineFun("floor", floor_of);
  if (!controls().empty()) parser.DefineFun("control", value_of_control);  // else nobody has given it a meaning
}

/// muParser ends some of its messages with a full stop; the reader goes on with a semicolon.
std::string without_full_stop(std::string text) {
  while (!text.empty() && (text.back() == '.' || text.back() == ' ' || text.back() == '\n')) text.pop_back();
  return shortened(text, 400);
}

/// muParser would let a formula assign to its variables; `=` is only meant in ==, !=, <= and >=.
bool assigns(const std::string& formula) {
  for (std::size_t k = 0; k < formula.size(); ++k) {
    if (formula[k] != '=') continue;
    if (k + 1 < formula.size() && formula[k + 1] == '=') {
      ++k;
      continue;
    }
    if (k == 0 || std::string_view("!<>").find(formula[k - 1]) == std::string_view::npos) return true;
  }
  return false;
}

}  // namespace

namespace {

std::mutex fault_mutex;
std::optional<FormulaFault> first_fault;

void note_fault(FormulaFault fault) {
  const std::lock_guard lock(fault_mutex);
  if (first_fault) return;
  while (fault.formula.ends_with(' ')) fault.formula.pop_back();  // muParser adds one
  first_fault = std::move(fault);
}

}  // namespace

std::optional<FormulaFault> formula_fault() {
  const std::lock_guard lock(fault_mutex);
  return first_fault;
}

void forget_formula_fault() {
  const std::lock_guard lock(fault_mutex);
  first_fault.reset();
}

struct Formula::Parser {
  mu::Parser parser;
  double x = 0.0, y = 0.0, z = 0.0, t = 0.0;
};

Formula::Formula(const Expression& expression) : value_(expression.value) {
  if (!expression.is_formula()) return;
  parser_ = std::make_unique<Parser>();
  try {
    define_constants(parser_->parser);
    parser_->parser.DefineVar("x", &parser_->x);
    parser_->parser.DefineVar("y", &parser_->y);
    parser_->parser.DefineVar("z", &parser_->z);
    parser_->parser.DefineVar("t", &parser_->t);
    parser_->parser.SetExpr(expression.formula);
    parser_->parser.Eval();  // compiles, so that later calls only evaluate
  } catch (const mu::Parser::exception_type& error) {
    throw SceneError("the formula \"" + shortened(expression.formula) +
                     "\" is malformed: " + without_full_stop(error.GetMsg()));
  }
}

Formula::~Formula() = default;
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;

double Formula::operator()(const Vec3& x, double t) const {
  if (!parser_) return value_;
  parser_->x = x[0];
  parser_->y = x[1];
  parser_->z = x[2];
  parser_->t = t;
  const double value = parser_->parser.Eval();
  if (!std::isfinite(value)) note_fault({parser_->parser.GetExpr(), value, "a finite number", x, t});
  return value;
}

double Formula::not_negative(const Vec3& x, double t) const {
  const double value = (*this)(x, t);
  if (value < 0.0 && parser_) note_fault({parser_->parser.GetExpr(), value, "0 or more", x, t});
  return value;
}

bool Formula::is_constant() const { return parser_ == nullptr; }

double Formula::constant() const { return value_; }

std::string formula_problem(const std::string& formula, std::string_view variables) {
  if (formula.empty()) return "the formula is empty";
  if (assigns(formula)) return "the formula \"" + shortened(formula) + "\" assigns a value";
  mu::Parser parser;
  double somewhere = 0.37;
  try {
    define_constants(parser);
    for (const char name : variables)
      if (name != ' ') parser.DefineVar(std::string(1, name), &somewhere);
    parser.SetExpr(formula);
    parser.Eval();
    if (parser.GetNumResults() != 1) return "\"" + shortened(formula) + "\" is several formulas";
  } catch (const mu::Parser::exception_type& error) {
    std::string meant;
    if (formula.find("**") != std::string::npos) meant = "; a power is x^2";
    for (const char* const prefix : {"np.", "numpy.", "math.", "std::"})
      if (formula.find(prefix) != std::string::npos) meant = "; a function has no prefix, as in sin(x)";
    return "the formula \"" + shortened(formula) + "\" is malformed: " + without_full_stop(error.GetMsg()) + meant;
  }
  return "";
}

}  // namespace barchan
