#include "preprocessor/command_line.hpp"

#include "format/io/command_line.hpp"
#include "format/model/errors.hpp"
#include "format/model/version.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace iga::prep {

namespace {

const char* const examples = R"(Examples:
  igaprep part.stl                                       grid of a twentieth of the longest side, writes part.h5
  igaprep part.stl -o part.h5 --degree 2 --span-size 10 --length-unit mm
  igaprep part.stl --box 0 0 0 350 190 300 --spans 35 19 30 --moment-degree 2p
  igaprep broken.stl --repair                            may change the shape where the surface is open or crosses itself
  igaprep part.stl --quadrature ggq-reduced              fewest points inside at degree 2; ggq is exact, like gauss
  igaprep prep.toml --span-size 5 --force                settings from a file, flags override them

One number for --spans counts along the longest side, with cubic spans; one for --degree, --span-size or --moment-degree
holds in all directions. The settings file uses the flags' names with underscores: input, output, scale, length_unit,
title; [surface] repair, wrap, wrap_alpha, wrap_offset, region_angle, accept_leaks; [grid] box, spans, span_size, degree,
margin, rotation, rotate_axis_angle, optimise_offset; [trim] sliver_tolerance, min_fraction; [quadrature] interior
(--quadrature), trimmed, moment_degree, tolerance, rank_bound. Paths in it are relative to its folder.

Exit codes: 0 done, 1 fault of the program, 2 input, usage or file access, 3 a file breaks the schema, 4 a method did not
reach its tolerance, 129, 130, 131 and 143 interrupted by SIGHUP, SIGINT, SIGQUIT and SIGTERM: no file is changed, unless
the points were being reduced (--trimmed minimal); then the file is written with the rules there are. 141: nobody reads
the report any more. Too little memory is exit code 2 and says so.)";

// Numbers that follow these flags are joined by commas to one word: a file name may then follow a list of open length,
// and a negative number is not taken for a flag.
const std::map<std::string, std::size_t> most_values{{"--degree", 3},
                                                     {"--span-size", 3},
                                                     {"--spans", 3},
                                                     {"--moment-degree", 3},
                                                     {"--box", 6},
                                                     {"--rotation", 9},
                                                     {"--rotate-axis-angle", 4},
                                                     {"--scale", 1},
                                                     {"--margin", 1},
                                                     {"--wrap-alpha", 1},
                                                     {"--wrap-offset", 1},
                                                     {"--region-angle", 1},
                                                     {"--sliver-tolerance", 1},
                                                     {"--min-fraction", 1},
                                                     {"--tolerance", 1}};

template <class T> std::optional<T> parsed(std::string_view text) {
  T value{};
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

bool is_value(const std::string& text) {
  if (text == "p" || text == "2p" || parsed<double>(text)) return true;
  const auto comma = text.find(',');
  return comma != std::string::npos && is_value(text.substr(0, comma)) && is_value(text.substr(comma + 1));
}

std::vector<std::string> join_values(int argc, const char* const* argv) {
  std::vector<std::string> out;
  for (int i = 1; i < argc; ++i) {
    out.emplace_back(argv[i]);
    const auto flag = most_values.find(out.back());
    if (flag == most_values.end()) continue;
    std::vector<std::string> values;
    while (i + 1 < argc && values.size() < flag->second && is_value(argv[i + 1])) values.emplace_back(argv[++i]);
    if (!values.empty()) out.back() += fmt::format("={}", fmt::join(values, ","));
  }
  return out;
}

// "1,2,3" → numbers.
template <class T> std::vector<T> list_of(const std::string& flag, const std::string& text, const char* kind) {
  std::vector<T> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto value = parsed<T>(std::string_view(text).substr(begin, end - begin));
    if (!value)
      throw InputError(fmt::format("{}: found \"{}\", expected {}", flag, text.substr(begin, end - begin), kind));
    values.push_back(*value);
    begin = end + 1;
  }
  return values;
}

// Where every flag's text lands before it is converted.
struct Raw {
  std::optional<std::string> file, degree, span_size, spans, moment_degree, box, rotation, rotate_axis_angle;
};

void add_options(CLI::App& app, Raw& raw, TypedSettings& t, CommandLine& line) {
  app.add_option("file", raw.file, "Surface (.stl, .obj, .ply, .off) or settings file (.toml)");
  app.add_option("--input", t.input, "Surface file, where a settings file comes first")->type_name("FILE");
  app.add_option("-o,--output", t.output, "Model file [name of the surface].h5 in the current folder")
      ->type_name("FILE");

  const std::string surface = "Surface";
  app.add_option("--scale", t.scale, "Factor on all coordinates [1]")->group(surface);
  app.add_option("--length-unit", t.length_unit, "Label of the length unit, e.g. mm")->group(surface);
  app.add_option("--title", t.title, "Title in the file [name of the surface]")->group(surface);
  io::add_switch(app, "--repair,!--no-repair", t.repair,
                 "Allow changes of shape: fill holes, resolve self-intersections, unite bodies")
      ->group(surface);
  io::add_switch(app, "--wrap,!--no-wrap", t.wrap, "Last resort: alpha wrapping")->group(surface);
  app.add_option("--wrap-alpha", t.wrap_alpha, "Smallest detail of the wrapping, length [diagonal / 50]")
      ->group(surface);
  app.add_option("--wrap-offset", t.wrap_offset, "Distance of the wrapping, length [alpha / 30]")->group(surface);
  app.add_option("--region-angle", t.region_angle, "Split regions at edges sharper than this, degrees")->group(surface);
  io::add_switch(app, "--accept-leaks,!--no-accept-leaks", t.accept_leaks, "Go on with a surface that is not closed")
      ->group(surface);

  const std::string grid = "Grid";
  app.add_option("--degree", raw.degree, "Degree 1 … 4 [2]")->type_name("P [P P]")->group(grid);
  app.add_option("--span-size", raw.span_size, "Size of a span, length [longest side / 20]")
      ->type_name("H [H H]")
      ->group(grid);
  app.add_option("--spans", raw.spans, "Spans across the part, or across the box")->type_name("N [N N]")->group(grid);
  app.add_option("--box", raw.box, "Corners A and B of the grid: no margin then")
      ->type_name("AX AY AZ BX BY BZ")
      ->group(grid);
  app.add_option("--margin", t.margin, "Empty spans on every side [degree]")->group(grid);
  app.add_option("--rotation", raw.rotation, "Rotation of the grid about its centre, row by row; columns are its axes")
      ->type_name("R (9 numbers)")
      ->group(grid);
  app.add_option("--rotate-axis-angle", raw.rotate_axis_angle, "The same as axis and angle in degrees")
      ->type_name("X Y Z DEG")
      ->group(grid);
  io::add_switch(app, "--optimise-offset,!--no-optimise-offset", t.optimise_offset,
                 "Shift the grid within one span so that fewest functions are light")
      ->group(grid);

  const std::string quadrature = "Trimming and quadrature";
  app.add_option("--sliver-tolerance", t.sliver_tolerance, "Depth in spans below which a cut is snapped [2e-5]")
      ->group(quadrature);
  app.add_option("--min-fraction", t.min_fraction, "Drop trimmed spans with a smaller volume fraction [0]")
      ->group(quadrature);
  app.add_option("--quadrature", t.interior, "Rule of interior spans: gauss, ggq, ggq-reduced or ggq-reduced2 [ggq]")
      ->type_name("RULE")
      ->group(quadrature);
  app.add_option(
         "--trimmed", t.trimmed,
         "Rule of trimmed spans: nnls, or minimal: points taken out and moved [minimal up to moment degree 2, above it "
         "nnls]")
      ->type_name("RULE")
      ->group(quadrature);
  io::add_switch(app, "--rank-bound,!--no-rank-bound", t.rank_bound,
                 "With minimal: keep in a span as many points as its own stiffness has rank")
      ->group(quadrature);
  app.add_option("--moment-degree", raw.moment_degree, "Moments kept on trimmed spans: p, 2p or numbers [p]")
      ->type_name("Q [Q Q]")
      ->group(quadrature);
  app.add_option("--tolerance", t.tolerance, "Bound on the moment residual of every span [1e-10]")->group(quadrature);

  const std::string running = "Running";
  app.add_option("--threads", line.threads, "Number of threads [all]")->check(CLI::Range(1, 4096))->group(running);
  app.add_flag("--force", line.force, "Replace an output file that does not match")->group(running);
  app.add_flag("--quiet", line.quiet, "Print errors only")->group(running);
  app.add_flag("--json", line.json, "Report as one JSON object on stdout")->group(running);
  app.set_version_flag("--version", std::string("igaprep ") + program_version())->group(running);
  app.footer(examples);
}

TypedSettings flags_of(const Raw& raw, TypedSettings t) {
  if (raw.degree) t.degree = list_of<std::int64_t>("--degree", *raw.degree, "1 or 3 integers");
  if (raw.spans) t.spans = list_of<std::int64_t>("--spans", *raw.spans, "1 or 3 integers");
  if (raw.span_size) t.span_size = list_of<double>("--span-size", *raw.span_size, "1 or 3 numbers");
  if (raw.box) t.box = list_of<double>("--box", *raw.box, "6 numbers");
  if (raw.rotation) t.rotation = list_of<double>("--rotation", *raw.rotation, "9 numbers");
  if (raw.rotate_axis_angle)
    t.rotate_axis_angle = list_of<double>("--rotate-axis-angle", *raw.rotate_axis_angle, "4 numbers");
  if (raw.moment_degree) {
    if (*raw.moment_degree == "p" || *raw.moment_degree == "2p")
      t.moment_degree = *raw.moment_degree;
    else
      t.moment_degree = list_of<std::int64_t>("--moment-degree", *raw.moment_degree, "p, 2p, or 1 or 3 integers");
  }
  return t;
}

} // namespace

std::optional<CommandLine> parse_command_line(int argc, const char* const* argv) {
  CLI::App app("From a surface to a trimmed spline solid: igaprep puts a part into a B-spline grid, finds the exact\n"
               "volume of every span, makes positive quadrature points and writes one HDF5 file.",
               "igaprep");
  Raw raw;
  TypedSettings typed;
  CommandLine line;
  add_options(app, raw, typed, line);
  std::vector<std::string> words = join_values(argc, argv);
  std::reverse(words.begin(), words.end()); // CLI11 takes them from the back
  try {
    app.parse(words);
  } catch (const CLI::Success& answered) {
    app.exit(answered);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    io::refuse_usage(app, error, "igaprep");
  }
  line.text = io::command_text("igaprep", argc, argv);

  const TypedSettings flags = flags_of(raw, typed);
  if (!raw.file && !flags.input) throw InputError("no surface or settings file is given (see igaprep --help)");
  TypedSettings base;
  if (raw.file && std::filesystem::path(*raw.file).extension() == ".toml")
    base = read_settings_file(line.settings_file = *raw.file);
  else if (raw.file && flags.input)
    throw InputError(fmt::format("two surfaces are given: {} and --input {}", *raw.file, flags.input->string()));
  else if (raw.file)
    base.input = *raw.file;
  line.typed = override_settings(std::move(base), flags);
  return line;
}

} // namespace iga::prep
