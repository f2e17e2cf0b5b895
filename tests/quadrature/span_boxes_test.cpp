// Boxes over interior spans: they part them exactly, save what the formula says, and more than the greedy choice.
#include "preprocessor/interior/span_boxes.hpp"

#include "format/model/span_state.hpp"
#include "tests/quadrature/greedy_boxes.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <random>

namespace iga::prep {
namespace {

using States = std::vector<std::uint8_t>;
constexpr auto interior = static_cast<std::uint8_t>(SpanState::Interior);

States states(const Index3& n, const std::function<bool(double, double, double)>& inside) {
  States state;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i)
        state.push_back(inside(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5, static_cast<double>(k) + 0.5)
                            ? interior
                            : static_cast<std::uint8_t>(i % 2 == 0 ? SpanState::Exterior : SpanState::Trimmed));
  return state;
}

BoxCost cost_of(const char* rule, int p) {
  const TargetSpace space = target_space(rule, p);
  return {{space, space, space}, 64};
}

std::int64_t points(const std::vector<SpanBox>& boxes, const BoxCost& cost) {
  std::int64_t sum = 0;
  for (const SpanBox& box : boxes) sum += cost(box.size);
  return sum;
}

void expect_parting(const Index3& n, const States& state, const std::vector<SpanBox>& boxes) {
  std::vector<int> covered(state.size(), 0);
  for (const SpanBox& box : boxes)
    for (std::int64_t k = 0; k < box.size[2]; ++k)
      for (std::int64_t j = 0; j < box.size[1]; ++j)
        for (std::int64_t i = 0; i < box.size[0]; ++i) {
          const Index3 at{box.first[0] + i, box.first[1] + j, box.first[2] + k};
          for (std::size_t d = 0; d < 3; ++d) ASSERT_TRUE(at[d] >= 0 && at[d] < n[d]);
          ++covered[static_cast<std::size_t>(at[0] + n[0] * (at[1] + n[1] * at[2]))];
        }
  for (std::size_t s = 0; s < state.size(); ++s) ASSERT_EQ(covered[s], state[s] == interior ? 1 : 0) << "span " << s;
}

struct Shape {
  const char* name;
  Index3 n;
  std::function<bool(double, double, double)> inside;
};

std::vector<Shape> shapes() {
  return {
      {"ball", {30, 28, 31}, [](double x, double y, double z) { return std::hypot(x - 15, y - 14, z - 15.3) < 12; }},
      {"shell",
       {30, 30, 30},
       [](double x, double y, double z) {
         const double r = std::hypot(x - 15, y - 15, z - 15);
         return r < 13 && r > 10;
       }},
      {"angle", {20, 20, 8}, [](double x, double y, double) { return x < 6 || y < 5; }},
      {"plate", {40, 40, 3}, [](double x, double y, double z) { return z > 1 && z < 2 && x + y < 50; }},
      {"sponge",
       {24, 24, 24},
       [](double x, double y, double z) { return std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) < 0.6; }},
      {"checkerboard",
       {7, 7, 7},
       [](double x, double y, double z) {
         return (static_cast<int>(x) + static_cast<int>(y) + static_cast<int>(z)) % 2 == 0;
       }},
      {"full", {6, 9, 4}, [](double, double, double) { return true; }},
      {"nothing", {5, 5, 5}, [](double, double, double) { return false; }}};
}

TEST(SpanBoxes, PartTheInteriorSpansAndSaveNoLessThanTheGreedyChoice) {
  for (const Shape& shape : shapes())
    for (const char* rule : {"ggq", "ggq-reduced"})
      for (const int p : {2, 3}) {
        SCOPED_TRACE(std::string(shape.name) + " " + rule + " p " + std::to_string(p));
        const States state = states(shape.n, shape.inside);
        const BoxCost cost = cost_of(rule, p);
        const auto boxes = lay_boxes(shape.n, state, cost);
        expect_parting(shape.n, state, boxes);
        EXPECT_LE(points(boxes, cost), points(test::greedy_boxes(shape.n, state), cost));
      }
}

TEST(SpanBoxes, RandomSpansArePartedToo) {
  std::mt19937 random(7);
  for (const double share : {0.3, 0.7, 0.95}) {
    const Index3 n{17, 13, 15};
    std::bernoulli_distribution inside(share);
    const States state = states(n, [&](double, double, double) { return inside(random); });
    const auto boxes = lay_boxes(n, state, cost_of("ggq", 2));
    expect_parting(n, state, boxes);
  }
}

TEST(SpanBoxes, ABoxOfSpansSavesWhatTheFormulaSays) {
  const auto expect = [](const char* rule, int p, double limit) {
    const BoxCost cost = cost_of(rule, p);
    double saved = 0;
    for (const std::int64_t e : {1, 2, 3, 6, 10, 20, 30}) {
      const Index3 n{e + 4, e + 5, e + 3};
      const auto size = static_cast<double>(e);
      const auto within = [&](double x) { return x > 2 && x < 2 + size; };
      const States state = states(n, [&](double x, double y, double z) { return within(x) && within(y) && within(z); });
      const auto boxes = lay_boxes(n, state, cost);
      ASSERT_EQ(boxes, (std::vector<SpanBox>{{{2, 2, 2}, {e, e, e}}}));
      const double m = static_cast<double>(run_points(target_space(rule, p), e));
      saved = 1 - static_cast<double>(points(boxes, cost)) / std::pow(size * (p + 1), 3);
      EXPECT_NEAR(saved, 1 - std::pow(m / (size * (p + 1)), 3), 1e-14);
    }
    EXPECT_LE(saved, limit);
    EXPECT_GT(saved, limit - 0.04);
  };
  expect("ggq", 2, 0.7038);
  expect("ggq", 3, 0.7559);
  expect("ggq", 4, 0.7841);
  expect("ggq-reduced", 2, 0.8751);
}

TEST(SpanBoxes, DoNotDependOnTheNumberOfThreads) {
  const Shape ball = shapes().front();
  const States state = states(ball.n, ball.inside);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return lay_boxes(ball.n, state, cost_of("ggq", 2));
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(SpanBoxes, RulesWithoutRunsAreAdditive) {
  EXPECT_TRUE(cost_of("gauss", 3).is_additive());
  EXPECT_TRUE(cost_of("ggq", 1).is_additive());
  EXPECT_FALSE(cost_of("ggq", 2).is_additive());
  EXPECT_FALSE(cost_of("ggq-reduced", 4).is_additive());
}

} // namespace
} // namespace iga::prep
