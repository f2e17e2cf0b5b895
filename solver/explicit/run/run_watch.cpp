#include "solver/explicit/run/run_watch.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// In spans: what touches without a force is none of rounding.
constexpr double forceless_warning = 0.01;

template <class Value> std::size_t largest(std::span<const PairForce> pairs, Value value) {
  std::size_t most = 0;
  for (std::size_t p = 1; p < pairs.size(); ++p)
    if (value(pairs[p]) > value(pairs[most])) most = p;
  return most;
}

std::string at_point(const Point3& x) {
  return fmt::format("near ({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
}

} // namespace

void RunWatch::judge(Kind kind, double time, double value, double warning, double limit,
                     const std::function<std::string()>& what, const char* advice) {
  Finding& finding = findings_[kind];
  if (value > finding.worst) {
    finding.worst = value;
    finding.when = time;
  }
  if (warning > 0 && value > warning && finding.first.empty()) {
    finding.first = fmt::format("t = {:.6g}: {}", time, what());
    if (warn_) warn_(fmt::format("{}; {}", finding.first, advice));
  }
  if (limit > 0 && value > limit)
    throw NumericalError(fmt::format("t = {:.6g}: {}, more than {:g} is not allowed; {}", time, what(), limit, advice));
}

void RunWatch::look(const ExplicitScene& scene) {
  if (scene.contact()) look_at_contact(scene);
  look_at_supports(scene);
  look_at_points(scene);
}

void RunWatch::look_at_contact(const ExplicitScene& scene) {
  const Integrator& integrator = scene.integrator();
  const WatchLimits& limits = scene.run().watch;
  const auto& pairs = scene.contact()->report().pairs;
  if (pairs.empty()) return;
  const std::size_t hardest = largest(pairs, [](const PairForce& pair) { return pair.normal_force; });
  if (const double largest = integrator.largest_energy(); largest > 0)
    judge(
        Contact, integrator.time(), -integrator.energy().contact / largest, limits.contact_warning,
        limits.contact_limit,
        [&] {
          return fmt::format(
              "contact gave back {:.4g} more energy than it took, {:.3g} of the largest energy so far; the "
              "largest force now acts in contact '{}' {}",
              -integrator.energy().contact, -integrator.energy().contact / largest, pairs[hardest].name,
              at_point(pairs[hardest].deepest));
        },
        "take shorter steps ([time] dt_max or safety), smaller spans or contact triangles");
  look_at_depth(scene, pairs);
}

void RunWatch::look_at_depth(const ExplicitScene& scene, std::span<const PairForce> pairs) {
  const Integrator& integrator = scene.integrator();
  const WatchLimits& limits = scene.run().watch;
  const std::size_t deepest = largest(pairs, [](const PairForce&pair) { return pair.depth_in_spans(); }),
                    through = largest(pairs, [](const PairForce&pair) { return pair.wall_share; }),
                    forceless = largest(pairs, [](const PairForce&pair) { return pair.forceless_in_spans(); });
  judge(
      Depth, integrator.time(), pairs[deepest].depth_in_spans(), limits.depth_warning, limits.depth_limit,
      [&] {
        return fmt::format("contact '{}': one side lies {:.4g} deep in the other, {:.3g} spans, {}",
                           pairs[deepest].name, pairs[deepest].largest_depth, pairs[deepest].depth_in_spans(),
                           at_point(pairs[deepest].deepest));
      },
      "take shorter steps ([time] dt_max), which make contact stiffer, or smaller spans");
  judge(
      Wall, integrator.time(), pairs[through].wall_share, limits.wall_warning, limits.wall_limit,
      [&] {
        return fmt::format("contact '{}': one side lies {:.4g} deep in the other, {:.3g} of the wall's thickness, {}",
                           pairs[through].name, pairs[through].wall_depth, pairs[through].wall_share,
                           at_point(pairs[through].in_wall));
      },
      "contact is soft beside walls thinner than a span; half the step ([time] dt_max) makes it four times as stiff");
  judge(
      Forceless, integrator.time(), pairs[forceless].forceless_in_spans(), forceless_warning, 0,
      [&] {
        return fmt::format("contact '{}': one side lies {:.4g} deep in the other without a force, {}",
                           pairs[forceless].name, pairs[forceless].forceless_depth,
                           at_point(pairs[forceless].forceless));
      },
      "supports take all the stiffness that the step allows there: take shorter steps ([time] dt_max) or softer "
      "supports (stiffness)");
}

void RunWatch::look_at_supports(const ExplicitScene& scene) {
  const WatchLimits& limits = scene.run().watch;
  for (std::size_t s = 0; s < scene.supports().size(); ++s) {
    const SupportRun& support = scene.run().supports[s];
    const Point3 h = scene.body(support.body).space().model().grid.span_size();
    const double miss = scene.supports()[s]->largest_miss(), span = std::min({h[0], h[1], h[2]});
    judge(
        Support, scene.integrator().time(), miss / span, limits.support_warning, limits.support_limit,
        [&] {
          return fmt::format("support '{}' gives way: its surface is {:.4g} from where it should be, {:.3g} spans",
                             support.region.name, miss, miss / span);
        },
        "take shorter steps ([time] dt_max), which make supports stiffer, or smaller spans");
  }
}

void RunWatch::look_at_points(const ExplicitScene& scene) {
  const Integrator& integrator = scene.integrator();
  const WatchLimits& limits = scene.run().watch;
  for (std::size_t b = 0; b < scene.num_bodies(); ++b) {
    const ForceReport& report = integrator.report(b);
    if (report.inverted == 0) continue;
    const auto points = static_cast<double>(scene.body(b).space().model().points.weights.size());
    judge(
        Inverted, integrator.time(), static_cast<double>(report.inverted) / points, limits.inverted_warning,
        limits.inverted_limit,
        [&] {
          return fmt::format(
              "body '{}': {} of {} points are crushed below min_volume_ratio, the first {}; the smallest "
              "volume ratio is {:.3g}",
              scene.run().bodies[b].body.name, report.inverted, points, integrator.place(b, report.inverted_span),
              report.min_J);
        },
        "their stress is no longer that of the material: give a law that stiffens before (a yield curve up to full "
        "density), a smaller load or smaller spans");
  }
}

std::vector<std::string> RunWatch::warnings() const {
  constexpr std::array<const char*, num_kinds> names{
      "energy that contact gave back beyond what it took, of the largest",
      "depth of a contact in spans",
      "depth of a contact as share of a wall",
      "depth of a contact without force in spans",
      "way that a support gives in spans",
      "share of crushed points of a body"};
  std::vector<std::string> all;
  for (std::size_t k = 0; k < num_kinds; ++k)
    if (!findings_[k].first.empty())
      all.push_back(fmt::format("{}; at worst: {} {:.3g} at t = {:.6g}", findings_[k].first, names[k],
                                findings_[k].worst, findings_[k].when));
  return all;
}

} // namespace iga::solve
