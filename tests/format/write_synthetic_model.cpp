// Writes models whose content is known in closed form, for the tests in Python and for measuring.
#include "format/io/trimmed_model_io.hpp"
#include "tests/support/synthetic_model.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <string_view>

using namespace iga;

namespace {

// Every function an unknown of its own, said in so many words.
void add_unknowns(TrimmedModel& model) {
  Unknowns& u = model.unknowns;
  u.offsets.push_back(0);
  for (std::size_t f = 0; f < model.functions.number.size(); ++f) {
    u.terms.push_back(static_cast<std::int32_t>(f));
    u.function.push_back(static_cast<std::int32_t>(f));
    u.weights.push_back(1);
    u.offsets.push_back(static_cast<std::int64_t>(f) + 1);
    u.mass_fraction.push_back(std::min(1.0, model.functions.mass_fraction[f]));
    const Index3 ijk = model.grid.function_index(model.functions.number[f]);
    for (std::size_t d = 0; d < 3; ++d) u.parameters.push_back(model.grid.knots(static_cast<int>(d)).greville(ijk[d]));
  }
}

} // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fputs("usage: write_synthetic_model box|rotated|fine|large FILE [spans per side | optional]\n", stderr);
    return 2;
  }
  const std::string_view kind = argv[1];
  test::BoxCase box;
  if (kind == "rotated") {
    box.rotation = test::some_rotation(0.4);
    box.degree = {1, 3, 4};
  }
  if (kind == "fine") box = test::very_fine_case();
  TrimmedModel model =
      kind == "large" ? test::make_large_model(argc > 3 ? std::atoll(argv[3]) : 60) : test::make_box_model(box);
  if (argc > 3 && std::string_view(argv[3]) == "optional") { // the groups that files may lack
    add_unknowns(model);
    test::add_places(model);
  }
  const auto seconds = [](auto work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double write = seconds([&] { io::write_model(argv[2], model); });
  const double load = seconds([&] { io::load_model(argv[2]); });
  const double check_time = seconds([&] { check(model); });
  fmt::print("{} points: written in {:.2f} s, read in {:.2f} s, checked in {:.2f} s\n", model.points.weights.size(),
             write, load, check_time);
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
