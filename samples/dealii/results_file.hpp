// The solution as a results file by schema/results.toml, so that the scripts of this project read and draw it.
#pragma once

#include "run.hpp"

#include <filesystem>
#include <iostream>

namespace sample {

constexpr int strain_order[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}; // of the results file

/// A results file by schema/results.toml: coefficients, fields at the points and on the surface, reactions.
inline void write_results(const ParameterHandler& prm, const h5::File& in, const Model& model, const Run& run,
                          std::vector<Element>& elements, const Vector<double>& u, double work) {
  double strain_energy = 0, penalty_energy = 0, largest = 0, mass = 0;
  std::vector<double> position, displacement, strain, stress, mises;
  const auto keep = [&](Element& e, const Point<3>& unit, const Point<3>& x) { // field at a point, for the file
    e.evaluate(unit);
    const auto [value, epsilon] = e.field(u);
    const Strain sigma = run.C * epsilon;
    for (int i = 0; i < 3; ++i) position.push_back(x[i]), displacement.push_back(value[i]);
    for (const auto& [i, j] : strain_order) {
      strain.push_back((i == j ? 1 : 2) * epsilon[i][j]);
      stress.push_back(sigma[i][j]);
    }
    mises.push_back(std::sqrt(1.5) * deviator(sigma).norm());
    largest = std::max(largest, value.norm());
    return std::pair(value, epsilon * sigma);
  };
  const auto write_fields = [&](h5::File& out, const std::string& group, bool steps) {
    const auto shape = [&](hsize_t n) {
      std::vector<hsize_t> extents{mises.size()};
      if (n > 1) extents.push_back(n);
      if (steps) extents.insert(extents.begin(), 1);
      return extents;
    };
    out.write(group + "/displacement", shape(3), displacement);
    out.write(group + "/strain", shape(6), strain);
    out.write(group + "/stress", shape(6), stress);
    out.write(group + "/von_mises", shape(1), mises);
    for (auto* const values : {&position, &displacement, &strain, &stress, &mises}) values->clear();
  };

  const std::filesystem::path path = prm.get("Results file"), temporary = path.string() + ".part";
  {
    h5::File out(temporary.string(), true);
    out.write_attribute("/", "format", "iga-trimmed-solid-results");
    out.write_attribute("/", "format_version", "1.5");
    out.write_attribute("/", "analysis", "static");
    for (const char* name : {"length_unit", "title"}) out.write_attribute("/", name, in.text("/", name));
    for (const char* name : {"/model", "/material", "/functions", "/static", "/static/points", "/static/probes",
                             "/static/supports", "/static/loads", "/surface"})
      out.group(name);
    out.write_attribute("/model", "file", std::filesystem::path(prm.get("Model file")).filename().string());
    out.write_attribute("/model", "sha256", h5::sha256_of(prm.get("Model file")));
    std::vector<double> C;
    for (const auto& [i, j] : strain_order)
      for (const auto& [k, l] : strain_order) C.push_back(run.C[i][j][k][l]);
    out.write_attribute("/material", "C", {6, 6}, C);
    out.write_attribute<double>("/material", "density", {}, {run.density});
    out.write_attribute("/functions", "light_functions", "none");
    out.write_attribute<double>("/functions", "light_threshold", {}, {0});
    out.write_attribute<std::int64_t>("/functions", "unknowns", {}, {static_cast<std::int64_t>(model.num_unknowns)});
    out.write("/functions/active", {model.num_functions}, in.read<std::int64_t>("/functions/number"));

    std::vector<double> c(3 * model.num_functions); // coefficients of all functions, by /unknowns where it is there
    for (std::size_t f = 0; f < model.num_functions; ++f)
      for (int d = 0; d < 3; ++d)
        if (model.row_offsets.empty())
          c[3 * f + d] = u[3 * f + d];
        else
          for (auto t = model.row_offsets[f]; t < model.row_offsets[f + 1]; ++t)
            c[3 * f + d] += model.term_weights[t] * u[3 * model.terms[t] + d];
    out.write("/static/displacement", {model.num_functions, 3}, c);

    Tensor<1, 3> reaction, moment, centre_of_mass;
    for (std::size_t cell = 0; cell < elements.size(); ++cell) {
      const Quadrature<3> volume = elements[cell].quadrature(model.volume, cell);
      for (unsigned q = 0; q < volume.size(); ++q) {
        const Point<3> x = model.position(&model.volume.parameters[3 * (model.volume.offsets[cell] + q)]);
        strain_energy += volume.weight(q) * keep(elements[cell], volume.point(q), x).second / 2;
        mass += volume.weight(q) * run.density;
        centre_of_mass += volume.weight(q) * run.density * x;
      }
    }
    out.write("/static/points/position", {mises.size(), 3}, position);
    write_fields(out, "/static/points", false);

    for (std::size_t cell = 0; cell < elements.size(); ++cell) {
      const Quadrature<3> surface = elements[cell].quadrature(model.surface, cell);
      for (unsigned q = 0; q < surface.size(); ++q) {
        const auto at = model.surface.offsets[cell] + q;
        if (model.region[model.triangle[at]] != run.region[0]) continue;
        elements[cell].evaluate(surface.point(q));
        const Tensor<1, 3> t = -run.beta * surface.weight(q) * elements[cell].field(u).first;
        reaction += t;
        moment += cross_product_3d(model.position(&model.surface.parameters[3 * at]) - run.centre[0], t);
        penalty_energy += t * t / (2 * run.beta * surface.weight(q));
      }
    }
    const auto numbers = [](const Tensor<1, 3>& v) { return std::vector<double>{v[0], v[1], v[2]}; };
    out.write_attribute<double>("/static", "strain_energy", {}, {strain_energy});
    out.write_attribute<double>("/static", "external_work", {}, {work});
    out.write_attribute<double>("/static", "penalty_energy", {}, {penalty_energy});
    out.write_texts("/static/probes/name", {});
    out.write<double>("/static/probes/position", {0, 3}, {});
    out.write_texts("/static/supports/name", {"clamped"});
    out.write_texts("/static/supports/method", {"penalty"});
    out.write<double>("/static/supports/area", {1}, {run.area[0]});
    out.write("/static/supports/centroid", {1, 3}, numbers(run.centre[0]));
    out.write("/static/supports/force", {1, 3}, numbers(reaction));
    out.write("/static/supports/moment", {1, 3}, numbers(moment));
    const bool pulled = run.region[1] >= 0, heavy = mass > 0 && run.acceleration.norm() > 0;
    std::vector<std::string> kinds;
    std::vector<double> areas, centroids, forces;
    const auto add_load = [&](const char* kind, double area, const Tensor<1, 3>& centre, const Tensor<1, 3>& force) {
      kinds.emplace_back(kind);
      areas.push_back(area);
      for (int d = 0; d < 3; ++d) centroids.push_back(centre[d]), forces.push_back(force[d]);
    };
    if (pulled) add_load("total force", run.area[1], run.centre[1], run.force);
    if (heavy) add_load("acceleration", 0, centre_of_mass / mass, mass * run.acceleration);
    out.write_texts("/static/loads/name", kinds);
    out.write_texts("/static/loads/kind", kinds);
    out.write("/static/loads/area", {kinds.size()}, areas);
    out.write("/static/loads/centroid", {kinds.size(), 3}, centroids);
    out.write("/static/loads/force", {kinds.size(), 3}, forces);
    out.write("/static/loads/moment", {kinds.size(), 3}, std::vector<double>(forces.size())); // even loads have none

    const auto vertex_cell = in.read<std::int64_t>("/surface/vertex_cell");
    const auto parameters = in.read<double>("/surface/vertex_parameters"),
               vertices = in.read<double>("/surface/vertices");
    std::vector<std::int64_t> vertex_span;
    largest = 0;
    for (std::size_t v = 0; v < vertex_cell.size(); ++v) {
      Element& e = elements[vertex_cell[v]];
      keep(e, e.to_unit(&parameters[3 * v]), model.position(&parameters[3 * v]));
      vertex_span.push_back(model.span[vertex_cell[v]]);
    }
    out.write("/surface/vertices", {vertex_cell.size(), 3}, vertices);
    out.write("/surface/vertex_parameters", {vertex_cell.size(), 3}, parameters);
    out.write("/surface/vertex_cell", {vertex_cell.size()}, vertex_cell);
    out.write("/surface/vertex_span", {vertex_cell.size()}, vertex_span);
    out.write("/surface/triangles", {model.triangles.size() / 3, 3}, model.triangles);
    out.write("/surface/region", {model.region.size()}, model.region);
    out.write_texts("/surface/regions", model.regions);
    out.write<double>("/surface/steps", {1}, {1});
    write_fields(out, "/surface", true);
    std::cout << "reaction             " << reaction << "\n";
  }
  std::filesystem::rename(temporary, path); // whole or not at all
  std::cout << "strain energy        " << strain_energy << " + penalty energy " << penalty_energy
            << " = work of the loads " << work << "\nlargest displacement " << largest
            << " (of the surface's vertices)\nwritten              " << path.string() << "\n";
}

} // namespace sample
