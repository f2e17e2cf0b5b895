// All series of an explicit or nonlinear analysis under the names they have in the results file, one by one: writing,
// reading, appending and cutting off are loops over them.
#pragma once

#include "format/model/results.hpp"

namespace iga {

/// One series and the texts of its dataset.
struct SeriesColumn {
  std::string path; ///< below /time_series: "contact/plate/force"
  const char* unit;
  const char* order;
  const char* description;
  std::int64_t components = 1;
  bool required = false; ///< in every file that has time series
};

/// Calls visit(SeriesColumn, std::vector<double>&) for each series that `t` (TimeSeries, or const) may hold.
template <class Series, class Visit> void for_each_series(Series& t, Visit&& visit) {
  constexpr const char *scalar = "(time)", *vector = "(time; x y z)";
  visit(SeriesColumn{"time", "time", "ascending", "times of the series; of nonlinear statics load factors", 1, true},
        t.time);
  visit(SeriesColumn{"dt", "time", scalar, "time step that follows"}, t.dt);
  visit(SeriesColumn{"energy_error", "1", scalar, "change of the sum of energies / largest energy so far"},
        t.energy_error);
  constexpr std::array what{"internal energy", "kinetic energy",  "contact energy", "friction energy",
                            "damping energy",  "external energy", "eroded energy"};
  for (std::size_t i = 0; i < t.energy.size(); ++i)
    visit(SeriesColumn{std::string("energy/") + TimeSeries::energy_names[i], "force*length", scalar, what[i]},
          t.energy[i]);
  for (auto& c : t.contacts) {
    const std::string at = "contact/" + c.name + "/";
    visit(SeriesColumn{at + "force", "force", vector, "force on the first-named body", 3, true}, c.force);
    visit(SeriesColumn{at + "impulse", "force*time", vector, "integral of the force since the start", 3}, c.impulse);
    visit(SeriesColumn{at + "normal_force", "force", scalar, "sum of the sizes of normal forces"}, c.normal_force);
    visit(SeriesColumn{at + "friction_force", "force", scalar, "sum of the sizes of frictional forces"},
          c.friction_force);
    visit(SeriesColumn{at + "depth", "length", scalar, "deepest penetration"}, c.depth);
    visit(SeriesColumn{at + "area", "length^2", scalar, "area in contact, undeformed"}, c.area);
  }
  for (auto& b : t.bodies) {
    const std::string at = "body/" + b.name + "/";
    visit(SeriesColumn{at + "momentum", "mass*length/time", vector, "momentum, half a step later", 3}, b.momentum);
    visit(SeriesColumn{at + "angular_momentum", "mass*length^2/time", vector, "angular momentum about the origin", 3},
          b.angular_momentum);
    visit(SeriesColumn{at + "impulse", "mass*length/time", vector, "given by loads, contact and damping", 3},
          b.impulse);
    visit(SeriesColumn{at + "angular_impulse", "mass*length^2/time", vector, "given likewise, about the origin", 3},
          b.angular_impulse);
    visit(SeriesColumn{at + "min_volume_ratio", "1", scalar, "smallest det F at a quadrature point"},
          b.min_volume_ratio);
    visit(SeriesColumn{at + "inverted", "1", scalar, "points that inverted so far, step by step"}, b.inverted);
    visit(SeriesColumn{at + "eroded", "1", scalar, "points taken out so far"}, b.eroded);
  }
  for (auto& r : t.rigid) {
    const std::string at = "rigid/" + r.name + "/";
    visit(SeriesColumn{at + "position", "length", vector, "position of the centre", 3}, r.position);
    visit(SeriesColumn{at + "rotation", "1", "(time; w x y z)", "unit quaternion from the axes at the start", 4},
          r.rotation);
    visit(SeriesColumn{at + "velocity", "length/time", vector, "velocity of the centre, half a step later", 3},
          r.velocity);
    visit(SeriesColumn{at + "force", "force", vector, "force of all contacts", 3}, r.force);
    visit(SeriesColumn{at + "moment", "force*length", vector, "moment of all contacts about the centre", 3}, r.moment);
  }
  for (auto& s : t.supports)
    visit(SeriesColumn{"support/" + s.name + "/force", "force", vector, "force of the support on the body", 3},
          s.force);
  for (auto& p : t.probes)
    visit(SeriesColumn{"probe/" + p.name + "/displacement", "length", vector, "displacement of the probe", 3},
          p.displacement);
  visit(SeriesColumn{"iterations", "1", scalar, "iterations of Newton's method in the step"}, t.iterations);
  visit(SeriesColumn{"residual", "1", scalar, "forces out of balance / forces"}, t.residual);
}

/// Keeps the first `rows` outputs.
inline void cut_series(TimeSeries& t, std::size_t rows) {
  for_each_series(t, [rows](const SeriesColumn& column, std::vector<double>& values) {
    const std::size_t entries = rows * static_cast<std::size_t>(column.components);
    if (values.size() > entries) values.resize(entries);
  });
}

} // namespace iga
