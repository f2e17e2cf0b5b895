// A strict little JSON reader, so that the tests judge the reports independently of the code that writes them.
#pragma once

#include <map>
#include <string>

namespace iga::test {

/// Leaves of a JSON object by path: {"a": {"b": [1, 2]}} gives "a.b.0" → "1", "a.b.1" → "2"; strings come unescaped,
/// arrays and objects add "path.#" with their length.
/// @throws std::runtime_error at the first character that is no JSON (RFC 8259), and for anything after the object
std::map<std::string, std::string> parse_json(const std::string& text);

} // namespace iga::test
