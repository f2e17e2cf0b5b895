#include "preprocessor/trim/own_moments.hpp"

#include "format/model/vec3.hpp"

#include <algorithm>
#include <cmath>

namespace iga::prep {

void OwnMoments::add(std::span<const Point3> polygon, const Point3& corner) {
  std::array<double, 6> from_face{}; // largest distance of a vertex from each face
  std::array<bool, 6> reaches{};
  std::array<Point3, 9> v;
  for (std::size_t a = 0; a < polygon.size(); ++a)
    for (std::size_t d = 0; d < 3; ++d) {
      v[a][d] = polygon[a][d] - corner[d];
      from_face[2 * d] = std::max(from_face[2 * d], v[a][d]);
      from_face[2 * d + 1] = std::max(from_face[2 * d + 1], 1 - v[a][d]);
      reaches[2 * d] |= v[a][d] == 0;
      reaches[2 * d + 1] |= v[a][d] == 1;
    }
  depth = std::max(depth, *std::min_element(from_face.begin(), from_face.end()));
  Point3 own_area{};
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a) {
    const Point3 n = twice_area(v[0], v[a], v[a + 1]);
    for (std::size_t d = 0; d < 3; ++d) {
      const double mean = (v[0][d] + v[a][d] + v[a + 1][d]) / 3;
      own_area[d] += 0.5 * n[d];
      volume[d] += 0.5 * n[d] * mean;
      magnitude[d] += 0.5 * std::abs(n[d]) * mean;
    }
  }
  const bool flat = from_face[0] == 0 || from_face[2] == 0 || from_face[4] == 0;
  for (std::size_t d = 0; d < 3; ++d) {
    area[d] += own_area[d];
    if (!flat) far_area[d] += own_area[d];
  }
  if (!flat)
    for (std::size_t f = 0; f < 6; ++f) touches[f] |= reaches[f];
}

} // namespace iga::prep
