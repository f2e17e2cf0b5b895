#include "format/io/settings_reader.hpp"

#include "format/io/toml_letters.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <iterator>
#include <numeric>
#include <set>
#include <stdexcept>
// toml++ 3.3 asserts that a table's name follows "[" in the same line; without the assertion it refuses the file.
#define TOML_ASSERT(expression) static_assert(true)
#include <toml++/toml.h>

namespace iga::io {

struct SettingsTable::File {
  std::filesystem::path path;
  toml::table root;
  std::set<std::string> known; // full paths of keys and tables that were asked for, or may be
  bool complete = false;       // no other key may be asked for
};

struct SettingsTable::UnknownKey {
  std::string table, key;
  unsigned line = 0;
};

namespace {

std::string join(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

// "grid.degree" → "degree in [grid]"
std::string spoken(const std::string& full) {
  const auto dot = full.rfind('.');
  return dot == std::string::npos ? fmt::format("'{}'", full)
                                  : fmt::format("'{}' in [{}]", full.substr(dot + 1), full.substr(0, dot));
}

std::string found(const toml::node& node) {
  switch (node.type()) {
  case toml::node_type::table:
    return "a table";
  case toml::node_type::array:
    return fmt::format("a list of {}", node.as_array()->size());
  case toml::node_type::string:
    return fmt::format("the text \"{}\"", node.as_string()->get());
  case toml::node_type::integer:
    return fmt::format("the integer {}", node.as_integer()->get());
  case toml::node_type::floating_point:
    return fmt::format("the number {}", node.as_floating_point()->get());
  case toml::node_type::boolean:
    return node.as_boolean()->get() ? "true" : "false";
  default:
    return "a date or time";
  }
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& key, const toml::node& node,
                         const std::string& expected) {
  throw InputError(fmt::format("{}:{}: {}: found {}, expected {}", file.string(), node.source().begin.line, spoken(key),
                               found(node), expected));
}

std::string length_list(std::initializer_list<std::size_t> lengths) {
  return fmt::format("{}", fmt::join(lengths, " or "));
}

std::optional<double> finite_number(const toml::node& node) {
  std::optional<double> value;
  if (node.is_integer()) value = static_cast<double>(node.as_integer()->get());
  if (node.is_floating_point()) value = node.as_floating_point()->get();
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> whole_number(const toml::node& node) {
  return node.is_integer() ? std::optional<std::int64_t>(node.as_integer()->get()) : std::nullopt;
}

// A list of an allowed length whose entries `convert` accepts; nothing where the node is anything else.
template <class T>
std::optional<std::vector<T>> list_of(const toml::node& node, std::initializer_list<std::size_t> lengths,
                                      std::optional<T> (*convert)(const toml::node&)) {
  const auto allowed = [&](std::size_t n) { return std::find(lengths.begin(), lengths.end(), n) != lengths.end(); };
  if (!node.is_array()) {
    const auto value = convert(node);
    return value && allowed(1) ? std::optional(std::vector<T>{*value}) : std::nullopt;
  }
  const toml::array& array = *node.as_array();
  if (!allowed(array.size())) return std::nullopt;
  std::vector<T> values;
  for (const toml::node& entry : array) {
    const auto value = convert(entry);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::string value_text(const toml::node& node) {
  if (const auto* integer = node.as_integer()) {
    const auto value = static_cast<double>(integer->get()); // 4 as 4.0, as long as a double has it
    return static_cast<std::int64_t>(value) == integer->get() ? fmt::format("{}", value)
                                                              : fmt::format("{}", integer->get());
  }
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  std::vector<std::string> parts;
  if (const auto* array = node.as_array()) {
    for (const toml::node& entry : *array) parts.push_back(value_text(entry));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  if (const auto* table = node.as_table()) {
    for (const auto& [key, entry] : *table) parts.push_back(fmt::format("{} = {}", key.str(), value_text(entry)));
    return fmt::format("{{{}}}", fmt::join(parts, ", "));
  }
  return found(node);
}

void add_entries(const std::string& path, const toml::table& table, std::vector<SettingsEntry>& entries) {
  for (const auto& [key, node] : table) {
    const std::string full = join(path, key.str());
    if (const auto* inner = node.as_table()) {
      add_entries(full, *inner, entries);
    } else if (node.is_array() && node.as_array()->is_homogeneous(toml::node_type::table)) {
      std::size_t number = 0;
      for (const toml::node& entry : *node.as_array())
        add_entries(fmt::format("{}[{}]", full, ++number), *entry.as_table(), entries);
    } else {
      entries.push_back({full, value_text(node), node.source().begin.line});
    }
  }
}

/// The letters of the file in texts and keys, where stand-ins were parsed.
void put_letters_back(toml::node& node) {
  if (toml::value<std::string>* text = node.as_string()) {
    text->get() = without_stand_ins(text->get());
  } else if (toml::array* array = node.as_array()) {
    for (toml::node& entry : *array) put_letters_back(entry);
  } else if (toml::table* table = node.as_table()) {
    std::vector<toml::key> changed;
    for (auto&& [key, entry] : *table) {
      put_letters_back(entry);
      if (without_stand_ins(key.str()) != key.str()) changed.push_back(key);
    }
    for (const toml::key& key : changed) {
      table->find(key.str())->second.visit(
          [&](auto& entry) { table->insert(toml::key(without_stand_ins(key.str()), key.source()), std::move(entry)); });
      table->erase(key.str());
    }
  }
}

const toml::node* node_of(const void* table, std::string_view key) {
  return table ? static_cast<const toml::table*>(table)->get(key) : nullptr;
}

} // namespace

SettingsTable::SettingsTable(std::shared_ptr<File> file, std::string path, const void* node)
    : file_(std::move(file)), path_(std::move(path)), node_(node) {}

SettingsTable SettingsTable::read(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    throw InputError(fmt::format("{}: no such settings file", file.string()));
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno)));
  return parse({std::istreambuf_iterator<char>(in), {}}, file);
}

SettingsTable SettingsTable::parse(const std::string& text, const std::filesystem::path& file) {
  refuse_letters_outside_quotes(text, file.string());
  auto data = std::make_shared<File>();
  data->path = file;
  try {
    data->root = toml::parse(with_stand_ins(text, file.string()), file.string());
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}:{}: this is no valid TOML: {}", file.string(), error.source().begin.line,
                                 error.source().begin.column, without_stand_ins(error.description())));
  }
  put_letters_back(data->root);
  const void* root = &data->root;
  return {std::move(data), "", root};
}

SettingsTable SettingsTable::table(std::string_view key) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (node && !node->is_table()) refuse(file_->path, full, *node, fmt::format("a table, written as [{}]", full));
  return {file_, full, node ? node->as_table() : nullptr};
}

std::vector<SettingsTable> SettingsTable::tables(std::string_view key) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return {};
  if (!node->is_array() || !node->as_array()->is_homogeneous(toml::node_type::table))
    refuse(file_->path, full, *node, fmt::format("tables, each written as [[{}]]", full));
  std::vector<SettingsTable> entries;
  for (const toml::node& entry : *node->as_array()) entries.push_back(SettingsTable(file_, full, entry.as_table()));
  return entries;
}

std::string SettingsTable::where(std::string_view key) const {
  const toml::node* node = node_of(node_, key);
  if (!node && node_) node = static_cast<const toml::table*>(node_);
  const std::string place = spoken(join(path_, key));
  return node ? fmt::format("{}:{}: {}", file_->path.string(), node->source().begin.line, place)
              : fmt::format("{}: {}", file_->path.string(), place);
}

std::optional<bool> SettingsTable::boolean(std::string_view key) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  if (!node->is_boolean()) refuse(file_->path, full, *node, "true or false");
  return node->as_boolean()->get();
}

std::optional<std::string> SettingsTable::text(std::string_view key) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  if (!node->is_string()) refuse(file_->path, full, *node, "a text in quotes");
  return node->as_string()->get();
}

std::optional<std::vector<std::string>> SettingsTable::texts(std::string_view key) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  const char* expected = "a list of texts in quotes";
  if (!node->is_array()) refuse(file_->path, full, *node, expected);
  std::vector<std::string> values;
  for (const toml::node& entry : *node->as_array()) {
    if (!entry.is_string()) refuse(file_->path, full, entry, expected);
    values.push_back(entry.as_string()->get());
  }
  return values;
}

std::optional<std::filesystem::path> SettingsTable::path(std::string_view key) {
  const auto typed = text(key);
  return typed ? std::optional((file_->path.parent_path() / *typed).lexically_normal()) : std::nullopt;
}

std::optional<double> SettingsTable::number(std::string_view key) {
  const auto list = numbers(key, {1});
  return list ? std::optional(list->front()) : std::nullopt;
}

std::optional<std::int64_t> SettingsTable::integer(std::string_view key) {
  const auto list = integers(key, {1});
  return list ? std::optional(list->front()) : std::nullopt;
}

std::optional<std::vector<double>> SettingsTable::numbers(std::string_view key,
                                                          std::initializer_list<std::size_t> lengths) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  auto values = list_of<double>(*node, lengths, finite_number);
  if (!values) refuse(file_->path, full, *node, fmt::format("{} finite number(s)", length_list(lengths)));
  return values;
}

std::optional<std::vector<std::int64_t>> SettingsTable::integers(std::string_view key,
                                                                 std::initializer_list<std::size_t> lengths) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  auto values = list_of<std::int64_t>(*node, lengths, whole_number);
  if (!values) refuse(file_->path, full, *node, fmt::format("{} integer(s)", length_list(lengths)));
  return values;
}

std::optional<std::vector<double>> SettingsTable::number_list(std::string_view key) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  const char* expected = "a finite number or a list of them";
  std::vector<double> values;
  const auto add = [&](const toml::node& entry) {
    const auto value = finite_number(entry);
    if (!value) refuse(file_->path, full, entry, expected);
    values.push_back(*value);
  };
  if (!node->is_array())
    add(*node);
  else
    for (const toml::node& entry : *node->as_array()) add(entry);
  return values;
}

std::optional<std::vector<std::int64_t>> SettingsTable::integers(std::string_view key) {
  const std::string full = join(path_, key);
  file_->known.insert(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  const char* expected = "a list of whole numbers";
  if (!node->is_array()) refuse(file_->path, full, *node, expected);
  std::vector<std::int64_t> values;
  for (const toml::node& entry : *node->as_array()) {
    const auto value = whole_number(entry);
    if (!value) refuse(file_->path, full, entry, expected);
    values.push_back(*value);
  }
  return values;
}

std::optional<std::vector<std::vector<double>>> SettingsTable::rows(std::string_view key, std::size_t columns) {
  const std::string full = join(path_, key);
  take_note(full);
  const toml::node* node = node_of(node_, key);
  if (!node) return std::nullopt;
  const auto expected = fmt::format("a list of lists of {} finite numbers", columns);
  if (!node->is_array()) refuse(file_->path, full, *node, expected);
  std::vector<std::vector<double>> rows;
  for (const toml::node& entry : *node->as_array()) {
    auto row = entry.is_array() ? list_of<double>(entry, {columns}, finite_number) : std::nullopt;
    if (!row) refuse(file_->path, full, entry, expected);
    rows.push_back(std::move(*row));
  }
  return rows;
}

bool SettingsTable::holds_text(std::string_view key) const {
  const toml::node* node = node_of(node_, key);
  return node && node->is_string();
}

bool SettingsTable::holds_number(std::string_view key) const {
  const toml::node* node = node_of(node_, key);
  return node && node->is_number();
}

bool SettingsTable::holds_numbers(std::string_view key) const {
  const toml::node* node = node_of(node_, key);
  return node && node->is_array() && !node->as_array()->empty() && node->as_array()->front().is_number();
}

bool SettingsTable::holds(std::string_view key) const {
  return node_of(node_, key) != nullptr;
}

void SettingsTable::expect(std::string_view key) {
  take_note(join(path_, key));
}

std::vector<SettingsEntry> SettingsTable::entries() const {
  std::vector<SettingsEntry> entries;
  if (node_) add_entries(path_, *static_cast<const toml::table*>(node_), entries);
  return entries;
}

void SettingsTable::take_note(const std::string& full) const {
  if (file_->complete && !file_->known.contains(full))
    throw std::logic_error(
        fmt::format("{} is asked for but not listed among the keys of {}", spoken(full), file_->path.string()));
  file_->known.insert(full);
}

void SettingsTable::expect_only(const std::vector<TableKeys>& tables) {
  for (const TableKeys& table : tables) {
    for (std::size_t end = table.table.find('.'); end != std::string::npos; end = table.table.find('.', end + 1))
      take_note(table.table.substr(0, end));
    if (!table.table.empty()) take_note(table.table);
    for (const std::string& key : table.keys) take_note(join(table.table, key));
  }
  file_->complete = true;
  refuse_unknown_keys();
}

std::optional<SettingsTable::UnknownKey> SettingsTable::first_unknown_key() const {
  std::optional<UnknownKey> first;
  const auto take = [&first](std::optional<UnknownKey> other) {
    if (other && (!first || other->line < first->line)) first = std::move(other);
  };
  for (const auto& [key, node] : *static_cast<const toml::table*>(node_)) {
    const std::string full = join(path_, key.str());
    if (!file_->known.contains(full)) {
      take(UnknownKey{path_, std::string(key.str()), key.source().begin.line});
      continue;
    }
    if (node.is_table()) take(SettingsTable(file_, full, node.as_table()).first_unknown_key());
    if (node.is_array())
      for (const toml::node& entry : *node.as_array())
        if (entry.is_table()) take(SettingsTable(file_, full, entry.as_table()).first_unknown_key());
  }
  return first;
}

void SettingsTable::refuse_unknown_keys() const {
  const auto unknown = node_ ? first_unknown_key() : std::nullopt;
  if (!unknown) return;
  // The same name in another table is the likeliest slip, then a misspelt name of this table.
  std::vector<std::string> here;
  std::optional<std::string> meant;
  for (const std::string& name : file_->known) {
    const auto dot = name.rfind('.');
    const std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
    if ((dot == std::string::npos ? "" : name.substr(0, dot)) == unknown->table) here.push_back(last);
    if (last == unknown->key) meant = name;
  }
  if (!meant)
    if (const auto near = nearest_name(unknown->key, here)) meant = join(unknown->table, *near);
  const std::string advice = meant ? fmt::format("did you mean {}?", spoken(*meant))
                                   : fmt::format("known keys here: {}", fmt::join(here, ", "));
  throw InputError(fmt::format("{}:{}: unknown key {}; {}", file_->path.string(), unknown->line,
                               spoken(join(unknown->table, unknown->key)), advice));
}

std::optional<std::string> nearest_name(std::string_view word, const std::vector<std::string>& names) {
  // Levenshtein (1966), two rows.
  const auto distance = [&](std::string_view name) {
    std::vector<std::size_t> row(name.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < name.size(); ++j) {
        const std::size_t change = diagonal + (word[i] == name[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, change});
      }
    }
    return row.back();
  };
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& name : names)
    if (const std::size_t d = distance(name); d < least) {
      least = d;
      best = name;
    }
  return best;
}

} // namespace iga::io
