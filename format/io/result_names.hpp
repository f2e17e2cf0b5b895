// Every group and dataset name of the results file, once. schema/results.toml says the same for machines; the tests
// hold the two together. What results share with the model (/provenance, the root's attributes) is in
// dataset_names.hpp.
#pragma once

#include "format/io/h5_file.hpp"

#include <array>

namespace iga::io::result_names {

constexpr const char* format = "iga-trimmed-solid-results";
constexpr const char* format_version = "1.5";
constexpr int format_major = 1;

constexpr std::array<EnumName, 3> kinds{{{"RIGID", 0}, {"ELASTIC", 1}, {"MECHANISM", 2}}};

constexpr const char* model = "/model";
constexpr const char* material = "/material";
constexpr const char* functions = "/functions";
constexpr const char* eigen = "/eigen";
constexpr const char* statics = "/static";
constexpr const char* buckling = "/buckling";
constexpr const char* points = "/static/points";
constexpr const char* probes = "/static/probes";
constexpr const char* supports = "/static/supports";
constexpr const char* springs = "/static/springs";
constexpr const char* loads = "/static/loads";
constexpr const char* cases = "/static/cases";
constexpr const char* heat = "/heat";
constexpr const char* heat_boundaries = "/heat/boundaries";
constexpr const char* heat_probes = "/heat/probes";
constexpr const char* time_series = "/time_series";
constexpr const char* energy = "/time_series/energy";
constexpr const char* surface = "/surface";
constexpr const char* fields = "/fields";

constexpr DatasetText active_functions{
    "/functions/active", "1", "ascending, repeated for copies; number = i + n_u (j + n_v k) of B-spline (i, j, k)",
    "B-spline of each function, as /functions/number of the model"};

constexpr DatasetText frequencies{"/frequencies", "1/time",
                                  "(mode): rigid ones, mechanisms, elastic ones, ascending within each kind",
                                  "natural frequencies in cycles per time; 0 or rounding for rigid modes"};
constexpr DatasetText modes{"/modes", "1", "(mode; active function; x y z)",
                            "coefficients c_i of the modes u(x) = sum N_i(x) c_i, scaled to phi^T M phi = 1"};
constexpr DatasetText omega_squared{"/eigen/omega_squared", "1/time^2", "(mode), as /frequencies",
                                    "eigenvalues as computed; those of rigid modes may lie slightly below 0"};
constexpr DatasetText residuals{"/eigen/residual", "1", "(mode)", "relative residual of each eigenpair"};
constexpr DatasetText kind{"/eigen/kind", "1", "(mode)", "what each mode is"};
constexpr DatasetText participation{"/eigen/participation", "mass^(1/2)", "(mode; x y z)",
                                    "phi^T M r of translations r along x, y, z; squares are effective masses"};
constexpr DatasetText rotation_participation{
    "/eigen/rotation_participation", "mass^(1/2)*length", "(mode; x y z)",
    "phi^T M r of rotations r about the axes x, y, z through the centre of mass"};

constexpr DatasetText buckling_factors{"/buckling/factor", "1",
                                       "(mode): positive ones, then negative ones, each ascending in size",
                                       "factors on the loads at which the part buckles"};
constexpr DatasetText buckling_residuals{"/buckling/residual", "1", "(mode)", "relative residual of each mode"};
constexpr DatasetText buckling_modes{"/buckling/modes", "1", "(mode; active function; x y z)",
                                     "coefficients c_i of the shapes u(x) = sum N_i(x) c_i; the longest is 1"};
constexpr DatasetText growing_loads{"/buckling/growing", "1", "(load)",
                                    "names of the loads that the factor multiplies"};
constexpr DatasetText constant_loads{"/buckling/constant", "1", "(load)", "names of the loads that stay as they are"};
constexpr DatasetText preloads{"/eigen/preload", "1", "(load)", "names of the loads under which the part vibrates"};

constexpr const char* strain_order = "(point; xx yy zz xy yz zx)";
constexpr DatasetText displacement{"/static/displacement", "length", "(active function; x y z)",
                                   "coefficients c_i of the displacement u(x) = sum N_i(x) c_i"};
constexpr DatasetText point_positions{"/static/points/position", "length",
                                      "(point; x y z), as /quadrature of the model",
                                      "quadrature points of the model in space"};
constexpr DatasetText probe_names{"/static/probes/name", "1", "(probe)", "names of the points that were asked for"};
constexpr DatasetText probe_positions{"/static/probes/position", "length", "(probe; x y z)", "where the probes lie"};

constexpr DatasetText support_names{"/static/supports/name", "1", "(support)", "names of the supports"};
constexpr DatasetText support_methods{"/static/supports/method", "1", "(support)",
                                      "how each is held: nitsche, penalty or lagrange"};
constexpr DatasetText support_areas{"/static/supports/area", "length^2", "(support)", "area of the region"};
constexpr DatasetText support_centroids{"/static/supports/centroid", "length", "(support; x y z)",
                                        "centroid of the region"};
constexpr DatasetText support_forces{"/static/supports/force", "force", "(support; x y z)",
                                     "reaction: force of the support on the part"};
constexpr DatasetText support_moments{"/static/supports/moment", "force*length", "(support; x y z)",
                                      "its moment about the region's centroid"};

constexpr DatasetText spring_names{"/static/springs/name", "1", "(spring)", "names of the springs"};
constexpr DatasetText spring_areas{"/static/springs/area", "length^2", "(spring)",
                                   "area of the region; 0 of lines and points"};
constexpr DatasetText spring_centroids{"/static/springs/centroid", "length", "(spring; x y z)",
                                       "centroid of what it acts on"};
constexpr DatasetText spring_forces{"/static/springs/force", "force", "(spring; x y z)",
                                    "force of the spring on the part"};
constexpr DatasetText spring_moments{"/static/springs/moment", "force*length", "(spring; x y z)",
                                     "its moment about that centroid"};
constexpr DatasetText spring_energies{"/static/springs/energy", "force*length", "(spring)", "energy stored in each"};

constexpr DatasetText load_names{"/static/loads/name", "1", "(load)", "names of the loads"};
constexpr DatasetText load_kinds{"/static/loads/kind", "1", "(load)",
                                 "what each is: body force, acceleration, centrifugal, traction, pressure, …"};
constexpr DatasetText load_areas{"/static/loads/area", "length^2", "(load)",
                                 "area that it acts on; 0 for body forces and point loads"};
constexpr DatasetText load_centroids{"/static/loads/centroid", "length", "(load; x y z)",
                                     "centroid of what it acts on"};
constexpr DatasetText load_forces{"/static/loads/force", "force", "(load; x y z)", "resultant force on the part"};
constexpr DatasetText load_moments{"/static/loads/moment", "force*length", "(load; x y z)",
                                   "its moment about that centroid"};

constexpr DatasetText case_names{"/static/cases/name", "1", "(case)", "names of the load cases"};
constexpr DatasetText case_factors{"/static/cases/factor", "1", "(case; load)", "how much of each load a case has"};
constexpr DatasetText case_displacements{"/static/cases/displacement", "length", "(case; active function; x y z)",
                                         "coefficients c_i of the displacement u(x) = sum N_i(x) c_i"};
constexpr DatasetText case_forces{"/static/cases/support_force", "force", "(case; support; x y z)",
                                  "reactions: forces of the supports on the part"};
constexpr DatasetText case_energies{"/static/cases/strain_energy", "force*length", "(case)", "strain energies"};
constexpr DatasetText case_largest_displacements{"/static/cases/largest_displacement", "length", "(case)",
                                                 "largest displacement of each case"};
constexpr DatasetText case_largest_stresses{"/static/cases/largest_von_mises", "force/length^2", "(case)",
                                            "largest von Mises stress of each case"};

constexpr DatasetText temperature{"/heat/temperature", "temperature", "(active function)",
                                  "coefficients c_i of the temperature T(x) = sum N_i(x) c_i"};
constexpr DatasetText heat_names{"/heat/boundaries/name", "1", "(boundary)", "names of what heat goes through"};
constexpr DatasetText heat_kinds{"/heat/boundaries/kind", "1", "(boundary)",
                                 "what each is: temperature, flux, convection or source"};
constexpr DatasetText heat_areas{"/heat/boundaries/area", "length^2", "(boundary)",
                                 "area of the region; of a source the volume, length^3"};
constexpr DatasetText heat_centroids{"/heat/boundaries/centroid", "length", "(boundary; x y z)",
                                     "centroid of the region"};
constexpr DatasetText heat_temperatures{"/heat/boundaries/temperature", "temperature", "(boundary)",
                                        "mean temperature of the body there"};
constexpr DatasetText heat_powers{"/heat/boundaries/power", "power", "(boundary)", "heat into the body"};
constexpr DatasetText heat_probe_names{"/heat/probes/name", "1", "(probe)", "names of the points that were asked for"};
constexpr DatasetText heat_probe_positions{"/heat/probes/position", "length", "(probe; x y z)", "where the probes lie"};
constexpr DatasetText heat_probe_temperatures{"/heat/probes/temperature", "temperature", "(probe)", "temperature"};
constexpr DatasetText heat_probe_fluxes{"/heat/probes/heat_flux", "power/length^2", "(probe; x y z)",
                                        "heat flux -k grad T"};
constexpr DatasetText surface_temperature{"/surface/temperature", "temperature", "(step; vertex)", "temperature"};
constexpr DatasetText surface_heat_flux{"/surface/heat_flux", "power/length^2", "(step; vertex; x y z)",
                                        "heat flux -k grad T"};

constexpr DatasetText surface_von_mises_error{"/surface/von_mises_error", "force/length^2", "(step; vertex)",
                                              "estimated error of the von Mises stress, where stress is recovered"};
constexpr DatasetText surface_safety_factor{"/surface/safety_factor", "1", "(step; vertex)",
                                            "yield strength over von Mises stress, at most 1000"};

constexpr DatasetText time{"/time_series/time", "time", "ascending", "times of the series"};

/// Groups of named things: <path>/<name>, and the list of the names in their order. The series in them are listed in
/// format/model/time_series.hpp.
struct NamedGroup {
  const char *path, *description, *one;
  DatasetText names;
};
constexpr NamedGroup contact_series{
    "/time_series/contact",
    "forces of each contact",
    "one contact",
    {"/time_series/contact_names", "1", "(contact)", "names of the contacts, each a group of /time_series/contact"}};
constexpr NamedGroup body_series{
    "/time_series/body",
    "deformable bodies",
    "one body",
    {"/time_series/body_names", "1", "(body)", "names of the bodies, each a group of /time_series/body"}};
constexpr NamedGroup rigid_series{
    "/time_series/rigid",
    "rigid bodies",
    "one rigid body",
    {"/time_series/rigid_names", "1", "(rigid body)", "names of the rigid bodies, each a group of /time_series/rigid"}};
constexpr NamedGroup support_series{
    "/time_series/support",
    "driven and fixed regions",
    "one support",
    {"/time_series/support_names", "1", "(support)", "names of the supports, each a group of /time_series/support"}};
constexpr NamedGroup probe_series{
    "/time_series/probe",
    "points that the user asked for",
    "one probe",
    {"/time_series/probe_names", "1", "(probe)", "names of the probes, each a group of /time_series/probe"}};
constexpr NamedGroup body_heads{"/bodies",
                                "deformable bodies and their models",
                                "one body",
                                {"/body_names", "1", "(body)", "names of the bodies, each a group of /bodies"}};
constexpr NamedGroup tables{"/tables",
                            "tables of numbers: responses over frequency or time, root mean squares",
                            "one table",
                            {"/table_names", "1", "(table)", "names of the tables, each a group of /tables"}};
constexpr DatasetText field_times{"/fields/time", "time", "ascending",
                                  "times of the fields; of modes and load steps their numbers, from 1"};
constexpr DatasetText field_files{"/fields/file", "1", "(step)",
                                  "file that holds the fields of each step, relative to this file's folder"};

constexpr DatasetText vertices{"/surface/vertices", "length", "(vertex; x y z)",
                               "vertices of the undeformed surface, subdivided to show the fields"};
constexpr DatasetText vertex_parameters{"/surface/vertex_parameters", "parameter", "(vertex; u v w)",
                                        "the vertices in knot space, inside the closed span that owns each"};
constexpr DatasetText vertex_span{"/surface/vertex_span", "1", "(vertex)",
                                  "linear number of the span that owns each vertex"};
constexpr DatasetText vertex_cell{"/surface/vertex_cell", "1", "(vertex)",
                                  "cell of the model that owns each vertex: entry of /cells"};
constexpr DatasetText triangles{"/surface/triangles", "1",
                                "(triangle; vertex numbers, anticlockwise seen from outside)",
                                "triangles of the surface"};
constexpr DatasetText region{"/surface/region", "1", "(triangle)",
                             "number of the region that each triangle belongs to"};
constexpr DatasetText regions{"/surface/regions", "1", "(region)", "names of the regions"};
constexpr DatasetText steps{"/surface/steps", "1", "ascending",
                            "what each step of the fields stands for: mode number from 1, load step from 1, or time"};

/// Fields of a group: displacement, strain, stress and von Mises stress under <group>/<name>, for points or for steps
/// and points.
struct FieldText {
  DatasetText displacement, strain, stress, von_mises;
};
constexpr FieldText point_fields{
    {"/static/points/displacement", "length", "(point; x y z)", "displacement"},
    {"/static/points/strain", "1", "(point; xx yy zz xy yz zx)", "strain; shear strains are engineering strains"},
    {"/static/points/stress", "force/length^2", "(point; xx yy zz xy yz zx)", "stress in the part's frame"},
    {"/static/points/von_mises", "force/length^2", "(point)", "von Mises stress"}};
constexpr FieldText probe_fields{
    {"/static/probes/displacement", "length", "(probe; x y z)", "displacement"},
    {"/static/probes/strain", "1", "(probe; xx yy zz xy yz zx)", "strain; shear strains are engineering strains"},
    {"/static/probes/stress", "force/length^2", "(probe; xx yy zz xy yz zx)", "stress in the part's frame"},
    {"/static/probes/von_mises", "force/length^2", "(probe)", "von Mises stress"}};
constexpr FieldText surface_fields{
    {"/surface/displacement", "length", "(step; vertex; x y z)", "displacement; of modes as scaled in /modes"},
    {"/surface/strain", "1", "(step; vertex; xx yy zz xy yz zx)", "strain; shear strains are engineering strains"},
    {"/surface/stress", "force/length^2", "(step; vertex; xx yy zz xy yz zx)", "stress in the part's frame"},
    {"/surface/von_mises", "force/length^2", "(step; vertex)", "von Mises stress"}};

} // namespace iga::io::result_names
