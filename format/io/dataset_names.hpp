// Every group, dataset and attribute name of the interchange file, once. schema/model.toml says the same for machines;
// the tests hold the two together.
#pragma once

#include "format/io/h5_file.hpp"

#include <array>

namespace iga::io::names {

constexpr const char* format = "iga-trimmed-solid";
constexpr const char* format_version = "2.0";
constexpr int format_major = 2;

constexpr std::array<EnumName, 3> states{{{"EXTERIOR", 0}, {"INTERIOR", 1}, {"TRIMMED", 2}}};

constexpr const char* root = "/";
constexpr const char* patch = "/patch";
constexpr const char* spans = "/spans";
constexpr const char* cells = "/cells";
constexpr const char* links = "/links";
constexpr const char* quadrature = "/quadrature";
constexpr const char* functions = "/functions";
constexpr const char* unknowns = "/unknowns";
constexpr const char* surface = "/surface";
constexpr const char* surface_quadrature = "/surface/quadrature";
constexpr const char* curves = "/curves";
constexpr const char* markers = "/markers";
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
constexpr DatasetText cell_span{"/cells/span", "1",
                                "ascending, repeated where a span holds several; number = i + n_u (j + n_v k) of span "
                                "(i, j, k)",
                                "linear number of the span that each cell is a piece of"};
constexpr DatasetText cell_state{"/cells/state", "1", "(cell)", "INTERIOR: the whole span; TRIMMED: a part of it"};
constexpr DatasetText volume_fraction{"/cells/volume_fraction", "1", "(cell)",
                                      "exact share of the span that the cell fills, before snapping"};
constexpr DatasetText cell_functions{"/cells/functions", "1", "(cell; function of the span, u fastest, then v, then w)",
                                     "entries of /functions that each cell sees"};
constexpr DatasetText link_cells{"/links/cells", "1", "(link; lower cell, higher cell), sorted",
                                 "cells of neighbouring spans that share solid area on the common face"};

constexpr DatasetText point_offsets{"/quadrature/offsets", "1", "(cell), then the total",
                                    "cell c owns the points offsets[c] ... offsets[c+1] - 1"};
constexpr DatasetText point_parameters{"/quadrature/parameters", "parameter", "(point; u v w), grouped by cell",
                                       "quadrature points of the volume"};
constexpr DatasetText point_weights{"/quadrature/weights", "length^3", "(point), grouped by cell",
                                    "physical volume that each point stands for, positive"};
constexpr DatasetText residual{"/quadrature/residual", "1", "(cell)",
                               "relative moment residual of a trimmed cell's rule, 0 for an interior one"};

constexpr DatasetText function_number{"/functions/number", "1",
                                      "ascending, repeated for copies; number = i + n_u (j + n_v k) of B-spline "
                                      "(i, j, k)",
                                      "B-spline that each function is a copy of: one copy for each connected part of "
                                      "the solid in its support"};
constexpr DatasetText mass_fraction{"/functions/mass_fraction", "1", "(function)",
                                    "integral of N over the copy's cells divided by its integral over the whole grid"};

constexpr DatasetText unknown_offsets{"/unknowns/offsets", "1", "(function), then the total",
                                      "the coefficient of function f is the sum of the terms offsets[f] ... "
                                      "offsets[f+1] - 1"};
constexpr DatasetText unknown_terms{"/unknowns/terms", "1", "(term), grouped by function, ascending in each",
                                    "unknown of each term"};
constexpr DatasetText unknown_weights{"/unknowns/weights", "1", "(term), grouped by function",
                                      "factor of the unknown in each term"};
constexpr DatasetText unknown_function{"/unknowns/function", "1", "(unknown), ascending, then -1",
                                       "function that each unknown is the coefficient of; -1: a Bernstein function "
                                       "beside the end of a gap"};
constexpr DatasetText unknown_parameters{"/unknowns/parameters", "parameter", "(unknown; u v w)",
                                         "Greville point of each unknown: what it is for the field u(x) = x"};
constexpr DatasetText unknown_mass_fraction{"/unknowns/mass_fraction", "1", "(unknown)",
                                            "integral of its function over the material divided by that over the "
                                            "whole support"};

constexpr DatasetText vertices{"/surface/vertices", "length", "(vertex; x y z)",
                               "vertices of the embedded surface in space"};
constexpr DatasetText vertex_parameters{"/surface/vertex_parameters", "parameter", "(vertex; u v w)",
                                        "the vertices in knot space, inside the closed span that owns each"};
constexpr DatasetText vertex_cell{"/surface/vertex_cell", "1", "(vertex)", "cell that owns each vertex"};
constexpr DatasetText triangles{"/surface/triangles", "1",
                                "(triangle; vertex numbers, anticlockwise seen from outside)",
                                "triangles of the embedded surface"};
constexpr DatasetText region{"/surface/region", "1", "(triangle)",
                             "number of the region that each triangle belongs to"};
constexpr DatasetText regions{"/surface/regions", "1", "(region)", "names of the regions"};

constexpr DatasetText surface_offsets{"/surface/quadrature/offsets", "1", "(cell), then the total",
                                      "cell c owns the surface points offsets[c] ... offsets[c+1] - 1"};
constexpr DatasetText surface_parameters{"/surface/quadrature/parameters", "parameter",
                                         "(point; u v w), grouped by cell", "quadrature points of the surface"};
constexpr DatasetText surface_weights{"/surface/quadrature/weights", "length^2", "(point), grouped by cell",
                                      "area that each point stands for, positive"};
constexpr DatasetText surface_normals{"/surface/quadrature/normals", "1", "(point; x y z), grouped by cell",
                                      "outward unit normals in space"};
constexpr DatasetText surface_triangle{"/surface/quadrature/triangle", "1", "(point), grouped by cell",
                                       "number of the triangle that each point lies on"};

constexpr DatasetText curve_names{"/curves/names", "1", "(curve)", "names of the curves, none twice"};
constexpr DatasetText curve_offsets{"/curves/offsets", "1", "(curve), then the total",
                                    "curve c has the points offsets[c] ... offsets[c+1] - 1, two or more"};
constexpr DatasetText curve_points{"/curves/points", "length", "(point; x y z), grouped by curve, in order along it",
                                   "points in space; straight between neighbours; a closed curve ends at its first"};
constexpr DatasetText marker_names{"/markers/names", "1", "(marker)", "names of the points, none twice"};
constexpr DatasetText marker_positions{"/markers/positions", "length", "(marker; x y z)", "points in space"};

constexpr DatasetText timing_stages{"/provenance/timing_stages", "1", "in the order they ran",
                                    "stages of the program's work"};
constexpr DatasetText timing_seconds{"/provenance/timing_seconds", "s", "(stage)", "wall-clock time of each stage"};
constexpr DatasetText findings{"/provenance/findings", "1", "in the order they were made",
                               "what was found wrong and what was done about it"};
constexpr DatasetText warnings{"/provenance/warnings", "1", "in the order they were made",
                               "what may make results wrong or inaccurate"};

} // namespace iga::io::names
