#include "solver/base/csv_table.hpp"

#include "format/io/replace_file.hpp"
#include "format/model/errors.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>

namespace iga::solve {

namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

} // namespace

CsvTable& CsvTable::add(std::string title, std::function<std::string(std::size_t)> cell) {
  titles_.push_back(std::move(title));
  cells_.push_back(std::move(cell));
  return *this;
}

CsvTable& CsvTable::numbers(const std::string& title, const std::string& unit, std::span<const double> values,
                            const std::vector<std::string>& suffixes) {
  if (values.empty()) return *this;
  const std::size_t width = suffixes.size();
  for (std::size_t c = 0; c < width; ++c)
    add(fmt::format("{}{}{}", title, suffixes[c], unit == "1" ? "" : fmt::format(" [{}]", unit)),
        [values, width, c](std::size_t row) { return fmt::format("{}", values[width * row + c]); });
  return *this;
}

void CsvTable::write(const std::filesystem::path& file) const {
  io::ReplacementFile replacement(file);
  std::ofstream out(replacement.path(), std::ios::binary);
  const auto line = [&](const auto& cell) {
    std::string text;
    for (std::size_t c = 0; c < titles_.size(); ++c) text += (c ? "," : "") + quoted(cell(c));
    out << text << '\n';
  };
  line([&](std::size_t c) { return titles_[c]; });
  for (std::size_t row = 0; row < rows_ && out; ++row) line([&](std::size_t c) { return cells_[c](row); });
  out.close();
  if (!out) throw InputError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  replacement.commit();
}

} // namespace iga::solve
