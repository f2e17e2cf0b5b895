#include "preprocessor/cad/cad_format.hpp"

#include <cctype>
#include <string>

namespace iga::prep {

namespace {

// The section letter in column 73 of an 80-column record.
bool looks_like_iges(std::string_view bytes) {
  const std::string_view line = bytes.substr(0, bytes.find('\n'));
  return line.size() >= 80 && line[72] == 'S' && line.find_first_not_of(" 0123456789\r", 73) == std::string_view::npos;
}

} // namespace

std::optional<CadFormat> cad_format(std::string_view bytes, const std::filesystem::path& file) {
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const std::string_view text = begin == std::string_view::npos ? std::string_view{} : bytes.substr(begin);
  if (text.starts_with("ISO-10303-21")) return CadFormat::Step;
  if (text.starts_with("DBRep_DrawableShape") || text.starts_with("CASCADE Topology")) return CadFormat::Brep;
  if (looks_like_iges(bytes)) return CadFormat::Iges;
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending == ".step" || ending == ".stp") return CadFormat::Step;
  if (ending == ".iges" || ending == ".igs") return CadFormat::Iges;
  if (ending == ".brep" || ending == ".brp") return CadFormat::Brep;
  return std::nullopt;
}

} // namespace iga::prep
