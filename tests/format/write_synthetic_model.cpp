// Writes models whose content is known in closed form, for the tests in Python and for measuring.
#include "format/io/trimmed_model_io.hpp"
#include "tests/support/synthetic_model.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <string_view>

using namespace iga;

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fputs("usage: write_synthetic_model box|rotated|fine|large FILE [spans per side]\n", stderr);
    return 2;
  }
  const std::string_view kind = argv[1];
  test::BoxCase box;
  if (kind == "rotated") {
    box.rotation = test::some_rotation(0.4);
    box.degree = {1, 3, 4};
  }
  if (kind == "fine") box = test::very_fine_case();
  const TrimmedModel model =
      kind == "large" ? test::make_large_model(argc > 3 ? std::atoll(argv[3]) : 60) : test::make_box_model(box);
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
