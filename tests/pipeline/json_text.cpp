#include "tests/pipeline/json_text.hpp"

#include <regex>
#include <stdexcept>

namespace iga::test {

namespace {

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  std::map<std::string, std::string> object() {
    value("");
    space();
    if (at_ != text_.size()) fail("text after the object");
    return std::move(leaves_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("JSON at character " + std::to_string(at_) + ": " + what);
  }
  void space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t' || text_[at_] == '\r'))
      ++at_;
  }
  bool take(char c) {
    space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string string() {
    if (!take('"')) fail("a string should start here");
    std::string out;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) fail("control character in a string");
      if (text_[at_] == '\\') {
        ++at_;
        if (at_ >= text_.size()) break;
        const char c = text_[at_++];
        if (c == 'u') {
          if (!std::regex_match(text_.substr(at_, 4), std::regex("[0-9a-fA-F]{4}"))) fail("bad \\u escape");
          out += static_cast<char>(std::stoi(text_.substr(at_, 4), nullptr, 16));
          at_ += 4;
        } else if (std::string("\"\\/bfnrt").find(c) != std::string::npos) {
          out += c;
        } else {
          fail("unknown escape");
        }
      } else {
        out += text_[at_++];
      }
    }
    if (!take('"')) fail("string without an end");
    return out;
  }
  void scalar(const std::string& path) {
    static const std::regex allowed("true|false|null|-?(0|[1-9][0-9]*)(\\.[0-9]+)?([eE][+-]?[0-9]+)?");
    const std::size_t end = text_.find_first_of(",]} \n\t\r", at_);
    const std::string word = text_.substr(at_, end == std::string::npos ? end : end - at_);
    if (!std::regex_match(word, allowed)) fail("no value: " + word);
    at_ += word.size();
    leaves_[path] = word;
  }
  void value(const std::string& path) {
    space();
    if (at_ >= text_.size()) fail("a value should stand here");
    const std::string prefix = path.empty() ? "" : path + ".";
    const char first = text_[at_];
    if (first == '"') {
      leaves_[path] = string();
    } else if (first == '{' || first == '[') {
      ++at_;
      const char last = first == '{' ? '}' : ']';
      int count = 0;
      if (!take(last)) {
        do {
          std::string key = std::to_string(count);
          if (first == '{') {
            space();
            key = string();
            if (!take(':')) fail("a colon should stand here");
          }
          value(prefix + key);
          ++count;
        } while (take(','));
        if (!take(last)) fail("list or object without an end");
      }
      leaves_[prefix + "#"] = std::to_string(count);
    } else {
      scalar(path);
    }
  }

  const std::string& text_;
  std::size_t at_ = 0;
  std::map<std::string, std::string> leaves_;
};

} // namespace

std::map<std::string, std::string> parse_json(const std::string& text) {
  return Reader(text).object();
}

} // namespace iga::test
