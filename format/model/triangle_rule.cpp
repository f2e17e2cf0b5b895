#include "format/model/triangle_rule.hpp"

#include <cassert>
#include <vector>

namespace iga {

namespace {

// A rule is a set of orbits under the triangle's symmetry group, each given by one weight and a generating point.
struct RuleBuilder {
  std::vector<TrianglePoint> points;

  RuleBuilder& centroid(double w) {
    points.push_back({{1.0 / 3, 1.0 / 3, 1.0 / 3}, w});
    return *this;
  }
  // Three points (a, a, 1 - 2a) and their turns.
  RuleBuilder& on_median(double w, double a) {
    const double c = 1 - 2 * a;
    for (const auto& l : {std::array{a, a, c}, std::array{a, c, a}, std::array{c, a, a}}) points.push_back({l, w});
    return *this;
  }
  // Six points: all permutations of (a, b, 1 - a - b).
  RuleBuilder& general(double w, double a, double b) {
    const double c = 1 - a - b;
    for (const auto& l : {std::array{a, b, c}, std::array{b, a, c}, std::array{a, c, b}, std::array{c, a, b},
                          std::array{b, c, a}, std::array{c, b, a}})
      points.push_back({l, w});
    return *this;
  }
};

std::vector<TrianglePoint> degree_4() {
  return RuleBuilder{}
      .on_median(0.22338158967801147, 0.44594849091596489)
      .on_median(0.10995174365532187, 0.091576213509770746)
      .points;
}

std::vector<TrianglePoint> degree_6() {
  return RuleBuilder{}
      .on_median(0.11678627572637937, 0.24928674517091042)
      .on_median(0.050844906370206817, 0.063089014491502228)
      .general(0.082851075618373575, 0.31035245103378441, 0.053145049844816947)
      .points;
}

std::vector<TrianglePoint> degree_9() {
  return RuleBuilder{}
      .centroid(0.097135796282798834)
      .on_median(0.031334700227139071, 0.48968251919873763)
      .on_median(0.077827541004774279, 0.43708959149293664)
      .on_median(0.079647738927210253, 0.18820353561903273)
      .on_median(0.025577675658698031, 0.04472951339445271)
      .general(0.043283539377289377, 0.2219629891607657, 0.036838412054736284)
      .points;
}

std::vector<TrianglePoint> degree_12() {
  return RuleBuilder{}
      .on_median(0.025731066440455335, 0.48821738977380488)
      .on_median(0.043692544538038402, 0.43972439229446027)
      .on_median(0.0628582242178851, 0.27121038501211592)
      .on_median(0.034796112930708943, 0.12757614554158592)
      .on_median(0.0061662610515590172, 0.02131735045321037)
      .general(0.04037155776638093, 0.27571326968551419, 0.11534349453469800)
      .general(0.022356773202303446, 0.28132558098993955, 0.02283833222225703)
      .general(0.017316231108658892, 0.11625191590759714, 0.025734050548330228)
      .points;
}

} // namespace

std::span<const TrianglePoint> triangle_rule(int degree) {
  assert(degree >= 0 && degree <= max_triangle_rule_degree);
  static const std::vector<TrianglePoint> rule_4 = degree_4();
  static const std::vector<TrianglePoint> rule_6 = degree_6();
  static const std::vector<TrianglePoint> rule_9 = degree_9();
  static const std::vector<TrianglePoint> rule_12 = degree_12();
  if (degree <= 4) return rule_4;
  if (degree <= 6) return rule_6;
  return degree <= 9 ? rule_9 : rule_12;
}

} // namespace iga
