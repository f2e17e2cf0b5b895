#include "solver/explicit/contact/tool_mesh.hpp"

#include "format/io/file_bytes.hpp"
#include "format/io/foreign_file.hpp"
#include "format/io/stl_reader.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/explicit/contact/contact_mesh.hpp"

#include <fmt/format.h>

namespace iga::solve {

ToolMesh read_tool(const std::filesystem::path& file, double scale) {
  const std::string bytes = io::read_bytes(file, "an STL file");
  io::refuse_foreign(bytes, file);
  return make_tool(io::read_stl(bytes, file.string(), scale).mesh, file.string());
}

ToolMesh make_tool(const TriangleMesh& mesh, const std::string& name) {
  ToolMesh tool;
  tool.shape.mesh = merge_equal_vertices(mesh);
  const ContactMesh connected = make_contact_mesh(tool.shape.mesh, 0);
  std::size_t open = 0;
  for (const auto& neighbours : connected.neighbour)
    for (const std::int32_t n : neighbours)
      if (n < 0) ++open;
  if (open > 0)
    throw InputError(fmt::format("{}: the tool's surface is open at {} edges: it has no inside; close it", name, open));
  const VolumeMoments moments = volume_moments(tool.shape.mesh);
  if (!(moments.volume > 0))
    throw InputError(fmt::format("{}: the tool encloses a volume of {:.6g}: its triangles are turned inwards; turn "
                                 "them",
                                 name, moments.volume));
  tool.centre = moments.centroid;
  tool.volume = moments.volume;
  for (Point3& x : tool.shape.mesh.vertices) x = minus(x, tool.centre);
  return tool;
}

FreeMotion solid_tool(const ToolMesh& tool, double density) {
  const std::array<double, 6> s = volume_moments(tool.shape.mesh).second_moments; // xx yy zz xy yz zx
  FreeMotion motion;
  motion.mass = density * tool.volume;
  motion.inertia = {{{density * (s[1] + s[2]), -density * s[3], -density * s[5]},
                     {-density * s[3], density * (s[2] + s[0]), -density * s[4]},
                     {-density * s[5], -density * s[4], density * (s[0] + s[1])}}};
  return motion;
}

} // namespace iga::solve
