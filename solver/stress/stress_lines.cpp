#include "solver/stress/stress_lines.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/base/run_tables.hpp"
#include "solver/space/locate.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr int points_per_piece = 5; // exact for degree 9: stress of degree 5 times the distance, with room

Eigen::Matrix3d tensor(const Voigt& s) {
  Eigen::Matrix3d t;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) t(a, b) = s[voigt_place[a][b]];
  return t;
}

Voigt voigt(const Eigen::Matrix3d& t) {
  Voigt s;
  s << t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(1, 2), t(2, 0);
  return s;
}

} // namespace

std::vector<io::TableKeys> stress_line_keys() {
  return {{"line", {"name", "body", "from", "to"}}};
}

std::vector<StressLine> read_stress_lines(io::SettingsTable& root) {
  std::vector<StressLine> lines;
  for (io::SettingsTable& table : root.tables("line")) {
    StressLine line;
    line.name = read_name(table, "name", fmt::format("line {}", lines.size() + 1));
    line.body = table.text("body").value_or("");
    line.where = place_of(table, "from");
    line.from = need_vector(table, "from", "the place where the line enters the wall");
    line.to = need_vector(table, "to", "the place where it leaves the wall");
    if (line.from == line.to)
      refuse(table, "to", "the line has no length; it goes from one side of a wall to the other");
    lines.push_back(std::move(line));
  }
  return lines;
}

LinePoints points_of(const TrimmedModel& model, const StressLine& line) {
  LinePoints out;
  const Point3 way = minus(line.to, line.from);
  out.length = norm(way);
  out.along = times(way, 1 / out.length);
  const Point3 u = model.grid.to_parameter(line.from), v = model.grid.to_parameter(line.to);
  std::vector<double> cuts{0, 1};
  for (std::size_t d = 0; d < 3; ++d) {
    const KnotVector& knots = model.grid.knots(static_cast<int>(d));
    for (std::int64_t s = 0; s <= knots.num_spans(); ++s) {
      const double face = s < knots.num_spans() ? knots.lower(s) : knots.upper(s - 1);
      const double share = (face - u[d]) / (v[d] - u[d]);
      if (share > 1e-9 && share < 1 - 1e-9) cuts.push_back(share); // not of lines along the face
    }
  }
  std::sort(cuts.begin(), cuts.end());
  const Locator locator(model);
  const auto add = [&](double share, double weight) {
    const LocatedPoint at =
        locator.locate(plus(line.from, times(way, share)), fmt::format("{}: line '{}'", line.where, line.name));
    out.points.cell.push_back(at.cell);
    out.points.parameters.insert(out.points.parameters.end(), at.parameter.begin(), at.parameter.end());
    out.distance.push_back(share * out.length);
    out.weight.push_back(weight * out.length);
  };
  add(0, 0);
  add(1, 0);
  const Eigen::MatrixX2d rule = gauss_rule(points_per_piece);
  for (std::size_t c = 1; c < cuts.size(); ++c) {
    const double piece = cuts[c] - cuts[c - 1];
    if (piece < 1e-9) continue; // of two faces at once
    for (Eigen::Index k = 0; k < rule.rows(); ++k) add(cuts[c - 1] + piece * rule(k, 0), piece * rule(k, 1));
  }
  return out;
}

LinearisedStress linearise(const LinePoints& line, const RecoveredStress& stress) {
  LinearisedStress out;
  out.membrane.setZero();
  Voigt moment = Voigt::Zero();
  const auto at = [&](std::size_t k) { return Voigt(Eigen::Map<const Voigt>(&stress.stress[6 * k])); };
  for (std::size_t k = 2; k < line.weight.size(); ++k) {
    out.membrane += line.weight[k] / line.length * at(k);
    moment += line.weight[k] * (0.5 * line.length - line.distance[k]) * 6 / (line.length * line.length) * at(k);
  }
  const Eigen::Vector3d t = as_vector(line.along);
  const Eigen::Matrix3d wall = Eigen::Matrix3d::Identity() - t * t.transpose();
  out.bending = voigt(wall * tensor(moment) * wall);
  out.von_mises_membrane = von_mises(out.membrane);
  for (std::size_t end = 0; end < 2; ++end) {
    const Voigt linear = out.membrane + (end == 0 ? 1 : -1) * out.bending;
    out.total[end] = at(end);
    out.peak[end] = out.total[end] - linear;
    out.von_mises_linear[end] = von_mises(linear);
    out.von_mises_total[end] = von_mises(out.total[end]);
  }
  out.error = *std::max_element(stress.error.begin(), stress.error.end());
  return out;
}

} // namespace iga::solve
