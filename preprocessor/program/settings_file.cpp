// prep.toml → TypedSettings.
#include "format/io/settings_reader.hpp"
#include "preprocessor/program/settings_table.hpp"

namespace iga::prep {

namespace {

using io::SettingsTable;

void read(SettingsTable& table, const Setting<std::filesystem::path>& s, std::optional<std::filesystem::path>& value) {
  value = table.path(s.key);
}
void read(SettingsTable& table, const Setting<std::string>& s, std::optional<std::string>& value) {
  value = table.text(s.key);
}
void read(SettingsTable& table, const Setting<bool>& s, std::optional<bool>& value) {
  value = table.boolean(s.key);
}
void read(SettingsTable& table, const Setting<double>& s, std::optional<double>& value) {
  value = table.number(s.key);
}
void read(SettingsTable& table, const Setting<std::int64_t>& s, std::optional<std::int64_t>& value) {
  value = table.integer(s.key);
}
void read(SettingsTable& table, const Setting<Numbers>& s, std::optional<Numbers>& value) {
  const std::size_t n = s.length.count;
  value = s.length.or_one ? table.numbers(s.key, {1, n}) : table.numbers(s.key, {n});
}
std::optional<Integers> integers(SettingsTable& table, const char* key, const ListLength& length) {
  return length.or_one ? table.integers(key, {1, length.count}) : table.integers(key, {length.count});
}
void read(SettingsTable& table, const Setting<Integers>& s, std::optional<Integers>& value) {
  value = integers(table, s.key, s.length);
}
void read(SettingsTable& table, const Setting<WordOrIntegers>& s, std::optional<WordOrIntegers>& value) {
  if (table.holds_text(s.key))
    value = *table.text(s.key);
  else if (const auto numbers = integers(table, s.key, s.length))
    value = *numbers;
}

} // namespace

TypedSettings read_settings_file(const std::filesystem::path& file) {
  SettingsTable root = SettingsTable::read(file);
  TypedSettings typed;
  each_setting([&](const auto& setting) {
    SettingsTable table = *setting.table == 0 ? root : root.table(setting.table);
    read(table, setting, typed.*setting.member);
  });
  root.refuse_unknown_keys();
  return typed;
}

} // namespace iga::prep
