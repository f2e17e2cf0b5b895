// Narrow phase: what touches, how deep, in which direction.
#pragma once

#include "solver/explicit/contact/pair_search.hpp"

#include <limits>
#include <optional>

namespace iga::solve {

/// One place where two sides overlap. The gap's derivative by vertex positions is Σ weight · normal: a spring on the
/// depth has a potential.
struct Touch {
  std::uint64_t key = 0; ///< pair, kind and numbers: the same contact has it in all steps; ascending
  struct Entry {
    std::size_t surface = 0;
    std::int32_t vertex = 0;
    double weight = 0; ///< positive on the side that is pushed along the normal; the sides' sums are 1 and -1
  };
  std::array<Entry, 4> entries{}; ///< deformable vertices
  int count = 0;
  std::ptrdiff_t rigid = -1; ///< rigid body on one side
  double rigid_sign = 0;     ///< its weight
  Point3 point{};            ///< where it is; where the rigid body is pushed, length
  Point3 normal{};           ///< unit; out of the second side of the touch
  double first_sign = 1;     ///< the first side of the pair is pushed along (1) or against (-1) the normal
  double depth = 0;          ///< > 0, length
  double area = 0;           ///< reference area that stands behind it, length²
  double limit = 0;          ///< depth that its spring does not let pass, length
  double wall =
      std::numeric_limits<double>::infinity(); ///< thickness that it sinks into where less than a span, length
};

/// @pre positions of active vertices are up to date
std::optional<Touch> touch_face(const PairSearch& search, std::size_t pass, std::size_t candidate,
                                const std::vector<MovingSurface>& surfaces);
std::optional<Touch> touch_shape(const PairSearch& search, std::size_t candidate,
                                 const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid);
/// A sphere in the inside of a face, or of an edge between two: where it is deeper than at the corners around.
std::optional<Touch> touch_sphere(const PairSearch& search, std::size_t candidate,
                                  const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid);
std::optional<Touch> touch_edge(const PairSearch& search, std::size_t candidate,
                                const std::vector<MovingSurface>& surfaces);

/// Some candidates of a pair, [first, last) of one kind: what one thread looks at.
struct CandidatePiece {
  enum class Kind { Face, Shape, Sphere, Edge };
  Kind kind = Kind::Face;
  std::size_t pass = 0, first = 0, last = 0;
};
/// All candidates of a pair; their touches ascend by key from piece to piece and within each.
std::vector<CandidatePiece> candidate_pieces(const PairSearch& search);
/// The touch of candidate k of a piece, with a key without the pair's number.
std::optional<Touch> touch_of(const PairSearch& search, const CandidatePiece& piece, std::size_t k,
                              const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid);

/// Key of a vertex against a side. @param pass  0: the first side's vertices; 1: the second side's
constexpr std::uint64_t vertex_key(std::size_t pass, std::int32_t vertex) {
  return static_cast<std::uint64_t>(pass) << 54 | static_cast<std::uint64_t>(vertex);
}

} // namespace iga::solve
