// Broad phase of one contact pair: which vertices, faces and edges may touch until the sides have moved by a skin.
#pragma once

#include "solver/explicit/contact/contact_settings.hpp"
#include "solver/explicit/contact/pair_motion.hpp"

#include <functional>
#include <utility>

namespace iga::solve {

/// Vertices of one surface with the faces of another one (or the same) that they may touch.
struct VertexFaceCandidates {
  std::size_t slave = 0, master = 0; ///< surfaces
  double share = 1;                  ///< of the stiffness: 1/2 where both sides do it
  bool sharp_only = false;           ///< vertices of sharp edges only
  std::vector<std::int32_t> vertex;  ///< ascending
  std::vector<std::size_t> offsets;  ///< (vertices + 1)
  std::vector<std::int32_t> faces;   ///< ascending for each vertex
  Bvh tree;                          ///< of the master's faces, as they were at the last look
  Bvh vertex_tree;                   ///< of the slave's vertices in self-contact
};

/// Vertices that may touch a rigid shape with a closed form.
struct VertexShapeCandidates {
  std::size_t slave = 0, rigid = 0;
  std::vector<std::int32_t> vertex; ///< ascending
  std::vector<std::int32_t> face;   ///< faces whose inside may touch a sphere, ascending
  /// Faces count as touched from this depth on, in spans: a sphere that lies on flat triangles is between their corners
  /// by less, one that a stretched surface spans like a tent by more.
  static constexpr double face_offset = 0.05;
};

/// Sharp edges (numbers in ContactMesh::sharp_edges) that may cross.
struct EdgeCandidates {
  std::size_t first = 0, second = 0;                        ///< surfaces
  std::vector<std::pair<std::int32_t, std::int32_t>> edges; ///< ascending
  Bvh tree;                                                 ///< of the second side's edges
};

/// Which part of a surface takes part.
struct SideMask {
  std::vector<std::uint8_t> face, vertex;
};

/// How deep a vertex (of a pass, 0 …) was at the last look; 0 where it did not touch.
using DepthOf = std::function<double(std::size_t pass, std::int32_t vertex)>;

class PairSearch {
 public:
  /// @param tool  surface of a rigid mesh among `surfaces`, by rigid body; -1 for shapes with a closed form
  /// @throws InputError for sides that do not exist, naming the pair
  PairSearch(ContactPair pair, const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid,
             const std::vector<std::ptrdiff_t>& tool, double skin);

  const ContactPair& pair() const { return pair_; }
  bool is_self() const { return self_; }
  /// Surfaces of the sides; npos for a closed form.
  std::size_t first() const { return first_; }
  std::size_t second() const { return second_; }
  static constexpr std::size_t npos = static_cast<std::size_t>(-1);

  const std::vector<VertexFaceCandidates>& vertex_face() const { return vertex_face_; }
  const std::vector<VertexShapeCandidates>& vertex_shape() const { return vertex_shape_; }
  const std::vector<EdgeCandidates>& edges() const { return edges_; }
  const SideMask& mask(std::size_t surface) const { return surface == first_ ? first_mask_ : second_mask_; }
  std::size_t num_candidates() const;

  /// May a pair that is no candidate touch by now? Safe and cheap: relative motion since the last look is bounded from
  /// the nodes.
  bool may_be_stale(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                    const std::vector<RigidState>& rigid) const;
  /// The same from where the vertices are; is it time to look? @pre all positions of both sides are up to date
  bool is_stale(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                const std::vector<RigidState>& rigid);
  /// New candidates. @pre all positions of both sides are up to date
  void look(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
            const std::vector<RigidState>& rigid, const DepthOf& depth_of);
  /// Have the next step look again.
  void expire() { looked_ = false; }
  /// Marks the vertices that the narrow phase reads.
  void mark(const std::vector<MovingSurface>& surfaces, std::vector<std::vector<std::uint8_t>>& is_active) const;

 private:
  PairSides sides(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                  const std::vector<RigidState>& rigid) const;
  void look_at_faces(VertexFaceCandidates& pass, std::size_t number, const std::vector<MovingSurface>& surfaces,
                     const DepthOf& depth_of);
  void look_at_own_faces(VertexFaceCandidates& pass, const std::vector<Box3>& boxes, const MovingSurface& surface,
                         const DepthOf& depth_of);
  void look_at_shape(VertexShapeCandidates& pass, const std::vector<MovingSurface>& surfaces,
                     const std::vector<RigidState>& rigid);
  void look_at_edges(EdgeCandidates& pass, const std::vector<MovingSurface>& surfaces) const;
  bool are_neighbours(const ContactMesh& mesh, std::int32_t vertex, std::int32_t face) const;

  ContactPair pair_;
  double skin_ = 0;
  double wall_distance_ = 0, patch_distance_ = 0; ///< of neighbours in the reference, length
  bool self_ = false, looked_ = false, first_look_ = true;
  std::size_t first_ = npos, second_ = npos;
  SideMask first_mask_, second_mask_;
  std::vector<VertexFaceCandidates> vertex_face_;
  std::vector<VertexShapeCandidates> vertex_shape_;
  std::vector<EdgeCandidates> edges_;
  double allowance_ = 0; ///< relative motion that the candidates last for
  double deepest_ = 0;   ///< depth of a vertex in its own body at the last look
  PairMotion motion_;    ///< since then
};

} // namespace iga::solve
