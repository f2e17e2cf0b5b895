// Every key that a run file may hold; README.md says what they mean.
#include "solver/explicit/run/run_parts.hpp"
#include "solver/space/body_tables.hpp"
#include "solver/supports/read_supports.hpp"

namespace iga::solve {

std::vector<io::TableKeys> tool_keys() {
  return {{"rigid_bodies",
           {"name", "shape", "radius", "normal", "axis", "height", "size", "file", "scale", "density", "centre",
            "motion", "mass", "inertia", "velocity", "spin", "guided", "rotates"}},
          {"rigid_bodies.drive", {"kind", "smooth", "x", "y", "z", "rotation", "axis"}},
          {"contact", {"skin"}},
          {"contacts",
           {"name", "bodies", "self", "first_regions", "second_regions", "friction", "friction_dynamic",
            "friction_decay", "stiffness", "damping", "edges"}}};
}

std::vector<io::TableKeys> run_file_keys() {
  std::vector<io::TableKeys> keys{
      {"", {"units", "unit_system", "materials", "gravity"}},
      {"bodies",
       {"mass", "light_functions", "light_threshold", "damping", "erosion_volume_ratio", "locking", "velocity", "spin",
        "spin_centre", "edge_length", "merge_length"}},
      {"bodies.material", material_keys()},
      {"loads", {"body", "smooth", "factor", "follows"}},
      {"supports", {"name", "body", "fixed", "stiffness", "damping"}},
      {"supports.drive", {"kind", "smooth", "x", "y", "z"}},
      {"time", {"end", "safety", "start_share", "dt_max", "dt_min", "hold", "growth", "max_steps"}},
      {"energy", {"limit", "warning"}},
      {"watch",
       {"contact_warning", "contact_limit", "depth_warning", "depth_limit", "wall_warning", "wall_limit",
        "support_warning", "support_limit", "inverted_warning", "inverted_limit"}},
      {"output", {"file", "interval", "field_interval", "restart_interval", "subdivide", "points", "viewer"}},
      {"stop", {"quantity", "above", "below", "after"}}};
  for (const auto& more : {tool_keys(), load_keys("loads"), region_keys("supports"), body_file_keys()})
    keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

} // namespace iga::solve
