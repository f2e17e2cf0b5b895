#include "solver/base/formula.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

using One = double (*)(double);
using Two = double (*)(double, double);

constexpr std::array<std::pair<const char*, One>, 14> functions_of_one{
    {{"sqrt", [](double a) { return std::sqrt(a); }},
     {"exp", [](double a) { return std::exp(a); }},
     {"log", [](double a) { return std::log(a); }},
     {"log10", [](double a) { return std::log10(a); }},
     {"sin", [](double a) { return std::sin(a); }},
     {"cos", [](double a) { return std::cos(a); }},
     {"tan", [](double a) { return std::tan(a); }},
     {"asin", [](double a) { return std::asin(a); }},
     {"acos", [](double a) { return std::acos(a); }},
     {"atan", [](double a) { return std::atan(a); }},
     {"sinh", [](double a) { return std::sinh(a); }},
     {"cosh", [](double a) { return std::cosh(a); }},
     {"tanh", [](double a) { return std::tanh(a); }},
     {"abs", [](double a) { return std::abs(a); }}}};
constexpr std::array<std::pair<const char*, Two>, 4> functions_of_two{
    {{"atan2", [](double a, double b) { return std::atan2(a, b); }},
     {"hypot", [](double a, double b) { return std::hypot(a, b); }},
     {"min", [](double a, double b) { return std::min(a, b); }},
     {"max", [](double a, double b) { return std::max(a, b); }}}};

// Parentheses and signs nest no deeper: the parser calls itself for each.
constexpr int deepest = 200;

} // namespace

/// Recursive descent: sum → product → power → value.
class FormulaParser {
 public:
  FormulaParser(const std::string& text, std::vector<Formula::Step>& steps) : text_(text), steps_(steps) {}

  void run() {
    sum();
    if (next() != '\0') refuse("an operator or the end");
  }

 private:
  using Kind = Formula::Kind;

  char next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (next() != c) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void refuse(const std::string& expected) {
    const char c = next();
    throw InputError(fmt::format("\"{}\": {} at character {}, expected {}", text_,
                                 c == '\0' ? "it ends" : fmt::format("found '{}'", c), at_ + 1, expected));
  }
  void emit(Kind kind) { steps_.push_back({kind, 0, 0, nullptr, nullptr}); }

  void sum() {
    if (++depth_ > deepest) refuse("fewer parentheses");
    product();
    for (;;) {
      if (take('+')) {
        product();
        emit(Kind::Add);
      } else if (take('-')) {
        product();
        emit(Kind::Subtract);
      } else {
        break;
      }
    }
    --depth_;
  }
  void product() {
    sign();
    for (;;) {
      if (take('*')) {
        if (next() == '*') refuse("a value; powers are written with ^");
        sign();
        emit(Kind::Multiply);
      } else if (take('/')) {
        sign();
        emit(Kind::Divide);
      } else {
        return;
      }
    }
  }
  void sign() {
    if (++depth_ > deepest) refuse("fewer signs");
    if (take('-')) {
      sign();
      emit(Kind::Negate);
    } else {
      take('+');
      value();
      if (take('^')) {
        sign();
        emit(Kind::Power);
      }
    }
    --depth_;
  }
  void value() {
    const char c = next();
    if (take('(')) {
      sum();
      if (!take(')')) refuse("')'");
    } else if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      number();
    } else if (std::isalpha(static_cast<unsigned char>(c))) {
      name();
    } else {
      refuse("a number, x, y, z, a function or '('");
    }
  }
  void number() {
    const char* const start = text_.c_str() + at_;
    char* end = nullptr;
    const double number = std::strtod(start, &end);
    if (end == start || !std::isfinite(number)) refuse("a finite number");
    at_ += static_cast<std::size_t>(end - start);
    steps_.push_back({Kind::Number, number, 0, nullptr, nullptr});
  }
  void name() {
    const std::size_t start = at_;
    std::size_t end = at_;
    while (end < text_.size() && std::isalnum(static_cast<unsigned char>(text_[end]))) ++end;
    const std::string word = text_.substr(start, end - start);
    at_ = end;
    if (word == "x" || word == "y" || word == "z")
      steps_.push_back({Kind::Variable, 0, static_cast<std::size_t>(word[0] - 'x'), nullptr, nullptr});
    else if (word == "pi")
      steps_.push_back({Kind::Number, std::numbers::pi, 0, nullptr, nullptr});
    else
      call(word, start);
  }
  void call(const std::string& word, std::size_t start) {
    std::vector<std::string> known{"x", "y", "z", "pi"};
    for (const auto& [name, function] : functions_of_one) {
      if (word == name) {
        arguments(word, 1);
        return steps_.push_back({Kind::Call1, 0, 0, function, nullptr});
      }
      known.emplace_back(name);
    }
    for (const auto& [name, function] : functions_of_two) {
      if (word == name) {
        arguments(word, 2);
        return steps_.push_back({Kind::Call2, 0, 0, nullptr, function});
      }
      known.emplace_back(name);
    }
    const auto near = io::nearest_name(word, known);
    throw InputError(fmt::format("\"{}\": there is no '{}' (character {}); expected x, y, z, pi or a function{}", text_,
                                 word, start + 1, near ? fmt::format("; did you mean {}?", *near) : ""));
  }
  void arguments(const std::string& word, int count) {
    if (!take('(')) refuse(fmt::format("'(' after {}", word));
    sum();
    if (count == 2) {
      if (!take(',')) refuse(fmt::format("',': {} takes two values", word));
      sum();
    }
    if (!take(')')) refuse("')'");
  }

  const std::string& text_;
  std::vector<Formula::Step>& steps_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

Formula::Formula(const std::string& text) : text_(text) {
  FormulaParser(text_, steps_).run();
}

double Formula::operator()(const Point3& x) const {
  thread_local std::vector<double> stack;
  stack.clear();
  for (const Step& step : steps_) {
    if (step.kind == Kind::Number || step.kind == Kind::Variable) {
      stack.push_back(step.kind == Kind::Number ? step.number : x[step.variable]);
      continue;
    }
    if (step.kind == Kind::Negate || step.kind == Kind::Call1) {
      stack.back() = step.kind == Kind::Negate ? -stack.back() : step.one(stack.back());
      continue;
    }
    const double b = stack.back();
    stack.pop_back();
    double& a = stack.back();
    switch (step.kind) {
    case Kind::Add:
      a += b;
      break;
    case Kind::Subtract:
      a -= b;
      break;
    case Kind::Multiply:
      a *= b;
      break;
    case Kind::Divide:
      a /= b;
      break;
    case Kind::Power:
      a = std::pow(a, b);
      break;
    default:
      a = step.two(a, b);
    }
  }
  return stack.back();
}

} // namespace iga::solve
