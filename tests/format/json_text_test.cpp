// JSON reports and the texts of a model file are valid UTF-8, whatever a name holds.
#include "format/io/json_text.hpp"
#include "format/io/utf8.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace iga::io {
namespace {

constexpr const char* replaced = "\xEF\xBF\xBD";

TEST(ValidUtf8, KeepsWellFormedText) {
  for (const char* text : {"", "part", "Gehäuse", "部品", "\U0001F600", "\u07FF\u0800\uFFFF", "\U0010FFFF"})
    EXPECT_EQ(valid_utf8(text), text);
}

TEST(ValidUtf8, ReplacesEveryOtherByte) {
  const std::string r = replaced;
  EXPECT_EQ(valid_utf8("Geh\xE4use"), "Geh" + r + "use");   // Latin-1
  EXPECT_EQ(valid_utf8("\xC3"), r);                         // cut off
  EXPECT_EQ(valid_utf8("\xE2\x82"), r + r);                 // cut off
  EXPECT_EQ(valid_utf8("\x80x"), r + "x");                  // continuation without a start
  EXPECT_EQ(valid_utf8("\xC0\xAF"), r + r);                 // overlong
  EXPECT_EQ(valid_utf8("\xE0\x80\xAF"), r + r + r);         // overlong
  EXPECT_EQ(valid_utf8("\xED\xA0\x80"), r + r + r);         // surrogate
  EXPECT_EQ(valid_utf8("\xF4\x90\x80\x80"), r + r + r + r); // above U+10FFFF
  EXPECT_EQ(valid_utf8("\xFF"
                       "\xC3\xA4"),
            r + "\xC3\xA4"); // a good sequence right after a bad byte
}

TEST(JsonText, EscapesWhatJsonForbids) {
  EXPECT_EQ(json(std::string("a\"b\\c\n\t\x01")), "\"a\\\"b\\\\c\\u000a\\u0009\\u0001\"");
  EXPECT_EQ(json(std::string("caf\xE9")), std::string("\"caf") + replaced + "\"");
  EXPECT_EQ(json(std::numeric_limits<double>::quiet_NaN()), "null");
}

} // namespace
} // namespace iga::io
