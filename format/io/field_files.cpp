#include "format/io/field_files.hpp"

#include "format/io/dataset_names.hpp"
#include "format/io/field_names.hpp"
#include "format/io/h5_arrays.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace iga::io {

namespace {

namespace field = field_names;

// Datasets of one body: the text with its full path.
class BodyGroup {
 public:
  BodyGroup(H5Writer& file, const std::string& name) : file_(file), group_(fmt::format("{}/{}", field::bodies, name)) {
    file_.group(group_.c_str(), "one body");
  }
  template <class T> void add(const DatasetText& text, const std::vector<T>& values, std::int64_t columns = 1) {
    const std::string path = path_of(text);
    write(file_, {path.c_str(), text.unit, text.order, text.description}, values, columns);
  }
  template <class Row> void add_rows(const DatasetText& text, const std::vector<Row>& rows) {
    const std::string path = path_of(text);
    file_.dataset({path.c_str(), text.unit, text.order, text.description}, {static_cast<std::int64_t>(rows.size()), 3},
                  flat(rows));
  }
  void add_texts(const DatasetText& text, const std::vector<std::string>& values) {
    const std::string path = path_of(text);
    file_.strings({path.c_str(), text.unit, text.order, text.description}, values);
  }

 private:
  std::string path_of(const DatasetText& text) const { return fmt::format("{}/{}", group_, text.path); }
  H5Writer& file_;
  std::string group_;
};

// The same datasets for reading.
class BodyData {
 public:
  BodyData(const H5Reader& file, const std::string& name)
      : file_(file), group_(fmt::format("{}/{}", field::bodies, name)) {}
  bool has(const DatasetText& text) const { return file_.has(path_of(text)); }
  std::int64_t rows(const DatasetText& text, std::size_t rank = 1) const {
    return file_.shape(path_of(text).c_str(), rank)[0];
  }
  template <class T> std::vector<T> read(const DatasetText& text, std::int64_t rows, std::int64_t columns = 1) const {
    return file_.dataset<T>(path_of(text).c_str(), columns == 1 ? Shape{rows} : Shape{rows, columns});
  }
  std::vector<std::string> texts(const DatasetText& text) const { return file_.strings(path_of(text).c_str()); }
  template <class T> void expect_below(const DatasetText& text, const std::vector<T>& values, std::int64_t end) const {
    for (const T value : values)
      if (value < 0 || static_cast<std::int64_t>(value) >= end)
        file_.refuse(path_of(text), fmt::format("holds {}, expected 0 ... {}", value, end - 1));
  }

 private:
  std::string path_of(const DatasetText& text) const { return fmt::format("{}/{}", group_, text.path); }
  const H5Reader& file_;
  std::string group_;
};

void write_head(H5Writer& file) {
  file.attribute(names::root, "format", std::string(field::format));
  file.attribute(names::root, "format_version", std::string(field::format_version));
  file.group(field::bodies, "deformable bodies");
}

} // namespace

std::filesystem::path fields_folder(const std::filesystem::path& results) {
  return results.parent_path() / (results.stem().string() + "_fields");
}

std::string bodies_file(const std::filesystem::path& results) {
  return fmt::format("{0}_fields/{0}_bodies.h5", results.stem().string());
}

std::string field_file(const std::filesystem::path& results, std::size_t step) {
  return fmt::format("{0}_fields/{0}_{1:04d}.h5", results.stem().string(), step + 1);
}

void remove_fields_from(const std::filesystem::path& results, std::size_t step) {
  std::error_code ignored;
  while (std::filesystem::remove(results.parent_path() / field_file(results, step), ignored)) ++step;
}

namespace {

// The largest principal strain by size.
double principal(const double* e) {
  const double xy = 0.5 * e[3], yz = 0.5 * e[4], zx = 0.5 * e[5], mean = (e[0] + e[1] + e[2]) / 3;
  const double a = e[0] - mean, b = e[1] - mean, c = e[2] - mean;
  // Deviator: λ = 2 √(J2 / 3) cos(θ + 2πk/3), cos 3θ = (3 √3 / 2) J3 / J2^(3/2).
  const double J2 = 0.5 * (a * a + b * b + c * c) + xy * xy + yz * yz + zx * zx;
  if (!(J2 > 0)) return mean;
  const double J3 = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
  const double cosine = std::clamp(1.5 * std::numbers::sqrt3 * J3 / (J2 * std::sqrt(J2)), -1.0, 1.0);
  const double size = 2 * std::sqrt(J2 / 3), angle = std::acos(cosine) / 3;
  const double largest = mean + size * std::cos(angle),
               least = mean + size * std::cos(angle + 2 * std::numbers::pi / 3);
  return std::abs(least) > std::abs(largest) ? least : largest;
}

std::vector<double> slice(const std::vector<double>& values, std::size_t step, std::size_t steps) {
  const std::size_t width = values.size() / steps;
  return {values.begin() + static_cast<std::ptrdiff_t>(step * width),
          values.begin() + static_cast<std::ptrdiff_t>((step + 1) * width)};
}

BodyFields fields_of(const BodyPart& part, std::size_t step) {
  const std::size_t steps = part.surface.steps.size();
  BodyFields fields;
  fields.name = part.name;
  fields.coefficients = slice(part.coefficients, step, steps);
  fields.displacement = slice(part.surface.fields.displacement, step, steps);
  fields.von_mises = slice(part.surface.fields.von_mises, step, steps);
  const std::vector<double> strain = slice(part.surface.fields.strain, step, steps);
  for (std::size_t v = 0; v < fields.von_mises.size(); ++v) fields.strain.push_back(principal(&strain[6 * v]));
  fields.point_stress = part.point_stress;
  return fields;
}

} // namespace

void write_parts(const std::filesystem::path& path, Results& results) {
  const std::filesystem::path folder = path.parent_path();
  std::error_code error;
  std::filesystem::create_directories(fields_folder(path), error);
  if (error)
    throw InputError(fmt::format("{}: the folder cannot be made: {}", fields_folder(path).string(), error.message()));
  std::vector<BodyMesh> meshes;
  for (const BodyPart& part : results.parts) meshes.push_back({part.name, part.active_functions, part.surface.output});
  write_body_meshes(folder / bodies_file(path), meshes);
  results.fields = FieldIndex{bodies_file(path), results.parts.front().surface.steps, {}};
  for (std::size_t step = 0; step < results.fields->times.size(); ++step) {
    std::vector<BodyFields> fields;
    for (const BodyPart& part : results.parts) fields.push_back(fields_of(part, step));
    write_fields(folder / field_file(path, step), results.fields->times[step], fields);
    results.fields->files.push_back(field_file(path, step));
  }
  remove_fields_from(path, results.fields->times.size());
}

void write_body_meshes(const std::filesystem::path& path, const std::vector<BodyMesh>& bodies) {
  H5Writer file(path);
  write_head(file);
  for (const BodyMesh& body : bodies) {
    BodyGroup group(file, body.name);
    group.add(field::active_functions, body.active_functions);
    group.add_rows(field::vertices, body.surface.mesh.vertices);
    group.add(field::vertex_parameters, body.surface.parameters, 3);
    group.add(field::vertex_span, body.surface.span);
    if (!body.surface.cell.empty()) group.add(field::vertex_cell, body.surface.cell);
    group.add_rows(field::triangles, body.surface.mesh.triangles);
    group.add(field::region, body.surface.mesh.region);
    group.add_texts(field::regions, body.surface.mesh.region_names);
  }
  file.commit();
}

void write_fields(const std::filesystem::path& path, double time, const std::vector<BodyFields>& bodies) {
  H5Writer file(path);
  write_head(file);
  file.attribute(names::root, "time", time);
  for (const BodyFields& body : bodies) {
    BodyGroup group(file, body.name);
    group.add(field::coefficients, body.coefficients, 3);
    group.add(field::displacement, body.displacement, 3);
    group.add(field::von_mises, body.von_mises);
    group.add(field::strain, body.strain);
    if (!body.plastic_strain.empty()) group.add(field::plastic_strain, body.plastic_strain);
    if (!body.point_stress.empty()) group.add(field::point_stress, body.point_stress, 6);
    if (!body.point_plastic_strain.empty()) group.add(field::point_plastic_strain, body.point_plastic_strain);
  }
  file.commit();
}

std::vector<BodyMesh> read_body_meshes(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const H5Reader file(path, H5Reader::Writer::H5Writer);
  expect_format(file, field::format, field::format_major, field::format_version);
  std::vector<BodyMesh> bodies;
  for (const std::string& name : names) {
    const BodyData data(file, name);
    BodyMesh body;
    body.name = name;
    TriangleMesh& mesh = body.surface.mesh;
    body.active_functions = data.read<std::int64_t>(field::active_functions, data.rows(field::active_functions));
    const std::int64_t vertices = data.rows(field::vertices, 2), triangles = data.rows(field::triangles, 2);
    mesh.vertices = in_rows<Point3>(data.read<double>(field::vertices, vertices, 3));
    body.surface.parameters = data.read<double>(field::vertex_parameters, vertices, 3);
    body.surface.span = data.read<std::int64_t>(field::vertex_span, vertices);
    if (data.has(field::vertex_cell)) // since 1.1
      body.surface.cell = data.read<std::int64_t>(field::vertex_cell, vertices);
    const auto corners = data.read<std::int32_t>(field::triangles, triangles, 3);
    data.expect_below(field::triangles, corners, vertices);
    mesh.triangles = in_rows<Triangle>(corners);
    mesh.region = data.read<std::int32_t>(field::region, triangles);
    mesh.region_names = data.texts(field::regions);
    data.expect_below(field::region, mesh.region, static_cast<std::int64_t>(mesh.region_names.size()));
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<BodyFields> read_fields(const std::filesystem::path& path, const std::vector<BodyMesh>& meshes) {
  const H5Reader file(path, H5Reader::Writer::H5Writer);
  expect_format(file, field::format, field::format_major, field::format_version);
  std::vector<BodyFields> bodies;
  for (const BodyMesh& mesh : meshes) {
    const BodyData data(file, mesh.name);
    const auto vertices = static_cast<std::int64_t>(mesh.surface.mesh.vertices.size());
    const auto optional = [&](const DatasetText& text, std::int64_t columns = 1) {
      return data.has(text) ? data.read<double>(text, data.rows(text, columns == 1 ? 1 : 2), columns)
                            : std::vector<double>();
    };
    BodyFields body;
    body.name = mesh.name;
    body.coefficients =
        data.read<double>(field::coefficients, static_cast<std::int64_t>(mesh.active_functions.size()), 3);
    body.displacement = data.read<double>(field::displacement, vertices, 3);
    body.von_mises = data.read<double>(field::von_mises, vertices);
    body.strain = data.read<double>(field::strain, vertices);
    if (data.has(field::plastic_strain)) body.plastic_strain = data.read<double>(field::plastic_strain, vertices);
    body.point_stress = optional(field::point_stress, 6);
    body.point_plastic_strain = optional(field::point_plastic_strain);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

} // namespace iga::io
