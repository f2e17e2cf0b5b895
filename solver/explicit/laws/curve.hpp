// A piecewise linear curve y(x): yield stress over strain.
#pragma once

#include "solver/explicit/simd/pack.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace iga::solve {

/// Constant left of its first point, its last slope goes on right of the last one.
class Curve {
 public:
  /// The flat curve y = 0 through one point.
  Curve() : Curve({0}, {0}, "curve") {}
  /// @param name opens the messages: where the curve was written
  /// @throws InputError unless there are as many y as x, at least one, all finite, x strictly ascending
  Curve(std::vector<double> x, std::vector<double> y, const std::string& name);
  /// Two columns of a text file (read_two_columns). @throws InputError naming file and line
  static Curve read_csv(const std::filesystem::path& file);

  std::size_t size() const { return x_.size(); }
  const std::vector<double>& x() const { return x_; }
  const std::vector<double>& y() const { return y_; }
  double value(double x) const;
  /// dy/dx right of x.
  double slope(double x) const;
  double final_slope() const { return slope_.back(); }

  /// The line y + slope (· - x) of one piece of the curve, per lane.
  struct Piece {
    Pack x, y, slope;
    Pack value(const Pack& at) const { return y + slope * (at - x); }
  };
  /// The last piece whose start `reached(x, y)` holds (a PackMask); the constant one where none does. Once false along
  /// the curve it has to stay false.
  template <class Reached> Piece last_piece(Reached reached) const {
    constexpr std::size_t stride = 16; // long curves: lanes of one pack lie close together, skip what all have passed
    std::size_t k = 0;
    while (k + stride < x_.size() && !any(~reached(x_[k + stride], y_[k + stride]))) k += stride;
    Piece p{pack(x_[0]), pack(y_[0]), Pack{}};
    for (; k < x_.size(); ++k) {
      const PackMask m = reached(x_[k], y_[k]);
      if (!any(m)) break;
      p.x = m ? pack(x_[k]) : p.x;
      p.y = m ? pack(y_[k]) : p.y;
      p.slope = m ? pack(slope_[k]) : p.slope;
    }
    return p;
  }
  Piece piece_at(const Pack& x) const {
    return last_piece([&](double start, double) -> PackMask { return x >= start; });
  }

 private:
  std::vector<double> x_, y_, slope_; // slope_[k] right of x_[k]
};

} // namespace iga::solve
