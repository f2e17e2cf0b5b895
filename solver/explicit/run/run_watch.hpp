// Looks after each step for what makes results of a run worthless although it goes on: contact that gives back more
// energy than it got, sides that sink through each other, points crushed beyond their law.
#pragma once

#include "solver/explicit/run/run_scene.hpp"

#include <array>
#include <functional>
#include <span>

namespace iga::solve {

class RunWatch {
 public:
  using Warn = std::function<void(const std::string&)>;
  /// @param warn  called once for each kind of trouble, in the step in which it is met first
  explicit RunWatch(Warn warn) : warn_(std::move(warn)) {}

  /// @throws NumericalError above the limits of WatchLimits, with time, place and what to do
  void look(const ExplicitScene& scene);
  /// One sentence for each kind of trouble met: when first, and how bad it became.
  std::vector<std::string> warnings() const;

 private:
  struct Finding {
    double worst = 0, when = 0;
    std::string first; ///< empty: none
  };
  enum Kind : std::size_t { Contact, Depth, Wall, Forceless, Support, Inverted, num_kinds };
  void judge(Kind kind, double time, double value, double warning, double limit,
             const std::function<std::string()>& what, const char* advice);
  void look_at_contact(const ExplicitScene& scene);
  void look_at_depth(const ExplicitScene& scene, std::span<const PairForce> pairs);
  void look_at_supports(const ExplicitScene& scene);
  void look_at_points(const ExplicitScene& scene);

  Warn warn_;
  std::array<Finding, num_kinds> findings_;
};

} // namespace iga::solve
