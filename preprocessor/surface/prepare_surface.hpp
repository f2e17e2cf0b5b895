// Judges a surface and makes it fit for trimming: closed, oriented outwards, nothing counted twice.
#pragma once

#include "preprocessor/surface/read_mesh.hpp"

#include <functional>
#include <optional>

namespace iga::prep {

struct SurfaceOptions {
  bool repair = false;              ///< allow changes of shape: fill holes, resolve self-intersections, union of bodies
  bool wrap = false;                ///< last resort: CGAL's alpha wrapping
  std::optional<double> wrap_alpha; ///< length; default: diagonal / 50
  std::optional<double> wrap_offset;  ///< length; default: alpha / 30
  std::optional<double> region_angle; ///< degrees; split regions at sharper edges into numbered regions
  bool accept_leaks = false;          ///< keep going with a surface that is not closed
  std::function<void(std::int64_t done, std::int64_t total)> progress; ///< of a union of bodies; may be empty
};

struct PreparedSurface {
  TriangleMesh mesh;                 ///< welded, closed, outward-oriented; regions kept
  int bodies = 0;                    ///< mechanically separate outer shells
  int cavities = 0;                  ///< inner shells
  bool open = false;                 ///< not closed, which was accepted
  bool shape_changed = false;        ///< repair or wrapping changed the shape
  bool wrapped = false;              ///< a wrapped surface stands for the given one
  std::vector<std::string> findings; ///< what was found and what was done, one sentence each
  std::vector<std::string> warnings; ///< what the user should know but need not mend
};

/// @throws InputError when the surface cannot be trimmed; the message says what was found, where, and which option
/// mends it
PreparedSurface prepare_surface(ReadMesh input, const SurfaceOptions& options);

/// A surface wrapped around the given one, whatever that is, because of `reason` (it goes into the findings).
/// @throws InputError where wrapping makes no solid
PreparedSurface wrap_around(ReadMesh input, const SurfaceOptions& options, const std::string& reason);

} // namespace iga::prep
