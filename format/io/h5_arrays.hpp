// Arrays of the model and of results as datasets: what their writers and readers share.
#pragma once

#include "format/io/h5_file.hpp"
#include "format/model/types.hpp"

namespace iga::io {

/// (n) and (n × columns) arrays of numbers; the number of rows follows from the array itself.
template <class T>
void write(H5Writer& file, const DatasetText& text, const std::vector<T>& values, std::int64_t columns = 1) {
  const std::int64_t rows = static_cast<std::int64_t>(values.size()) / columns;
  file.dataset(text, columns == 1 ? Shape{rows} : Shape{rows, columns}, std::span<const T>(values));
}

template <class T>
std::vector<T> read(const H5Reader& file, const DatasetText& text, std::int64_t rows, std::int64_t columns = 1) {
  return file.dataset<T>(text.path, columns == 1 ? Shape{rows} : Shape{rows, columns});
}

inline std::int64_t rows_of(const H5Reader& file, const DatasetText& text, std::size_t rank = 1) {
  return file.shape(text.path, rank)[0];
}

/// Point3 or Triangle rows, number by number.
template <class Row> auto flat(const std::vector<Row>& rows) {
  return std::span(rows.empty() ? nullptr : rows.front().data(), 3 * rows.size());
}

template <class Row, class T> std::vector<Row> in_rows(const std::vector<T>& values) {
  std::vector<Row> rows(values.size() / 3);
  for (std::size_t i = 0; i < values.size(); ++i) rows[i / 3][i % 3] = values[i];
  return rows;
}

/// Holds the root's format and format_version against what this program reads. @throws FormatError
void expect_format(const H5Reader& file, const char* format, int major, const char* version_written);

} // namespace iga::io
