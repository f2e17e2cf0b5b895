#include "solver/explicit/run/run_outputs.hpp"

#include "format/io/field_files.hpp"
#include "format/io/results_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/explicit/run/series_rigid_mesh.hpp"

#include <fmt/format.h>
#include <memory>

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
  if (scene_.run().out.viewer && steps > 0) write_index(*results_.fields);
}

// Fields that no list names would only confuse.
void RunOutputs::remove_fields_after(std::size_t steps) const {
  io::remove_fields_from(path_, steps);
  io::remove_viewer_parts_from(path_, steps);
}

struct RunOutputs::FieldStep {
  FieldIndex steps; ///< up to this one
  std::vector<BodyFields> fields;
  std::vector<Pose> poses; ///< of the rigid bodies, at the time of the bodies
};

void RunOutputs::add_fields() {
  FieldStep now;
  for (std::size_t b = 0; b < samplers_.size(); ++b)
    now.fields.push_back(samplers_[b].sample(scene_.body(b), scene_.run().out.points));
  for (std::size_t r = 0; r < rigid_.size(); ++r) now.poses.push_back(scene_.contact()->rigid()[r].pose_before());
  const std::size_t step = num_fields();
  results_.fields->times.push_back(scene_.integrator().time());
  results_.fields->files.push_back(field_file(step));
  now.steps = *results_.fields;
  work_.add([this, step, written = std::make_shared<const FieldStep>(std::move(now))] {
    io::write_fields(folder_ / field_file(step), written->steps.times.back(), written->fields);
    if (scene_.run().out.viewer) write_viewer(*written);
  });
}

void RunOutputs::write_viewer(const FieldStep& written) const {
  make_folder((folder_ / viewer_file(0, 0)).parent_path());
  const std::vector<BodyFields>& fields = written.fields;
  const std::size_t step = written.steps.times.size() - 1;
  const std::vector<io::VtpNumber> numbers{{"time", written.steps.times.back()}};
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
    const Point3& centre = scene_.run().rigid[r].body.centre;
    const Pose& pose = written.poses[r];
    TriangleMesh mesh = rigid_[r];
    std::vector<double> displacement;
    for (Point3& x : mesh.vertices) {
      const Eigen::Vector3d local(x[0], x[1], x[2]), now = pose.centre + pose.turn * local;
      for (std::size_t d = 0; d < 3; ++d) {
        const double moved = now[static_cast<Eigen::Index>(d)];
        displacement.push_back(moved - (centre[d] + x[d]));
        x[d] = moved;
      }
    }
    io::write_vtp(folder_ / viewer_file(step, fields.size() + r), mesh,
                  std::vector<io::VtpArray>{{"displacement", 3, displacement}}, numbers);
  }
  write_index(written.steps);
}

void RunOutputs::write_index(const FieldIndex& steps) const {
  std::vector<io::ViewerEntry> entries;
  for (std::size_t step = 0; step < steps.times.size(); ++step) {
    if (!std::filesystem::exists(folder_ / viewer_file(step, 0))) continue; // before a restart that turned them on
    for (std::size_t part = 0; part < samplers_.size() + rigid_.size(); ++part)
      entries.push_back({steps.times[step], static_cast<int>(part), viewer_file(step, part)});
  }
  io::write_viewer_index(io::viewer_index(path_), entries);
}

void RunOutputs::publish(const TimeSeries& series) {
  results_.time_series = series;
  published_ = Clock::now();
  work_.add([this, written = std::make_shared<const Results>(results_)] {
    const auto before = Clock::now();
    io::write_results(path_, *written, true);
    cost_ = Clock::now() - before;
  });
}

void RunOutputs::publish_if_cheap(const TimeSeries& series) {
  if (work_.is_idle() && Clock::now() - published_ >= least_gap * cost_.load()) publish(series);
}

} // namespace iga::solve
