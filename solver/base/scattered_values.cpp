#include "solver/base/scattered_values.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <numeric>

namespace iga::solve {

namespace {

// Enough for a linear function with neighbours on all sides of a regular grid (8 corners of the cell and more).
constexpr std::size_t most_neighbours = 16;
// Points whose spread across a plane or line is below this share of the largest one lie in it.
constexpr double flat = 1e-6;

} // namespace

ScatteredValues::ScatteredValues(std::vector<Point3> points, std::vector<double> values)
    : points_(std::move(points)), values_(std::move(values)) {
  build(0, points_.size(), 0);
}

void ScatteredValues::build(std::size_t first, std::size_t last, std::size_t axis) {
  if (last - first < 2) return;
  std::vector<std::size_t> order(last - first);
  std::iota(order.begin(), order.end(), first);
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>((last - first) / 2);
  std::nth_element(order.begin(), middle, order.end(),
                   [&](std::size_t a, std::size_t b) { return points_[a][axis] < points_[b][axis]; });
  std::vector<Point3> points;
  std::vector<double> values;
  for (const std::size_t k : order) {
    points.push_back(points_[k]);
    values.push_back(values_[k]);
  }
  std::copy(points.begin(), points.end(), points_.begin() + static_cast<std::ptrdiff_t>(first));
  std::copy(values.begin(), values.end(), values_.begin() + static_cast<std::ptrdiff_t>(first));
  const std::size_t split = first + (last - first) / 2;
  build(first, split, (axis + 1) % 3);
  build(split + 1, last, (axis + 1) % 3);
}

void ScatteredValues::search(std::size_t first, std::size_t last, std::size_t axis, const Point3& x, std::size_t count,
                             std::vector<Near>& heap) const {
  if (first >= last) return;
  const auto farther = [](const Near& a, const Near& b) { return a.distance2 < b.distance2; };
  const std::size_t split = first + (last - first) / 2;
  const Point3 d = minus(points_[split], x);
  if (heap.size() < count || dot(d, d) < heap.front().distance2) {
    if (heap.size() == count) {
      std::pop_heap(heap.begin(), heap.end(), farther);
      heap.pop_back();
    }
    heap.push_back({dot(d, d), split});
    std::push_heap(heap.begin(), heap.end(), farther);
  }
  const bool lower_first = x[axis] < points_[split][axis];
  const auto go = [&](bool lower) {
    search(lower ? first : split + 1, lower ? split : last, (axis + 1) % 3, x, count, heap);
  };
  go(lower_first);
  if (heap.size() < count || d[axis] * d[axis] < heap.front().distance2) go(!lower_first);
}

std::vector<ScatteredValues::Near> ScatteredValues::nearest(const Point3& x, std::size_t count) const {
  std::vector<Near> heap;
  search(0, points_.size(), 0, x, std::min(count, points_.size()), heap);
  std::sort(heap.begin(), heap.end(), [](const Near& a, const Near& b) {
    return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && a.point < b.point);
  });
  return heap;
}

double ScatteredValues::distance_to_nearest(const Point3& x) const {
  return std::sqrt(nearest(x, 1).front().distance2);
}

double ScatteredValues::at(const Point3& x) const {
  const std::vector<Near> near = nearest(x, most_neighbours + 1);
  const double closest = std::sqrt(near.front().distance2), reach = std::sqrt(near.back().distance2);
  if (near.size() == 1 || closest <= 1e-12 * reach) return values_[near.front().point];
  // Few points: the last one, too, shall count.
  const double R = near.size() <= most_neighbours ? 1.1 * reach : reach;
  const auto n = static_cast<Eigen::Index>(near.size());
  Eigen::MatrixX3d places(n, 3);
  Eigen::VectorXd values(n), weights(n); // roots of the weights, at most 1
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& [distance2, point] = near[static_cast<std::size_t>(k)];
    const double d = std::sqrt(distance2);
    const Point3 from = times(minus(points_[point], x), 1 / reach);
    weights[k] = closest * (R - d) / (R * d);
    places.row(k) << from[0], from[1], from[2];
    values[k] = values_[point];
  }
  const Eigen::VectorXd share = weights.cwiseAbs2() / weights.squaredNorm();
  const Eigen::RowVector3d middle = share.transpose() * places;
  const double mean = share.dot(values);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixX3d> fit;
  fit.setThreshold(flat);
  fit.compute(weights.asDiagonal() * (places.rowwise() - middle));
  const Eigen::Vector3d slope = fit.solve(weights.asDiagonal() * (values.array() - mean).matrix());
  return mean - middle.dot(slope);
}

ScatteredValues read_scattered_values(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw InputError(fmt::format("{}: cannot be opened; expected lines of x, y, z, value", file.string()));
  std::vector<Point3> points;
  std::vector<double> values;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos || line[start] == '#') continue;
    std::vector<double> row;
    const char* at = line.c_str() + start;
    for (char* end = nullptr;; at = end) {
      while (*at == ' ') ++at;
      const double value = std::strtod(at, &end);
      if (end == at) break;
      row.push_back(value);
    }
    const bool ended = *at == '\0';
    if (points.empty() && row.empty()) continue; // names
    if (!ended || row.size() != 4 || !std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); }))
      throw InputError(fmt::format("{}:{}: found \"{}\", expected four finite numbers x, y, z, value", file.string(),
                                   number, line.substr(start)));
    points.push_back({row[0], row[1], row[2]});
    values.push_back(row[3]);
  }
  if (points.empty())
    throw InputError(fmt::format("{}: holds no points; expected lines of x, y, z, value", file.string()));
  std::vector<Point3> sorted = points;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    throw InputError(fmt::format("{}: the point ({:g}, {:g}, {:g}) is given twice; leave one of the lines out",
                                 file.string(), (*twice)[0], (*twice)[1], (*twice)[2]));
  return {std::move(points), std::move(values)};
}

} // namespace iga::solve
