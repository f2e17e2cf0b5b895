// What the lattice of lines sees inside the touched spans: which lattice points lie in the solid and between which
// neighbours the surface passes. Packed bits, so that memory stays small beside the surface pieces.
#pragma once

#include "preprocessor/connectivity/line_lattice.hpp"

#include <cstdint>
#include <vector>

namespace iga::prep {

/// n³ nodes per touched span, numbered m_u + n (m_v + n m_w), and along every axis n + 1 segments on each of the n²
/// lines: segment m ends at node m, segment 0 begins and segment n ends at the span's face.
class LatticeNodes {
 public:
  LatticeNodes(std::int64_t num_touched, LineLattice lattice);

  const LineLattice& lattice() const { return lattice_; }
  std::int64_t per_span() const { return n_; }
  std::int64_t nodes_per_span() const { return n_ * n_ * n_; }
  std::int64_t node(const Index3& m) const { return m[0] + n_ * (m[1] + n_ * m[2]); }

  bool inside(std::size_t t, std::int64_t node) const { return get(t, node); }
  /// @param m  the line's node numbers along the other two axes; m[axis] is the segment
  bool blocked(std::size_t t, std::size_t axis, const Index3& m) const { return get(t, segment(axis, m)); }
  void set_inside(std::size_t t, std::int64_t node) { set(t, node); }
  void set_blocked(std::size_t t, std::size_t axis, const Index3& m) { set(t, segment(axis, m)); }

 private:
  std::int64_t segment(std::size_t axis, const Index3& m) const {
    const std::int64_t line = m[(axis + 1) % 3] + n_ * m[(axis + 2) % 3];
    return nodes_per_span() + (static_cast<std::int64_t>(axis) * n_ * n_ + line) * (n_ + 1) + m[axis];
  }
  std::size_t word(std::size_t t, std::int64_t bit) const { return t * stride_ + static_cast<std::size_t>(bit / 64); }
  bool get(std::size_t t, std::int64_t bit) const { return (words_[word(t, bit)] >> (bit % 64)) & 1; }
  void set(std::size_t t, std::int64_t bit) { words_[word(t, bit)] |= std::uint64_t{1} << (bit % 64); }

  LineLattice lattice_;
  std::int64_t n_;
  std::size_t stride_;
  std::vector<std::uint64_t> words_;
};

} // namespace iga::prep
