// Everything that takes part in a run, made from its settings and models and checked before the first step.
#pragma once

#include "solver/explicit/contact/contact_model.hpp"
#include "solver/explicit/run/run_file.hpp"

#include <memory>

namespace iga::solve {

class ExplicitScene {
 public:
  /// Reads the models and builds bodies, contacts, loads and supports.
  /// @throws InputError with file and line of the run file for empty regions, labels that do not match, …
  explicit ExplicitScene(const ExplicitRun& run);

  /// What a new run can be refused for before its first step is known. @throws InputError for bodies that overlap
  /// deeply
  void check_start();
  /// Limits of the bodies at rest, by Lanczos. @throws InputError for a first step below dt_min, and for sides of a
  /// contact that approach so fast that they would pass each other in a step
  void find_limits();
  const std::vector<StartStep>& limits() const { return limits_; }
  /// The first forces; bodies that overlap deeply are refused here. @throws InputError, NumericalError
  void start();
  /// In their place: a saved state with its limits.
  void load(const IntegratorState& state, std::vector<StartStep> limits);

  const ExplicitRun& run() const { return run_; }
  Integrator& integrator() { return *integrator_; }
  const Integrator& integrator() const { return *integrator_; }
  std::size_t num_bodies() const { return bodies_.size(); }
  const ExplicitBody& body(std::size_t b) const { return *bodies_[b]; }
  const ContactModel* contact() const { return contact_.get(); }
  const std::vector<std::unique_ptr<RegionDrive>>& supports() const { return supports_; }
  const std::vector<LoadReport>& loads() const { return load_reports_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// What the models say of themselves beside their warnings; each names its body.
  const std::vector<std::string>& findings() const { return findings_; }

 private:
  void add_bodies();
  void add_loads();
  void add_contact();
  struct MovingBox { ///< where a side is at the start, and its velocity as a whole
    Box3 box;
    Eigen::Vector3d velocity;
  };
  MovingBox side_at_start(const ContactSide& side) const;
  void check_speeds() const;
  void warn_of_inertia();
  void make_integrator();

  const ExplicitRun& run_;
  std::vector<std::unique_ptr<TrimmedModel>> models_;
  std::vector<std::unique_ptr<ExplicitBody>> bodies_;
  std::vector<std::unique_ptr<TimedLoads>> loads_;
  std::vector<std::unique_ptr<RegionDrive>> supports_;
  std::vector<LoadReport> load_reports_;
  std::unique_ptr<ContactModel> contact_;
  std::vector<StartStep> limits_;
  std::unique_ptr<Integrator> integrator_;
  std::vector<std::string> findings_, warnings_;
};

} // namespace iga::solve
