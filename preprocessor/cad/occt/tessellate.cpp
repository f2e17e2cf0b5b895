#include "preprocessor/cad/occt/tessellate.hpp"

#include "format/model/disjoint_sets.hpp"
#include "format/model/errors.hpp"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <GeomAbs_CurveType.hxx>
#include <GeomAbs_SurfaceType.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>
#include <map>

namespace iga::prep {

namespace {

// Facets turn by at most this much from one to the next: with a chord alone a small fillet would become one facet.
constexpr double largest_turn = 20 * M_PI / 180;

// Of exact volumes and areas: without it OpenCASCADE integrates with a fixed rule, off by 4e-4 where bores meet.
constexpr double integration_error = 1e-7;

Point3 point_of(const gp_XYZ& p, double length) {
  return {length * p.X(), length * p.Y(), length * p.Z()};
}
Point3 direction_of(const gp_Dir& d) {
  return {d.X(), d.Y(), d.Z()};
}

// Names of faces, edges or vertices: what the file says, made unique; a number where it says nothing.
class Namer {
 public:
  Namer(const LoadedCad& cad, const char* word) : cad_(cad), word_(word) {}
  std::string operator()(const TopoDS_Shape& part, int number) {
    const ShapeLabel* label = find(part);
    return unique_(label && !label->name.empty() ? label->name : fmt::format("{} {}", word_, number));
  }
  std::string colour(const TopoDS_Shape& part) const {
    const ShapeLabel* label = find(part);
    return label ? label->colour : "";
  }

 private:
  const ShapeLabel* find(const TopoDS_Shape& part) const {
    const int* entry = cad_.label_of.Seek(part.Located(TopLoc_Location()));
    return entry ? &cad_.labels[static_cast<std::size_t>(*entry)] : nullptr;
  }
  const LoadedCad& cad_;
  const char* word_;
  UniqueNames unique_;
};

CadFace describe(const TopoDS_Face& face, double length) {
  CadFace out;
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties, integration_error);
  out.area = std::abs(properties.Mass()) * length * length;
  out.centroid = point_of(properties.CentreOfMass().XYZ(), length);
  const BRepAdaptor_Surface surface(face);
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  const auto axis = [&](const gp_Ax1& line) {
    out.direction = direction_of(line.Direction());
    out.axis_point = point_of(line.Location().XYZ(), length);
  };
  // The material lies outside where the outward normal points to the axis.
  const auto cylinder_kind = [&]() -> const char* {
    if (surface.Cylinder().Direct() != reversed) return "cylinder";
    return surface.LastUParameter() - surface.FirstUParameter() > 0.99 * M_PI ? "bore" : "fillet";
  };
  switch (surface.GetType()) {
  case GeomAbs_Plane: {
    out.kind = "plane";
    const gp_Pln plane = surface.Plane();
    gp_Dir normal = plane.Axis().Direction();
    if (reversed == plane.Direct()) normal.Reverse();
    out.direction = direction_of(normal);
    break;
  }
  case GeomAbs_Cylinder:
    out.kind = cylinder_kind();
    axis(surface.Cylinder().Axis());
    out.radius = surface.Cylinder().Radius() * length;
    break;
  case GeomAbs_Cone:
    out.kind = "cone";
    axis(surface.Cone().Axis());
    out.radius = surface.Cone().RefRadius() * length;
    break;
  case GeomAbs_Sphere:
    out.kind = "sphere";
    out.axis_point = point_of(surface.Sphere().Location().XYZ(), length);
    out.radius = surface.Sphere().Radius() * length;
    break;
  case GeomAbs_Torus:
    out.kind = "torus";
    axis(surface.Torus().Axis());
    out.radius = surface.Torus().MajorRadius() * length;
    break;
  case GeomAbs_BezierSurface:
  case GeomAbs_BSplineSurface:
    out.kind = "spline";
    break;
  case GeomAbs_SurfaceOfRevolution:
    out.kind = "revolved";
    break;
  case GeomAbs_SurfaceOfExtrusion:
    out.kind = "extruded";
    break;
  default:
    out.kind = "offset";
    break;
  }
  return out;
}

CadEdge describe(const TopoDS_Edge& edge, double length) {
  CadEdge out;
  GProp_GProps properties;
  BRepGProp::LinearProperties(edge, properties);
  out.length = properties.Mass() * length;
  const BRepAdaptor_Curve curve(edge);
  out.middle = point_of(curve.Value(0.5 * (curve.FirstParameter() + curve.LastParameter())).XYZ(), length);
  switch (curve.GetType()) {
  case GeomAbs_Line:
    out.kind = "line";
    break;
  case GeomAbs_Circle:
    out.kind = "circle";
    out.radius = curve.Circle().Radius() * length;
    break;
  case GeomAbs_Ellipse:
    out.kind = "ellipse";
    break;
  case GeomAbs_BezierCurve:
  case GeomAbs_BSplineCurve:
    out.kind = "spline";
    break;
  default:
    out.kind = "curve";
    break;
  }
  return out;
}

// The facets of one face on their own, refined where they leave the face by more than the chord.
// OpenCASCADE subdivides a face along its edges and, on cylinders and cones, hardly inside: a facet whose corners lie
// on the edges of two bores may cut deep through the cylinder between them.
class FaceFacets {
 public:
  FaceFacets(const TopoDS_Face& face, const Handle(Poly_Triangulation) & facets, const gp_Trsf& place)
      : surface_(face) {
    const bool has_uv = facets->HasUVNodes();
    for (int n = 1; n <= facets->NbNodes(); ++n) {
      positions_.push_back(facets->Node(n).Transformed(place).XYZ());
      uv_.push_back(has_uv ? facets->UVNode(n).XY() : gp_XY());
    }
    for (int t = 1; t <= facets->NbTriangles(); ++t) {
      std::array<int, 3> n{};
      facets->Triangle(t).Get(n[0], n[1], n[2]);
      triangles_.push_back({n[0] - 1, n[1] - 1, n[2] - 1});
    }
    is_curved_ = has_uv && surface_.GetType() != GeomAbs_Plane;
    for (std::size_t n = 0; is_curved_ && n < uv_.size(); ++n) free_.push_back(free_at(uv_[n]));
  }

  void refine(double chord) {
    if (!is_curved_) return;
    for (int round = 0; round < most_rounds; ++round)
      if (!refine_once(chord)) return;
  }

  /// Largest distance found of the face from the middles of facets and their sides.
  double deviation() const {
    double largest = 0;
    if (!is_curved_) return 0;
    for (const Triangle& t : triangles_) {
      largest = std::max(largest, deviation_of(t));
      for (std::size_t k = 0; k < 3; ++k) largest = std::max(largest, deviation_of(t[k], t[(k + 1) % 3]));
    }
    return largest;
  }

  const std::vector<gp_XYZ>& positions() const { return positions_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  static constexpr int most_rounds = 12; ///< each halves the sides and quarters the distances
  using Side = std::pair<std::int32_t, std::int32_t>;
  static Side side_of(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }
  const gp_XYZ& at(std::int32_t n) const { return positions_[static_cast<std::size_t>(n)]; }
  const gp_XY& uv(std::int32_t n) const { return uv_[static_cast<std::size_t>(n)]; }
  gp_XYZ on_face(const gp_XY& p) const { return surface_.Value(p.X(), p.Y()).XYZ(); }

  // Whether the face does not move with its first or second parameter: at the tip of a cone, at a pole.
  using Free = std::array<bool, 2>;
  Free free_at(const gp_XY& p) const {
    gp_Pnt x;
    gp_Vec by_u, by_v;
    surface_.D1(p.X(), p.Y(), x, by_u, by_v);
    const double u_length = by_u.Magnitude() * (surface_.LastUParameter() - surface_.FirstUParameter());
    const double v_length = by_v.Magnitude() * (surface_.LastVParameter() - surface_.FirstVParameter());
    return {u_length < 1e-9 * v_length, v_length < 1e-9 * u_length};
  }
  // Mean of parameters, without those that a corner leaves free.
  gp_XY middle_of(std::initializer_list<std::int32_t> corners) const {
    gp_XY mean;
    for (const int d : {0, 1}) {
      double sum = 0, all = 0;
      int bound = 0;
      for (const std::int32_t c : corners) {
        all += uv(c).Coord(d + 1);
        if (free_[static_cast<std::size_t>(c)][static_cast<std::size_t>(d)]) continue;
        sum += uv(c).Coord(d + 1);
        ++bound;
      }
      mean.SetCoord(d + 1, bound > 0 ? sum / bound : all / static_cast<double>(corners.size()));
    }
    return mean;
  }

  // Distance of the face from a side or a facet, at their middle in parameters: what counts is how far it lies beside
  // them, not along.
  double deviation_of(std::int32_t a, std::int32_t b) const {
    const gp_XYZ way = on_face(middle_of({a, b})) - at(a), side = at(b) - at(a);
    const double length = side.Modulus();
    return length > 0 ? way.Crossed(side).Modulus() / length : way.Modulus();
  }
  double deviation_of(const Triangle& t) const {
    const gp_XYZ way = on_face(middle_of({t[0], t[1], t[2]})) - at(t[0]);
    const gp_XYZ normal = (at(t[1]) - at(t[0])).Crossed(at(t[2]) - at(t[0]));
    const double length = normal.Modulus();
    return length > 0 ? std::abs(way.Dot(normal)) / length : 0;
  }

  std::int32_t add(const gp_XY& p) {
    uv_.push_back(p);
    free_.push_back(free_at(p));
    positions_.push_back(on_face(p));
    return static_cast<std::int32_t>(positions_.size()) - 1;
  }

  // Splits the sides inside the face that lie too far from it, and facets that do though their sides do not.
  bool refine_once(double chord) {
    std::map<Side, int> uses;
    for (const Triangle& t : triangles_)
      for (std::size_t k = 0; k < 3; ++k) ++uses[side_of(t[k], t[(k + 1) % 3])];
    std::map<Side, std::int32_t> middle;
    for (const auto& [side, count] : uses)
      if (count == 2 && deviation_of(side.first, side.second) > chord)
        middle[side] = add(middle_of({side.first, side.second}));
    bool changed = !middle.empty();
    std::vector<Triangle> refined;
    for (const Triangle& t : triangles_) {
      std::array<std::int32_t, 3> m{-1, -1, -1}; // between corners k and k + 1
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto found = middle.find(side_of(t[k], t[(k + 1) % 3])); found != middle.end()) m[k] = found->second;
      const auto count = std::count_if(m.begin(), m.end(), [](std::int32_t n) { return n >= 0; });
      if (count == 0 && deviation_of(t) > chord) {
        const std::int32_t c = add(middle_of({t[0], t[1], t[2]}));
        for (std::size_t k = 0; k < 3; ++k) refined.push_back({t[k], t[(k + 1) % 3], c});
        changed = true;
      } else {
        split(t, m, refined);
      }
    }
    triangles_ = std::move(refined);
    return changed;
  }

  // A facet whose sides have new vertices in their middle (-1: none).
  static void split(const Triangle& t, const std::array<std::int32_t, 3>& m, std::vector<Triangle>& out) {
    const auto count = std::count_if(m.begin(), m.end(), [](std::int32_t n) { return n >= 0; });
    if (count == 0) return out.push_back(t);
    if (count == 3) {
      for (std::size_t k = 0; k < 3; ++k) out.push_back({t[k], m[k], m[(k + 2) % 3]});
      return out.push_back({m[0], m[1], m[2]});
    }
    // Turned so that the first side is split and, of two, the third is not.
    std::size_t k = 0;
    while (m[k] < 0 || (count == 2 && m[(k + 1) % 3] < 0)) ++k;
    const std::int32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3];
    if (count == 1) {
      out.push_back({a, ab, c});
      return out.push_back({ab, b, c});
    }
    out.push_back({ab, b, bc});
    out.push_back({a, ab, bc});
    out.push_back({a, bc, c});
  }

  BRepAdaptor_Surface surface_;
  std::vector<gp_XYZ> positions_;
  std::vector<gp_XY> uv_;
  std::vector<Free> free_; ///< where the face is curved
  std::vector<Triangle> triangles_;
  bool is_curved_ = false;
};

// Numbers of the vertices that faces share, and the facets of all faces.
class Facets {
 public:
  Facets(const TopTools_IndexedMapOfShape& edges, const TopTools_IndexedMapOfShape& vertices, double chord)
      : edges_(edges), vertices_(vertices), chord_(chord), edge_nodes_(static_cast<std::size_t>(edges.Extent())) {
    for (int v = 1; v <= vertices.Extent(); ++v)
      positions_.push_back(BRep_Tool::Pnt(TopoDS::Vertex(vertices(v))).XYZ());
    parent_ = lone_sets(positions_.size());
  }

  /// @return false where the face has no facets
  bool add(const TopoDS_Face& face, std::int32_t region) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) facets = BRep_Tool::Triangulation(face, location);
    if (facets.IsNull() || facets->NbTriangles() == 0) return false;
    const gp_Trsf place = location.Transformation();
    FaceFacets own(face, facets, place);
    own.refine(chord_);
    deviation_ = std::max(deviation_, own.deviation());
    std::vector<std::int32_t> number(own.positions().size(), -1);
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next())
      take_edge(TopoDS::Edge(it.Current()),
                BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(it.Current()), facets, location), own.positions(),
                number);
    for (std::size_t n = 0; n < number.size(); ++n)
      if (number[n] < 0) number[n] = new_vertex(own.positions()[n]);
    const bool flip = (face.Orientation() == TopAbs_REVERSED) != place.IsNegative();
    const auto at = [&](std::int32_t n) { return number[static_cast<std::size_t>(n)]; };
    for (const Triangle& t : own.triangles()) {
      triangles_.push_back(flip ? Triangle{at(t[0]), at(t[2]), at(t[1])} : Triangle{at(t[0]), at(t[1]), at(t[2])});
      region_.push_back(region);
    }
    return true;
  }

  double deviation() const { return deviation_; }

  /// Facets with vertices numbered anew, those that edges of no length collapsed left out.
  void write(TriangleMesh& mesh, double length) {
    std::vector<std::int32_t> number(positions_.size(), -1);
    const auto at = [&](std::int32_t v) {
      std::int32_t& n = number[static_cast<std::size_t>(find_root(parent_, v))];
      if (n < 0) {
        n = static_cast<std::int32_t>(mesh.vertices.size());
        mesh.vertices.push_back(position(v, length));
      }
      return n;
    };
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const Triangle facet{at(triangles_[t][0]), at(triangles_[t][1]), at(triangles_[t][2])};
      if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) continue;
      mesh.triangles.push_back(facet);
      mesh.region.push_back(region_[t]);
    }
  }

  /// Corners of the facets along an edge; empty where no facet has it.
  std::vector<Point3> polyline(int edge, double length) {
    std::vector<Point3> points;
    for (const std::int32_t v : edge_nodes_[static_cast<std::size_t>(edge - 1)]) points.push_back(position(v, length));
    return points;
  }

 private:
  Point3 position(std::int32_t v, double length) {
    return point_of(positions_[static_cast<std::size_t>(find_root(parent_, v))], length);
  }

  std::int32_t new_vertex(const gp_XYZ& position) {
    positions_.push_back(position);
    parent_.push_back(static_cast<std::int32_t>(parent_.size()));
    return parent_.back();
  }

  std::int32_t vertex_of(const TopoDS_Vertex& vertex) const { return vertices_.FindIndex(vertex) - 1; }

  // Nodes of a face along one of its edges get the numbers that the edge has, whichever face came first.
  void take_edge(const TopoDS_Edge& edge, const Handle(Poly_PolygonOnTriangulation) & polygon,
                 const std::vector<gp_XYZ>& positions, std::vector<std::int32_t>& number) {
    if (polygon.IsNull()) return;
    const std::int32_t first = vertex_of(TopExp::FirstVertex(edge)), last = vertex_of(TopExp::LastVertex(edge));
    const bool collapsed = BRep_Tool::Degenerated(edge);
    const int count = polygon->NbNodes();
    const auto node = [&](int k) { return static_cast<std::size_t>(polygon->Node(k) - 1); };
    std::vector<std::int32_t>& shared = edge_nodes_[static_cast<std::size_t>(edges_.FindIndex(edge) - 1)];
    if (shared.empty())
      for (int k = 1; k <= count; ++k)
        shared.push_back(collapsed || (k == 1 && first >= 0) ? first
                         : k == count && last >= 0           ? last
                                                             : new_vertex(positions[node(k)]));
    if (shared.size() != static_cast<std::size_t>(count)) return; // the surface stays open here, which is found later
    for (int k = 1; k <= count; ++k) {
      std::int32_t& n = number[node(k)];
      const std::int32_t v = shared[static_cast<std::size_t>(k - 1)];
      if (n < 0)
        n = v;
      else
        join_sets(parent_, n, v);
    }
  }

  const TopTools_IndexedMapOfShape &edges_, &vertices_;
  double chord_;
  std::vector<std::vector<std::int32_t>> edge_nodes_; ///< by edge, along its curve
  std::vector<gp_XYZ> positions_;
  std::vector<std::int32_t> parent_;
  std::vector<Triangle> triangles_;
  std::vector<std::int32_t> region_;
  double deviation_ = 0;
};

} // namespace

double exact_volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, integration_error);
  return properties.Mass();
}

double longest_side(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, false, false);
  if (box.IsVoid()) return 0;
  double x0 = 0, y0 = 0, z0 = 0, x1 = 0, y1 = 0, z1 = 0;
  box.Get(x0, y0, z0, x1, y1, z1);
  return std::max({x1 - x0, y1 - y0, z1 - z0});
}

CadSolid tessellate(const LoadedCad& cad, const LoadedSolid& solid, double chord, double length,
                    const std::string& file) {
  CadSolid out;
  out.name = solid.name;
  out.colour = solid.colour;
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(solid.shape, volume, integration_error);
  BRepGProp::SurfaceProperties(solid.shape, area, integration_error);
  out.volume = volume.Mass() * length * length * length;
  out.area = area.Mass() * length * length;
  out.centroid = point_of(volume.CentreOfMass().XYZ(), length);
  out.chord = chord * length;

  TopTools_IndexedMapOfShape faces, edges, vertices;
  TopExp::MapShapes(solid.shape, TopAbs_FACE, faces);
  TopExp::MapShapes(solid.shape, TopAbs_EDGE, edges);
  TopExp::MapShapes(solid.shape, TopAbs_VERTEX, vertices);
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_edge;
  TopExp::MapShapesAndAncestors(solid.shape, TopAbs_EDGE, TopAbs_FACE, faces_of_edge);
  Facets facets(edges, vertices, chord);
  if (chord > 0) {
    BRepTools::Clean(solid.shape);
    const BRepMesh_IncrementalMesh mesher(solid.shape, chord, false, largest_turn, true);
  }
  Namer face_name(cad, "face"), edge_name(cad, "edge"), vertex_name(cad, "vertex");
  std::vector<std::string> failed;
  for (int f = 1; f <= faces.Extent(); ++f) {
    const TopoDS_Face face = TopoDS::Face(faces(f));
    CadFace described = describe(face, length);
    described.name = face_name(face, f);
    described.colour = face_name.colour(face);
    if (described.colour.empty()) described.colour = solid.colour;
    if (chord > 0 && !facets.add(face, f - 1)) failed.push_back(described.name);
    out.mesh.region_names.push_back(described.name);
    out.faces.push_back(std::move(described));
  }
  if (!failed.empty())
    throw InputError(fmt::format("{}: OpenCASCADE makes no facets on {} of {} faces of \"{}\" (the first is "
                                 "\"{}\"); another --chord may help, or the face must be mended in CAD",
                                 file, failed.size(), faces.Extent(), solid.name, failed.front()));
  facets.write(out.mesh, length);
  out.deviation = facets.deviation() * length;
  for (int e = 1; e <= edges.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(edges(e));
    if (BRep_Tool::Degenerated(edge)) continue;
    CadEdge described = describe(edge, length);
    described.name = edge_name(edge, e);
    described.points = facets.polyline(e, length);
    for (const TopoDS_Shape& face : faces_of_edge.FindFromKey(edge)) {
      const std::string& name = out.faces[static_cast<std::size_t>(faces.FindIndex(face) - 1)].name;
      if (described.faces.empty() || described.faces.back() != name) described.faces.push_back(name);
    }
    out.edges.push_back(std::move(described));
  }
  for (int v = 1; v <= vertices.Extent(); ++v)
    out.vertices.push_back(
        {vertex_name(vertices(v), v), point_of(BRep_Tool::Pnt(TopoDS::Vertex(vertices(v))).XYZ(), length)});
  return out;
}

} // namespace iga::prep
