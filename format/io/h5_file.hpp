// Typed reading and writing of HDF5 files. The only place that knows the HDF5 library: it owns the handles, keeps the
// library's error stack off the terminal and turns it into messages with file, path, what was found and what was
// expected.
#pragma once

#include "format/io/replace_file.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iga::io {

/// Extents of a dataset, slowest index first.
using Shape = std::vector<std::int64_t>;

/// A dataset's place and the text attributes that every dataset carries.
struct DatasetText {
  const char* path;
  const char* unit;  ///< length, length^2, length^3, parameter, 1, s
  const char* order; ///< what the indices mean and which one runs fastest
  const char* description;
};

struct EnumName {
  const char* name;
  std::uint8_t value;
};

/// Owner of one HDF5 identifier.
class H5Id {
 public:
  using Close = int (*)(std::int64_t);
  H5Id() = default;
  H5Id(std::int64_t id, Close close) : id_(id), close_(close) {}
  H5Id(H5Id&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  H5Id& operator=(H5Id&& other) noexcept;
  ~H5Id() { reset(); }
  std::int64_t get() const { return id_; }
  void reset();
  std::int64_t release();

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

/// Element types of the file: double, int64_t, int32_t, uint8_t.
/// Every dataset is chunked and carries a Fletcher-32 checksum; above 64 KiB it is shuffled and compressed. Metadata
/// has the library's own checksums (bounds V110), so that a flipped bit is refused when the file is read.
class H5Writer {
 public:
  /// Starts a file that replaces `path` at commit().
  /// @throws InputError where the folder cannot be written
  explicit H5Writer(const std::filesystem::path& path);
  ~H5Writer();

  void group(const char* path, const char* description);
  template <class T> void dataset(const DatasetText& text, const Shape& shape, std::span<const T> values);
  void enums(const DatasetText& text, const Shape& shape, std::span<const std::uint8_t> values,
             std::span<const EnumName> names);
  /// Fixed-length UTF-8; (n) strings.
  void strings(const DatasetText& text, const std::vector<std::string>& values);
  /// (rows × columns) doubles made block by block: `fill(first, block)` sets rows first … first + block.size() /
  /// columns; called from several threads at once.
  void rows(const DatasetText& text, std::int64_t rows, std::int64_t columns,
            const std::function<void(std::int64_t first, std::span<double> block)>& fill);

  void attribute(const char* object, const char* name, const std::string& value);
  void attribute(const char* object, const char* name, const std::vector<std::string>& values);
  template <class T> void attribute(const char* object, const char* name, T value);
  template <class T>
  void attribute(const char* object, const char* name, const Shape& shape, std::span<const T> values);

  /// Closes, syncs and renames. @throws InputError (folder and reason, such as a full disk); nothing is left behind
  void commit();

 private:
  H5Id create_dataset(const DatasetText& text, std::int64_t type, std::size_t element_size, const Shape& shape);
  void write_chunks(const DatasetText& text, const H5Id& dataset, std::size_t element_size, const Shape& shape,
                    const std::function<void(std::size_t first_byte, std::span<std::byte>)>& copy);
  void write_attribute(const char* object, const char* name, std::int64_t type, const Shape* shape, const void* data);
  void write_texts(const char* object, const char* name, const std::vector<std::string>& values, bool scalar);
  [[noreturn]] void fail(std::string_view what);
  void discard_writes();

  ReplacementFile replacement_;
  H5Id file_;
};

/// All functions throw FormatError with file, path, what was found and what was expected.
class H5Reader {
 public:
  /// Who may have written the file. Other programs write models, often in the layout of HDF5 1.6 (superblock 0, what
  /// h5py makes unless told otherwise). Its object headers bear no checksum, and the library reads past its memory in
  /// some that are damaged; so what only H5Writer writes is refused in that layout before an object is opened.
  enum class Writer { Anyone, H5Writer };

  /// @throws InputError for a missing or unreadable file, FormatError for one that is no intact HDF5 file
  explicit H5Reader(const std::filesystem::path& path, Writer writer = Writer::Anyone);

  /// Is there such a group or dataset?
  bool has(const std::string& path) const;
  /// Extents of a dataset that must exist with `rank` indices.
  Shape shape(const char* path, std::size_t rank) const;
  /// All values, in the order stored; the shape must be `expected`.
  template <class T> std::vector<T> dataset(const char* path, const Shape& expected) const;
  std::vector<std::uint8_t> enums(const char* path, const Shape& expected, std::span<const EnumName> names) const;
  std::vector<std::string> strings(const char* path) const;
  /// (rows × columns) doubles handed over block by block; see H5Writer::rows.
  void rows(const char* path, std::int64_t rows, std::int64_t columns,
            const std::function<void(std::int64_t first, std::span<const double> block)>& visit) const;

  bool has_attribute(const char* object, const char* name) const;
  std::string text(const char* object, const char* name) const;
  std::vector<std::string> texts(const char* object, const char* name) const;
  template <class T> T number(const char* object, const char* name) const;
  template <class T> std::vector<T> numbers(const char* object, const char* name, const Shape& expected) const;

  /// Throws FormatError "file: path: message".
  [[noreturn]] void refuse(std::string_view path, std::string_view message) const;

 private:
  H5Id open_dataset(const char* path) const;
  H5Id open_attribute(const char* object, const char* name) const;
  void expect_shape(const char* path, const Shape& found, const Shape& expected) const;
  void expect_checksums() const;
  void expect_stored(const char* path, const H5Id& dataset) const;
  std::vector<std::string> read_texts(const std::string& path, const H5Id& object, bool is_attribute) const;
  [[noreturn]] void refuse_damaged(std::string_view path) const;

  std::string name_;
  H5Id file_;
};

} // namespace iga::io
