#include "preprocessor/program/settings.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/interior/generalised_gauss.hpp"
#include "preprocessor/program/settings_table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

namespace iga::prep {

namespace {

constexpr std::size_t one_per_direction = 3;

void require(bool fine, const std::string& name, double value, const std::string& allowed) {
  if (!fine) throw InputError(fmt::format("{} = {}: {}", name, value, allowed));
}

void require_length(bool fine, const std::string& name, std::size_t found, const std::string& allowed) {
  if (!fine) throw InputError(fmt::format("{}: found {} value(s), expected {}", name, found, allowed));
}

bool positive(double x) {
  return std::isfinite(x) && x > 0;
}

template <class T> void check_lengths(const std::optional<std::vector<T>>& values, const std::string& name) {
  if (values)
    require_length(values->size() == 1 || values->size() == one_per_direction, name, values->size(), "1 or 3");
}

std::array<int, 3> degrees(const std::vector<std::int64_t>& typed) {
  std::array<int, 3> degree{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t p = typed[typed.size() == 1 ? 0 : d];
    require(p >= 1 && p <= max_degree, "degree", static_cast<double>(p),
            fmt::format("supported degrees are 1 … {}", max_degree));
    degree[d] = static_cast<int>(p);
  }
  return degree;
}

// Rodrigues' formula; quarter turns give exact zeros and ones.
Rotation about_axis(const std::vector<double>& typed) {
  require_length(typed.size() == 4, "rotate_axis_angle", typed.size(), "4: the axis and the angle in degrees");
  const double length = std::hypot(typed[0], typed[1], typed[2]);
  if (!positive(length) || !std::isfinite(typed[3]))
    throw InputError(
        fmt::format("rotate_axis_angle = {}: the axis must not be zero and all four numbers must be finite",
                    fmt::join(typed, " ")));
  const Point3 a{typed[0] / length, typed[1] / length, typed[2] / length};
  const double degree = std::remainder(typed[3], 360.0);
  const double radian = degree * std::numbers::pi / 180;
  const double c = std::abs(degree) == 90 ? 0 : std::abs(degree) == 180 ? -1 : std::cos(radian);
  const double s = std::abs(degree) == 180 ? 0 : std::abs(degree) == 90 ? std::copysign(1, degree) : std::sin(radian);
  Rotation R;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) R[i][j] = (i == j ? c : 0) + (1 - c) * a[i] * a[j];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    R[j][i] += s * a[k];
    R[i][j] -= s * a[k];
  }
  return R;
}

Rotation rotation_of(const TypedSettings& typed) {
  if (typed.rotation && typed.rotate_axis_angle)
    throw InputError(
        "rotation and rotate_axis_angle are both given; they are two ways to write the same: leave one out");
  if (typed.rotate_axis_angle) return about_axis(*typed.rotate_axis_angle);
  Rotation R = identity_rotation;
  if (!typed.rotation) return R;
  require_length(typed.rotation->size() == 9, "rotation", typed.rotation->size(), "9: a 3×3 matrix row by row");
  for (std::size_t i = 0; i < 9; ++i) R[i / 3][i % 3] = (*typed.rotation)[i];
  // The grid refuses what is no rotation; a unit box asks it early.
  SplineGrid({0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, R);
  return R;
}

GridOptions grid_options(const TypedSettings& typed) {
  GridOptions grid;
  check_lengths(typed.degree, "degree");
  check_lengths(typed.spans, "spans");
  check_lengths(typed.span_size, "span_size");
  if (typed.degree) grid.degree = degrees(*typed.degree);
  grid.spans = typed.spans.value_or(std::vector<std::int64_t>{});
  grid.span_size = typed.span_size.value_or(std::vector<double>{});
  grid.margin = typed.margin;
  grid.rotation = rotation_of(typed);
  if (typed.box) {
    const auto& b = *typed.box;
    require_length(b.size() == 6, "box", b.size(), "6: the corners A and B");
    for (const double x : b) require(std::isfinite(x), "box", x, "all six numbers must be finite");
    grid.box = {Point3{b[0], b[1], b[2]}, Point3{b[3], b[4], b[5]}};
  }
  check_options(grid);
  return grid;
}

std::array<int, 3> moment_degrees(const TypedSettings& typed, const std::array<int, 3>& p) {
  if (!typed.moment_degree) return p;
  if (const auto* word = std::get_if<std::string>(&*typed.moment_degree)) {
    if (*word != "p" && *word != "2p")
      throw InputError(fmt::format("moment_degree = \"{}\": expected \"p\", \"2p\", or 1 or 3 integers", *word));
    return *word == "p" ? p : std::array<int, 3>{2 * p[0], 2 * p[1], 2 * p[2]};
  }
  const auto& typed_degrees = std::get<std::vector<std::int64_t>>(*typed.moment_degree);
  require_length(typed_degrees.size() == 1 || typed_degrees.size() == 3, "moment_degree", typed_degrees.size(),
                 "1 or 3");
  std::array<int, 3> degree{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t q = typed_degrees[typed_degrees.size() == 1 ? 0 : d];
    require(q >= 1 && q <= 2 * p[d], "moment_degree", static_cast<double>(q),
            fmt::format("with degree {} it lies in 1 … {} (twice the degree integrates products of functions)", p[d],
                        2 * p[d]));
    degree[d] = static_cast<int>(q);
  }
  return degree;
}

SurfaceOptions surface_options(const TypedSettings& typed) {
  SurfaceOptions surface;
  surface.repair = typed.repair.value_or(false);
  surface.wrap = typed.wrap.value_or(false);
  surface.accept_leaks = typed.accept_leaks.value_or(false);
  surface.wrap_alpha = typed.wrap_alpha;
  surface.wrap_offset = typed.wrap_offset;
  surface.region_angle = typed.region_angle;
  const std::string a_length = "it is a length and must be positive";
  if (typed.wrap_alpha) require(positive(*typed.wrap_alpha), "wrap_alpha", *typed.wrap_alpha, a_length);
  if (typed.wrap_offset) require(positive(*typed.wrap_offset), "wrap_offset", *typed.wrap_offset, a_length);
  if ((typed.wrap_alpha || typed.wrap_offset) && !surface.wrap)
    throw InputError("wrap_alpha and wrap_offset belong to wrapping: add wrap (--wrap) or leave them out");
  if (typed.region_angle)
    require(*typed.region_angle > 0 && *typed.region_angle <= 180, "region_angle", *typed.region_angle,
            "it is an angle in degrees between 0 and 180");
  return surface;
}

QuadratureOptions quadrature_options(const TypedSettings& typed, const std::array<int, 3>& p) {
  QuadratureOptions quadrature;
  quadrature.interior_rule = typed.interior.value_or("ggq");
  for (const int degree : p) target_space(quadrature.interior_rule, degree);
  quadrature.moment_degree = moment_degrees(typed, p);
  // With more moments the reduction takes longer than most analyses: there it is asked for where points cost most.
  const auto& q = quadrature.moment_degree;
  quadrature.trimmed_rule = typed.trimmed.value_or(*std::max_element(q.begin(), q.end()) <= 2 ? "minimal" : "nnls");
  quadrature.surface_rule = typed.surface_rule.value_or("exact");
  quadrature.tolerance = typed.tolerance.value_or(quadrature.tolerance);
  // Below the lower bound lies rounding; above the upper one the masses of a model would be visibly off.
  require(quadrature.tolerance >= 1e-14 && quadrature.tolerance <= 1e-4, "tolerance", quadrature.tolerance,
          "the bound on the moment residual lies between 1e-14 and 1e-4");
  quadrature.rank_bound = typed.rank_bound.value_or(false);
  if (quadrature.rank_bound && quadrature.trimmed_rule != "minimal")
    throw InputError(fmt::format("rank_bound limits the reduction of trimmed = \"minimal\", and trimmed is \"{}\": "
                                 "leave one out",
                                 quadrature.trimmed_rule));
  check_options(quadrature);
  return quadrature;
}

CadSettings cad_settings(const TypedSettings& typed) {
  CadSettings cad;
  cad.chord = typed.chord;
  if (cad.chord) require(positive(*cad.chord), "chord", *cad.chord, "it is a length and must be positive");
  cad.sew = typed.sew.value_or(0);
  if (typed.sew) require(positive(cad.sew), "sew", cad.sew, "it is a length and must be positive");
  cad.merge = typed.merge.value_or(false);
  cad.solid = typed.solid.value_or("");
  if (typed.solid && cad.solid.empty())
    throw InputError("solid is empty; give the name of a solid (--list shows them)");
  if (cad.merge && !cad.solid.empty()) throw InputError("merge takes all solids and solid one of them: leave one out");
  return cad;
}

} // namespace

TypedSettings override_settings(TypedSettings base, const TypedSettings& over) {
  if (over.spans) base.span_size.reset();
  if (over.span_size) base.spans.reset();
  if (over.rotation) base.rotate_axis_angle.reset();
  if (over.rotate_axis_angle) base.rotation.reset();
  each_setting([&](const auto& setting) {
    if (over.*setting.member) base.*setting.member = over.*setting.member;
  });
  return base;
}

Settings validate(const TypedSettings& typed) {
  Settings s;
  if (!typed.input)
    throw InputError("no surface file is given; name one on the command line or as input in the settings file");
  s.input = *typed.input;
  s.output = typed.output.value_or(s.input.stem().string() + ".h5");
  s.output_is_folder = !s.output.empty() && s.output.filename().empty(); // "models/"
  if (s.output.empty()) throw InputError(fmt::format("output = \"{}\": this is no file name", s.output.string()));
  s.scale = typed.scale.value_or(1);
  require(positive(s.scale), "scale", s.scale, "the factor on all coordinates must be positive");
  s.length_unit = typed.length_unit.value_or(s.length_unit);
  if (s.length_unit.empty()) throw InputError("length_unit is empty; give a label such as mm, or leave it out");
  s.title = typed.title.value_or(s.input.stem().string());
  s.cad = cad_settings(typed);
  s.surface = surface_options(typed);
  s.grid = grid_options(typed);
  s.optimise_offset = typed.optimise_offset.value_or(false);
  if (s.optimise_offset && s.grid.box)
    throw InputError("optimise_offset and box are both given; an explicit box fixes the grid's place: leave one out");
  s.trim.sliver_tolerance = typed.sliver_tolerance.value_or(s.trim.sliver_tolerance);
  require(s.trim.sliver_tolerance >= 0 && s.trim.sliver_tolerance <= 0.1, "sliver_tolerance", s.trim.sliver_tolerance,
          "it is a depth in spans between 0 and 0.1");
  s.trim.min_fraction = typed.min_fraction.value_or(s.trim.min_fraction);
  require(s.trim.min_fraction >= 0 && s.trim.min_fraction < 1, "min_fraction", s.trim.min_fraction,
          "it is a volume fraction from 0 to below 1");
  const std::string gap_ends = typed.gap_ends.value_or("split");
  s.trim.split_gap_ends = gap_ends == "split";
  if (gap_ends != "split" && gap_ends != "glued")
    throw InputError(fmt::format("gap_ends = \"{}\" is not known; choose split or glued", gap_ends));
  s.quadrature = quadrature_options(typed, s.grid.degree);
  return s;
}

std::string canonical_text(const Settings& s) {
  CanonicalText canonical;
  each_setting([&](const auto& setting) {
    if (setting.canonical) setting.canonical(canonical, s);
  });
  return canonical.text;
}

} // namespace iga::prep
