#include "preprocessor/cad/cad_format.hpp"

#include "format/io/foreign_file.hpp"

#include <cctype>
#include <string>

namespace iga::prep {

std::optional<CadFormat> cad_format(std::string_view bytes, const std::filesystem::path& file) {
  if (const auto known = io::recognise_content(bytes)) {
    if (known->name == io::step_file) return CadFormat::Step;
    if (known->name == io::iges_file) return CadFormat::Iges;
    if (known->name == io::brep_file) return CadFormat::Brep;
    return std::nullopt;
  }
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending == ".step" || ending == ".stp") return CadFormat::Step;
  if (ending == ".iges" || ending == ".igs") return CadFormat::Iges;
  if (ending == ".brep" || ending == ".brp") return CadFormat::Brep;
  return std::nullopt;
}

} // namespace iga::prep
