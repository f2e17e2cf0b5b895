// What the user says about contact.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace iga::solve {

/// Coulomb's law; mu = dynamic + (static - dynamic) exp(-decay |v|), v the sliding velocity.
struct FrictionLaw {
  double static_coefficient = 0, dynamic_coefficient = 0;
  double decay = 0; ///< time/length
};

struct ContactSide {
  enum class Kind { Deformable, Rigid };
  Kind kind = Kind::Deformable;
  std::size_t number = 0;           ///< of the surface or rigid body
  std::vector<std::string> regions; ///< surface regions that take part, by name; empty: all. Deformable sides only
};

struct ContactPair {
  std::string name;
  ContactSide first;  ///< deformable; the force of the pair is that on this side
  ContactSide second; ///< deformable (the same as first: self-contact) or rigid
  FrictionLaw friction;
  /// k = stiffness · m / dt² with m the reduced mass of the slabs, half a span deep, behind the contact. Commercial
  /// segment-based penalties use 0.05; the budget of stability lowers what is too much: 2 is as much as it allows.
  double stiffness = 2;
  double damping = 0.03;  ///< share of critical damping of the pair's mass on its spring; it takes from the budget
  bool edges = true;      ///< sharp edges touch each other and rigid bodies' corners touch faces
  std::string where = {}; ///< opens messages about the pair, such as file and line; may be empty
};

struct ContactOptions {
  double skin = 0.2; ///< relative motion that candidates last for, in spans
  /// Largest step of a run with contact, in the time a wave takes through a span of a body that touches: springs are as
  /// stiff as 1 / step² allows. Lumped masses would be stable with about 1.1. Infinite: no limit.
  double step = 0.42;
};

} // namespace iga::solve
