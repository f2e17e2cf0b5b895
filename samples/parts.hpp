// The sample parts by name.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <functional>
#include <string>
#include <vector>

namespace iga::samples {

struct PartOptions {
  double theta = 3;   ///< mm by which the trimmed cube stays behind its 120 mm grid on every side
  int refinement = 5; ///< of the spheres: 20 · 4^refinement triangles
};

/// Binary STL holds float32; a part whose figures are compared with exact ones is written as text with 17 digits.
enum class StlKind { Binary, Ascii };

struct Part {
  std::string name;
  std::string what; ///< one line
  StlKind kind;
  std::function<TriangleMesh(const PartOptions&)> make;
};

/// All parts; lengths in mm.
const std::vector<Part>& parts();

} // namespace iga::samples
