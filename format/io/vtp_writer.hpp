// Surface fields for ParaView: one .vtp per step and a .pvd that lists them, opened by a double click on the .pvd.
// VTK's XML PolyData, appended raw data in zlib blocks.
#pragma once

#include "format/model/results.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace iga::io {

/// A named array of a .vtp file, (tuples × components), row-major; stored in single precision.
struct VtpArray {
  std::string name;
  int components = 1;
  std::span<const double> values;
};

/// A number that belongs to the whole data set, such as the frequency of a mode.
struct VtpNumber {
  std::string name;
  double value = 0;
};

/// Writes a triangle mesh with the array `region` on its triangles and the given arrays on its vertices.
/// The file appears whole or not at all. @throws InputError with the system's reason
void write_vtp(const std::filesystem::path& path, const TriangleMesh& mesh, std::span<const VtpArray> arrays,
               std::span<const VtpNumber> numbers);

/// One part of one step of a series.
struct ViewerEntry {
  double time = 0;
  int part = 0;
  std::string file; ///< relative to the index's folder
};

/// Writes or replaces the .pvd that lists the parts of all steps. The file appears whole or not at all.
void write_viewer_index(const std::filesystem::path& index, std::span<const ViewerEntry> entries);

/// Where the viewer files of a results file lie: modes.h5 → modes.pvd and modes_vtp/modes_0001.vtp …
std::filesystem::path viewer_index(const std::filesystem::path& results);

/// The folder of the steps: modes_vtp.
std::filesystem::path viewer_folder(const std::filesystem::path& results);

/// The file of one of several parts of a step (both from 0), relative to the results file's folder:
/// out_vtp/out_0001_0.vtp.
std::string viewer_part(const std::filesystem::path& results, std::size_t step, std::size_t part);
/// Removes such files of this step and later ones that an earlier run left.
void remove_viewer_parts_from(const std::filesystem::path& results, std::size_t step);

/// @throws InputError where the .pvd exists and `force` is not set
void check_viewer_target(const std::filesystem::path& results, bool force);

/// Writes the steps of results.surface, or of results.parts with one file for each body, as a time series: time is the
/// mode number (the load step, the time); the arrays have the same names in every step: displacement, von_mises, and
/// stress and strain where there are any. Modes, whose size means nothing, are scaled so that the largest displacement
/// is a twentieth of the part's box diagonal; the factor and the frequency are numbers of the data set. Earlier steps
/// that are no longer listed are removed. Several load cases have a file of their largest values beside the series:
/// static_vtp/static_envelope.vtp (static_envelope_0.vtp … of several bodies), with the numbers of the cases they
/// belong to.
/// @pre results.surface or results.parts is there
/// @throws InputError as check_viewer_target, and with the system's reason
void write_viewer_files(const std::filesystem::path& results_path, const Results& results, bool force);

} // namespace iga::io
