// What is to be solved: material, the clamped and the loaded part of the surface, loads of the whole part.
#pragma once

#include <deal.II/base/parameter_handler.h>

#include "bezier_element.hpp"

#include <cmath>

namespace sample {

inline void declare(ParameterHandler& prm) {
  prm.declare_entry("Model file", "", Patterns::FileName(), "made by igaprep");
  prm.declare_entry("Results file", "", Patterns::FileName(), "to write; scripts/render.py draws it");
  prm.declare_entry("Young's modulus", "210e3", Patterns::Double(0));
  prm.declare_entry("Poisson's ratio", "0.3", Patterns::Double(-1, 0.5));
  prm.declare_entry("Density", "0", Patterns::Double(0));
  prm.declare_entry("Clamped region", "", Patterns::Anything(), "its three displacements are held by a penalty");
  prm.declare_entry("Penalty factor", "1e3", Patterns::Double(0), "C in beta = C E / h, h³ the volume of a span");
  prm.declare_entry("Loaded region", "", Patterns::Anything(), "none where empty");
  prm.declare_entry("Force", "0, 0, 0", Patterns::List(Patterns::Double(), 3, 3),
                    "spread evenly over the loaded region");
  prm.declare_entry("Acceleration", "0, 0, 0", Patterns::List(Patterns::Double(), 3, 3), "acts on the whole part");
}

inline Tensor<1, 3> vector_of(const ParameterHandler& prm, const std::string& key) {
  const auto numbers = Utilities::string_to_double(Utilities::split_string_list(prm.get(key)));
  return Point<3>(numbers[0], numbers[1], numbers[2]);
}

/// Supports and loads of the run: what every rank needs and what the results file tells.
struct Run {
  double E, nu, density, beta, area[2] = {0, 0}; // areas of the clamped and of the loaded region
  int region[2] = {-1, -1};
  Tensor<1, 3> force, acceleration, centre[2];
  SymmetricTensor<4, 3> C;
  Run(const ParameterHandler& prm, const Model& model)
      : E(prm.get_double("Young's modulus")), nu(prm.get_double("Poisson's ratio")), density(prm.get_double("Density")),
        force(vector_of(prm, "Force")), acceleration(vector_of(prm, "Acceleration")) {
    double span_volume = 1;
    for (int d = 0; d < 3; ++d) span_volume *= (model.upper[d] - model.lower[d]) / model.spans[d];
    beta = prm.get_double("Penalty factor") * E / std::cbrt(span_volume);
    region[0] = model.region_number(prm.get("Clamped region"));
    if (!prm.get("Loaded region").empty()) region[1] = model.region_number(prm.get("Loaded region"));
    need(region[1] >= 0 || force.norm() == 0, "a force acts, but no region is loaded");
    for (std::size_t q = 0; q < model.surface.weights.size(); ++q)
      for (int r = 0; r < 2; ++r)
        if (model.region[model.triangle[q]] == region[r]) {
          area[r] += model.surface.weights[q];
          centre[r] += model.surface.weights[q] * model.position(&model.surface.parameters[3 * q]);
        }
    for (int r = 0; r < 2; ++r)
      if (region[r] >= 0) centre[r] /= area[r];
    C = E * nu / ((1 + nu) * (1 - 2 * nu)) * outer_product(unit_symmetric_tensor<3>(), unit_symmetric_tensor<3>()) +
        E / (1 + nu) * identity_tensor<3>();
  }
};

} // namespace sample
