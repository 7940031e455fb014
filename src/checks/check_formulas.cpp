// Values of formulas: the bounds of a key hold for a formula as for a number, at the times and places that are looked
// at. What a formula gives elsewhere shows in the run (Formula::operator()).
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "checks/checks.hpp"
#include "scene/formula.hpp"
#include "scene/formulas_of.hpp"

namespace barchan {
namespace {

struct Sample {
  Vec3 x;  // m
  double t, value;
};

std::string text_of(const Sample& sample, bool by_place, bool by_time) {
  std::string text = number_text(sample.value);
  if (by_time) text += " at t = " + number_text(sample.t) + " s";
  if (by_place)
    text += std::string(by_time ? ", (" : " at (") + number_text(sample.x[0]) + ", " + number_text(sample.x[1]) + ", " +
            number_text(sample.x[2]) + ") m";
  return text;
}

class FormulaChecker {
 public:
  FormulaChecker(const Scene& scene, const Report& report) : scene_(scene), report_(report) {}

  void operator()(const KeyedFormula& one) const {
    if (report_.touched(one.dotted)) return;
    const std::string_view variables = one.key->variables;
    const bool by_time = variables.find('t') != std::string_view::npos,
               by_place = variables.find('x') < variables.size();
    const Formula formula(Expression{.formula = one.text});
    std::optional<Sample> wrong, beyond;
    const int times = by_time ? (by_place ? 20 : 1000) : 0;
    for (int step = 0; step <= times && !wrong; ++step) {
      const double t = times > 0 ? scene_.time.end * step / times : 0.0;
      bool finite = false;
      Sample last{{}, t, 0.0};
      for (unsigned k = 0; k < (by_place ? places : 1u); ++k) {
        const Vec3 x = place(k);
        last = {x, t, formula(x, t)};
        finite = finite || std::isfinite(last.value);
        if (!beyond && std::isfinite(last.value) && !one.key->bounds.hold(last.value)) beyond = last;
      }
      // At a place of its own, as 1/x at 0, a formula may have no number where no particle is.
      if (!finite) wrong = last;
    }
    const std::string when = by_time ? (by_place ? " at all times and places" : " at all times") : " at all places";
    if (wrong)
      report_(one.dotted, "the formula \"" + shortened(one.text) + "\" gives " + text_of(*wrong, false, by_time) +
                              "; expected a finite number" + when);
    else if (beyond)
      report_(one.dotted, "the formula is " + text_of(*beyond, by_place, by_time) + "; expected " +
                              (one.key->bounds.at_least == 0.0 ? "0 or more" : expected(*one.key, scene_.dimensions)) +
                              when);
  }

 private:
  /// The corners and the middle of the domain, and places that stand on no round number.
  static constexpr unsigned places = 9 + 8;
  Vec3 place(unsigned k) const {
    Vec3 x = scene_.domain.origin;
    for (unsigned d = 0; d < 3; ++d) {
      const double corner = static_cast<double>(k >> d & 1u);
      const double share = k < 8 ? corner : k == 8 ? 0.5 : 0.137 + 0.731 * static_cast<double>((k - 9) >> d & 1u);
      x[d] += share * scene_.domain.size[d];
    }
    return x;
  }

  const Scene& scene_;
  const Report& report_;
};

}  // namespace

void check_formulas(const toml::table& document, const Scene& scene, const Report& report) {
  if (report.touched("domain") || report.touched("time.end") || report.touched("time")) return;
  const FormulaChecker check(scene, report);
  for (const KeyedFormula& one : formulas_of(document)) check(one);
}

}  // namespace barchan
