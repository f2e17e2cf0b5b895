#include "solver/supports/body_choice.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

std::size_t body_by_name(const BodySystem& system, const std::string& name, const std::string& what) {
  std::vector<std::string> known;
  for (std::size_t b = 0; b < system.size(); ++b) {
    if (system[b].name == name) return b;
    known.push_back(system[b].name);
  }
  if (known.size() == 1 && known[0].empty())
    throw InputError(
        fmt::format("{}: it names the body '{}', but the run has no [[bodies]]; leave 'body' out", what, name));
  const auto near = io::nearest_name(name, known);
  throw InputError(fmt::format("{}: there is no body '{}'{}; the bodies are '{}'", what, name,
                               near ? fmt::format(", did you mean '{}'?", *near) : "", fmt::join(known, "', '")));
}

std::size_t chosen_body(const BodySystem& system, const std::string& name, const std::string& what,
                        const std::function<void(std::size_t)>& look) {
  if (!name.empty()) return body_by_name(system, name, what);
  if (system.size() == 1) return 0;
  std::vector<std::size_t> found;
  std::vector<std::string> names, misses;
  for (std::size_t b = 0; b < system.size(); ++b) try {
      look(b);
      found.push_back(b);
      names.push_back(fmt::format("'{}'", system[b].name));
    } catch (const InputError& error) {
      misses.push_back(fmt::format("in body '{}': {}", system[b].name, error.what()));
    }
  if (found.size() == 1) return found.front();
  if (found.empty())
    throw InputError(fmt::format("{}: no body has what it asks for\n  {}", what, fmt::join(misses, "\n  ")));
  throw InputError(fmt::format("{}: the bodies {} all have what it asks for; say which one is meant: body = \"{}\"",
                               what, fmt::join(names, " and "), system[found.front()].name));
}

} // namespace iga::solve
