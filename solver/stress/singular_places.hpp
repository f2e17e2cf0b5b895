// Where stress has no limit as spans shrink: sharp re-entrant edges, the ends of supports, lines and points that
// supports and loads act on.
#pragma once

#include "solver/base/bvh.hpp"
#include "solver/supports/boundary.hpp"

#include <optional>
#include <string>

namespace iga::solve {

class SingularPlaces {
 public:
  /// @param supports  of the body
  /// @param regions   that supports and loads of the body act on, with their names ("support 'edge'")
  SingularPlaces(const TrimmedModel& model, std::span<const Support> supports,
                 std::span<const std::pair<std::string, RegionReport>> regions);

  /// What lies nearer than two spans: "a sharp re-entrant edge", "the end of support 'base'", "support 'edge'".
  std::optional<std::string> near(const Point3& x) const;

 private:
  struct Line {
    std::string what;
    Point3 from{}, to{};
  };
  void add_edges(const TrimmedModel& model, std::span<const Support> supports);
  void add_end(const TrimmedModel& model, const Support& support, std::span<const Line> sliding);

  double reach_ = 0; ///< length
  std::vector<Line> lines_;
  Bvh boxes_;
};

} // namespace iga::solve
