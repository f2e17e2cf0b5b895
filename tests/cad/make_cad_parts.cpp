// make_cad_parts FOLDER: STEP files for the tests of igaprep.
#include "tests/cad/cad_parts.hpp"

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>

int main(int argc, char** argv) {
  using namespace iga::test;
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  for (const std::string& name : cad_part_names()) write_step(make_cad_part(name), folder / (name + ".step"));
  write_named_box(folder / "named_box.step");
  write_step(make_cad_part("filleted_box"), folder / "inches.step", "INCH");
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(30, 20, 4).Shape(), bolt = BRepPrimAPI_MakeCylinder(2, 10).Shape();
  write_assembly({{"plate", plate}, {"bolt left", bolt, {5, 10, 4}}, {"bolt right", bolt, {25, 10, 4}, 30}},
                 folder / "assembly.step");
  write_assembly({{"plate", plate}, {"bolt", bolt, {5, 10, 3}}}, folder / "overlap.step");
}
