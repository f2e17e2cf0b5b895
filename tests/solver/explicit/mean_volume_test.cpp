// F-bar of eight cells, or of one: forces are the derivative of what the law stores, crushed points included.
#include "solver/explicit/kernel/mean_volume.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

using namespace iga;
using namespace iga::solve;

namespace {

constexpr std::size_t blocks = 3;

struct Cells {
  std::array<TensorLanes, blocks> F;
  std::array<Lanes, blocks> weight;
};

double noise(std::size_t k) {
  return std::sin(1.0 + 3.7 * static_cast<double>(k));
}

// Volume ratios about 1; some points of block 1 with J between -0.4 and 0.2.
Cells some_cells(bool crushed) {
  Cells cells;
  for (std::size_t b = 0; b < blocks; ++b)
    for (std::size_t l = 0; l < 8; ++l) {
      cells.weight[b][l] = 1.5 + noise(17 * b + l);
      for (std::size_t i = 0; i < 9; ++i)
        cells.F[b].c[i][l] = (i % 4 == 0 ? 1.0 : 0.0) + 0.15 * noise(71 * b + 9 * l + i);
      if (crushed && b == 1) cells.F[b].c[8][l] = l % 2 == 0 ? 0.1 : -0.3;
    }
  return cells;
}

// ψ = ½ |F̄|² + ¼ |F̄|⁴ and its P̄.
double stored(const TensorLanes& F, std::size_t l) {
  double s = 0;
  for (const Lanes& c : F.c) s += c[l] * c[l];
  return 0.5 * s + 0.25 * s * s;
}
TensorLanes stress(const TensorLanes& F) {
  TensorLanes P;
  for (std::size_t l = 0; l < 8; ++l) {
    double s = 0;
    for (const Lanes& c : F.c) s += c[l] * c[l];
    for (std::size_t i = 0; i < 9; ++i) P.c[i][l] = (1 + s) * F.c[i][l];
  }
  return P;
}

double energy(const Cells& cells, bool one_cell) {
  MeanVolumeLanes means;
  means.start(blocks, one_cell);
  for (std::size_t b = 0; b < blocks; ++b) means.add(b, cells.weight[b], cells.F[b]);
  means.find_means();
  double sum = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const TensorLanes F = means.scaled(b);
    for (std::size_t l = 0; l < 8; ++l) sum += cells.weight[b][l] * stored(F, l);
  }
  return sum;
}

std::array<TensorLanes, blocks> stresses(const Cells& cells, bool one_cell) {
  MeanVolumeLanes means;
  means.start(blocks, one_cell);
  for (std::size_t b = 0; b < blocks; ++b) means.add(b, cells.weight[b], cells.F[b]);
  means.find_means();
  for (std::size_t b = 0; b < blocks; ++b) {
    const TensorLanes F = means.scaled(b);
    means.take(b, cells.weight[b], stress(F));
  }
  means.find_mean_stress();
  std::array<TensorLanes, blocks> P;
  for (std::size_t b = 0; b < blocks; ++b) P[b] = means.stress(b);
  return P;
}

} // namespace

TEST(MeanVolumeLanes, ForcesAreTheDerivativeOfWhatIsStored) {
  for (const bool one_cell : {false, true})
    for (const bool crushed : {false, true}) {
      const Cells cells = some_cells(crushed);
      const auto P = stresses(cells, one_cell);
      for (std::size_t b = 0; b < blocks; ++b)
        for (std::size_t i = 0; i < 9; ++i)
          for (std::size_t l = 0; l < 8; ++l) {
            constexpr double step = 1e-6;
            Cells up = cells, down = cells;
            up.F[b].c[i][l] += step;
            down.F[b].c[i][l] -= step;
            const double slope = (energy(up, one_cell) - energy(down, one_cell)) / (2 * step);
            ASSERT_NEAR(slope, cells.weight[b][l] * P[b].c[i][l], 1e-6) << one_cell << crushed << b << i << l;
          }
    }
}

TEST(MeanVolumeLanes, TheLawSeesTheMeanAndOfACrushedPointItsOwn) {
  const Cells cells = some_cells(true);
  MeanVolumeLanes means;
  means.start(blocks, false);
  std::array<double, 8> theta{}, volume{};
  std::array<Lanes, blocks> J;
  for (std::size_t b = 0; b < blocks; ++b) {
    means.add(b, cells.weight[b], cells.F[b]);
    J[b] = means.J(b);
    for (std::size_t l = 0; l < 8; ++l) {
      theta[l] += cells.weight[b][l] * J[b][l];
      volume[l] += cells.weight[b][l];
    }
  }
  means.find_means();
  for (std::size_t b = 0; b < blocks; ++b) {
    means.scaled(b);
    for (std::size_t l = 0; l < 8; ++l) {
      const double mean = theta[l] / volume[l], scale = means.scale(b)[l];
      ASSERT_GT(mean, 0);
      const double seen = scale * scale * scale * J[b][l];
      EXPECT_NEAR(seen, J[b][l] > 0.25 * mean ? mean : 4 * J[b][l], 1e-12);
    }
  }
}

// Lanes beyond the last cell have no volume; a cell turned inside out in the mean is left as it is.
TEST(MeanVolumeLanes, EmptyLanesAndInvertedCellsStayFinite) {
  Cells cells = some_cells(false);
  for (std::size_t b = 0; b < blocks; ++b) {
    cells.weight[b][7] = 0;
    cells.F[b].c[0][3] = -1.2;
  }
  const auto P = stresses(cells, false);
  MeanVolumeLanes means;
  means.start(blocks, false);
  for (std::size_t b = 0; b < blocks; ++b) means.add(b, cells.weight[b], cells.F[b]);
  means.find_means();
  for (std::size_t b = 0; b < blocks; ++b) {
    const TensorLanes F = means.scaled(b), plain = stress(cells.F[b]);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_TRUE(std::isfinite(F.c[i][7]) && std::isfinite(P[b].c[i][7]));
      EXPECT_EQ(F.c[i][3], cells.F[b].c[i][3]);
      EXPECT_DOUBLE_EQ(P[b].c[i][3], plain.c[i][3]);
    }
  }
}
