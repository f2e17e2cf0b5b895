#include "format/io/output_ending.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <string>
#include <string_view>

namespace iga::io {

namespace {

struct Foreign {
  std::string_view endings; // each between blanks
  const char* advice;
};

constexpr std::array<Foreign, 5> foreign{
    {{" .csv .tsv .txt .dat .xls .xlsx .ods ", "; for tables, igasolve export FILE.h5 --csv"},
     {" .vtk .vtu .vtp .vtm .vti .vts .pvd .xdmf .xmf .exo .frd ",
      "; igasolve writes files for ParaView (.pvd) beside a results file by itself"},
     {" .json .yaml .yml .xml .toml .log .md ", "; for a report as JSON, add --json and send the output to a file"},
     {" .stl .obj .ply .off .step .stp .iges .igs .3mf .amf .brep .x_t .sat .msh .inp .bdf .nas .k .key .unv .med "
      ".cdb ",
      "; the surface is in the model file, in the group /surface"},
     {" .png .jpg .jpeg .svg .pdf .gif .mp4 .html .mat .npy .npz .nc .odb .rst .zip .gz .tar .7z .py ", ""}}};

} // namespace

void refuse_foreign_ending(const std::filesystem::path& output) {
  std::string ending = output.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending.empty()) return;
  for (const Foreign& kind : foreign)
    if (kind.endings.find(fmt::format(" {} ", ending)) != std::string_view::npos)
      throw InputError(fmt::format("{}: the output is an HDF5 file, which does not go by the ending {}; name it {}{}",
                                   output.string(), ending,
                                   std::filesystem::path(output).replace_extension(".h5").string(), kind.advice));
}

} // namespace iga::io
