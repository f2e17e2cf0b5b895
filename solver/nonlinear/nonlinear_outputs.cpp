#include "solver/nonlinear/nonlinear_outputs.hpp"

#include "format/io/field_files.hpp"
#include "format/io/results_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "format/model/time_series.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
}

void append(std::vector<double>& values, const Point3& x) {
  values.insert(values.end(), x.begin(), x.end());
}

} // namespace

NonlinearOutputs::NonlinearOutputs(const NonlinearRun& run, const NonlinearStatics& statics,
                                   std::filesystem::path results, Results head)
    : run_(run), statics_(statics), path_(std::move(results)), folder_(path_.parent_path()), results_(std::move(head)),
      sampler_(statics.body().space().model(), nonlinear_body, run.material.law, run.subdivide) {
  TimeSeries series;
  series.bodies.emplace_back();
  series.bodies.back().name = nonlinear_body;
  for (const ToolContactSettings& contact : run.contacts) {
    series.contacts.emplace_back();
    series.contacts.back().name = contact.name;
  }
  for (const RigidRun& rigid : run.rigid) {
    series.rigid.emplace_back();
    series.rigid.back().name = rigid.body.name;
  }
  for (const Support& support : run.supports) series.supports.push_back({support.name, {}});
  for (const Probe& probe : run.probes) series.probes.push_back({probe.name, {}});
  results_.time_series = std::move(series);
  if (!path_.empty()) results_.fields = FieldIndex{io::bodies_file(path_), {}, {}};
}

void NonlinearOutputs::begin() {
  if (path_.empty()) return;
  make_folder((folder_ / io::field_file(path_, 0)).parent_path());
  io::remove_fields_from(path_, 0);
  io::remove_viewer_parts_from(path_, 0);
  io::write_body_meshes(folder_ / results_.fields->bodies_file, std::vector<BodyMesh>{sampler_.mesh()});
}

void NonlinearOutputs::resume(Results before, std::size_t rows) {
  if (!before.time_series || !before.fields || before.time_series->time.size() < rows ||
      before.fields->times.size() < rows)
    throw InputError(fmt::format("{}: does not hold the {} steps that the restart file says; they belong to different "
                                 "runs",
                                 path_.string(), rows));
  cut_series(*before.time_series, rows);
  before.fields->times.resize(rows);
  before.fields->files.resize(rows);
  for (const std::string& file : before.fields->files)
    if (!std::filesystem::exists(folder_ / file))
      throw InputError(fmt::format("{}: is missing; {} lists it", (folder_ / file).string(), path_.string()));
  results_.time_series = std::move(before.time_series);
  results_.fields = std::move(before.fields);
  io::remove_fields_from(path_, rows);
  io::remove_viewer_parts_from(path_, rows);
  if (run_.viewer) write_index();
}

void NonlinearOutputs::record(const StepReport& step) {
  TimeSeries& t = *results_.time_series;
  t.time.push_back(statics_.factor());
  t.iterations.push_back(step.iterations);
  t.residual.push_back(step.residual);
  // In the order of TimeSeries::energy_names.
  t.energy[0].push_back(statics_.internal_work());
  if (!run_.contacts.empty()) {
    t.energy[2].push_back(statics_.contact_energy());
    t.energy[3].push_back(statics_.friction_energy());
    t.energy[5].push_back(statics_.external_work());
  }
  record_contacts(t);
  t.bodies[0].min_volume_ratio.push_back(step.points.min_J);
  t.bodies[0].inverted.push_back(static_cast<double>(step.points.inverted));
  const std::vector<SupportForce> forces = statics_.support_forces();
  for (std::size_t s = 0; s < forces.size(); ++s) append(t.supports[s].force, forces[s].force);
  const std::vector<Point3> probes = statics_.probe_displacements();
  for (std::size_t k = 0; k < probes.size(); ++k) append(t.probes[k].displacement, probes[k]);
}

void NonlinearOutputs::record_contacts(TimeSeries& t) const {
  std::vector<Point3> force(run_.rigid.size()), moment(run_.rigid.size());
  for (std::size_t c = 0; c < run_.contacts.size(); ++c) {
    const ToolContactReport& report = statics_.contact_reports()[c];
    TimeSeries::Contact& row = t.contacts[c];
    append(row.force, times(report.force, run_.contacts[c].swapped ? -1 : 1));
    row.normal_force.push_back(report.normal_force);
    row.friction_force.push_back(report.friction_force);
    row.depth.push_back(report.depth);
    row.area.push_back(report.area);
    const std::size_t tool = run_.contacts[c].tool;
    force[tool] = minus(force[tool], report.force);
    moment[tool] = minus(moment[tool], report.moment);
  }
  for (std::size_t r = 0; r < run_.rigid.size(); ++r) {
    TimeSeries::Rigid& row = t.rigid[r];
    const Pose pose = pose_of(run_.rigid[r].body, statics_.factor());
    append(row.position, as_point(pose.centre));
    for (const double q : {pose.turn.w(), pose.turn.x(), pose.turn.y(), pose.turn.z()}) row.rotation.push_back(q);
    append(row.force, force[r]);
    append(row.moment, moment[r]);
  }
}

void NonlinearOutputs::write_fields() {
  const std::size_t step = results_.fields->times.size();
  const FiniteBody& body = statics_.body();
  const std::vector<BodyFields> fields{sampler_.sample(body.space().expand(statics_.displacement()), body.save(),
                                                       body.point(), run_.points,
                                                       body.scales(statics_.displacement()))};
  io::write_fields(folder_ / io::field_file(path_, step), statics_.factor(), fields);
  results_.fields->times.push_back(statics_.factor());
  results_.fields->files.push_back(io::field_file(path_, step));
  if (!run_.viewer) return;
  const std::string part = io::viewer_part(path_, step, 0);
  make_folder((folder_ / part).parent_path());
  TriangleMesh mesh = sampler_.mesh().surface.mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (std::size_t d = 0; d < 3; ++d) mesh.vertices[v][d] += fields[0].displacement[3 * v + d];
  std::vector<io::VtpArray> arrays{{"displacement", 3, fields[0].displacement},
                                   {"von_mises", 1, fields[0].von_mises},
                                   {"strain", 1, fields[0].strain}};
  if (!fields[0].plastic_strain.empty()) arrays.push_back({"plastic_strain", 1, fields[0].plastic_strain});
  io::write_vtp(folder_ / part, mesh, arrays, std::vector<io::VtpNumber>{{"time", statics_.factor()}});
  write_index();
}

void NonlinearOutputs::write_index() const {
  std::vector<io::ViewerEntry> entries;
  for (std::size_t step = 0; step < results_.fields->times.size(); ++step)
    if (std::filesystem::exists(folder_ / io::viewer_part(path_, step, 0)))
      entries.push_back({results_.fields->times[step], 0, io::viewer_part(path_, step, 0)});
  io::write_viewer_index(io::viewer_index(path_), entries);
}

void NonlinearOutputs::add(const StepReport& step) {
  record(step);
  if (path_.empty()) return;
  write_fields();
  publish();
}

void NonlinearOutputs::publish() {
  if (!path_.empty()) io::write_results(path_, results_, true);
}

} // namespace iga::solve
