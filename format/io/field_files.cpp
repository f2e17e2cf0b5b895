#include "format/io/field_files.hpp"

#include "format/io/dataset_names.hpp"
#include "format/io/field_names.hpp"
#include "format/io/h5_arrays.hpp"

#include <fmt/format.h>

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

void write_head(H5Writer& file) {
  file.attribute(names::root, "format", std::string(field::format));
  file.attribute(names::root, "format_version", std::string(field::format_version));
  file.group(field::bodies, "deformable bodies");
}

} // namespace

void write_body_meshes(const std::filesystem::path& path, const std::vector<BodyMesh>& bodies) {
  H5Writer file(path);
  write_head(file);
  for (const BodyMesh& body : bodies) {
    BodyGroup group(file, body.name);
    group.add(field::active_functions, body.active_functions);
    group.add_rows(field::vertices, body.surface.mesh.vertices);
    group.add(field::vertex_parameters, body.surface.parameters, 3);
    group.add(field::vertex_span, body.surface.span);
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

} // namespace iga::io
