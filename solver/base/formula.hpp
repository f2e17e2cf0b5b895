// Formulas of x, y, z in run files: "20 + 3*x".
#pragma once

#include "format/model/types.hpp"

#include <string>
#include <vector>

namespace iga::solve {

/// A formula of the position. It knows numbers, x, y, z, pi, + - * / ^ with the usual precedence (^ from the right,
/// before a sign), parentheses, and the functions sqrt exp log log10 sin cos tan asin acos atan sinh cosh tanh abs,
/// atan2(y, x) hypot(a, b) min(a, b) max(a, b). Angles are radians. Nothing else is ever run.
class Formula {
 public:
  /// @throws InputError naming the place in the text, what stands there and what was expected
  explicit Formula(const std::string& text);
  /// May be no finite number where the formula has none.
  double operator()(const Point3& x) const;
  const std::string& text() const { return text_; }

 private:
  friend class FormulaParser;
  enum class Kind { Number, Variable, Negate, Add, Subtract, Multiply, Divide, Power, Call1, Call2 };
  struct Step {
    Kind kind = Kind::Number;
    double number = 0;
    std::size_t variable = 0;
    double (*one)(double) = nullptr;
    double (*two)(double, double) = nullptr;
  };
  std::string text_;
  std::vector<Step> steps_; // in reverse Polish order
};

} // namespace iga::solve
