#include "solver/program/command_line.hpp"

#include "format/io/command_line.hpp"
#include "format/model/errors.hpp"
#include "format/model/version.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace iga::solve {

namespace {

const char* const footer = R"(Examples:
  igasolve info part.h5                                  what a model file holds
  igasolve check part.h5                                 everything that is wrong with a model file, and a table
  igasolve check part.h5 static.h5                       and whether the results belong to it
  igasolve eigen part.h5 --E 210 --nu 0.3 --rho 7.8e-6 --modes 10 -o modes.h5
  igasolve eigen part.h5 --material steel --modes 10      the same; the model's length unit must be mm or m
  igasolve eigen part.h5 --E 210 --nu 0.3 --rho 7.8e-6 --largest --mass lumped
  igasolve timestep part.h5 --E 210 --nu 0.3 --rho 7.8e-6
  igasolve static run.toml -o static.h5
  igasolve heat run.toml -o heat.h5                      steady temperatures; static reads them
  igasolve harmonic run.toml -o response.h5              frequency response; random and transient likewise
  igasolve buckling run.toml -o buckling.h5              factors on the loads at which the part buckles
  igasolve explicit impact.toml -o impact.h5             impact and crush; igasolve explicit --help shows a run file
  igasolve nonlinear run.toml -o bent.h5                 statics at large displacement; its --help shows a run file
  igasolve export modes.h5 --csv                         frequencies, series, probes, fields as tables

Exit codes: 0 done, 1 fault of the program, 2 input, usage or file access, 3 a file breaks the schema, 4 a method did not
reach its tolerance or a run blew up, 129, 130, 131 and 143 interrupted by SIGHUP, SIGINT, SIGQUIT and SIGTERM (no file is
changed; explicit and nonlinear runs leave their results so far and a restart file), 141: nobody reads the report any more. Too little
memory is exit code 2 and says so.)";

const char* const analysis_footer =
    R"(Any consistent set of units: E in force/length², rho in mass/length³, frequencies in cycles per time. The run file
(.toml) holds the flags' names with underscores: model, output, units, unit_system, material, materials, mass,
light_functions, light_threshold, solver; [material] name, E, nu, rho or C, yield, expansion, conductivity; [eigen] modes or
modes_below, largest, sturm, errors, prestress; [buckling] factors, negative, constant, sturm; [results] subdivide, viewer,
stress = "recovered" or "raw"; [[support]], [[load]], [[probe]]; [[line]] name, body, from, to: linearised stress through a wall. Loads of the whole part: body_force,
acceleration, centrifugal = { axis, point, speed or rpm, angular_acceleration }. [[case]] name, loads, prescribed; [temperature]
uniform, formula, file or results, reference; [[bolt]] plane, force, box, length; inertia_relief; [[heat]] temperature, flux,
power, convection or source. Attached to a choice of surface, a line or a point: [[spring]] stiffness, normal_stiffness,
tangential_stiffness, axial and to; [[added_mass]] mass, inertia, at, spread.
Several bodies, instead of model: [[bodies]] name, model, material, place, light_functions, light_threshold; [[ties]] name,
bodies, first, second, tolerance, method, penalty_factor join their surfaces; supports, loads and probes say their body.
Paths in it are relative to its folder; flags override it.)";

const char* const response_footer =
    R"(Run file: as for static runs, with [[support]], [[load]] and [[probe]], and
[damping] one of ratio = 0.02, modes = [0.01, 0.02], table = [[frequency, ratio], …], rayleigh = [alpha, beta],
structural = 0.04;
[base] direction, unit = "g", gravity: all supports accelerate together;
[base] and [[load]]: spectrum, phase (harmonic), psd (random), history (transient), each a number, rows [[x, y], …] or a
text file with two columns: amplitude over frequency, power spectral density over frequency, factor over time;
[harmonic] from, to, points, frequencies, fields; [random] from, to, points; [transient] end, step, fields;
[eigen] modes or modes_below; [response] residual_vectors.
Results: tables for igasolve export --csv and scripts/plot.py response, fields for ParaView.)";

const char* const explicit_footer =
    R"(Example of a run file (kg, mm, ms); all keys: solver/explicit/README.md. Paths are relative to its folder.
  gravity = [0, 0, -9.81e-3]
  [[bodies]]
  name = "cube"
  model = "cube.h5"                        # made by igaprep
  material = { law = "neo-hookean", E = 0.05, nu = 0.3, rho = 6e-8 }
  [[rigid_bodies]]
  name = "sphere"
  shape = "sphere"                         # plane, cylinder, box, stl
  radius = 35
  centre = [50, 50, 136]
  motion = "free"                          # fixed, or driven by [rigid_bodies.drive]
  mass = 1
  inertia = 490
  velocity = [0, 0, -8]
  [[contacts]]
  bodies = ["cube", "sphere"]              # or self = "cube"
  friction = 0.2
  [time]
  end = 8
  [output]
  interval = 0.01                          # of the time series
  field_interval = 0.2                     # of the fields, also for ParaView

Results: out.h5 (time series), out_fields/ and, for ParaView, out.pvd. Ctrl-C and SIGTERM leave valid results and
out_restart.h5: the same command with --restart goes on bit for bit.)";

const char* const nonlinear_footer =
    R"(Example of a run file; all keys: solver/nonlinear/README.md. Paths are relative to its folder.
  model = "beam.h5"                        # made by igaprep
  material = { law = "neo-hookean", E = 210e3, nu = 0.3 }
  locking = "none"                         # "fbar", the default for rubber: metal that flows far, too
  [[support]]                              # as in static runs, all held by penalty; values grow with the load factor
  plane = { point = [0, 0, 0], normal = [1, 0, 0] }
  [[load]]                                 # dead; a pressure follows the surface unless follower = false
  plane = { point = [100, 0, 0], normal = [1, 0, 0] }
  force = [0, 0, -500]
  [[probe]]
  name = "tip"
  position = [100, 5, 5]
  [[rigid_bodies]]                         # a tool; the time of its drive is the load factor
  name = "press"
  shape = "plane"                          # also: sphere, cylinder, box, stl
  normal = [0, 0, -1]
  centre = [50, 5, 10]
  drive = { z = [[0, 0], [1, -2]] }
  [[contacts]]
  bodies = ["part", "press"]
  friction = 0.1                           # also: rough = true, first_regions, stiffness
  [nonlinear]
  steps = 10                               # cut where Newton's method needs it; results are kept at each
  tolerance = 1e-8                         # also: max_iterations, smallest_step

Laws and their keys: those of explicit runs, solver/explicit/laws/README.md. Results: bent.h5 (series over the load factor),
bent_fields/ and, for ParaView, bent.pvd. Ctrl-C, and a run that finds no equilibrium (exit code 4), keep all converged steps and
bent_restart.h5: the same command with --restart goes on; [nonlinear] and [results] may change.)";

struct Raw {
  std::string file, results;
  bool json = false, quiet = false;
};

CLI::App* add_model_command(CLI::App& app, const char* name, const char* what, Raw& raw) {
  CLI::App* sub = app.add_subcommand(name, what);
  sub->add_option("model", raw.file, "Model file made by igaprep")->required();
  auto* json = sub->add_flag("--json", raw.json, "Print one JSON object");
  sub->add_flag("--quiet", raw.quiet, "Print nothing but errors")->excludes(json);
  sub->footer(fmt::format("Example:\n  igasolve {} part.h5", name));
  return sub;
}

CLI::App* add_analysis(CLI::App& app, const char* name, const char* what, Raw& raw, AnalysisCommand& c) {
  CLI::App* sub = app.add_subcommand(name, what);
  TypedRun& t = c.typed;
  sub->add_option("file", raw.file, "Model file made by igaprep, or run file (.toml)")->type_name("FILE");
  sub->add_option("--model", t.model, "Model file, where a run file comes first")->type_name("FILE");
  sub->add_option("-o,--output", t.output, "Results file (.h5); without it only the report is printed")
      ->type_name("FILE");
  sub->add_option("--units", t.units, "Length unit; refused where the model's label differs");

  const std::string material = "Material";
  sub->add_option("--material", t.material.name, "Material by name, such as steel; an unknown name lists all")
      ->type_name("NAME")
      ->group(material);
  sub->add_option("--unit-system", t.unit_system,
                  "Units of its numbers: t-mm-s, kg-mm-ms or SI [by the model's length unit]")
      ->type_name("UNITS")
      ->group(material);
  sub->add_option("--materials", t.materials, "Table of materials of your own (.toml)")
      ->type_name("FILE")
      ->group(material);
  sub->add_option("--E", t.material.E, "Young's modulus, force/length²")->group(material);
  sub->add_option("--nu", t.material.nu, "Poisson's ratio")->group(material);
  sub->add_option("--rho", t.material.rho, "Density, mass/length³")->group(material);

  const std::string method = "Method";
  sub->add_option("--light-functions", t.light_functions,
                  "Functions with little material: none, remove, linear or degree-p [by mass type]")
      ->type_name("REMEDY")
      ->group(method);
  sub->add_option("--light-threshold", t.light_threshold, "Mass fraction below which a function is light")
      ->group(method);

  const std::string running = "Running";
  sub->add_option("--threads", c.threads, "Number of threads [all]")->check(CLI::Range(1, 4096))->group(running);
  sub->add_flag("--force", c.force, "Replace an existing results file")->group(running);
  sub->add_flag("--quiet", raw.quiet, "Print errors only")->group(running);
  sub->add_flag("--json", raw.json, "Report as one JSON object on stdout")->group(running);
  sub->footer(analysis_footer);
  return sub;
}

void add_mass(CLI::App& sub, TypedRun& t, const char* standard) {
  sub.add_option("--mass", t.mass, fmt::format("consistent, lumped, two-pass or three-pass [{}]", standard))
      ->type_name("TYPE")
      ->group("Method");
}

void add_solver(CLI::App& sub, TypedRun& t) {
  sub.add_option("--solver", t.solver, "auto, direct or multigrid [auto: by the size of the model]")
      ->type_name("SOLVER")
      ->group("Method");
}

void add_results(CLI::App& sub, TypedRun& t) {
  const std::string results = "Results";
  sub.add_option("--subdivide", t.subdivide, "Surface of the results: edges at most span / N [2]")
      ->type_name("N")
      ->group(results);
  io::add_switch(sub, "--viewer,!--no-viewer", t.viewer, "Files for ParaView beside the results file [yes]")
      ->group(results);
}

CLI::App* add_buckling(CLI::App& app, Raw& raw, AnalysisCommand& c) {
  CLI::App* sub = add_analysis(app, "buckling", "Factors on the loads at which the part buckles", raw, c);
  TypedBuckling& buckling = c.typed.buckling;
  sub->add_option("--factors", buckling.factors, "Number of factors [5]")->type_name("N")->group("Method");
  io::add_switch(*sub, "--negative,!--no-negative", buckling.negative, "Those of the reversed loads too [no]")
      ->group("Method");
  io::add_switch(*sub, "--sturm,!--no-sturm", buckling.sturm,
                 "Prove by a Sturm count that no factor is missing [below 100 000 unknowns]")
      ->group("Method");
  add_results(*sub, c.typed);
  return sub;
}

CLI::App* add_stepped(CLI::App& app, const char* name, const char* about, const char* output, Raw& raw,
                      SteppedCommand& c) {
  CLI::App* sub = app.add_subcommand(name, about);
  sub->add_option("run", raw.file, "Run file (.toml)")->type_name("FILE")->required();
  sub->add_option("-o,--output", c.output, output)->type_name("FILE");
  const std::string running = "Running";
  sub->add_flag("--restart", c.restart, "Go on with the restart file beside the results file")->group(running);
  sub->add_option("--threads", c.threads, "Number of threads [all]")->check(CLI::Range(1, 4096))->group(running);
  sub->add_flag("--force", c.force, "Replace existing results")->group(running);
  sub->add_flag("--quiet", raw.quiet, "Print errors only")->group(running);
  sub->add_flag("--json", raw.json, "Report as one JSON object on stdout")->group(running);
  return sub;
}

CLI::App* add_export(CLI::App& app, Raw& raw, ExportCommand& c) {
  CLI::App* sub = app.add_subcommand("export", "Write tables of a results file or a model as text files (CSV)");
  sub->add_option("file", raw.file, "Results file of igasolve, or model file of igaprep")
      ->type_name("FILE")
      ->required();
  sub->add_flag("--csv", c.csv, "Comma-separated values, one header line with names and units");
  sub->add_option("-o,--output", c.output, "Folder for all tables, or FILE.csv for one [FILE_csv]")->type_name("PATH");
  sub->add_option("--table", c.table, "Write this table alone")->type_name("NAME");
  sub->add_flag("--force", c.force, "Replace existing files");
  auto* json = sub->add_flag("--json", raw.json, "Print the list of files as one JSON object");
  sub->add_flag("--quiet", raw.quiet, "Print errors only")->excludes(json);
  sub->footer(R"(Tables:
  eigen      frequencies, participation, surface, triangles
  static     reactions, springs, loads, cases, probes, points, surface, triangles
  heat       heat, probes, surface, triangles
  harmonic   probe_NAME, support_NAME, modes, fields, surface, triangles; transient the same
  random     rms_NAME, rms_support_NAME, psd_NAME, modes, surface, triangles
  buckling   factors, surface, triangles
  nonlinear  energy, body_part, support_NAME, probe_NAME, surface_part_STEP, triangles_part
  explicit   energy, contact_NAME, body_NAME, rigid_NAME, support_NAME, surface_NAME_STEP, triangles_NAME
  model      points, surface_points, spans, functions

Examples:
  igasolve export modes.h5 --csv                         all tables, into the folder modes_csv
  igasolve export modes.h5 --csv -o frequencies.csv      the first table, or the one that --table names)");
  return sub;
}

// The file is a run file or the model itself.
void settle_file(const Raw& raw, AnalysisCommand& c) {
  const TypedRun flags = c.typed;
  TypedRun base;
  if (std::filesystem::path(raw.file).extension() == ".toml") {
    c.run_file = raw.file;
    base = read_run_file(c.run_file);
  } else if (!raw.file.empty() && flags.model) {
    throw InputError(fmt::format("two models are given: {} and --model {}", raw.file, flags.model->string()));
  } else if (!raw.file.empty()) {
    base.model = raw.file;
  }
  c.typed = override_run(std::move(base), flags);
}

} // namespace

std::optional<Command> parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Analyses of trimmed solids made by igaprep: eigenmodes, statics, buckling, time steps, impact.",
               "igasolve");
  Raw raw;
  AnalysisCommand analysis;
  app.set_version_flag("--version", std::string("igasolve ") + program_version());
  app.require_subcommand(1);
  app.footer(footer);
  CLI::App* info = add_model_command(app, "info", "Print what a model file holds", raw);
  CLI::App* check = add_model_command(app, "check", "Validate a model file and print what is wrong", raw);
  check->add_option("results", raw.results, "Results file: does it belong to the model?");
  check->footer("Example:\n  igasolve check part.h5\n  igasolve check part.h5 static.h5");
  CLI::App* eigen =
      add_analysis(app, "eigen", "Eigenfrequencies and modes, or the largest eigenfrequency", raw, analysis);
  add_mass(*eigen, analysis.typed, "consistent; lumped with --largest");
  eigen->add_option("--modes", analysis.typed.modes, "Number of elastic modes [10]")->type_name("N")->group("Method");
  eigen
      ->add_option("--modes-below", analysis.typed.modes_below,
                   "Instead: all elastic modes below this frequency, cycles per time")
      ->type_name("F")
      ->group("Method");
  add_solver(*eigen, analysis.typed);
  io::add_switch(*eigen, "--largest", analysis.typed.largest, "The largest eigenfrequency alone")->group("Method");
  io::add_switch(*eigen, "--sturm,!--no-sturm", analysis.typed.sturm,
                 "Prove by a Sturm count that no mode is missing [below 100 000 unknowns]")
      ->group("Method");
  io::add_switch(*eigen, "--errors,!--no-errors", analysis.typed.errors,
                 "Estimate the error of each mode from what it leaves of the equations (degree 2 and more)")
      ->group("Method");
  io::add_switch(*eigen, "--prestress,!--no-prestress", analysis.typed.prestress,
                 "Modes of the part under the run file's loads [no]")
      ->group("Method");
  add_results(*eigen, analysis.typed);
  CLI::App* timestep = add_analysis(app, "timestep", "Largest stable time step of explicit dynamics", raw, analysis);
  add_mass(*timestep, analysis.typed, "lumped");
  CLI::App* statics = add_analysis(app, "static", "Displacements and stresses under loads and supports", raw, analysis);
  add_solver(*statics, analysis.typed);
  add_results(*statics, analysis.typed);
  CLI::App* heat =
      add_analysis(app, "heat", "Steady temperatures: conduction, fluxes, convection, sources", raw, analysis);
  add_results(*heat, analysis.typed);
  const std::array<std::pair<Analysis, CLI::App*>, 3> responses{
      {{Analysis::Harmonic,
        add_analysis(app, "harmonic", "Frequency response to loads and base motion", raw, analysis)},
       {Analysis::Random, add_analysis(app, "random", "Root mean squares of random vibration", raw, analysis)},
       {Analysis::Transient,
        add_analysis(app, "transient", "Answers to loads and base motion over time", raw, analysis)}}};
  for (const auto& [kind, response] : responses) {
    add_mass(*response, analysis.typed, "consistent");
    response->add_option("--modes", analysis.typed.modes, "Number of elastic modes")->type_name("N")->group("Method");
    add_results(*response, analysis.typed);
    response->footer(response_footer);
  }
  CLI::App* buckling = add_buckling(app, raw, analysis);
  ExportCommand tables;
  CLI::App* export_app = add_export(app, raw, tables);
  ExplicitCommand dynamics;
  CLI::App* explicit_app = add_stepped(app, "explicit", "Impact, crush, waves: explicit dynamics with contact",
                                       "Results file (.h5)", raw, dynamics);
  explicit_app
      ->add_flag("--profile", dynamics.profile,
                 "Report CPU time by phase, and how much of it more threads would not shorten")
      ->group("Running");
  explicit_app->footer(explicit_footer);
  NonlinearCommand nonlinear;
  CLI::App* nonlinear_app =
      add_stepped(app, "nonlinear", "Statics at large displacement: rubber, metal that yields, foam",
                  "Results file (.h5); without it only the report is printed", raw, nonlinear);
  nonlinear_app->footer(nonlinear_footer);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& answered) {
    app.exit(answered);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    io::refuse_usage(chosen.empty() ? app : *chosen.front(), error,
                     chosen.empty() ? "igasolve" : "igasolve " + chosen.front()->get_name());
  }
  const ReportStyle style = raw.json ? ReportStyle::Json : raw.quiet ? ReportStyle::Quiet : ReportStyle::Text;
  if (*info) return InfoCommand{{raw.file, style}};
  if (*check) return CheckCommand{{raw.file, style}, raw.results};
  if (*export_app) {
    tables.style = style;
    tables.file = raw.file;
    return tables;
  }
  const auto settled = [&](auto command) {
    command.style = style;
    command.run_file = raw.file;
    command.text = io::command_text("igasolve", argc, argv);
    return command;
  };
  if (*explicit_app) return settled(dynamics);
  if (*nonlinear_app) return settled(nonlinear);
  analysis.style = style;
  analysis.analysis = *eigen      ? Analysis::Eigen
                      : *timestep ? Analysis::Timestep
                      : *heat     ? Analysis::Heat
                      : *buckling ? Analysis::Buckling
                                  : Analysis::Static;
  for (const auto& [kind, response] : responses)
    if (*response) analysis.analysis = kind;
  (void)statics;
  analysis.text = io::command_text("igasolve", argc, argv);
  settle_file(raw, analysis);
  return analysis;
}

} // namespace iga::solve
