// A number over time or frequency from a run file: one number, rows [[x, y], …], or a text file with two columns.
#pragma once

#include "format/io/settings_reader.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace iga::solve {

/// Two columns of a text file, separated by comma, semicolon or blanks; a first line without numbers, empty lines and
/// lines that open with # are passed over.
struct TwoColumns {
  std::vector<double> x, y;
};
/// @throws InputError naming file and line
TwoColumns read_two_columns(const std::filesystem::path& file);

/// Points with strictly ascending x. One point is a constant, good for all x.
struct NumberCurve {
  std::vector<double> x, y;
  std::string where; ///< opens messages about it
  bool operator==(const NumberCurve&) const = default;

  bool is_constant() const { return x.size() == 1; }
  /// Straight lines between the points; the end values go on.
  double linear(double at) const;
  /// Straight lines of log y over log x, 0 outside; y = 0 at an end of a piece makes the piece 0. A constant is itself
  /// everywhere. @pre x > 0, y >= 0
  double log_log(double at) const;
};

/// Nothing where the key is absent.
/// @throws InputError with file and line for rows that do not ascend, and what the file's reader finds
std::optional<NumberCurve> read_number_curve(io::SettingsTable& table, const char* key);

} // namespace iga::solve
