#include "preprocessor/cad/occt/load_shapes.hpp"

#include "format/io/file_bytes.hpp"
#include "format/io/sha256.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/cad/cad_format.hpp"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRepTools.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Shape.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::prep {

namespace {

constexpr std::array<std::pair<const char*, double>, 6> units{
    {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"um", 1e-3}, {"in", 25.4}, {"ft", 304.8}}};

// Keeps what OpenCASCADE says of errors instead of printing it.
class Listener : public Message_Printer {
 public:
  mutable std::vector<std::string> errors; // OpenCASCADE's printers are constant

 protected:
  void send(const TCollection_AsciiString& text, const Message_Gravity gravity) const override {
    if (gravity < Message_Fail) return;
    std::string line = text.ToCString();
    std::replace(line.begin(), line.end(), '\n', ' ');
    while (!line.empty() && (line.back() == ' ' || line.back() == '*')) line.pop_back();
    while (!line.empty() && (line.front() == ' ' || line.front() == '*')) line.erase(0, 1);
    errors.push_back(line);
  }
};

std::string first_of(const Listener& listener) {
  return listener.errors.empty() ? "" : fmt::format(" (OpenCASCADE: {})", listener.errors.front());
}

std::string text_of(const TCollection_ExtendedString& text) {
  return TCollection_AsciiString(text).ToCString(); // UTF-8
}

// Some CAD programs write NONE or blanks for no name.
std::string useful(std::string name) {
  while (!name.empty() && std::isspace(static_cast<unsigned char>(name.back()))) name.pop_back();
  while (!name.empty() && std::isspace(static_cast<unsigned char>(name.front()))) name.erase(0, 1);
  return name == "NONE" || name == "none" || name == "None" ? "" : name;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? useful(text_of(name->Get())) : "";
}

std::string text_of(const Quantity_Color& colour) {
  return TCollection_AsciiString(Quantity_Color::ColorToHex(colour)).ToCString();
}

TopoDS_Shape without_location(const TopoDS_Shape& shape) {
  return shape.Located(TopLoc_Location());
}

// Of a shape or of a label.
std::string colour_of(const Handle(XCAFDoc_ColorTool) & colours, const auto& coloured) {
  Quantity_Color colour;
  for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
    if (colours->GetColor(coloured, type, colour)) return text_of(colour);
  return "";
}

// Shapes of a kind that belong to no shape of a kind above.
TopTools_IndexedMapOfShape loose(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind, TopAbs_ShapeEnum above) {
  TopTools_IndexedMapOfShape found;
  for (TopExp_Explorer it(shape, kind, above); it.More(); it.Next()) found.Add(it.Current());
  return found;
}

double diagonal_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

// Collects the solids of all shapes of a file.
class Loader {
 public:
  Loader(const std::filesystem::path& file, double sew) : file_(file.string()), sew_(sew) {}

  LoadedCad run(CadFormat format) {
    const Handle(Message_Messenger)& messenger = Message::DefaultMessenger();
    messenger->ChangePrinters().Clear();
    messenger->AddPrinter(listener_);
    if (format == CadFormat::Step)
      read_step();
    else if (format == CadFormat::Iges)
      read_iges();
    else
      read_brep();
    settle_open_faces();
    number_names();
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const std::string& text) const { throw InputError(fmt::format("{}: {}", file_, text)); }

  // Faces of no solid, wherever they stand in the file: joined to solids where that is asked for, else refused, or left
  // out where there are solids beside them.
  void settle_open_faces() {
    if (open_faces_ > 0 && sew_ > 0) {
      const std::vector<TopoDS_Shape> sewn = sew();
      for (std::size_t k = 0; k < sewn.size(); ++k)
        add_solid(sewn[k], sewn.size() > 1 ? fmt::format("sewn {}", k + 1) : "sewn", "", "", gp_Trsf());
    } else if (open_faces_ > 0 && out_.solids.empty()) {
      refuse(fmt::format(
          "the {} file holds {} faces and no solid: surfaces alone enclose nothing. Export the part again "
          "as a solid, or join the faces: --sew LENGTH closes gaps up to that length, {:.2g} (in the file's "
          "unit) is a first try",
          out_.format, open_faces_, 1e-5 * diagonal_of(open_) / out_.millimetres));
    } else if (open_faces_ > 0) {
      out_.warnings.push_back(fmt::format(
          "{} faces of the file belong to no solid and are left out; --sew LENGTH joins them", open_faces_));
    }
    if (out_.solids.empty())
      refuse(fmt::format("{} file without any solid; export the part again as a solid", out_.format));
  }

  static Handle(TDocStd_Document) new_document() {
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    return document;
  }

  void set_unit(double millimetres) {
    out_.millimetres = millimetres;
    out_.file_unit = unit_of_millimetres(millimetres);
  }

  void read_step() {
    out_.format = "STEP";
    STEPCAFControl_Reader reader;
    reader.SetNameMode(true);
    reader.SetColorMode(true);
    if (reader.ReadFile(file_.c_str()) != IFSelect_RetDone)
      refuse(fmt::format("the STEP file cannot be read{}; export the part again", first_of(*listener_)));
    take_step_unit(reader.ChangeReader());
    Handle(TDocStd_Document) document = new_document();
    if (reader.NbRootsForTransfer() == 0 || !reader.Transfer(document))
      refuse(fmt::format("the STEP file holds no shape{}", first_of(*listener_)));
    const Handle(XSControl_WorkSession) session = reader.Reader().WS();
    judge_step_faces(session);
    names_from_ = session->TransferReader();
    visit_document(document);
  }

  void take_step_unit(STEPControl_Reader& reader) {
    TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
    reader.FileUnits(lengths, angles, solid_angles);
    std::set<std::string> names;
    for (int i = 1; i <= lengths.Length(); ++i) names.insert(lengths(i).ToCString());
    if (names.empty()) {
      out_.warnings.push_back("the STEP file names no length unit: millimetres are taken");
      return set_unit(1);
    }
    if (names.size() > 1) {
      out_.findings.push_back(
          fmt::format("lengths in several units ({}), all converted to mm", fmt::join(names, ", ")));
      return set_unit(1);
    }
    static const std::map<std::string, double> known{{"millimetre", 1},    {"millimeter", 1},  {"metre", 1000},
                                                     {"meter", 1000},      {"centimetre", 10}, {"centimeter", 10},
                                                     {"micrometre", 1e-3}, {"inch", 25.4},     {"in", 25.4},
                                                     {"foot", 304.8},      {"ft", 304.8}};
    std::string name = *names.begin();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto found = known.find(name);
    if (found != known.end()) return set_unit(found->second);
    out_.findings.push_back(fmt::format("the file's length unit \"{}\" was converted to mm", *names.begin()));
    set_unit(1);
  }

  // A face that OpenCASCADE cannot make is left out without a word: it would be a hole.
  void judge_step_faces(const Handle(XSControl_WorkSession) & session) const {
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(session->Model());
    const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
    int faces = 0, missing = 0, first = 0;
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(Standard_Transient) entity = model->Value(i);
      if (!entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) continue;
      ++faces;
      if (!process->IsBound(entity) || TransferBRep::ShapeResult(process, entity).IsNull()) {
        if (missing++ == 0) first = model->IdentLabel(entity);
      }
    }
    if (missing > 0 && missing < faces)
      refuse(
          fmt::format("{} of {} faces of the STEP file cannot be read (the first is #{}){}; export the part again, in "
                      "AP214 or AP242",
                      missing, faces, first, first_of(*listener_)));
  }

  void read_iges() {
    out_.format = "IGES";
    IGESCAFControl_Reader reader;
    reader.SetNameMode(true);
    reader.SetColorMode(true);
    if (reader.ReadFile(file_.c_str()) != IFSelect_RetDone)
      refuse(fmt::format("the IGES file cannot be read{}; export the part again", first_of(*listener_)));
    const double millimetres = reader.IGESModel()->GlobalSection().UnitValue();
    set_unit(unit_of_millimetres(millimetres).empty() ? 1 : millimetres);
    Handle(TDocStd_Document) document = new_document();
    if (!reader.Transfer(document)) refuse(fmt::format("the IGES file holds no shape{}", first_of(*listener_)));
    visit_document(document);
  }

  void read_brep() {
    out_.format = "BREP";
    out_.file_unit = "unspecified";
    TopoDS_Shape shape;
    BRep_Builder builder;
    if (!BRepTools::Read(shape, file_.c_str(), builder) || shape.IsNull())
      refuse(fmt::format("the BREP file cannot be read{}; write it again", first_of(*listener_)));
    add_solids(shape.Located(TopLoc_Location()), "", "", "", shape.Location().Transformation());
  }

  void visit_document(const Handle(TDocStd_Document) & document) {
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    colours_ = XCAFDoc_DocumentTool::ColorTool(document->Main());
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (int i = 1; i <= roots.Length(); ++i) visit(roots(i), "", "", gp_Trsf());
  }

  // A product, an instance of one or an assembly of instances.
  void visit(const TDF_Label& label, const std::string& instance, const std::string& colour, const gp_Trsf& place) {
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      TDF_Label product;
      XCAFDoc_ShapeTool::GetReferredShape(label, product);
      const std::string own = colour_of(colours_, label);
      return visit(product, name_of(label), own.empty() ? colour : own,
                   place * XCAFDoc_ShapeTool::GetLocation(label).Transformation());
    }
    const std::string own = colour_of(colours_, label);
    const std::string shown = colour.empty() ? own : colour;
    if (XCAFDoc_ShapeTool::IsAssembly(label)) {
      TDF_LabelSequence parts;
      XCAFDoc_ShapeTool::GetComponents(label, parts);
      for (int i = 1; i <= parts.Length(); ++i) visit(parts(i), "", shown, place);
      return;
    }
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    add_solids(without_location(shape), name_of(label), instance, shown, place * shape.Location().Transformation());
  }

  // All solids of a product; what is closed without being one becomes one.
  void add_solids(const TopoDS_Shape& shape, const std::string& product, const std::string& instance,
                  const std::string& colour, const gp_Trsf& place) {
    std::vector<TopoDS_Shape> solids;
    for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) solids.push_back(it.Current());
    for (const TopoDS_Shape& solid : closed_surfaces(shape, place)) solids.push_back(solid);
    for (std::size_t k = 0; k < solids.size(); ++k) {
      const std::string suffix = solids.size() > 1 ? fmt::format("/{}", k + 1) : "";
      const gp_Trsf own = place * solids[k].Location().Transformation();
      add_solid(without_location(solids[k]), product.empty() ? "" : product + suffix,
                instance.empty() ? "" : instance + suffix, colour, own);
    }
  }

  // Solids from closed shells that belong to none; what is open is kept for later.
  std::vector<TopoDS_Shape> closed_surfaces(const TopoDS_Shape& shape, const gp_Trsf& place) {
    const TopTools_IndexedMapOfShape shells = loose(shape, TopAbs_SHELL, TopAbs_SOLID);
    const TopTools_IndexedMapOfShape faces = loose(shape, TopAbs_FACE, TopAbs_SHELL);
    std::vector<TopoDS_Shape> solids;
    const auto keep = [&](const TopoDS_Shape& part) {
      if (open_.IsNull()) BRep_Builder().MakeCompound(open_);
      BRep_Builder().Add(open_, BRepBuilderAPI_Transform(part, place).Shape());
      for (TopExp_Explorer it(part, TopAbs_FACE); it.More(); it.Next()) ++open_faces_;
    };
    for (int i = 1; i <= shells.Extent(); ++i)
      if (BRep_Tool::IsClosed(shells(i)))
        solids.push_back(solid_of(TopoDS::Shell(shells(i))));
      else
        keep(shells(i));
    for (int i = 1; i <= faces.Extent(); ++i) keep(faces(i));
    if (!solids.empty())
      out_.findings.push_back(fmt::format("{} closed {} taken as solid", solids.size(),
                                          solids.size() == 1 ? "surface was" : "surfaces were"));
    return solids;
  }

  std::vector<TopoDS_Shape> sew() {
    BRepBuilderAPI_Sewing sewing(sew_ * out_.millimetres);
    sewing.Add(open_);
    sewing.Perform();
    const TopoDS_Shape result = sewing.SewedShape();
    std::vector<TopoDS_Shape> solids;
    if (!result.IsNull())
      for (TopExp_Explorer it(result, TopAbs_SHELL); it.More(); it.Next())
        if (BRep_Tool::IsClosed(it.Current())) solids.push_back(solid_of(TopoDS::Shell(it.Current())));
    if (solids.empty())
      refuse(fmt::format(
          "{} faces do not close a solid when they are joined across gaps up to {:.3g}: {} edges stay open; "
          "try a larger --sew, or mend the part in CAD",
          open_faces_, sew_, sewing.NbFreeEdges()));
    out_.findings.push_back(fmt::format("{} faces were joined to {} solid{}, across gaps up to {:.3g}", open_faces_,
                                        solids.size(), solids.size() == 1 ? "" : "s", sew_));
    return solids;
  }

  static TopoDS_Shape solid_of(const TopoDS_Shell& shell) {
    TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shell).Solid();
    BRepLib::OrientClosedSolid(solid); // outwards
    return solid;
  }

  // An instance of a solid that is there already gets a place there.
  void add_solid(const TopoDS_Shape& solid, const std::string& name, const std::string& instance,
                 const std::string& colour, const gp_Trsf& place) {
    for (std::size_t k = 0; k < out_.solids.size(); ++k)
      if (sources_[k].IsPartner(solid)) {
        out_.solids[k].places.emplace_back(instance, place);
        return;
      }
    LoadedSolid loaded;
    loaded.name = name;
    loaded.colour = colour;
    if (loaded.colour.empty() && !colours_.IsNull()) loaded.colour = colour_of(colours_, solid);
    loaded.places.emplace_back(instance, place);
    sources_.push_back(solid);
    Handle(BRepTools_ReShape) healing;
    loaded.shape = healed(solid, name, healing);
    out_.solids.push_back(std::move(loaded));
    for (const TopAbs_ShapeEnum kind : {TopAbs_FACE, TopAbs_EDGE, TopAbs_VERTEX}) label(solid, kind, healing);
  }

  /// @param[out] healing  what became of each part; null where nothing changed
  TopoDS_Shape healed(const TopoDS_Shape& solid, const std::string& name, Handle(BRepTools_ReShape) & healing) {
    if (BRepCheck_Analyzer(solid).IsValid()) return solid;
    const Handle(ShapeFix_Shape) fix = new ShapeFix_Shape(solid);
    fix->Perform();
    TopoDS_Shape fixed = fix->Shape();
    TopTools_IndexedMapOfShape found;
    if (!fixed.IsNull()) TopExp::MapShapes(fixed, TopAbs_SOLID, found);
    const std::string which = name.empty() ? fmt::format("solid {}", out_.solids.size() + 1) : name;
    if (found.Extent() == 1 && BRepCheck_Analyzer(found(1)).IsValid()) {
      out_.findings.push_back(
          fmt::format("the boundary of {} was inconsistent and was healed (OpenCASCADE's ShapeFix); "
                      "compare volume and area with the CAD program",
                      which));
      healing = fix->Context();
      return without_location(found(1));
    }
    out_.findings.push_back(
        fmt::format("OpenCASCADE finds the boundary of {} inconsistent and cannot heal it; its facets "
                    "decide whether it is used",
                    which));
    return solid;
  }

  // Names and colours of faces, edges and vertices.
  void label(const TopoDS_Shape& solid, TopAbs_ShapeEnum kind, const Handle(BRepTools_ReShape) & healing) {
    TopTools_IndexedMapOfShape parts;
    TopExp::MapShapes(solid, kind, parts);
    for (int i = 1; i <= parts.Extent(); ++i) {
      const TopoDS_Shape part = without_location(parts(i));
      ShapeLabel text;
      if (!names_from_.IsNull()) {
        const Handle(StepRepr_RepresentationItem) item =
            Handle(StepRepr_RepresentationItem)::DownCast(names_from_->EntityFromShapeResult(part, 1));
        if (!item.IsNull() && !item->Name().IsNull()) text.name = useful(item->Name()->ToCString());
      }
      if (kind == TopAbs_FACE && !colours_.IsNull()) text.colour = colour_of(colours_, parts(i));
      if (text.name.empty() && text.colour.empty()) continue;
      out_.label_of.Bind(healing.IsNull() ? part : without_location(healing->Apply(part)),
                         static_cast<int>(out_.labels.size()));
      out_.labels.push_back(std::move(text));
    }
  }

  // Solids and instances without a name get a number; equal names get one behind.
  void number_names() {
    UniqueNames solids, instances;
    int number = 0;
    for (LoadedSolid& solid : out_.solids) {
      ++number;
      solid.name = solids(solid.name.empty() ? fmt::format("solid {}", number) : solid.name);
    }
    for (LoadedSolid& solid : out_.solids) {
      int place = 0;
      for (auto& [instance, trsf] : solid.places) {
        ++place;
        if (solid.places.size() == 1)
          instance = instances(solid.name);
        else
          instance = instances(is_given(instance) ? instance : fmt::format("{} {}", solid.name, place));
      }
    }
  }

  // Numbers of usages (NAUO12), which CAD programs write where an instance has no name, say nothing to anybody.
  static bool is_given(const std::string& instance) {
    return !instance.empty() &&
           !(instance.starts_with("NAUO") && instance.find_first_not_of("0123456789", 4) == std::string::npos);
  }

  std::string file_;
  double sew_;
  LoadedCad out_;
  std::vector<TopoDS_Shape> sources_; ///< solids as the file has them, before healing
  Handle(Listener) listener_ = new Listener;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  Handle(XSControl_TransferReader) names_from_;
  TopoDS_Compound open_; ///< faces of no solid, where they stand
  int open_faces_ = 0;
};

} // namespace

std::string UniqueNames::operator()(const std::string& name) {
  std::string unique = name;
  for (int times = 2; !used_.insert(unique).second; ++times) unique = fmt::format("{} ({})", name, times);
  return unique;
}

std::string unit_of_millimetres(double millimetres) {
  for (const auto& [name, value] : units)
    if (std::abs(value - millimetres) <= 1e-12 * value) return name;
  return "";
}

double millimetres_of(const std::string& unit) {
  for (const auto& [name, value] : units)
    if (unit == name) return value;
  return 0;
}

LoadedCad load_shapes(const std::filesystem::path& file, double sew) {
  const std::string bytes = io::read_bytes(file, "a STEP, IGES or BREP file");
  const std::optional<CadFormat> format = cad_format(bytes, file);
  if (!format) throw InputError(fmt::format("{}: this is no STEP, IGES or BREP file", file.string()));
  LoadedCad cad = Loader(file, sew).run(*format);
  cad.sha256 = io::sha256_bytes(bytes.data(), bytes.size());
  return cad;
}

} // namespace iga::prep
