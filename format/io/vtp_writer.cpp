#include "format/io/vtp_writer.hpp"

#include "format/io/replace_file.hpp"
#include "format/model/case_envelope.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <tbb/parallel_for.h>
#include <zlib.h>

namespace iga::io {

namespace {

constexpr std::size_t block_size = std::size_t{1} << 18; // bytes before compression
constexpr int deflate_level = 1;                         // higher levels gain little on floating-point numbers
constexpr double mode_share = 0.05;                      // of the part's diagonal: well seen, shapes still recognised

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
    case '&':
      out += "&amp;";
      break;
    case '<':
      out += "&lt;";
      break;
    case '>':
      out += "&gt;";
      break;
    case '"':
      out += "&quot;";
      break;
    default:
      out += c;
    }
  return out;
}

void append_number(std::string& out, std::uint64_t value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// vtkZLibDataCompressor's layout: number of blocks, block size, size of a partial last block or 0, compressed sizes.
std::string compressed(std::string_view bytes) {
  const std::size_t blocks = (bytes.size() + block_size - 1) / block_size;
  std::string header, data;
  append_number(header, blocks);
  append_number(header, block_size);
  append_number(header, bytes.size() % block_size);
  std::vector<Bytef> packed(compressBound(block_size));
  for (std::size_t first = 0; first < bytes.size(); first += block_size) {
    const auto block = bytes.substr(first, block_size);
    uLongf size = packed.size();
    if (compress2(packed.data(), &size, reinterpret_cast<const Bytef*>(block.data()), block.size(), deflate_level) !=
        Z_OK)
      throw std::bad_alloc();
    append_number(header, size);
    data.append(reinterpret_cast<const char*>(packed.data()), size);
  }
  return header + data;
}

// Gathers the appended data while the XML in front of it is written.
class VtpText {
 public:
  template <class T>
  void array(const char* type, const std::string& name, int components, const std::vector<T>& values,
             const char* tuples = "") {
    xml_ += fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}"{} format="appended" offset="{}"/>)"
                        "\n",
                        type, escaped(name), components, tuples, data_.size());
    data_ += compressed({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }
  void line(const std::string& text) { xml_ += text + "\n"; }
  std::string text() const {
    return R"(<?xml version="1.0" encoding="UTF-8"?>)"
           "\n"
           R"(<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64" )"
           R"(compressor="vtkZLibDataCompressor">)"
           "\n" +
           xml_ + "<AppendedData encoding=\"raw\">\n_" + data_ + "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  std::string xml_, data_;
};

void write_whole(const std::filesystem::path& path, const std::string& bytes) {
  ReplacementFile file(path);
  errno = 0;
  std::ofstream out(file.path(), std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw InputError(fmt::format("{}: cannot be written: {}; free space or choose another folder", path.string(),
                                 errno ? std::strerror(errno) : "unknown reason"));
  file.commit();
}

std::string step_name(const std::filesystem::path& results, std::size_t step) {
  return fmt::format("{}_{:04d}.vtp", results.stem().string(), step + 1);
}

double largest_length(std::span<const double> vectors) {
  double largest = 0;
  for (std::size_t i = 0; i + 2 < vectors.size(); i += 3)
    largest = std::max(largest, norm({vectors[i], vectors[i + 1], vectors[i + 2]}));
  return largest;
}

std::span<const double> values_of(const std::vector<double>& field, const SurfaceResult& s, std::size_t components,
                                  std::size_t step) {
  const std::size_t n = s.output.mesh.vertices.size() * components;
  return field.empty() ? std::span<const double>() : std::span(field).subspan(step * n, n);
}

// Of a mode: the largest displacement of all parts becomes a share of the box around them.
double scale_of_mode(std::span<const SurfaceResult* const> parts, std::size_t step) {
  Box3 all = bounding_box(parts[0]->output.mesh);
  double largest = 0;
  for (const SurfaceResult* s : parts) {
    const Box3 box = bounding_box(s->output.mesh);
    for (std::size_t d = 0; d < 3; ++d) {
      all.lower[d] = std::min(all.lower[d], box.lower[d]);
      all.upper[d] = std::max(all.upper[d], box.upper[d]);
    }
    largest = std::max(largest, largest_length(values_of(s->fields.displacement, *s, 3, step)));
  }
  return largest > 0 ? mode_share * norm(minus(all.upper, all.lower)) / largest : 1;
}

void write_step(const std::filesystem::path& path, const SurfaceResult& s, std::size_t step,
                std::span<const VtpNumber> numbers, double scale) {
  std::vector<VtpArray> arrays;
  std::vector<std::vector<double>> scaled;
  scaled.reserve(8);
  const auto add = [&](const char* name, const std::vector<double>& field, int components) {
    if (field.empty()) return;
    const auto values = values_of(field, s, static_cast<std::size_t>(components), step);
    scaled.emplace_back(values.begin(), values.end());
    for (double& value : scaled.back()) value *= scale;
    arrays.push_back({name, components, scaled.back()});
  };
  add("displacement", s.fields.displacement, 3);
  add("von_mises", s.fields.von_mises, 1);
  add("stress", s.fields.stress, 6);
  add("strain", s.fields.strain, 6);
  add("temperature", s.fields.temperature, 1);
  add("heat_flux", s.fields.heat_flux, 3);
  add("von_mises_error", s.fields.von_mises_error, 1);
  add("safety_factor", s.fields.safety_factor, 1);
  write_vtp(path, s.output.mesh, arrays, numbers);
}

std::filesystem::path envelope_file(const std::filesystem::path& results, std::size_t part, bool several) {
  const std::string stem = results.stem().string();
  return viewer_folder(results) / (several ? fmt::format("{}_envelope_{}.vtp", stem, part) : stem + "_envelope.vtp");
}

// Of load cases: what they do at most, beside the series; none where an earlier run left one.
void write_envelopes(const std::filesystem::path& path, const Results& results,
                     std::span<const SurfaceResult* const> parts) {
  std::error_code ignored;
  std::filesystem::remove(envelope_file(path, 0, false), ignored);
  for (std::size_t part = 0; std::filesystem::remove(envelope_file(path, part, true), ignored);) ++part;
  if (!results.statics || results.statics->cases.size() < 2) return;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const SurfaceEnvelope all = surface_envelope(*parts[part]);
    const std::array<VtpArray, 4> arrays{{{"von_mises", 1, all.von_mises},
                                          {"von_mises_case", 1, all.von_mises_case},
                                          {"displacement", 1, all.displacement},
                                          {"displacement_case", 1, all.displacement_case}}};
    write_vtp(envelope_file(path, part, !results.surface), parts[part]->output.mesh, arrays, {});
  }
}

// Steps of an earlier, longer series would only confuse.
void remove_other_steps(const std::filesystem::path& results, std::size_t num_steps) {
  std::error_code error;
  for (std::size_t step = num_steps; std::filesystem::remove(viewer_folder(results) / step_name(results, step), error);)
    ++step;
}

} // namespace

void write_vtp(const std::filesystem::path& path, const TriangleMesh& mesh, std::span<const VtpArray> arrays,
               std::span<const VtpNumber> numbers) {
  std::vector<std::int64_t> ends(mesh.triangles.size());
  for (std::size_t t = 0; t < ends.size(); ++t) ends[t] = static_cast<std::int64_t>(3 * (t + 1));
  VtpText file;
  file.line("<PolyData>\n<FieldData>");
  for (const VtpNumber& number : numbers)
    file.array("Float64", number.name, 1, std::vector{number.value}, R"( NumberOfTuples="1")");
  file.line(fmt::format("</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                        "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n<PointData>",
                        mesh.vertices.size(), mesh.triangles.size()));
  for (const VtpArray& array : arrays)
    file.array("Float32", array.name, array.components, std::vector<float>(array.values.begin(), array.values.end()));
  file.line("</PointData>\n<CellData>");
  file.array("Int32", "region", 1, mesh.region);
  file.line("</CellData>\n<Points>");
  file.array("Float64", "Points", 3, mesh.vertices);
  file.line("</Points>\n<Polys>");
  file.array("Int32", "connectivity", 1, mesh.triangles);
  file.array("Int64", "offsets", 1, ends);
  file.line("</Polys>\n</Piece>\n</PolyData>");
  write_whole(path, file.text());
}

void write_viewer_index(const std::filesystem::path& index, std::span<const ViewerEntry> entries) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                     "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const ViewerEntry& entry : entries)
    text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"{}\"/>\n", entry.time, entry.part,
                        escaped(entry.file));
  write_whole(index, text + "</Collection>\n</VTKFile>\n");
}

std::string viewer_part(const std::filesystem::path& results, std::size_t step, std::size_t part) {
  return fmt::format("{0}_vtp/{0}_{1:04d}_{2}.vtp", results.stem().string(), step + 1, part);
}

void remove_viewer_parts_from(const std::filesystem::path& results, std::size_t step) {
  std::error_code ignored;
  const auto remove = [&](std::size_t part) {
    return std::filesystem::remove(results.parent_path() / viewer_part(results, step, part), ignored);
  };
  for (; remove(0); ++step)
    for (std::size_t part = 1; remove(part);) ++part;
}

std::filesystem::path viewer_index(const std::filesystem::path& results) {
  return std::filesystem::path(results).replace_extension(".pvd");
}

std::filesystem::path viewer_folder(const std::filesystem::path& results) {
  return results.parent_path() / (results.stem().string() + "_vtp");
}

void check_viewer_target(const std::filesystem::path& results, bool force) {
  std::error_code error;
  const auto index = viewer_index(results);
  if (!force && std::filesystem::exists(index, error))
    throw InputError(fmt::format("{}: exists; choose another name or add --force to replace it", index.string()));
}

void write_viewer_files(const std::filesystem::path& results_path, const Results& results, bool force) {
  check_viewer_target(results_path, force);
  std::vector<const SurfaceResult*> parts;
  if (results.surface) parts.push_back(&*results.surface);
  for (const BodyPart& part : results.parts) parts.push_back(&part.surface);
  const auto folder = viewer_folder(results_path);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
  const auto file = [&](std::size_t step, std::size_t part) {
    return results.surface ? folder.filename().string() + "/" + step_name(results_path, step)
                           : viewer_part(results_path, step, part);
  };
  const std::vector<double>& steps = parts[0]->steps;
  write_envelopes(results_path, results, parts);
  tbb::parallel_for(std::size_t{0}, steps.size(), [&](std::size_t step) {
    std::vector<VtpNumber> numbers;
    double scale = 1;
    if (results.eigen) {
      scale = scale_of_mode(parts, step);
      numbers = {{"mode", steps[step]}, {"frequency", results.eigen->frequencies[step]}, {"scale", scale}};
    } else if (results.buckling) {
      scale = scale_of_mode(parts, step);
      numbers = {{"mode", steps[step]}, {"factor", results.buckling->factors[step]}, {"scale", scale}};
    }
    for (std::size_t part = 0; part < parts.size(); ++part)
      write_step(results_path.parent_path() / file(step, part), *parts[part], step, numbers, scale);
  });
  std::vector<ViewerEntry> entries;
  for (std::size_t step = 0; step < steps.size(); ++step)
    for (std::size_t part = 0; part < parts.size(); ++part)
      entries.push_back({steps[step], static_cast<int>(part), file(step, part)});
  write_viewer_index(viewer_index(results_path), entries);
  remove_other_steps(results_path, results.surface ? steps.size() : 0);
  remove_viewer_parts_from(results_path, results.surface ? 0 : steps.size());
}

} // namespace iga::io
