#include "preprocessor/program/assembly.hpp"

#include "format/io/interrupt.hpp"
#include "format/io/json_text.hpp"
#include "format/io/replace_file.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/surface/surface_bodies.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <numbers>
#include <set>

namespace iga::prep {

namespace {

namespace fs = std::filesystem;

// A solid with its file and its places.
struct Member {
  std::string name, file;
  std::vector<CadPlace> places;
  std::function<Part()> part;
};

// Letters, digits, dots, hyphens and underscores; no two alike.
std::string file_name(const std::string& name, std::set<std::string>& used) {
  std::string stem;
  for (const char c : name)
    stem += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' ? c : '_';
  if (stem.empty() || stem.front() == '.') stem = "solid" + stem;
  std::string file = stem + ".h5";
  for (int k = 2; !used.insert(file).second; ++k) file = fmt::format("{}_{}.h5", stem, k);
  return file;
}

std::vector<Member> members_of_cad(const Settings& s) {
  auto cad = std::make_shared<CadModel>(read_cad_file(s, [] { return io::pending_signal() != 0; }));
  io::stop_if_interrupted();
  std::vector<Member> members;
  std::set<std::string> used;
  for (std::size_t k = 0; k < cad->solids.size(); ++k) {
    const CadSolid& solid = cad->solids[k];
    members.push_back({solid.name, file_name(solid.name, used), solid.places,
                       [cad, k, input = s.input] { return part_of(*cad, cad->solids[k], input); }});
  }
  return members;
}

std::vector<Member> members_of_surface(const Settings& s) {
  ReadMesh read = read_mesh(s.input, s.scale);
  const ReadMesh head = without_facets(read);
  const PreparedSurface surface = prepare_surface(std::move(read), s.surface);
  auto bodies = std::make_shared<std::vector<TriangleMesh>>(split_into_bodies(surface.mesh));
  std::vector<Member> members;
  std::set<std::string> used;
  for (std::size_t k = 0; k < bodies->size(); ++k) {
    const std::string name = fmt::format("body {}", k + 1);
    members.push_back({name, file_name(name, used), {CadPlace{.name = name}}, [=] {
                         Part part;
                         part.read = head;
                         part.read.mesh = (*bodies)[k];
                         part.read.format = fmt::format("{}, {} of {}", head.format, name, bodies->size());
                         part.findings = surface.findings;
                         part.warnings = surface.warnings;
                         return part;
                       }});
  }
  return members;
}

// Axis and angle (degrees) of a rotation.
std::pair<Point3, double> axis_angle(const Rotation& R) {
  const Point3 twice_sine{R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]};
  const double sine = std::hypot(twice_sine[0], twice_sine[1], twice_sine[2]), cosine = R[0][0] + R[1][1] + R[2][2] - 1;
  const double angle = std::atan2(sine, cosine) * 180 / std::numbers::pi;
  if (sine > 1e-6) return {{twice_sine[0] / sine, twice_sine[1] / sine, twice_sine[2] / sine}, angle};
  if (cosine > 0) return {{0, 0, 1}, 0};
  // Half a turn: R + I = 2 a aᵀ; the column with the largest diagonal.
  std::size_t d = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (R[k][k] > R[d][d]) d = k;
  const double a = std::sqrt((R[d][d] + 1) / 2);
  Point3 axis{};
  for (std::size_t k = 0; k < 3; ++k) axis[k] = k == d ? a : R[k][d] / (2 * a);
  return {axis, 180};
}

std::string place_text(const CadPlace& place) {
  const auto [axis, degrees] = axis_angle(place.rotation);
  const Point3& shift = place.shift;
  if (degrees == 0 && shift == Point3{}) return "";
  std::string text = fmt::format("place = {{ shift = [{}, {}, {}]", shift[0], shift[1], shift[2]);
  if (degrees != 0) text += fmt::format(", axis = [{}, {}, {}], degrees = {}", axis[0], axis[1], axis[2], degrees);
  return text + " }\n";
}

// Texts are quoted as in JSON, which TOML reads alike.
std::string run_text(const Settings& s, const std::vector<Member>& members, const std::string& length_unit) {
  std::string text = fmt::format(
      "# Made by igaprep from {}: a body for each solid. Give every body its material, add supports and loads, then\n"
      "#   igasolve eigen run.toml --modes 10 -o modes.h5\n#   igasolve static run.toml -o static.h5\n",
      s.input.filename().string());
  if (length_unit != "unspecified") text += fmt::format("units = {}\n", io::json(length_unit));
  // Materials have names in millimetres and metres.
  const bool named = length_unit == "mm" || length_unit == "m";
  const char* const numbers = "{ E = …, nu = …, rho = … }";
  text +=
      named
          ? "#material = \"steel\"   # of all bodies that have none of their own\n\n"
          : fmt::format("#material = {}   # of all bodies that have none of their own; names, such as \"steel\", need "
                        "--length-unit mm or m\n\n",
                        numbers);
  text +=
      "# Surfaces that touch move together only where a tie joins them; this one joins all that meet. bodies = [\"a\", "
      "\"b\"],\n"
      "# first and second choose some, tolerance (a length) is the largest gap: 1 % of a span where it is not given.\n"
      "#[[ties]]\n";
  for (const Member& member : members)
    for (const CadPlace& place : member.places) {
      text += fmt::format("\n[[bodies]]\nname = {}\nmodel = {}\n", io::json(place.name), io::json(member.file));
      text += place_text(place);
      text += named ? fmt::format("#material = {{ name = \"steel\" }}   # or {}\n", numbers)
                    : fmt::format("#material = {}\n", numbers);
    }
  return text;
}

} // namespace

AssemblyReport run_assembly(const Settings& s, const RunInfo& run, io::Progress& progress) {
  if (!fs::exists(s.input)) throw InputError(fmt::format("{}: no such file", s.input.string()));
  std::error_code error;
  fs::create_directories(s.output, error);
  if (error)
    throw InputError(fmt::format("{}: the output folder cannot be made: {}", s.output.string(), error.message()));
  progress.start("read");
  const std::vector<Member> members = is_cad_file(s.input) ? members_of_cad(s) : members_of_surface(s);
  progress.finish();
  AssemblyReport report;
  for (const Member& member : members) {
    Settings own = s;
    own.output = s.output / member.file;
    own.output_is_folder = false;
    own.title = member.name;
    own.cad.solid = member.name;
    try {
      report.models.push_back(run_pipeline(own, run, progress, member.part));
    } catch (const InputError& fault) {
      throw InputError(fmt::format("\"{}\": {}", member.name, fault.what()));
    } catch (const NumericalError& fault) {
      throw NumericalError(fmt::format("\"{}\": {}", member.name, fault.what()));
    }
  }
  report.run_file = s.output / "run.toml";
  report.run_file_kept = fs::exists(report.run_file);
  if (!report.run_file_kept) {
    io::ReplacementFile file(report.run_file);
    std::ofstream text(file.path());
    text << run_text(s, members, report.models.front().length_unit);
    text.close();
    if (!text) throw InputError(fmt::format("{}: cannot be written; is the disk full?", report.run_file.string()));
    file.commit();
  }
  return report;
}

} // namespace iga::prep
