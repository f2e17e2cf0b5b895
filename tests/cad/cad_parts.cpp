#include "tests/cad/cad_parts.hpp"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepLib.hxx>
#include <BRepOffsetAPI_MakePipeShell.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <GC_MakeCircle.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <functional>
#include <gp_Ax2.hxx>
#include <gp_Ax3.hxx>
#include <map>
#include <stdexcept>

namespace iga::test {

namespace {

gp_Ax2 along_z(double x, double y, double z) {
  return {gp_Pnt(x, y, z), gp::DZ()};
}

TopoDS_Wire circle(double radius, double z) {
  return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(along_z(0, 0, z), radius)).Edge()).Wire();
}

TopoDS_Wire square(double half, double z) {
  BRepBuilderAPI_MakePolygon polygon;
  for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
    polygon.Add(gp_Pnt(half * x, half * y, z));
  polygon.Close();
  return polygon.Wire();
}

TopoDS_Shape filleted_box() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(30, 20, 10).Shape();
  BRepFilletAPI_MakeFillet fillet(box);
  for (TopExp_Explorer it(box, TopAbs_EDGE); it.More(); it.Next()) fillet.Add(2, TopoDS::Edge(it.Current()));
  return fillet.Shape();
}

// A block with two bores that meet at a right angle.
TopoDS_Shape crossing_bores() {
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(gp_Pnt(-15, -10, -10), 30, 20, 20).Shape();
  const TopoDS_Shape first = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-20, 0, 0), gp::DX()), 5, 40).Shape();
  const TopoDS_Shape second = BRepPrimAPI_MakeCylinder(along_z(0, 1, -20), 3, 40).Shape();
  return BRepAlgoAPI_Cut(BRepAlgoAPI_Cut(block, first).Shape(), second).Shape();
}

// A rod around which a triangular ridge winds three times.
TopoDS_Shape thread() {
  const double radius = 5, pitch = 2, turns = 3;
  const Handle(Geom_CylindricalSurface) cylinder = new Geom_CylindricalSurface(gp_Ax3(gp::XOY()), radius);
  const Handle(Geom2d_Line) line = new Geom2d_Line(gp_Pnt2d(0, 0), gp_Dir2d(2 * M_PI, pitch));
  const double length = turns * std::hypot(2 * M_PI, pitch);
  const TopoDS_Edge helix = BRepBuilderAPI_MakeEdge(line, cylinder, 0, length).Edge();
  BRepLib::BuildCurve3d(helix);
  BRepBuilderAPI_MakePolygon profile(gp_Pnt(radius - 0.2, 0, -0.6), gp_Pnt(radius + 0.8, 0, 0),
                                     gp_Pnt(radius - 0.2, 0, 0.6), true);
  BRepOffsetAPI_MakePipeShell pipe(BRepBuilderAPI_MakeWire(helix).Wire());
  pipe.SetMode(gp_Dir(0, 0, 1));
  pipe.Add(profile.Wire());
  pipe.Build();
  pipe.MakeSolid();
  const TopoDS_Shape rod = BRepPrimAPI_MakeCylinder(along_z(0, 0, -3), radius, 12).Shape();
  return BRepAlgoAPI_Fuse(rod, pipe.Shape()).Shape();
}

TopoDS_Shape loft() {
  BRepOffsetAPI_ThruSections sections(true);
  sections.AddWire(square(10, 0));
  sections.AddWire(circle(7, 10));
  sections.AddWire(circle(4, 25));
  sections.Build();
  return sections.Shape();
}

// A bent sheet, half a millimetre thick.
TopoDS_Shape bent_sheet() {
  const TopoDS_Shape outer = BRepPrimAPI_MakeCylinder(along_z(0, 0, 0), 20.5, 30, M_PI / 2).Shape();
  const TopoDS_Shape inner = BRepPrimAPI_MakeCylinder(along_z(0, 0, -1), 20, 32).Shape();
  return BRepAlgoAPI_Cut(outer, inner).Shape();
}

// A chamfer of two hundredths of a millimetre on a block of forty.
TopoDS_Shape tiny_faces() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(40, 30, 20).Shape();
  BRepFilletAPI_MakeChamfer chamfer(box);
  for (TopExp_Explorer it(box, TopAbs_EDGE); it.More(); it.Next()) chamfer.Add(0.02, TopoDS::Edge(it.Current()));
  return chamfer.Shape();
}

TopoDS_Shape hollow_sphere() {
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(10).Shape(), BRepPrimAPI_MakeSphere(6).Shape()).Shape();
}

// Mirrored and made half as large.
TopoDS_Shape mirrored_scaled() {
  gp_Trsf mirror, scale;
  mirror.SetMirror(gp_Ax2(gp_Pnt(5, 0, 0), gp::DX()));
  scale.SetScale(gp_Pnt(0, 0, 0), 0.5);
  return BRepBuilderAPI_Transform(crossing_bores(), scale * mirror, true).Shape();
}

// A plate with thirty holes and rounded corners.
TopoDS_Shape perforated_plate() {
  TopoDS_Shape plate = BRepPrimAPI_MakeBox(60, 50, 3).Shape();
  TopTools_ListOfShape plates, holes;
  plates.Append(plate);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 5; ++j)
      holes.Append(BRepPrimAPI_MakeCylinder(along_z(5 + 10 * i, 5 + 10 * j, -1), 3, 5).Shape());
  BRepAlgoAPI_Cut cut;
  cut.SetArguments(plates);
  cut.SetTools(holes);
  cut.Build();
  return cut.Shape();
}

const std::map<std::string, std::function<TopoDS_Shape()>>& makers() {
  static const std::map<std::string, std::function<TopoDS_Shape()>> all{
      {"bent_sheet", bent_sheet},
      {"box", [] { return BRepPrimAPI_MakeBox(30, 20, 10).Shape(); }},
      {"cone", [] { return BRepPrimAPI_MakeCone(10, 4, 15).Shape(); }},
      {"pointed_cone", [] { return BRepPrimAPI_MakeCone(10, 0, 15).Shape(); }},
      {"crossing_bores", crossing_bores},
      {"filleted_box", filleted_box},
      {"hollow_sphere", hollow_sphere},
      {"loft", loft},
      {"mirrored_scaled", mirrored_scaled},
      {"perforated_plate", perforated_plate},
      {"thread", thread},
      {"tiny_faces", tiny_faces},
      {"torus", [] { return BRepPrimAPI_MakeTorus(10, 4).Shape(); }}};
  return all;
}

void quiet() {
  Message::DefaultMessenger()->ChangePrinters().Clear();
}

void expect(bool fine, const std::filesystem::path& file) {
  if (!fine) throw std::runtime_error("OpenCASCADE cannot write " + file.string());
}

Handle(TDocStd_Document) new_document() {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  return document;
}

void write_document(const Handle(TDocStd_Document) & document, const std::filesystem::path& file) {
  quiet();
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", "MM");
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  STEPCAFControl_Writer writer;
  expect(writer.Transfer(document, STEPControl_AsIs), file);
  expect(writer.Write(file.c_str()) == IFSelect_RetDone, file);
}

} // namespace

std::vector<std::string> cad_part_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : makers()) names.push_back(name);
  return names;
}

TopoDS_Shape make_cad_part(const std::string& name) {
  return makers().at(name)();
}

void write_step(const TopoDS_Shape& shape, const std::filesystem::path& file, const std::string& unit) {
  quiet();
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", unit.c_str()); // a writer takes it when it is made
  STEPControl_Writer writer;
  expect(writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone, file);
  expect(writer.Write(file.c_str()) == IFSelect_RetDone, file);
}

void write_iges(const TopoDS_Shape& shape, const std::filesystem::path& file) {
  quiet();
  IGESControl_Writer writer("MM", 1); // 1: solids
  expect(writer.AddShape(shape), file);
  writer.ComputeModel();
  expect(writer.Write(file.c_str()), file);
}

void write_brep(const TopoDS_Shape& shape, const std::filesystem::path& file) {
  expect(BRepTools::Write(shape, file.c_str()), file);
}

void write_assembly(const std::vector<Instance>& instances, const std::filesystem::path& file) {
  const Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label assembly = shapes->NewShape();
  TDataStd_Name::Set(assembly, "assembly");
  for (const Instance& instance : instances) {
    TDF_Label product;
    if (!shapes->FindShape(instance.solid, product)) {
      product = shapes->AddShape(instance.solid, false);
      TDataStd_Name::Set(product, instance.name.c_str());
    }
    gp_Trsf turn, shift;
    turn.SetRotation(gp::OZ(), instance.turn_degrees * M_PI / 180);
    shift.SetTranslation(gp_Vec(instance.shift[0], instance.shift[1], instance.shift[2]));
    const TDF_Label component = shapes->AddComponent(assembly, product, TopLoc_Location(shift * turn));
    TDataStd_Name::Set(component, instance.name.c_str());
  }
  shapes->UpdateAssemblies();
  write_document(document, file);
}

void write_named_box(const std::filesystem::path& file) {
  const Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  BRepPrimAPI_MakeBox box(30, 20, 10);
  const TDF_Label label = shapes->AddShape(box.Solid(), false);
  TDataStd_Name::Set(label, "named box");
  const TDF_Label top = shapes->AddSubShape(label, box.TopFace()),
                  bottom = shapes->AddSubShape(label, box.BottomFace());
  TDataStd_Name::Set(top, "top");
  TDataStd_Name::Set(bottom, "bottom");
  colours->SetColor(top, Quantity_Color(1, 0, 0, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  write_document(document, file);
}

} // namespace iga::test
