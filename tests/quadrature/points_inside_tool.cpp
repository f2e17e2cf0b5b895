// The large run behind points_inside_test.cpp: usage: points_inside_tool TRIES [FIRST_SEED]. Exit code 1 where a point
// lies outside, a weight is not positive or a moment is not met.
#include "format/model/errors.hpp"
#include "tests/quadrature/random_solids.hpp"

#include <cstdlib>
#include <fmt/format.h>

int main(int argc, char** argv) {
  using namespace iga::test;
  const long tries = argc > 1 ? std::atol(argv[1]) : 100;
  const long first = argc > 2 ? std::atol(argv[2]) : 0;
  long faults = 0, refused = 0;
  long long points = 0;
  for (long seed = first; seed < first + tries; ++seed) {
    const RandomSolid solid = random_solid(static_cast<std::uint64_t>(seed));
    for (const char* rule : {"nnls", "minimal"}) {
      if (rule[0] == 'm' && solid.degree > 2 && seed % 8 != 0) continue; // slow at high degree
      try {
        const OutsidePoints found = find_outside_points(solid, rule);
        points += found.points;
        if (found.outside == 0 && found.least_weight > 0 && found.moment_residual <= 1e-10 && found.volume_error < 1e-9)
          continue;
        ++faults;
        fmt::print(
            "{}, {}: {} of {} points outside, up to {:.3g} spans, weights {:.3g} of the volume; residual {:.2g}, "
            "volume off by {:.2g}, least weight {:.2g}\n",
            solid.name, rule, found.outside, found.points, found.deepest, found.weight, found.moment_residual,
            found.volume_error, found.least_weight);
      } catch (const iga::NumericalError& error) {
        ++refused;
        fmt::print("{}, {}: refused: {}\n", solid.name, rule, error.what());
      }
      std::fflush(stdout);
    }
  }
  fmt::print("{} solids, {} points: {} rules at fault, {} refused\n", tries, points, faults, refused);
  return faults == 0 ? 0 : 1;
}
