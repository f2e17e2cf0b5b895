// Consistent orientation, closed shells, and which shell lies in which: bodies, cavities, what is counted twice.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

#include <string>

namespace iga::prep {

struct Orienting {
  std::int64_t turned = 0; ///< facets turned to agree with the majority of their patch
  bool orientable = true;  ///< false for a one-sided surface (a Möbius strip among the facets)
  Point3 where{};          ///< a facet where the outside cannot be decided
};

/// Makes neighbours across two-facet edges agree; in each patch the majority keeps its order. Patches that meet at
/// edges of more facets are turned as wholes where that balances those edges. A closed chain is left alone.
Orienting orient_facets(Surface& surface);

/// Edge-connected parts of the surface; patches that are closed on their own count separately even where they touch.
struct Shells {
  std::vector<std::int32_t> shell;               ///< (n_t); numbered by first facet
  std::vector<double> volume;                    ///< (num_shells); signed, length³
  std::vector<double> area;                      ///< (num_shells); length²
  std::vector<Box3> box;                         ///< (num_shells)
  std::vector<std::vector<std::int32_t>> facets; ///< per shell, ascending

  std::size_t count() const { return volume.size(); }
};
Shells find_shells(const TriangleMesh& mesh);

/// Winding number of the listed facets about x: Van Oosterom & Strackee (1983), solid angle of a plane triangle.
/// 1 inside a closed outward shell, 0 outside, near 0.5 on the surface.
double winding_number(const TriangleMesh& mesh, std::span<const std::int32_t> facets, const Point3& x);

/// Whether `inner` lies in `outer` grown by `slack`.
bool box_contains(const Box3& outer, const Box3& inner, double slack);

/// Whether what lies `depth` below shell `a`'s facets (up to 100 of them are looked at) is partly inside shell `b`.
bool reaches_in_and_out(const TriangleMesh& mesh, const Shells& shells, std::int32_t a, std::int32_t b, double depth);

/// The shells' roles.
/// Rule: a shell whose surroundings are empty is a body, one that lies in material is a cavity if it faces inwards (its
/// facets run opposite to the body's, or at least its stored normals point into it), else it is a body inside a body.
/// A body that faces inwards is turned round; a part that faces inwards as a whole is turned round as a whole.
struct Nesting {
  int bodies = 0;
  int cavities = 0;
  std::vector<std::int32_t> turned;  ///< shells turned round
  bool whole_turned = false;         ///< every shell was turned: the part came inside out
  std::vector<std::int32_t> doubled; ///< shells inside another body that face outwards: counted twice
};
/// @param depth  how far below its facets a shell is asked where it lies, length; more than touching bodies overlap
Nesting orient_shells(Surface& surface, Shells& shells, double depth);

} // namespace iga::prep
