#include "preprocessor/cad/occt/read_cad.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/cad/occt/tessellate.hpp"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::prep {

namespace {

bool is_identity(const gp_Trsf& place) {
  return place.Form() == gp_Identity;
}
bool is_rigid(const gp_Trsf& place) {
  return std::abs(place.ScaleFactor() - 1) < 1e-12 && !place.IsNegative();
}

// Labels follow the faces, edges and vertices of `before` through a change of the shape.
template <class Images> void carry_labels(LoadedCad& cad, const TopoDS_Shape& before, Images&& images_of) {
  for (const TopAbs_ShapeEnum kind : {TopAbs_FACE, TopAbs_EDGE, TopAbs_VERTEX}) {
    TopTools_IndexedMapOfShape parts;
    TopExp::MapShapes(before, kind, parts);
    for (int i = 1; i <= parts.Extent(); ++i) {
      const int* label = cad.label_of.Seek(parts(i).Located(TopLoc_Location()));
      if (!label) continue;
      const int entry = *label;
      for (const TopoDS_Shape& image : images_of(parts(i))) cad.label_of.Bind(image.Located(TopLoc_Location()), entry);
    }
  }
}

// The solid moved, mirrored or scaled to where it stands.
TopoDS_Shape placed(LoadedCad& cad, const TopoDS_Shape& solid, const gp_Trsf& place) {
  if (is_identity(place)) return solid;
  if (is_rigid(place)) return solid.Moved(TopLoc_Location(place));
  BRepBuilderAPI_Transform transform(solid, place, true);
  carry_labels(cad, solid, [&](const TopoDS_Shape& part) {
    TopTools_ListOfShape images;
    images.Append(transform.ModifiedShape(part));
    return images;
  });
  return transform.Shape();
}

// Solids that stand once are taken where they stand, as are mirrored and scaled instances; others keep their frame.
void settle_places(LoadedCad& cad) {
  std::vector<LoadedSolid> settled;
  for (const LoadedSolid& solid : cad.solids) {
    LoadedSolid repeated = solid;
    repeated.places.clear();
    for (const auto& [name, place] : solid.places)
      if (is_rigid(place) && solid.places.size() > 1)
        repeated.places.emplace_back(name, place);
      else
        settled.push_back({placed(cad, solid.shape, place),
                           solid.places.size() > 1 ? name : solid.name,
                           solid.colour,
                           {{name, gp_Trsf()}}});
    if (!repeated.places.empty()) settled.push_back(std::move(repeated));
  }
  cad.solids = std::move(settled);
}

std::size_t count_places(const LoadedCad& cad) {
  std::size_t count = 0;
  for (const LoadedSolid& solid : cad.solids) count += solid.places.size();
  return count;
}

// One solid instead of all.
void merge(LoadedCad& cad, const std::string& file, double length) {
  const std::size_t count = count_places(cad);
  if (count < 2) return;
  TopTools_ListOfShape first, others;
  std::vector<TopoDS_Shape> all;
  for (const LoadedSolid& solid : cad.solids)
    for (const auto& [name, place] : solid.places) {
      all.push_back(placed(cad, solid.shape, place));
      (first.IsEmpty() ? first : others).Append(all.back());
    }
  BRepAlgoAPI_Fuse fuse;
  fuse.SetArguments(first);
  fuse.SetTools(others);
  fuse.SetRunParallel(true);
  fuse.SetNonDestructive(true);
  fuse.Build();
  if (!fuse.IsDone() || fuse.HasErrors())
    throw InputError(
        fmt::format("{}: OpenCASCADE cannot unite the {} solids; unite them in CAD, or write one model for "
                    "each (igaprep FILE -o folder/)",
                    file, count));
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(fuse.Shape(), TopAbs_SOLID, solids);
  if (solids.Extent() != 1)
    throw InputError(
        fmt::format("{}: {} solids became {} when they were united, so not all of them touch; leave --merge "
                    "out and write one model for each (igaprep FILE -o folder/)",
                    file, count, solids.Extent()));
  for (const TopoDS_Shape& solid : all)
    carry_labels(cad, solid, [&](const TopoDS_Shape& part) { return fuse.Modified(part); });
  double before = 0;
  for (const TopoDS_Shape& solid : all) before += exact_volume(solid);
  const double cube = std::pow(length, 3);
  cad.findings.push_back(fmt::format("{} solids were united to one: volume {:.8g} became {:.8g}", count, before * cube,
                                     exact_volume(solids(1)) * cube));
  cad.solids = {{solids(1), "united", "", {{"united", gp_Trsf()}}}};
}

CadPlace place_of(const std::string& name, const gp_Trsf& trsf, double length) {
  CadPlace place;
  place.name = name;
  for (int i = 1; i <= 3; ++i) {
    for (int j = 1; j <= 3; ++j)
      place.rotation[static_cast<std::size_t>(i - 1)][static_cast<std::size_t>(j - 1)] =
          trsf.HVectorialPart().Value(i, j);
    place.shift[static_cast<std::size_t>(i - 1)] = trsf.TranslationPart().Coord(i) * length;
  }
  return place;
}

// Pairs of instances with a common volume that is more than rounding; `solids` are those of `cad`, tessellated.
std::vector<CadOverlap> find_overlaps(LoadedCad& cad, const std::vector<CadSolid>& solids, double length) {
  struct Instance {
    std::string name;
    TopoDS_Shape shape;
    double volume = 0; ///< in the units of the model
    Bnd_Box box;
  };
  std::vector<Instance> all;
  for (std::size_t k = 0; k < solids.size(); ++k)
    for (const auto& [name, place] : cad.solids[k].places) {
      all.push_back({name, placed(cad, cad.solids[k].shape, place), solids[k].volume, {}});
      BRepBndLib::Add(all.back().shape, all.back().box);
    }
  std::vector<CadOverlap> overlaps;
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      if (all[a].box.IsOut(all[b].box)) continue;
      BRepAlgoAPI_Common common(all[a].shape, all[b].shape);
      if (!common.IsDone() || common.Shape().IsNull()) continue;
      const double shared = exact_volume(common.Shape()) * std::pow(length, 3);
      if (shared > 1e-6 * std::min(all[a].volume, all[b].volume))
        overlaps.push_back({all[a].name, all[b].name, shared});
    }
  return overlaps;
}

} // namespace

CadModel read_cad(const std::filesystem::path& file, const CadOptions& options) {
  LoadedCad cad = load_shapes(file, options.sew);
  CadModel model;
  model.format = cad.format;
  model.sha256 = cad.sha256;
  model.file_unit = cad.file_unit;
  // Shapes are in millimetres, in the file's own unit where it tells none.
  double unit = cad.millimetres;
  model.length_unit = cad.file_unit;
  if (!options.length_unit.empty()) {
    model.length_unit = options.length_unit;
    if (cad.file_unit != "unspecified") {
      unit = millimetres_of(options.length_unit);
      if (unit == 0)
        throw InputError(
            fmt::format("length_unit = \"{}\": a CAD file is converted to this unit; expected one of mm, cm, "
                        "m, um, in, ft",
                        options.length_unit));
    }
  }
  const double length = options.scale / unit;
  settle_places(cad);
  if (options.merge) merge(cad, file.string(), length);
  for (const LoadedSolid& solid : cad.solids) {
    const double chord = !options.tessellate ? 0
                         : options.chord > 0 ? options.chord / length
                                             : options.chord_share * longest_side(solid.shape);
    CadSolid out = tessellate(cad, solid, chord, length, file.string());
    for (const auto& [name, place] : solid.places) out.places.push_back(place_of(name, place, length));
    model.solids.push_back(std::move(out));
  }
  if (options.overlaps) model.overlaps = find_overlaps(cad, model.solids, length);
  model.findings = std::move(cad.findings);
  model.warnings = std::move(cad.warnings);
  return model;
}

} // namespace iga::prep
