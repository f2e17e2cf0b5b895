// Every group and dataset name of the field files of explicit analyses, once; schema/fields.toml says the same for
// machines. <name> is that of a body.
#pragma once

#include "format/io/h5_file.hpp"

namespace iga::io::field_names {

constexpr const char* format = "iga-trimmed-solid-fields";
constexpr int format_major = 1;
constexpr const char* format_version = "1.1";
constexpr const char* bodies = "/bodies";

/// Datasets of /bodies/<name>: `path` holds the last name alone.
constexpr DatasetText active_functions{"active_functions", "1",
                                       "as /functions/number of the model: ascending, repeated for copies",
                                       "functions that the coefficients belong to"};
constexpr DatasetText vertices{"vertices", "length", "(vertex; x y z)", "vertices of the undeformed surface"};
constexpr DatasetText vertex_parameters{"vertex_parameters", "parameter", "(vertex; u v w)",
                                        "the vertices in knot space, inside the closed span that owns each"};
constexpr DatasetText vertex_span{"vertex_span", "1", "(vertex)", "linear number of the span that owns each vertex"};
constexpr DatasetText vertex_cell{"vertex_cell", "1", "(vertex)",
                                  "cell of the model that owns each vertex: entry of /cells"};
constexpr DatasetText triangles{"triangles", "1", "(triangle; vertex numbers, anticlockwise seen from outside)",
                                "triangles of the surface"};
constexpr DatasetText region{"region", "1", "(triangle)", "number of the region that each triangle belongs to"};
constexpr DatasetText regions{"regions", "1", "(region)", "names of the regions"};

constexpr DatasetText coefficients{"coefficients", "length", "(active function; x y z)",
                                   "coefficients c_i of the displacement u(x) = sum N_i(x) c_i"};
constexpr DatasetText displacement{"displacement", "length", "(vertex; x y z)", "displacement of the surface"};
constexpr DatasetText von_mises{"von_mises", "force/length^2", "(vertex)", "von Mises stress of the Cauchy stress"};
constexpr DatasetText strain{"strain", "1", "(vertex)", "largest principal logarithmic strain, by size"};
constexpr DatasetText plastic_strain{"plastic_strain", "1", "(vertex)", "equivalent plastic strain"};
constexpr DatasetText point_stress{"point_stress", "force/length^2", "(point; xx yy zz xy yz zx)",
                                   "Cauchy stress at the model's quadrature points"};
constexpr DatasetText point_plastic_strain{"point_plastic_strain", "1", "(point)",
                                           "equivalent plastic strain at the model's quadrature points"};

} // namespace iga::io::field_names
