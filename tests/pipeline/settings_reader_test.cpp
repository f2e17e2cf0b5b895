#include "format/io/settings_reader.hpp"

#include "format/model/errors.hpp"
#include "tests/support/temp_folder.hpp"

#include <cstdint>
#include <gtest/gtest.h>
#include <stdexcept>

namespace iga::io {
namespace {

using test::TempFolder;

SettingsTable table_of(const TempFolder& folder, const std::string& text) {
  test::write_bytes(folder / "run.toml", text);
  return SettingsTable::read(folder / "run.toml");
}

// The message of the InputError that `work` throws.
template <class Work> std::string refusal(Work&& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << " is missing in: " << text;
}

TEST(SettingsReader, GivesTypedValuesAndNothingForAbsentKeys) {
  const TempFolder folder;
  auto root = table_of(folder, "title = \"a\"\n[grid]\nspans = [1, 2, 3]\nsize = 4\nflag = true\n");
  auto grid = root.table("grid");
  EXPECT_EQ(root.text("title"), "a");
  EXPECT_EQ(grid.integers("spans", {1, 3}), (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(grid.numbers("size", {1, 3}), std::vector<double>{4});
  EXPECT_EQ(grid.boolean("flag"), true);
  EXPECT_FALSE(grid.number("absent"));
  EXPECT_FALSE(root.table("none").number("absent"));
  EXPECT_NO_THROW(root.refuse_unknown_keys());
}

TEST(SettingsReader, UnknownKeyNamesItsLineAndTheNearestKey) {
  const TempFolder folder;
  auto root = table_of(folder, "title = \"a\"\n\n[grid]\ndegre = 2\n");
  root.text("title");
  root.table("grid").number("degree");
  expect_words(refusal([&] { root.refuse_unknown_keys(); }),
               {"run.toml:4", "'degre' in [grid]", "did you mean 'degree' in [grid]"});
}

TEST(SettingsReader, KeysSaidBeforehandAreCheckedBeforeAnyValue) {
  const TempFolder folder;
  const std::vector<TableKeys> keys{{"", {"title"}}, {"grid", {"degree"}}, {"grid.box", {"lower"}}};
  auto good = table_of(folder, "title = 1\n[grid]\ndegree = 2\nbox = {lower = 0}\n");
  EXPECT_NO_THROW(good.expect_only(keys));
  EXPECT_EQ(good.table("grid").integer("degree"), 2);
  EXPECT_THROW(good.number("size"), std::logic_error); // a getter that the list forgot
  auto bad = table_of(folder, "title = 1\n[grid.box]\nlower = 0\nuppr = 1\n[zzz]\n");
  expect_words(refusal([&] { bad.expect_only(keys); }), {"run.toml:4: unknown key 'uppr' in [grid.box]"});
}

TEST(SettingsReader, EntriesAreTheSameHoweverTheyAreWritten) {
  const TempFolder folder;
  const auto text_of = [&](const std::string& text) {
    std::string all;
    for (const SettingsEntry& entry : table_of(folder, text).entries()) all += entry.path + "=" + entry.value + ";";
    return all;
  };
  const std::string expected = "a[1].b=4;a[1].c.d=\"x\";a[2].b=[[0, 0.5], [1, 2]];e=true;f.g=1e-09;";
  EXPECT_EQ(text_of("e = true\n[[a]]\nb = 4\nc = {d = \"x\"}\n[[a]]\nb = [[0, 0.5], [1, 2]]\n[f]\ng = 1e-9\n"),
            expected);
  EXPECT_EQ(
      text_of("f = {g = 0.000000001}\ne=true # so\n[[a]]\nb = 4.0\n[a.c]\nd = 'x'\n[[a]]\nb=[[0.0,0.5],[1,2.0]]\n"),
      expected);
}

TEST(SettingsReader, KeyInTheWrongTableIsSentToTheRightOne) {
  const TempFolder folder;
  auto root = table_of(folder, "degree = 2\n");
  root.table("grid").number("degree");
  expect_words(refusal([&] { root.refuse_unknown_keys(); }),
               {"run.toml:1", "'degree'", "did you mean 'degree' in [grid]"});
}

TEST(SettingsReader, UnknownTableIsRefused) {
  const TempFolder folder;
  auto root = table_of(folder, "[gird]\ndegree = 2\n");
  root.table("grid").number("degree");
  expect_words(refusal([&] { root.refuse_unknown_keys(); }), {"run.toml:1", "'gird'", "did you mean 'grid'"});
}

TEST(SettingsReader, WordsUnlikeAllKeysListTheKnownOnes) {
  const TempFolder folder;
  auto root = table_of(folder, "colour = 2\n");
  root.number("scale");
  expect_words(refusal([&] { root.refuse_unknown_keys(); }), {"'colour'", "known keys here: scale"});
}

TEST(SettingsReader, WrongTypeNamesLineFoundAndExpected) {
  const TempFolder folder;
  auto root = table_of(folder, "a = \"two\"\nb = 1.5\nc = [1, 2]\nd = nan\ne = 1\n");
  expect_words(refusal([&] { root.number("a"); }), {"run.toml:1", "'a'", "the text \"two\"", "finite number"});
  expect_words(refusal([&] { root.integer("b"); }), {"run.toml:2", "the number 1.5", "integer"});
  expect_words(refusal([&] { root.numbers("c", {1, 3}); }), {"run.toml:3", "a list of 2", "1 or 3"});
  expect_words(refusal([&] { root.number("d"); }), {"run.toml:4", "finite"});
  expect_words(refusal([&] { root.boolean("e"); }), {"run.toml:5", "the integer 1", "true or false"});
  expect_words(refusal([&] { root.table("e"); }), {"run.toml:5", "[e]"});
}

TEST(SettingsReader, BadTomlNamesLineAndColumn) {
  const TempFolder folder;
  expect_words(refusal([&] { table_of(folder, "a = 1\nb = = 2\n"); }), {"run.toml:2:", "no valid TOML"});
  expect_words(refusal([&] { SettingsTable::read(folder / "absent.toml"); }), {"absent.toml", "no such"});
}

TEST(SettingsReader, LettersBeyondAsciiBelongInQuotesAndComments) {
  const TempFolder folder;
  auto root = table_of(folder, "\xEF\xBB\xBF# 2 \xC3\x97 3\na = \"\xC3\xB6 \\\" \xC3\xA4\" # \xC2\xA0\nb = '\xC3\xB6'\n"
                               "c = \"\"\"\xC3\xB6\n\xC3\xA4\"\"\"\"\"\nd = '''\n\xC3\xB6'''\n\"\xC3\xA9\" = 'e'\n");
  EXPECT_EQ(root.text("a"), "\xC3\xB6 \" \xC3\xA4");
  EXPECT_EQ(root.text("b"), "\xC3\xB6");
  EXPECT_EQ(root.text("c"), "\xC3\xB6\n\xC3\xA4\"\"");
  EXPECT_EQ(root.text("d"), "\xC3\xB6");
  expect_words(refusal([&] { table_of(folder, "a = 1\nb\xC3\x97 = 2\n"); }),
               {"run.toml:2:2: ", "\"\xC3\x97\"", "quotes"});
  expect_words(refusal([&] {
                 table_of(folder, "a = \"open\nb = \xC2\xA0"
                                  "2\n");
               }),
               {"run.toml:2:5: "});
}

// toml++ 3.3 has undefined behaviour where it asks whether one of these is a space: letters of all ranges of its table,
// and beside them.
TEST(SettingsReader, EveryLetterInQuotesIsRead) {
  const TempFolder folder;
  std::string toml, texts, key;
  for (const std::uint32_t code :
       {0x80U,   0xA0U,   0xA1U,   0x499U,  0x49AU,  0x1680U, 0x2028U, 0x202FU, 0x2C5DU, 0x2C5EU,
        0x2FFFU, 0x3000U, 0x3001U, 0x3057U, 0x3058U, 0xFB25U, 0xFB26U, 0xFEFEU, 0xFEFFU, 0xFFFFU}) {
    const auto add = [&](std::uint32_t byte) { texts.push_back(static_cast<char>(byte)); };
    if (code >= 0x800) add(0xE0U | code >> 12U);
    add(code >= 0x800 ? 0x80U | (code >> 6U & 0x3FU) : 0xC0U | code >> 6U);
    add(0x80U | (code & 0x3FU));
  }
  texts += "\xF0\x9F\x94\xA7"; // a letter beyond U+FFFF
  auto root = table_of(folder, "a = \"" + texts + "\"\nb = '" + texts + "'\nc = [['" + texts + "']]\nd = \"\"\"\\\n" +
                                   texts + "\"\"\"\n[[e]]\n" + "'" + texts + "' = 1\n");
  EXPECT_EQ(root.text("a"), texts);
  EXPECT_EQ(root.text("b"), texts);
  EXPECT_EQ(root.text("d"), texts);
  EXPECT_EQ(root.tables("e").at(0).integer(texts), 1);
  EXPECT_NE(refusal([&] { root.number("a"); }).find(texts), std::string::npos);
  EXPECT_NE(refusal([&] { root.number("c"); }).find("run.toml:3"), std::string::npos);
}

// What looks like quotes after damage lies in no quotes for the parser.
TEST(SettingsReader, LettersInDamagedQuotesAreRefused) {
  const TempFolder folder;
  for (const std::string letter : {"\xC3\xA4", "\xE3\x80\x81", "\xEF\xBB\x85"})
    for (const std::string before :
         {"a = [0X.v='", "a = 3n.b='", "a = [1 = '", "a = 'b''", "a = \"\"\"\\", "= '", "a = {= '"})
      expect_words(refusal([&] { table_of(folder, "# 1\n" + before + letter + "t' ,"); }),
                   {"run.toml:2:", "no valid TOML"});
  // Stand-ins are not told apart from letters that the file holds itself.
  for (const std::string letter : {"\xF3\xB0\x83\xA4", "\\U000F00E4", "\\U000f00e4"})
    expect_words(refusal([&] { table_of(folder, "# 1\na = \"" + letter + "\"\n"); }),
                 {"run.toml:2:6: ", "private-use"});
}

TEST(NearestName, FindsSmallSlipsOnly) {
  const std::vector<std::string> names{"degree", "span_size", "spans"};
  EXPECT_EQ(nearest_name("dgree", names), "degree");
  EXPECT_EQ(nearest_name("spansize", names), "span_size");
  EXPECT_EQ(nearest_name("span", names), "spans");
  EXPECT_FALSE(nearest_name("colour", names));
}

} // namespace
} // namespace iga::io
