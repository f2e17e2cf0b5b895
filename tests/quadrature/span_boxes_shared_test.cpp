// Boxes over the interior spans of real parts.
#include "preprocessor/interior/span_boxes.hpp"
#include "preprocessor/trim/trim.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/quadrature/greedy_boxes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace iga::prep {
namespace {

TEST(SpanBoxesOfSharedParts, SaveNoLessThanTheGreedyChoice) {
  std::int64_t all = 0, all_greedy = 0;
  for (const char* name :
       {"cube_theta3.stl", "cube_rot.stl", "elephant.stl", "torus.STL", "unit_sphere.STL", "cylinder.stl",
        "X_Carriage_x1.stl", "angle_block.STL", "large_block_obb.STL", "octagonal_pocket.stl", "plate_holes.STL",
        "round.stl", "busted.STL", "1002_tray_bottom.STL"}) {
    const auto file = test::shared_part(std::string("valid/") + name);
    if (file.empty()) GTEST_SKIP() << "the shared STL parts are absent";
    const TriangleMesh mesh = test::read_stl(file, test::weld_of(name));
    for (const int spans : {12, 32}) {
      const SplineGrid grid = test::grid_with(mesh, spans, 2);
      const Trimming trimming = trim(grid, mesh, {});
      const Index3 n = grid.spans();
      for (const char* rule : {"ggq", "ggq-reduced"}) {
        const TargetSpace space = target_space(rule, 2);
        const BoxCost cost({space, space, space}, *std::max_element(n.begin(), n.end()));
        const auto points = [&](const std::vector<SpanBox>& boxes) {
          std::int64_t sum = 0;
          for (const SpanBox& box : boxes) sum += cost(box.size);
          return sum;
        };
        const std::int64_t ours = points(lay_boxes(n, trimming.state, cost));
        const std::int64_t greedy = points(test::greedy_boxes(n, trimming.state));
        EXPECT_LE(ours, greedy) << name << " " << rule << " " << spans << " spans";
        all += ours;
        all_greedy += greedy;
      }
    }
  }
  RecordProperty("points", std::to_string(all));
  RecordProperty("points_greedy", std::to_string(all_greedy));
  EXPECT_LT(static_cast<double>(all), 0.99 * static_cast<double>(all_greedy));
}

} // namespace
} // namespace iga::prep
