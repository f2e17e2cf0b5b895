// A part ready for modal superposition: modes and residual vectors, what excites them, what is observed.
#pragma once

#include "solver/analysis/prepared_system.hpp"
#include "solver/analysis/system_loads.hpp"
#include "solver/response/modal_basis.hpp"

#include <optional>

namespace iga::solve {

/// A load, or the motion of the base, with modal forces for a factor of 1.
struct Excitation {
  std::string name;
  bool is_base = false;
  double unit = 1;     ///< of its factors: one g in length/time² of the run; 1 else
  Variation variation; ///< in multiples of the unit
};

/// What every vector of the basis has at the probes and in the supports.
struct Observed {
  std::vector<std::string> probes;
  std::vector<Point3> positions;         ///< (probes), length
  std::vector<std::string> probe_bodies; ///< (probes); empty names where there is one body
  Eigen::MatrixXd displacement;          ///< (3 probes × size)
  Eigen::MatrixXd stress;                ///< (6 probes × size): xx yy zz xy yz zx
  /// What holds the part: supports, then springs.
  struct Holder {
    const char* kind; ///< "support", "spring"
    std::string name;
  };
  std::vector<Holder> holders;
  Eigen::MatrixXd reaction; ///< (6 holders × size): force on the part, moment about the region's centroid
};

struct ResponseSystem : SystemOutcome {
  ModalBasis basis;
  ModalDamping damping;
  std::vector<Excitation> excitations;
  Eigen::MatrixXd modal_loads; ///< (size × excitations): Vᵀ f; of the base -Vᵀ M d
  Eigen::VectorXd load_shares; ///< (excitations): share of the modes in the static strain energy of each
  Observed observed;
  std::vector<LoadReport> loads;
  std::optional<Point3> base_direction;
  double base_mass_share = 0; ///< effective mass of the modes along the base's motion / total
  std::optional<SturmCount> sturm;

  Eigen::VectorXd base_vector() const; ///< (3 probes): the direction at every probe; zero without a base
};

/// @param highest  cycles/time, of the excitation: modes are sought up to twice as high where the run does not say how
///                 many; 0: the run's number of modes, transient_modes by default
/// @throws InputError for what modal superposition does not know: multipliers, prescribed displacements, loads on rigid
///         regions, a base without supports and springs to the ground; and as the analyses of modes and statics
ResponseSystem prepare_response(const RunSettings& run, std::span<const TrimmedModel> models, double highest);

/// Modes of a transient where the run says nothing: its excitation has no highest frequency.
constexpr int transient_modes = 40;

} // namespace iga::solve
