// Penalty contact of all bodies: forces, friction, energies. See README.md for the equations.
#pragma once

#include "solver/base/phase_clock.hpp"
#include "solver/explicit/contact/contact_spring.hpp"
#include "solver/explicit/contact/touches_at_vertices.hpp"
#include "solver/explicit/motion/force_source.hpp"

namespace iga::solve {

/// What one pair does at t_n.
struct PairForce {
  std::string name;
  Point3 force{};            ///< on the first side, force
  double normal_force = 0;   ///< Σ of the normal parts, force
  double friction_force = 0; ///< Σ of the tangential parts' sizes, force
  double largest_depth = 0;  ///< beyond the baseline of initial penetration, length
  Point3 deepest{};          ///< where that is
  double area = 0;           ///< reference area in contact, length²
  std::int64_t touches = 0;
  double span_size = 0; ///< of the first side, length
  double depth_in_spans() const { return span_size > 0 ? largest_depth / span_size : 0; }
  /// Deepest touch whose spring has no stiffness because other penalties, such as supports, take all that the step
  /// allows on its nodes: length, and where.
  double forceless_depth = 0;
  Point3 forceless{};
  double forceless_in_spans() const { return span_size > 0 ? forceless_depth / span_size : 0; }
  /// Largest depth as a share of the wall behind it, of walls thinner than a span; its depth, and where.
  double wall_share = 0, wall_depth = 0;
  Point3 in_wall{};
};

struct ContactReport {
  std::vector<PairForce> pairs;
  PenaltyEnergy energy;     ///< of the interval t_{n-1} … t_n
  double initial_depth = 0; ///< deepest penetration at the start, taken as baseline, length
  std::int64_t initial_touches = 0;
  double least_scale = 1; ///< by which the budget of stability lowered a spring, in this step
  std::int64_t looks = 0; ///< broad phases so far
  std::int64_t candidates = 0;
};

/// Two sides that lie in each other before the first step.
struct StartOverlap {
  std::string pair, where;               ///< ContactPair
  double depth = 0;                      ///< of the deepest point looked at: vertices, centres of rigid bodies; length
  Point3 place{};                        ///< where that is
  std::int64_t vertices = 0;             ///< that lie in the other side
  double span_size = 0;                  ///< length
  static constexpr double allowed = 0.5; ///< in spans
  bool is_deep() const { return depth > allowed * span_size; } ///< the bodies were placed wrongly
};

class ContactModel : public PenaltySource {
 public:
  /// @param surfaces  k-th one of the k-th deformable body; the order of all BodyStates
  /// @throws InputError for pairs of sides that do not exist, rigid bodies that cannot be
  ContactModel(std::vector<ContactSurface> surfaces, std::vector<RigidBody> rigid, std::vector<ContactPair> pairs,
               ContactOptions options = {});

  /// Adds the contact forces at t_n to the bodies' forces and penalty sums and to the rigid bodies (whose forces begin
  /// at zero here). Parallel; the same bits for any number of threads.
  /// @throws InputError for bodies that overlap deeply at the start, NumericalError where sides move so far in a step
  ///         that they could pass each other
  PenaltyEnergy add_forces(const StepTimes& times, std::span<const BodyState> bodies) override;
  /// The pairs that overlap where the bodies stand now, self-contact left out; for a check before the first step, which
  /// refuses deep ones. Holds for closed surfaces.
  std::vector<StartOverlap> start_overlaps(std::span<const BodyState> bodies);
  /// Sides that come closer by more than this in one step (in spans) could miss each other.
  static constexpr double longest_step = 0.5;
  /// Looks for them before the first step of a run, once. @throws InputError naming the pair, the depth and the place
  void refuse_deep_overlaps(std::span<const BodyState> bodies);
  /// ContactOptions::step for the bodies whose wave speed is known; shorter while springs stiffen.
  double largest_step() const override;
  /// That of one body, infinite where it touches nothing.
  double largest_step(std::size_t body) const { return largest_steps_[body]; }
  std::string step_reason() const override;
  /// Rigid bodies from t_n to t_{n+1}; other forces on them are added before.
  void advance(const StepTimes& times) override;
  /// Of the free rigid bodies.
  double kinetic_energy() const override;
  /// Of drives and of gravity on rigid bodies.
  double external_work() const override;

  /// No penalty source comes after it in a step: penalty_sum need not tell what contact takes of it.
  void comes_last() { is_last_ = true; }
  /// Takes laps of its phases from now on. Has to outlive it.
  void use_clock(PhaseClock& clock) { clock_ = &clock; }

  const ContactReport& report() const { return report_; }
  std::vector<RigidState>& rigid() { return rigid_; }
  const std::vector<RigidState>& rigid() const { return rigid_; }
  const std::vector<MovingSurface>& surfaces() const { return surfaces_; }

  std::vector<SavedArray> save() const override;
  void load(std::span<const SavedArray> arrays) override;

 private:
  /// What a touch remembers.
  struct Memory {
    std::uint64_t key = 0;
    Point3 traction{};   ///< tangential force on the side pushed along the normal
    double baseline = 0; ///< penetration without force, length
    double depth = 0;    ///< length
    double sliding = 0;  ///< 1 while the friction limit is reached
    double factor = 1;   ///< on the stiffness, for as long as it touches
    double area = 0;     ///< largest so far: a surface that folds under its load goes on to be held, length²
    SpringEnergy spring;
  };
  struct Spring {
    double stiffness = 0, scale = 1;
    double with_damping = 1; ///< factor on the stiffness in the bound of stability
    DepthPotential potential;
    double ratio = 1;  ///< φ'': tangent over stiffness
    double load = 1;   ///< dt² λ of the bound over the budget, as this spring and those beside it would have it
    double lever = 0;  ///< 1 + arm / radius of gyration of a free rigid body
    Point3 velocity{}; ///< relative, of the side pushed along the normal
  };

  /// Touches of some candidates, those that count, and what is known of each.
  struct FoundPiece {
    std::size_t pair = 0;
    CandidatePiece candidates;
    std::vector<Touch> touches;
    std::vector<Memory> memory;
    std::vector<Point3> velocity;
    std::optional<Touch> too_fast; ///< the first one whose sides moved too far in the step
    double way = 0;                ///< of that one, length
  };
  /// Sums over a part of the touches.
  struct PartialSums;

  void lap(Phase phase) const {
    if (clock_) clock_->lap(phase);
  }
  void look_where_stale(std::span<const BodyState> bodies);
  void move(std::span<const BodyState> bodies);
  void find(const StepTimes& times);
  [[noreturn]] void refuse(const Touch& touch, std::size_t pair, double way, double time) const;
  void find(FoundPiece& piece, const StepTimes& times);
  bool remember(std::size_t pair, const Touch& touch, double way, double factor, std::size_t place, Memory& memory);
  std::ptrdiff_t first_from(std::uint64_t key) const;
  void take_over(const FoundPiece& piece, std::size_t first);
  const Memory* remembered(std::uint64_t key) const;
  Point3 relative_velocity(const Touch& touch, const StepTimes& times) const;

  void share_budget(std::span<const BodyState> bodies, const StepTimes& times);
  void set_springs();
  void keep_within_budget(std::span<const BodyState> bodies, const StepTimes& times);
  void want_step(const StepTimes& times);
  double elastic_depth(std::size_t touch) const;
  void load_rigid(const StepTimes& times);
  void sum_at_vertices();

  void apply_forces(const StepTimes& times);
  void apply_force(std::size_t touch, const StepTimes& times, PartialSums& sums);
  static Point3 friction(const Touch& touch, const Spring& spring, const ContactPair& pair, double normal_force,
                         const StepTimes& times, Memory& memory, PenaltyEnergy& energy);
  void hand_back(std::span<const BodyState> bodies, const StepTimes& times);
  double hand_back(const MovingSurface& surface, const BodyState& body, const std::vector<Point3>& at_vertices);

  std::vector<MovingSurface> surfaces_;
  std::vector<RigidState> rigid_;
  std::vector<PairSearch> searches_;
  ContactReport report_;
  bool started_ = false, overlaps_are_checked_ = false, is_last_ = false;
  double reference_dt_ = 0;                                      ///< of the springs
  std::vector<double> largest_steps_;                            ///< per deformable body
  double wanted_step_ = std::numeric_limits<double>::infinity(); ///< of the next step, by springs that stiffen
  std::size_t wanting_ = 0;                                      ///< the touch that asks for it
  /// Per surface and vertex: mass of the slab behind it / dt², lowered where a node could not bear it; force/length³.
  std::vector<std::vector<double>> density_;
  std::vector<std::vector<double>> vertex_sum_; ///< per surface and vertex: Σ k |weight| of this step
  std::vector<std::vector<Point3>> vertex_force_;
  std::vector<Touch> touches_; ///< ascending by key
  TouchesAtVertices at_vertices_;
  std::vector<Point3> touch_force_; ///< per touch, on the side pushed along the normal
  std::vector<std::size_t> pair_of_;
  std::vector<Spring> springs_;
  std::vector<Memory> memory_;             ///< ascending by key
  std::vector<FoundPiece> pieces_;         ///< these three keep their memory from step to step
  std::vector<Memory> next_memory_;        ///< of this step, while memory_ is that of the last one
  std::vector<std::uint8_t> is_used_;      ///< per entry of memory_: does it go on?
  std::vector<Eigen::VectorXd> node_load_; ///< per surface: share of a node's room, (num_nodes)
  std::vector<double> rigid_load_;
  std::vector<Eigen::VectorXd> last_force_; ///< per deformable body, (3 num_nodes)
  std::vector<std::vector<std::uint8_t>>
      last_touched_; ///< per body and piece of its nodes: may last_force_ be other than zero?
  PhaseClock* clock_ = nullptr;
};

} // namespace iga::solve
