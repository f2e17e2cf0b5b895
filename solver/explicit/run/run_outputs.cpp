#include "solver/explicit/run/run_outputs.hpp"

#include "format/io/field_files.hpp"
#include "format/io/results_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/explicit/run/series_rigid_mesh.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr int least_gap = 20; // of the cost of writing the results file

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
}

double size_of(const std::vector<FieldSampler>& samplers) {
  double size = 0;
  for (const FieldSampler& sampler : samplers) {
    const Box3 box = bounding_box(sampler.mesh().surface.mesh);
    size = std::max(size, norm(minus(box.upper, box.lower)));
  }
  return size;
}

} // namespace

RunOutputs::RunOutputs(const ExplicitScene& scene, std::filesystem::path results, Results head)
    : scene_(scene), path_(std::move(results)), folder_(path_.parent_path()), results_(std::move(head)) {
  for (std::size_t b = 0; b < scene.num_bodies(); ++b)
    samplers_.emplace_back(scene.body(b).space().model(), scene.body(b).settings().name,
                           scene.run().bodies[b].material.law, scene.run().out.subdivide);
  for (const RigidRun& rigid : scene.run().rigid)
    rigid_.push_back(shape_mesh(rigid.body.shape, 2 * size_of(samplers_)));
  results_.fields = FieldIndex{io::bodies_file(path_), {}, {}};
}

std::string RunOutputs::field_file(std::size_t step) const {
  return io::field_file(path_, step);
}

std::string RunOutputs::viewer_file(std::size_t step, std::size_t part) const {
  return io::viewer_part(path_, step, part);
}

void RunOutputs::begin() {
  make_folder((folder_ / field_file(0)).parent_path());
  remove_fields_after(0);
  std::vector<BodyMesh> meshes;
  for (const FieldSampler& sampler : samplers_) meshes.push_back(sampler.mesh());
  io::write_body_meshes(folder_ / results_.fields->bodies_file, meshes);
}

void RunOutputs::resume(const FieldIndex& fields, std::size_t steps) {
  if (fields.times.size() < steps)
    throw InputError(
        fmt::format("{}: lists {} steps of fields, the restart file says {}; they belong to different runs",
                    path_.string(), fields.times.size(), steps));
  results_.fields = fields;
  results_.fields->times.resize(steps);
  results_.fields->files.resize(steps);
  for (const std::string& file : results_.fields->files)
    if (!std::filesystem::exists(folder_ / file))
      throw InputError(fmt::format("{}: is missing; {} lists it", (folder_ / file).string(), path_.string()));
  remove_fields_after(steps);
  if (scene_.run().out.viewer && steps > 0) write_index();
}

// Fields that no list names would only confuse.
void RunOutputs::remove_fields_after(std::size_t steps) const {
  io::remove_fields_from(path_, steps);
  io::remove_viewer_parts_from(path_, steps);
}

void RunOutputs::add_fields() {
  std::vector<BodyFields> fields;
  for (std::size_t b = 0; b < samplers_.size(); ++b)
    fields.push_back(samplers_[b].sample(scene_.body(b), scene_.run().out.points));
  const std::size_t step = num_fields();
  io::write_fields(folder_ / field_file(step), scene_.integrator().time(), fields);
  results_.fields->times.push_back(scene_.integrator().time());
  results_.fields->files.push_back(field_file(step));
  if (scene_.run().out.viewer) write_viewer(fields, step);
}

void RunOutputs::write_viewer(const std::vector<BodyFields>& fields, std::size_t step) {
  make_folder((folder_ / viewer_file(0, 0)).parent_path());
  const std::vector<io::VtpNumber> numbers{{"time", results_.fields->times[step]}};
  for (std::size_t b = 0; b < fields.size(); ++b) {
    TriangleMesh mesh = samplers_[b].mesh().surface.mesh;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      for (std::size_t d = 0; d < 3; ++d) mesh.vertices[v][d] += fields[b].displacement[3 * v + d];
    std::vector<io::VtpArray> arrays{{"displacement", 3, fields[b].displacement},
                                     {"von_mises", 1, fields[b].von_mises},
                                     {"strain", 1, fields[b].strain}};
    if (!fields[b].plastic_strain.empty()) arrays.push_back({"plastic_strain", 1, fields[b].plastic_strain});
    io::write_vtp(folder_ / viewer_file(step, b), mesh, arrays, numbers);
  }
  for (std::size_t r = 0; r < rigid_.size(); ++r) {
    const RigidState& body = scene_.contact()->rigid()[r];
    const Pose& pose = body.pose_before(); // at the time of the bodies
    TriangleMesh mesh = rigid_[r];
    std::vector<double> displacement;
    for (Point3& x : mesh.vertices) {
      const Eigen::Vector3d local(x[0], x[1], x[2]), now = pose.centre + pose.turn * local;
      for (std::size_t d = 0; d < 3; ++d) {
        const double moved = now[static_cast<Eigen::Index>(d)];
        displacement.push_back(moved - (body.body().centre[d] + x[d]));
        x[d] = moved;
      }
    }
    io::write_vtp(folder_ / viewer_file(step, fields.size() + r), mesh,
                  std::vector<io::VtpArray>{{"displacement", 3, displacement}}, numbers);
  }
  write_index();
}

void RunOutputs::write_index() const {
  std::vector<io::ViewerEntry> entries;
  for (std::size_t step = 0; step < num_fields(); ++step) {
    if (!std::filesystem::exists(folder_ / viewer_file(step, 0))) continue; // before a restart that turned them on
    for (std::size_t part = 0; part < samplers_.size() + rigid_.size(); ++part)
      entries.push_back({results_.fields->times[step], static_cast<int>(part), viewer_file(step, part)});
  }
  io::write_viewer_index(io::viewer_index(path_), entries);
}

void RunOutputs::publish(const TimeSeries& series) {
  const auto before = Clock::now();
  results_.time_series = series;
  io::write_results(path_, results_, true);
  published_ = Clock::now();
  cost_ = published_ - before;
}

void RunOutputs::publish_if_cheap(const TimeSeries& series) {
  if (Clock::now() - published_ >= least_gap * cost_) publish(series);
}

} // namespace iga::solve
