#include "preprocessor/program/pipeline.hpp"

#include "format/io/interrupt.hpp"
#include "format/io/output_claim.hpp"
#include "format/io/output_ending.hpp"
#include "format/io/sha256.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "format/model/points_outside.hpp"
#include "format/model/version.hpp"
#include "preprocessor/program/gates.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "preprocessor/quadrature/surface_quadrature.hpp"
#include "preprocessor/surface/read_mesh.hpp"
#include "preprocessor/trim/optimise_offset.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <numeric>
#include <unistd.h>
#include <utility>

namespace iga::prep {

namespace {

namespace fs = std::filesystem;

// Times the stages and lets an interrupt through between them.
class Stages {
 public:
  explicit Stages(io::Progress& progress) : progress_(progress) {}

  template <class Work> auto run(const std::string& name, Work&& work) {
    io::stop_if_interrupted();
    progress_.start(name);
    const Timer timer{*this, name};
    return work();
  }
  std::vector<std::pair<std::string, double>> timings;

 private:
  using Clock = std::chrono::steady_clock;
  struct Timer {
    Stages& stages;
    std::string name;
    Clock::time_point begin = Clock::now();
    ~Timer() {
      stages.timings.emplace_back(name, std::chrono::duration<double>(Clock::now() - begin).count());
      stages.progress_.finish();
    }
  };
  io::Progress& progress_;
};

// Refuses at once what would fail, or do harm, after the work is done.
void check_paths(const Settings& s) {
  if (!fs::exists(s.input)) throw InputError(fmt::format("{}: no such file", s.input.string()));
  const fs::path folder = s.output.has_parent_path() ? s.output.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) throw InputError(fmt::format("{}: the output folder does not exist", folder.string()));
  if (access(folder.c_str(), W_OK) != 0)
    throw InputError(fmt::format("{}: the output folder is not writable", folder.string()));
  if (!fs::exists(s.output)) return;
  if (fs::is_directory(s.output))
    throw InputError(
        fmt::format("{0}: the output is a folder; choose another name, or write {0}/ for one model of each "
                    "solid in it",
                    s.output.string()));
  if (!fs::is_regular_file(s.output))
    throw InputError(
        fmt::format("{}: the output exists and is no ordinary file; choose another name", s.output.string()));
}

// True where the output holds what this run would make; refuses to replace anything else unless forced.
bool stands_already(const Settings& s, const RunInfo& run) {
  if (run.force || !fs::exists(s.output)) return false;
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: the file exists and {}; choose another output or replace it with --force",
                                 s.output.string(), why));
  };
  Provenance found;
  try {
    found = io::read_provenance(s.output);
  } catch (const std::exception& error) {
    refuse(fmt::format("is no sound model file ({})", error.what()));
  }
  const Provenance ours;
  if (found.producer != ours.producer || found.inputs.size() != 1) refuse("was made by another program");
  if (found.version != program_version())
    refuse(fmt::format("was made by version {}, this is {}", found.version, program_version()));
  if (found.inputs[0].sha256 != io::sha256_file(s.input)) refuse("was made from another input");
  if (found.settings_sha256 != settings_hash(s)) refuse("was made with other settings");
  return true;
}

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

// A stage's many small buffers stay with the allocator, out of reach of the large arrays of the next stages.
void return_free_memory() {
  malloc_trim(0);
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

QuadratureInfo quadrature_info(const Settings& s, const Trimming& trimming, double part_volume, double max_residual) {
  QuadratureInfo info;
  info.interior_rule = s.quadrature.interior_rule;
  info.trimmed_rule = s.quadrature.trimmed_rule;
  info.surface_rule = s.quadrature.surface_rule;
  info.moment_degree = s.quadrature.moment_degree;
  info.tolerance = s.quadrature.tolerance;
  info.max_residual = max_residual;
  info.sliver_tolerance = s.trim.sliver_tolerance;
  info.min_fraction = s.trim.min_fraction;
  info.part_volume = part_volume;
  info.snapped_volume = trimming.snapped_volume;
  info.dropped_volume = trimming.dropped_volume;
  info.snapped_spans = trimming.snapped_spans;
  info.dropped_spans = trimming.dropped_spans;
  return info;
}

// The grid, shifted where the user asked for it.
SplineGrid choose_grid(const Settings& s, const TriangleMesh& mesh, io::Progress& progress, PrepReport& report) {
  GridChoice choice = make_grid(mesh, s.grid);
  append(report.findings, choice.notes);
  if (!s.optimise_offset) return choice.grid;
  const OffsetSearch search = optimise_offset(
      *choice.frame, mesh, s.trim, [&](std::int64_t done, std::int64_t total) { progress.update(done, total); },
      [] { return io::pending_signal() != 0; });
  io::stop_if_interrupted();
  report.offset = OffsetGain{search.light_before, search.light_after, search.evaluations};
  return place_grid(*choice.frame, search.offset);
}

TrimmedRules fit_rules(const QuadratureOptions& options, const SplineGrid& grid, const Trimming& trimming,
                       const PreparedSurface& surface) {
  try {
    return TrimmedRules(grid, trimming, options);
  } catch (const Cancelled&) {
    throw io::Interrupted{};
  } catch (const NumericalError& error) {
    if (!surface.shape_changed || surface.wrapped) throw;
    throw NumericalError(fmt::format("{}\nThe surface was repaired: where the repair left walls without thickness or "
                                     "facets on top of each other, --wrap makes a clean surface instead.",
                                     error.what()));
  }
}

// An interrupt ends the reduction, not the run: the rules there are go into the file.
void reduce_rules(TrimmedRules& rules, const QuadratureOptions& options, PrepReport& report) {
  rules.reduce(options);
  if (rules.counts().kept_spans == 0) return;
  report.interrupted_by = io::take_pending_signal();
  report.warnings.push_back(fmt::format(
      "the reduction of points was interrupted: {} trimmed spans keep their nnls rule (more points, the same "
      "exactness); run again with --force for all of them",
      rules.counts().kept_spans));
}

// What the file that stands there already says of itself; reading it checks that it is sound.
PrepReport report_standing(const Settings& s, PrepReport report) {
  report.reused = true;
  try {
    const TrimmedModel model = io::read_model(s.output);
    describe_model(report, model);
    measure_walls_and_gaps(report, model, TriangleTree(model.surface.mesh));
    report.findings = model.provenance.findings;
    report.warnings = model.provenance.warnings;
  } catch (const FormatError& error) {
    throw InputError(
        fmt::format("the file matches this run but is damaged; replace it with --force\n{}", error.what()));
  }
  report.peak_memory_mib = peak_memory_mib();
  return report;
}

Provenance provenance_of(const Settings& s, const RunInfo& run, const std::string& input_sha256,
                         const PrepReport& report, const Stages& stages) {
  Provenance p;
  p.version = program_version();
  p.command_line = run.command_line;
  p.inputs = {{s.input.filename().string(), input_sha256}};
  // A reduction that was cut short must not pass for the whole of it.
  p.settings_sha256 = report.interrupted_by == 0 ? settings_hash(s) : io::sha256_text(settings_hash(s) + "interrupted");
  p.created = now_utc();
  p.timings = stages.timings;
  p.findings = report.findings;
  p.warnings = report.warnings;
  return p;
}

// The part of the input file: triangles, or the solid that the settings choose.
Part read_part(const Settings& s) {
  if (is_cad_file(s.input)) {
    const CadModel cad = read_cad_file(s, [] { return io::pending_signal() != 0; });
    io::stop_if_interrupted();
    return part_of(cad, choose_solid(cad, s), s.input);
  }
  if (s.cad.any())
    throw InputError(
        fmt::format("{}: chord, solid, merge and sew are for CAD files (STEP, IGES, BREP); leave them out for "
                    "a file of triangles",
                    s.input.string()));
  Part part;
  part.read = read_mesh(s.input, s.scale);
  return part;
}

// Everything after the surface: grid, trimming, points, checks, file.
PrepReport make_model(const Settings& s, const RunInfo& run, const PreparedSurface& surface, const Part& part,
                      PrepReport report, Stages& stages, io::Progress& progress) {
  append(report.findings, part.findings);
  append(report.warnings, part.warnings);
  report.bodies = surface.bodies;
  report.cavities = surface.cavities;
  append(report.findings, surface.findings);
  append(report.warnings, surface.warnings);

  const SurfaceTreatment treatment{s.surface.repair, surface.wrapped, s.surface.accept_leaks, surface.open};
  TrimmedModel model;
  model.title = s.title;
  model.length_unit = part.length_unit.empty() ? s.length_unit : part.length_unit;
  model.curves = part.curves;
  model.markers = part.markers;
  model.grid = stages.run("grid", [&] { return choose_grid(s, surface.mesh, progress, report); });
  Trimming trimming = stages.run("trim", [&] { return trim(model.grid, surface.mesh, s.trim); });
  return_free_memory();
  const double mesh_volume = volume_moments(surface.mesh).volume;
  report.trimming_error = std::abs(trimming.exact_volume - mesh_volume) / std::abs(mesh_volume);
  append(report.warnings, judge_trimming(model.grid, trimming, mesh_volume, treatment));
  const WindingReport winding =
      stages.run("winding", [&] { return check_winding(model.grid, surface.mesh, trimming, s.trim.sliver_tolerance); });
  append(report.warnings, judge_winding(winding, trimming, treatment));
  CellTable cells = stages.run("cells", [&] { return split_into_cells(model.grid, s.trim, trimming); });
  report.pieces = cells.pieces;
  append(report.warnings, judge_cells(cells, model.grid));

  QuadratureOptions options = s.quadrature;
  options.progress = [&](std::int64_t done, std::int64_t total) { progress.update(done, total); };
  options.cancelled = [] { return io::pending_signal() != 0; };
  TrimmedRules rules = stages.run("quadrature", [&] { return fit_rules(options, model.grid, trimming, surface); });
  if (options.trimmed_rule == "minimal") stages.run("reduction", [&] { reduce_rules(rules, options, report); });
  stages.run("rigidity", [&] { rules.secure(options); });
  QuadratureResult quadrature =
      stages.run("points", [&] { return place_points(model.grid, trimming, options, std::move(rules)); });
  return_free_memory();
  report.counts = quadrature.counts;
  model.points = std::move(quadrature.points);
  // Without leaks the two volumes agree to rounding; an accepted leak leaves only the one that the spans hold.
  const bool leaks = surface.open || trimming.worst_leak > volume_tolerance || report.trimming_error > volume_tolerance;
  model.quadrature = quadrature_info(s, trimming, leaks ? trimming.exact_volume : mesh_volume, quadrature.max_residual);
  model.functions.mass_fraction =
      stages.run("functions", [&] { return mass_fractions(model.grid, trimming, cells, model.points); });
  model.surface = stages.run("surface points", [&] {
    return make_embedded_surface(model.grid, surface.mesh, trimming, surface_rule(s.quadrature.surface_rule));
  });
  trimming.pieces = {};
  model.surface.accepted_leak = leaks ? std::max(trimming.worst_leak, volume_tolerance) : 0;
  model.surface.bodies = surface.bodies;
  judge_surface_points(model, treatment);
  place_cells(std::move(trimming), std::move(cells), model);

  const TriangleTree tree(model.surface.mesh);
  stages.run("walls", [&] { measure_walls_and_gaps(report, model, tree); });
  append(report.warnings, judge_walls(report.walls, model.grid));
  stages.run("check", [&] {
    describe_model(report, model);
    judge_weights(report.points_moments.volume, model.quadrature);
    if (const std::vector<std::string> faults = check(model); !faults.empty())
      throw std::logic_error(
          fmt::format("the model breaks its own rules, nothing was written: {}", fmt::join(faults, "; ")));
    if (leaks) return;
    if (const std::string outside = describe(find_points_outside(model, tree), model); !outside.empty())
      throw std::logic_error(fmt::format("a point lies outside the part, nothing was written: {}", outside));
  });
  model.provenance = provenance_of(s, run, part.read.sha256, report, stages);
  stages.run("write", [&] { io::write_model(s.output, model); });
  report.timings = stages.timings;
  report.peak_memory_mib = peak_memory_mib();
  return report;
}

} // namespace

std::string settings_hash(const Settings& settings) {
  return io::sha256_text(canonical_text(settings) + "version = " + program_version() + "\n");
}

PrepReport run_pipeline(const Settings& s, const RunInfo& run, io::Progress& progress,
                        const std::function<Part()>& make_part) {
  PrepReport report;
  report.input = s.input.string();
  report.output = s.output.string();
  check_paths(s);
  const io::OutputPlan plan{{s.output}, {}};
  std::vector<fs::path> inputs{s.input};
  if (!run.settings_file.empty()) inputs.push_back(run.settings_file);
  io::refuse_replaced_inputs(plan, inputs);
  io::refuse_foreign_ending(s.output);
  if (stands_already(s, run)) return report_standing(s, std::move(report));
  const io::OutputClaim claim(plan, inputs);

  Stages stages(progress);
  Part part = stages.run("read", [&] { return make_part ? make_part() : read_part(s); });
  report.format = part.read.format;
  SurfaceOptions options = s.surface;
  options.progress = [&](std::int64_t done, std::int64_t total) { progress.update(done, total); };
  // Wrapping may need the facets once more, where only the trimming finds something amiss.
  const PreparedSurface surface = stages.run("surface", [&] {
    return prepare_surface(s.surface.wrap ? part.read : std::exchange(part.read, without_facets(part.read)), options);
  });
  if (!s.surface.wrap) return make_model(s, run, surface, part, std::move(report), stages, progress);
  std::string reason;
  try {
    return make_model(s, run, surface, part, report, stages, progress);
  } catch (const SurfaceFault& fault) {
    if (surface.wrapped) throw;
    reason = fault.what();
  }
  const PreparedSurface wrapped = stages.run("wrap", [&] { return wrap_around(part.read, options, reason); });
  return make_model(s, run, wrapped, part, std::move(report), stages, progress);
}

} // namespace iga::prep
