#include "preprocessor/program/command_line.hpp"

#include "format/io/command_line.hpp"
#include "format/model/errors.hpp"
#include "format/model/version.hpp"
#include "preprocessor/program/settings_table.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <type_traits>

namespace iga::prep {

namespace {

const char* const examples = R"(Examples:
  igaprep part.stl                                       grid of a twentieth of the longest side, writes part.h5
  igaprep part.stl -o part.h5 --degree 2 --span-size 10 --length-unit mm
  igaprep part.stl --box 0 0 0 350 190 300 --spans 35 19 30 --moment-degree 2p
  igaprep part.step --list                               faces of a CAD file: names, types, areas, places
  igaprep part.step --span-size 4                        in the file's length unit; every face is a region
  igaprep assembly.step -o models/                       one model for each solid, and a run file to fill in
  igaprep broken.stl --repair                            may change the shape where the surface is open or crosses itself
  igaprep part.stl --quadrature ggq-reduced              fewest points inside at degree 2; ggq is exact, like gauss
  igaprep prep.toml --span-size 5 --force                settings from a file, flags override them

One number for --spans counts along the longest side, with cubic spans; one for --degree, --span-size or --moment-degree
holds in all directions. The settings file uses the flags' names with underscores, in these tables; paths in it are relative
to its folder.
)";

const char* const exit_codes = R"(
Exit codes: 0 done, 1 fault of the program, 2 input, usage or file access, 3 a file breaks the schema, 4 a method did not
reach its tolerance, 129, 130, 131 and 143 interrupted by SIGHUP, SIGINT, SIGQUIT and SIGTERM: no file is changed, unless
the points were being reduced (--trimmed minimal); then the file is written with the rules there are. 141: nobody reads
the report any more. Too little memory is exit code 2 and says so.)";

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

template <class T>
constexpr bool holds_numbers =
    !std::is_same_v<T, bool> && !std::is_same_v<T, std::string> && !std::is_same_v<T, std::filesystem::path>;

// Numbers that follow a flag are joined by commas to one word: a file name may then follow a list of open length, and a
// negative number is not taken for a flag.
std::map<std::string, std::size_t> most_values() {
  std::map<std::string, std::size_t> most;
  each_setting([&]<class T>(const Setting<T>& setting) {
    if (holds_numbers<T>) most[setting.flags()] = setting.length.count;
  });
  return most;
}

std::vector<std::string> join_values(int argc, const char* const* argv) {
  const std::map<std::string, std::size_t> most = most_values();
  std::vector<std::string> out;
  for (int i = 1; i < argc; ++i) {
    out.emplace_back(argv[i]);
    const auto flag = most.find(out.back());
    if (flag == most.end()) continue;
    std::vector<std::string> values;
    while (i + 1 < argc && values.size() < flag->second && is_value(argv[i + 1])) values.emplace_back(argv[++i]);
    if (!values.empty()) out.back() += fmt::format("={}", fmt::join(values, ","));
  }
  return out;
}

// "1,2,3" → numbers.
template <class T> std::vector<T> list_of(const std::string& flag, const std::string& text, const std::string& kind) {
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

std::string group_of(std::string_view table) {
  if (table.empty()) return "Files and units";
  if (table == "cad") return "CAD files";
  if (table == "surface") return "Surface";
  return table == "grid" ? "Grid" : "Trimming and quadrature";
}

// Words that are no option of their own end up in `file`, lists in `lists` under their key until they are converted.
struct Raw {
  std::optional<std::string> file;
  std::map<std::string, std::optional<std::string>> lists;
};

CLI::Option* add(CLI::App& app, Raw& raw, const auto& setting, auto& value) {
  using T = typename std::remove_reference_t<decltype(value)>::value_type;
  const std::string flags = setting.flags();
  if constexpr (std::is_same_v<T, bool>)
    return io::add_switch(app, fmt::format("{},!--no-{}", flags, flags.substr(2)), value, setting.help);
  else if constexpr (std::is_same_v<T, Numbers> || std::is_same_v<T, Integers> || std::is_same_v<T, WordOrIntegers>)
    return app.add_option(flags, raw.lists[setting.key], setting.help);
  else
    return app.add_option(flags, value, setting.help);
}

// "input, output …; [surface] repair, …", in lines.
std::string settings_keys() {
  std::string text, line, table;
  each_setting([&](const auto& setting) {
    std::string word = setting.key;
    if (setting.flag && setting.flags().find("--" + word) == std::string::npos)
      word += fmt::format(" ({})", setting.flag);
    if (table != setting.table) {
      table = setting.table;
      text += line + "\n";
      line = fmt::format("  [{}] {}", table, word);
    } else {
      line += (line.empty() ? "  " : ", ") + word;
    }
  });
  return text + line + "\n";
}

void add_options(CLI::App& app, Raw& raw, TypedSettings& t, CommandLine& line) {
  app.add_option("file", raw.file,
                 "Surface (.stl, .obj, .ply, .off), CAD file (.step, .iges, .brep) or settings file (.toml)");
  each_setting([&](const auto& setting) {
    CLI::Option* option = add(app, raw, setting, t.*setting.member)->group(group_of(setting.table));
    if (*setting.value != 0) option->type_name(setting.value);
  });
  const std::string running = "Running";
  app.add_option("--threads", line.threads, "Number of threads [all]")->check(CLI::Range(1, 4096))->group(running);
  app.add_flag("--force", line.force, "Replace an output file that does not match")->group(running);
  app.add_flag("--quiet", line.quiet, "Print errors only")->group(running);
  app.add_flag("--list", line.list, "Print the solids and faces of a CAD file, with area, type, place; write nothing")
      ->group(running);
  app.add_flag("--list-edges", line.list_edges, "The same with edges and vertices")->group(running);
  app.add_flag("--json", line.json, "Report as one JSON object on stdout")->group(running);
  app.set_version_flag("--version", std::string("igaprep ") + program_version())->group(running);
  app.footer(examples + settings_keys() + exit_codes);
}

std::string expected(const ListLength& length, const char* kind) {
  return fmt::format("{}{} {}", length.or_one ? "1 or " : "", length.count, kind);
}

// Lists as typed → numbers; all else is there already.
void convert(const std::string& text, const Setting<Numbers>& s, TypedSettings& t) {
  t.*s.member = list_of<double>(s.flags(), text, expected(s.length, "numbers"));
}
void convert(const std::string& text, const Setting<Integers>& s, TypedSettings& t) {
  t.*s.member = list_of<std::int64_t>(s.flags(), text, expected(s.length, "integers"));
}
void convert(const std::string& text, const Setting<WordOrIntegers>& s, TypedSettings& t) {
  if (text == "p" || text == "2p")
    t.*s.member = text;
  else
    t.*s.member = list_of<std::int64_t>(s.flags(), text, "p, 2p, or " + expected(s.length, "integers"));
}
void convert(const std::string&, const auto&, TypedSettings&) {}

TypedSettings flags_of(const Raw& raw, TypedSettings t) {
  each_setting([&](const auto& setting) {
    const auto list = raw.lists.find(setting.key);
    if (list != raw.lists.end() && list->second) convert(*list->second, setting, t);
  });
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
