// Solids made by OpenCASCADE for the tests of CAD reading.
#pragma once

#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <string>
#include <vector>

namespace iga::test {

/// Names of all parts of one solid.
std::vector<std::string> cad_part_names();
/// Millimetres.
TopoDS_Shape make_cad_part(const std::string& name);

/// A faceless description of what write_assembly() writes.
struct Instance {
  std::string name;
  TopoDS_Shape solid;
  double shift[3] = {0, 0, 0};
  double turn_degrees = 0; ///< about z
};

/// @param unit  "MM", "M", "INCH": of the file
void write_step(const TopoDS_Shape& shape, const std::filesystem::path& file, const std::string& unit = "MM");
void write_iges(const TopoDS_Shape& shape, const std::filesystem::path& file);
void write_brep(const TopoDS_Shape& shape, const std::filesystem::path& file);
/// A STEP assembly with names; instances with equal solids share one product.
void write_assembly(const std::vector<Instance>& instances, const std::filesystem::path& file);
/// A box with named, coloured faces: "top" (red) and "bottom".
void write_named_box(const std::filesystem::path& file);

} // namespace iga::test
