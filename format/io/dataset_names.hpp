// Every group, dataset and attribute name of the interchange file, once. schema/model.toml says the same for machines;
// the tests hold the two together.
#pragma once

#include "format/io/h5_file.hpp"

#include <array>

namespace iga::io::names {

constexpr const char* format = "iga-trimmed-solid";
constexpr const char* format_version = "1.1";
constexpr int format_major = 1;

constexpr std::array<EnumName, 3> states{{{"EXTERIOR", 0}, {"INTERIOR", 1}, {"TRIMMED", 2}}};

constexpr const char* root = "/";
constexpr const char* patch = "/patch";
constexpr const char* spans = "/spans";
constexpr const char* quadrature = "/quadrature";
constexpr const char* functions = "/functions";
constexpr const char* surface = "/surface";
constexpr const char* surface_quadrature = "/surface/quadrature";
constexpr const char* provenance = "/provenance";

constexpr std::array<DatasetText, 3> knots{
    {{"/patch/knots_u", "parameter", "ascending", "open knot vector along u; n_spans + 2 degree + 1 values"},
     {"/patch/knots_v", "parameter", "ascending", "open knot vector along v; n_spans + 2 degree + 1 values"},
     {"/patch/knots_w", "parameter", "ascending", "open knot vector along w; n_spans + 2 degree + 1 values"}}};
/// A finer grid goes without the table: it would outweigh everything else in the file, and readers can make its rows.
constexpr std::int64_t most_control_points = std::int64_t{1} << 24;
constexpr DatasetText control_points{"/patch/control_points", "length",
                                     "(function; x y z); functions with u fastest, then v, then w",
                                     "P_i of x(u) = sum N_i(u) P_i: the positions of the Greville parameters"};

constexpr DatasetText state{"/spans/state", "1", "(w, v, u); u fastest",
                            "where each knot span lies with respect to the solid"};
constexpr DatasetText active_spans{"/spans/active", "1", "ascending; number = i + n_u (j + n_v k) of span (i, j, k)",
                                   "linear numbers of all INTERIOR and TRIMMED spans"};
constexpr DatasetText volume_fraction{"/spans/volume_fraction", "1", "(active span)",
                                      "exact share of the span that the solid fills, before snapping"};

constexpr DatasetText point_offsets{"/quadrature/offsets", "1", "(active span), then the total",
                                    "active span a owns the points offsets[a] ... offsets[a+1] - 1"};
constexpr DatasetText point_parameters{"/quadrature/parameters", "parameter", "(point; u v w), grouped by active span",
                                       "quadrature points of the volume"};
constexpr DatasetText point_weights{"/quadrature/weights", "length^3", "(point), grouped by active span",
                                    "physical volume that each point stands for, positive"};
constexpr DatasetText residual{"/quadrature/residual", "1", "(active span)",
                               "relative moment residual of a trimmed span's rule, 0 for an interior span"};

constexpr DatasetText active_functions{"/functions/active", "1",
                                       "ascending; number = i + n_u (j + n_v k) of function (i, j, k)",
                                       "linear numbers of the functions whose support holds material"};
constexpr DatasetText mass_fraction{"/functions/mass_fraction", "1", "(active function)",
                                    "integral of N over the solid divided by its integral over the whole grid"};

constexpr DatasetText vertices{"/surface/vertices", "length", "(vertex; x y z)",
                               "vertices of the embedded surface in space"};
constexpr DatasetText vertex_parameters{"/surface/vertex_parameters", "parameter", "(vertex; u v w)",
                                        "the vertices in knot space, inside the closed span that owns each"};
constexpr DatasetText vertex_span{"/surface/vertex_span", "1", "(vertex)",
                                  "linear number of the active span that owns each vertex"};
constexpr DatasetText triangles{"/surface/triangles", "1",
                                "(triangle; vertex numbers, anticlockwise seen from outside)",
                                "triangles of the embedded surface"};
constexpr DatasetText region{"/surface/region", "1", "(triangle)",
                             "number of the region that each triangle belongs to"};
constexpr DatasetText regions{"/surface/regions", "1", "(region)", "names of the regions"};

constexpr DatasetText surface_offsets{"/surface/quadrature/offsets", "1", "(active span), then the total",
                                      "active span a owns the surface points offsets[a] ... offsets[a+1] - 1"};
constexpr DatasetText surface_parameters{"/surface/quadrature/parameters", "parameter",
                                         "(point; u v w), grouped by active span", "quadrature points of the surface"};
constexpr DatasetText surface_weights{"/surface/quadrature/weights", "length^2", "(point), grouped by active span",
                                      "area that each point stands for, positive"};
constexpr DatasetText surface_normals{"/surface/quadrature/normals", "1", "(point; x y z), grouped by active span",
                                      "outward unit normals in space"};
constexpr DatasetText surface_triangle{"/surface/quadrature/triangle", "1", "(point), grouped by active span",
                                       "number of the triangle that each point lies on"};

constexpr DatasetText timing_stages{"/provenance/timing_stages", "1", "in the order they ran",
                                    "stages of the program's work"};
constexpr DatasetText timing_seconds{"/provenance/timing_seconds", "s", "(stage)", "wall-clock time of each stage"};
constexpr DatasetText findings{"/provenance/findings", "1", "in the order they were made",
                               "what was found wrong and what was done about it"};
constexpr DatasetText warnings{"/provenance/warnings", "1", "in the order they were made",
                               "what may make results wrong or inaccurate"};

} // namespace iga::io::names
