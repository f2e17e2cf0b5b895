// Tables of numbers and words as text files: comma-separated, one header line with names and units (RFC 4180).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace iga::solve {

/// One table: columns side by side, written row by row. What the columns were made from must live until then.
class CsvTable {
 public:
  CsvTable(std::string name, std::size_t rows) : name_(std::move(name)), rows_(rows) {}

  const std::string& name() const { return name_; }
  std::size_t rows() const { return rows_; }
  const std::vector<std::string>& titles() const { return titles_; }

  /// @param cell  the text of a row's cell; quoted where commas or quotes are in it
  CsvTable& add(std::string title, std::function<std::string(std::size_t row)> cell);
  /// One column per suffix; `values` has rows() × suffixes entries, row by row. An empty array adds no column.
  /// Numbers are written so that reading them back gives the same bits.
  CsvTable& numbers(const std::string& title, const std::string& unit, std::span<const double> values,
                    const std::vector<std::string>& suffixes = {""});

  /// Writes the file whole or not at all. @throws InputError with the system's reason
  void write(const std::filesystem::path& file) const;

 private:
  std::string name_;
  std::size_t rows_;
  std::vector<std::string> titles_;
  std::vector<std::function<std::string(std::size_t)>> cells_;
};

} // namespace iga::solve
