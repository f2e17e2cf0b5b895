#include "samples/parts.hpp"

#include "samples/foam_part.hpp"
#include "samples/solids.hpp"

#include <cmath>
#include <numbers>

namespace iga::samples {
namespace {

constexpr std::array<Point3, 3> z_to_y{
    {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}; // (x, y, z) → (x, -z, y): extrusions along y

TriangleMesh trimmed_cube(const PartOptions& o) {
  const double a = o.theta, b = 120 - o.theta;
  return box({a, a, a}, {b, b, b});
}

/// 100 mm cube about the origin, turned by 30° about z, then by 20° about x.
TriangleMesh rotated_cube(const PartOptions&) {
  const double a = std::numbers::pi / 6, b = std::numbers::pi / 9;
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
  const std::array<Point3, 3> axes{{{ca, -sa, 0}, {cb * sa, cb * ca, -sb}, {sb * sa, sb * ca, cb}}};
  return moved(box({-50, -50, -50}, {50, 50, 50}), axes, {0, 0, 0});
}

TriangleMesh hollow_sphere(const PartOptions& o) {
  return together(icosphere({0, 0, 0}, 50, o.refinement), inside_out(icosphere({4, -3, 2}, 32, o.refinement)));
}

/// 120 × 80 × 8 plate: rounded outline, four screw holes, a large bore, a slot, a raised rim about the bore.
TriangleMesh plate_with_holes(const PartOptions&) {
  TriangleMesh plate = extrude(rounded({{0, 0}, {120, 0}, {120, 80}, {0, 80}}, {12, 12, 12, 12}, 16), 0, 8);
  plate = united(plate, cylinder({42, 40}, 24, 4, 14, 96));
  plate = subtracted(plate, cylinder({42, 40}, 16.5, -1, 20, 96));
  for (const Point2& c : {Point2{12, 12}, {108, 12}, {108, 68}, {12, 68}})
    plate = subtracted(plate, cylinder(c, 3.3, -1, 10, 48));
  return subtracted(plate,
                    extrude(rounded({{82, 24}, {94, 24}, {94, 56}, {82, 56}}, {5.9, 5.9, 5.9, 5.9}, 16), -1, 10));
}

/// Angle of two 5 mm legs with a filleted inner edge, two ribs of 1.2 mm, and screw holes in both legs.
TriangleMesh bracket_with_ribs(const PartOptions&) {
  const auto profile = rounded({{0, 0}, {60, 0}, {60, 5}, {5, 5}, {5, 50}, {0, 50}}, {1, 2, 2, 8, 2, 2}, 12);
  TriangleMesh bracket = moved(extrude(profile, 0, 45), z_to_y, {0, 45, 0});
  for (const double y : {11.3, 32.5}) {
    const auto rib = rounded({{2, 2}, {52, 2}, {52, 6}, {6, 44}, {2, 44}}, {0, 0, 1, 1, 0}, 6);
    bracket = united(bracket, moved(extrude(rib, 0, 1.2), z_to_y, {0, y + 1.2, 0}));
  }
  bracket = subtracted(bracket, cylinder({42, 22.5}, 4.2, -1, 6, 48));
  constexpr std::array<Point3, 3> z_to_x{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  return subtracted(bracket, moved(cylinder({22.5, 36}, 3.2, -1, 6, 48), z_to_x, {0, 0, 0}));
}

/// A pin in a bush, 0.4 mm apart all round: two bodies, narrower apart than a span.
TriangleMesh pin_and_bush(const PartOptions&) {
  const TriangleMesh bush = subtracted(cylinder({0, 0}, 20, 0, 40, 96), cylinder({0, 0}, 10.4, -1, 41, 96));
  return together(bush, cylinder({0, 0}, 10, -8, 52, 96));
}

/// Cylinder of radius 3.2 and height 32.4 with 96 facets. Its triangles are about equally long in all directions:
/// contact halves long edges until they fit, which makes thousands of needles of a facet as long as the bar.
TriangleMesh taylor_bar(const PartOptions&) {
  constexpr int rings = 12, along = 100;
  constexpr double radius = 3.2, height = 32.4;
  std::vector<Point2> profile;
  for (int i = 0; i <= rings; ++i) profile.push_back({radius * i / rings, 0});
  for (int i = 1; i <= along; ++i) profile.push_back({radius, height * i / along});
  for (int i = rings - 1; i >= 0; --i) profile.push_back({radius * i / rings, height});
  return revolved(profile, 96);
}

/// A block with a step and a pocket whose faces should lie on 5 mm planes, with vertices scattered over 1e-6 of the
/// size, as coordinates come out of a CAD program that works elsewhere and exports float32.
TriangleMesh noisy_block(const PartOptions&) {
  TriangleMesh block = subtracted(box({0, 0, 0}, {100, 60, 40}), box({60, -1, 25}, {101, 61, 41}));
  block = subtracted(block, box({15, 15, 10}, {45, 45, 41}));
  std::uint32_t state = 1;
  const auto noise = [&] {
    state = state * 1664525u + 1013904223u; // Numerical Recipes' linear congruential generator
    return (static_cast<double>(state >> 8) / 0x1p24 - 0.5) * 1e-4;
  };
  for (Point3& x : block.vertices)
    for (double& c : x) c += noise();
  return block;
}

} // namespace

const std::vector<Part>& parts() {
  using enum StlKind;
  static const std::vector<Part> list{
      {"foam_part", "vehicle foam part: rounded, pockets, bores, notch", Binary,
       [](const PartOptions&) { return foam_part(); }},
      {"trimmed_cube", "cube trimmed by theta on every side of its 120 mm grid", Ascii, trimmed_cube},
      {"rotated_cube", "100 mm cube rotated by 30 and 20 degrees", Ascii, rotated_cube},
      {"aligned_box", "box whose faces lie in grid planes", Binary,
       [](const PartOptions&) {
         return box({10, 20, 30}, {110, 80, 70});
       }},
      {"sphere", "icosphere of radius 50", Ascii,
       [](const PartOptions& o) {
         return icosphere({0, 0, 0}, 50, o.refinement);
       }},
      {"torus", "torus of radii 40 and 15", Ascii,
       [](const PartOptions&) {
         return torus({0, 0, 0}, 40, 15, 192, 96);
       }},
      {"hollow_sphere", "sphere with an eccentric spherical cavity", Binary, hollow_sphere},
      {"plate_with_holes", "plate with rounded corners, holes, slot and rim", Binary, plate_with_holes},
      {"bracket_with_ribs", "angle bracket with thin ribs and a fillet", Binary, bracket_with_ribs},
      {"pin_and_bush", "two bodies with a narrow gap", Binary, pin_and_bush},
      {"taylor_bar", "cylinder of 32.4 mm, radius 3.2, of small triangles", Binary, taylor_bar},
      {"noisy_block", "block whose faces miss the grid planes by float noise", Binary, noisy_block},
  };
  return list;
}

} // namespace iga::samples
