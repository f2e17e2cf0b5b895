// TOML settings for both tools: every key is asked for by name and type, so that what nobody asked for is a typing
// error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace iga::io {

/// Keys of one table: "" is the root, "bodies.material" the table [bodies.material] (or material = {…} in [[bodies]]).
/// A table's parent need not list it.
struct TableKeys {
  std::string table;
  std::vector<std::string> keys;
};

/// One value of a settings file.
struct SettingsEntry {
  std::string path;  ///< "time.end", "bodies[2].material.E": entries of [[bodies]] count from 1
  std::string value; ///< the same text for the same value, however it was written: 4 and 4.0, spaces, order of tables
  unsigned line = 0;
};

/// One table of a settings file. The getters return nothing for an absent key.
/// All of them throw InputError "file:line: key: found this, expected that" for a value of another type, and for
/// numbers that are not finite.
class SettingsTable {
 public:
  /// The root table. @throws InputError for a file that is missing or is no TOML (with line and column)
  static SettingsTable read(const std::filesystem::path& file);
  /// The same from a text; `name` stands for the file in messages.
  static SettingsTable parse(const std::string& text, const std::filesystem::path& name);

  /// A sub-table; an absent one is empty (its keys still count as known).
  SettingsTable table(std::string_view key);
  /// A list of tables, written as [[key]] any number of times; empty where there is none. Every entry has to be asked
  /// for the same keys.
  std::vector<SettingsTable> tables(std::string_view key);
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::string> text(std::string_view key);
  /// A list of any length of texts.
  std::optional<std::vector<std::string>> texts(std::string_view key);
  /// A file's path, relative to the folder of the settings file.
  std::optional<std::filesystem::path> path(std::string_view key);
  std::optional<double> number(std::string_view key);
  std::optional<std::int64_t> integer(std::string_view key);
  /// Lists of one of the given lengths; where 1 is among them, a bare number counts as a list of one.
  std::optional<std::vector<double>> numbers(std::string_view key, std::initializer_list<std::size_t> lengths);
  std::optional<std::vector<std::int64_t>> integers(std::string_view key, std::initializer_list<std::size_t> lengths);
  /// A list of any length of numbers; a bare number counts as a list of one.
  std::optional<std::vector<double>> number_list(std::string_view key);
  /// A list of any length of whole numbers.
  std::optional<std::vector<std::int64_t>> integers(std::string_view key);
  /// A list of any length of lists of `columns` numbers: [[x, y], [x, y], …].
  std::optional<std::vector<std::vector<double>>> rows(std::string_view key, std::size_t columns);
  /// True where the key holds a string: for keys that take either a word or numbers.
  bool holds_text(std::string_view key) const;
  /// The same for a number, and for anything at all.
  bool holds_number(std::string_view key) const;
  /// True for a list that begins with a number.
  bool holds_numbers(std::string_view key) const;
  bool holds(std::string_view key) const;
  /// The key counts as known although its value is not asked for.
  void expect(std::string_view key);

  /// "file:line: 'key' in [table]": opens a message about a value of the right type that makes no sense; the line of
  /// the table where the key is absent.
  std::string where(std::string_view key) const;

  /// All values of the table and of those in it, in the alphabet's order: what two files differ in.
  std::vector<SettingsEntry> entries() const;

  /// Says, before any value is read, every key that the file may hold: a key that is not among them is refused with its
  /// line before anything else of the file is looked at. Asking for another key later is a mistake of the program.
  /// Call on the root. @throws InputError for the first unknown key, naming the line and the nearest known key
  void expect_only(const std::vector<TableKeys>& tables);
  /// Call on the root after every key was asked for. @throws InputError as expect_only
  void refuse_unknown_keys() const;

 private:
  struct File;
  struct UnknownKey;
  SettingsTable(std::shared_ptr<File> file, std::string path, const void* node);
  void take_note(const std::string& full) const;
  std::optional<UnknownKey> first_unknown_key() const;

  std::shared_ptr<File> file_;
  std::string path_;           // "" for the root, "grid" for [grid]
  const void* node_ = nullptr; // the parser's table; null where absent
};

/// The name with the smallest edit distance to `word`, or nothing where none is similar (a third of its letters
/// differ).
std::optional<std::string> nearest_name(std::string_view word, const std::vector<std::string>& names);

} // namespace iga::io
