#include "preprocessor/connectivity/lattice_nodes.hpp"

namespace iga::prep {

LatticeNodes::LatticeNodes(std::int64_t num_touched, LineLattice lattice) : lattice_(lattice), n_(lattice.per_span) {
  const std::int64_t bits = n_ * n_ * n_ + 3 * n_ * n_ * (n_ + 1);
  stride_ = static_cast<std::size_t>((bits + 63) / 64);
  words_.assign(static_cast<std::size_t>(num_touched) * stride_, 0);
}

} // namespace iga::prep
