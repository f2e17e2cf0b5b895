#include "solver/explicit/run/series_recorder.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

void append(std::vector<double>& values, const auto& three) {
  for (std::size_t d = 0; d < 3; ++d) values.push_back(three[static_cast<Eigen::Index>(d)]);
}
void append(std::vector<double>& values, const Point3& x) {
  values.insert(values.end(), x.begin(), x.end());
}

// "rigid/sphere/velocity.z": the last letter chooses a component.
std::vector<std::string> quantities(const SeriesColumn& column) {
  if (column.components == 1) return {column.path};
  const std::string letters = column.components == 4 ? "wxyz" : "xyz";
  std::vector<std::string> names;
  for (const char c : letters) names.push_back(column.path + "." + c);
  return names;
}

} // namespace

SeriesRecorder::SeriesRecorder(const ExplicitScene& scene) : scene_(&scene) {
  const ExplicitRun& run = scene.run();
  for (const ContactRun& contact : run.contacts) {
    series_.contacts.emplace_back();
    series_.contacts.back().name = contact.pair.name;
  }
  for (const BodyRun& body : run.bodies) {
    series_.bodies.emplace_back();
    series_.bodies.back().name = body.body.name;
  }
  for (const RigidRun& rigid : run.rigid) {
    series_.rigid.emplace_back();
    series_.rigid.back().name = rigid.body.name;
  }
  for (const SupportRun& support : run.supports) series_.supports.push_back({support.region.name, {}});
  impulses_.assign(3 * run.contacts.size(), 0);
  std::vector<std::string> known;
  std::vector<Watch> places;
  std::size_t number = 0;
  for_each_series(series_, [&](const SeriesColumn& column, const std::vector<double>&) {
    std::size_t component = 0;
    for (std::string& name : quantities(column)) {
      known.push_back(std::move(name));
      places.push_back({0, number, component++});
    }
    ++number;
  });
  for (std::size_t s = 0; s < run.stops.size(); ++s) {
    const auto found = std::find(known.begin(), known.end(), run.stops[s].quantity);
    if (found == known.end()) {
      const auto near = io::nearest_name(run.stops[s].quantity, known);
      throw InputError(fmt::format("{}: there is no series \"{}\"{}", run.stops[s].where, run.stops[s].quantity,
                                   near ? fmt::format("; did you mean \"{}\"?", *near)
                                        : "; give one such as \"energy/kinetic\" or \"contact/<name>/force.z\""));
    }
    watches_.push_back(places[static_cast<std::size_t>(found - known.begin())]);
    watches_.back().condition = s;
  }
}

void SeriesRecorder::add_step(double dt_last) {
  if (!scene_->contact()) return;
  const double dt = 0.5 * (dt_last + scene_->integrator().dt());
  const auto& pairs = scene_->contact()->report().pairs;
  for (std::size_t c = 0; c < pairs.size(); ++c) {
    const double sign = scene_->run().contacts[c].swapped ? -1 : 1;
    for (std::size_t d = 0; d < 3; ++d) impulses_[3 * c + d] += sign * dt * pairs[c].force[d];
  }
}

void SeriesRecorder::record() {
  const Integrator& integrator = scene_->integrator();
  series_.time.push_back(integrator.time());
  series_.dt.push_back(integrator.dt());
  series_.energy_error.push_back(integrator.energy_error());
  const auto energies = integrator.energy().values();
  for (std::size_t i = 0; i < energies.size(); ++i) series_.energy[i].push_back(energies[i]);
  record_contacts();
  record_bodies();
  record_rigid();
  for (std::size_t s = 0; s < series_.supports.size(); ++s)
    append(series_.supports[s].force, scene_->supports()[s]->force());
}

void SeriesRecorder::record_contacts() {
  for (std::size_t c = 0; c < series_.contacts.size(); ++c) {
    const PairForce& pair = scene_->contact()->report().pairs[c];
    TimeSeries::Contact& row = series_.contacts[c];
    const double sign = scene_->run().contacts[c].swapped ? -1 : 1;
    for (std::size_t d = 0; d < 3; ++d) row.force.push_back(sign * pair.force[d]);
    row.impulse.insert(row.impulse.end(), &impulses_[3 * c], &impulses_[3 * c] + 3);
    row.normal_force.push_back(pair.normal_force);
    row.friction_force.push_back(pair.friction_force);
    row.depth.push_back(pair.largest_depth);
    row.area.push_back(pair.area);
  }
}

void SeriesRecorder::record_bodies() {
  const Integrator& integrator = scene_->integrator();
  for (std::size_t b = 0; b < series_.bodies.size(); ++b) {
    const MomentumBalance& m = integrator.momentum(b);
    TimeSeries::Body& row = series_.bodies[b];
    append(row.momentum, m.linear);
    append(row.angular_momentum, m.angular);
    append(row.impulse, m.linear_impulse);
    append(row.angular_impulse, m.angular_impulse);
    row.min_volume_ratio.push_back(integrator.report(b).min_J);
    row.inverted.push_back(static_cast<double>(integrator.inverted(b)));
    row.eroded.push_back(static_cast<double>(integrator.eroded(b)));
  }
}

void SeriesRecorder::record_rigid() {
  for (std::size_t r = 0; r < series_.rigid.size(); ++r) {
    const RigidState& body = scene_->contact()->rigid()[r];
    TimeSeries::Rigid& row = series_.rigid[r];
    // The evaluation at t_n has moved rigid bodies on to t_{n+1} already.
    const Pose &now = body.pose_before(), &next = body.pose();
    append(row.position, now.centre);
    for (const double q : {now.turn.w(), now.turn.x(), now.turn.y(), now.turn.z()}) row.rotation.push_back(q);
    append(row.velocity, ((next.centre - now.centre) / scene_->integrator().dt()).eval());
    append(row.force, body.force());
    append(row.moment, body.moment());
  }
}

const StopCondition* SeriesRecorder::stop() const {
  for (const Watch& watch : watches_) {
    const StopCondition& condition = scene_->run().stops[watch.condition];
    if (series_.time.empty() || series_.time.back() < condition.after) continue;
    std::size_t number = 0;
    double value = 0;
    for_each_series(series_, [&](const SeriesColumn& column, const std::vector<double>& values) {
      if (number++ == watch.column)
        value = values[values.size() - static_cast<std::size_t>(column.components) + watch.component];
    });
    if (condition.above ? value > condition.limit : value < condition.limit) return &condition;
  }
  return nullptr;
}

void SeriesRecorder::resume(TimeSeries rows, std::size_t count, const std::vector<double>& sums) {
  const auto shape = [](const TimeSeries& t) {
    std::vector<std::string> paths;
    for_each_series(t, [&](const SeriesColumn& column, const std::vector<double>&) { paths.push_back(column.path); });
    return paths;
  };
  if (sums.size() != impulses_.size())
    throw InputError(fmt::format("/sums: found {} numbers, expected {}; restart with the files that "
                                 "the run began with",
                                 sums.size(), impulses_.size()));
  if (shape(rows) != shape(series_))
    throw InputError(
        "the results file to go on with has other time series than this run; restart with the run file that "
        "it began with");
  if (rows.time.size() < count)
    throw InputError(
        fmt::format("the results file to go on with has {} outputs, the restart file says {}; they belong to "
                    "different runs",
                    rows.time.size(), count));
  cut_series(rows, count);
  series_ = std::move(rows);
  impulses_ = sums;
}

} // namespace iga::solve
