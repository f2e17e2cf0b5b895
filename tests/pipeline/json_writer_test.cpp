#include "format/io/json_writer.hpp"

#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace iga::io {
namespace {

TEST(JsonWriter, WritesMembersInOrderWithNestedObjects) {
  JsonWriter inner;
  inner.member("a", 1);
  JsonWriter json;
  json.member("text", "x");
  json.member("flag", true);
  json.member("list", std::vector<std::string>{"p", "q"});
  json.member("numbers", std::array<double, 2>{0.5, 2});
  json.member("object", inner);
  json.member("none", JsonWriter());
  EXPECT_EQ(json.text(),
            R"({"text": "x", "flag": true, "list": ["p", "q"], "numbers": [0.5, 2], "object": {"a": 1}, "none": {}})");
}

TEST(JsonWriter, EscapesWhatJsonForbids) {
  EXPECT_EQ(json_string("a\"b\\c\n\t\x01"), R"("a\"b\\c\u000a\u0009\u0001")");
  EXPECT_EQ(json_string("µm → 3"), "\"µm → 3\"");
}

TEST(JsonWriter, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(json_string("a\xFF"), "\"a\xEF\xBF\xBD\"");
  EXPECT_EQ(json_string("\xC3"), "\"\xEF\xBF\xBD\"");
  EXPECT_EQ(json_string("\xC0\xAF"), "\"\xEF\xBF\xBD\xEF\xBF\xBD\"");
  EXPECT_EQ(json_string("\xED\xA0\x80").find("\xED"), std::string::npos);
}

TEST(JsonWriter, NumbersKeepTheirBitsAndInfinityIsNull) {
  JsonWriter json;
  json.member("x", 0.1 + 0.2);
  json.member("inf", std::numeric_limits<double>::infinity());
  json.member("nan", std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(json.text(), R"({"x": 0.30000000000000004, "inf": null, "nan": null})");
}

} // namespace
} // namespace iga::io
