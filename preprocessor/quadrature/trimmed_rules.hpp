// The rules of all trimmed spans: fitted first, then reduced to fewer points where that is asked for.
#pragma once

#include "preprocessor/fit/moment_fitting.hpp"
#include "preprocessor/quadrature/quadrature_options.hpp"

#include <memory>

namespace iga::prep {

/// Rules of trimmed spans in blocks of consecutive active spans, in span order: the unit of parallel work.
class TrimmedRules {
 public:
  /// Fits every trimmed span; cells at gap ends get rules of one degree more, and keep them.
  /// grid, trimming must outlive the object.
  /// @throws NumericalError naming the spans that did not reach the tolerance
  /// @throws Cancelled
  TrimmedRules(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options);

  /// Takes out points and moves the others, span by span; the result does not depend on the number of threads. Where
  /// `cancelled` becomes true the spans not yet reduced keep their rules (counts().kept_spans).
  void reduce(const QuadratureOptions& options);

  /// Gives rules that resist everything (resisting_rule) to spans whose few points might let a mechanism through.
  /// Rigidity is followed from the interior spans (whose rules are exact for the stiffness) from span to span, across
  /// faces: a span that resists every field its rigid neighbours leave free (KeptStiffness) is rigid with them.
  void secure(const QuadratureOptions& options);

  static constexpr std::size_t spans_per_block = 64; ///< active spans

  /// Points of one block's trimmed spans, in span units relative to the span's lower corner; weights in span volumes.
  struct Block {
    std::vector<double> points, weights; ///< (n × 3), (n)
    std::vector<double> residual;        ///< of each trimmed span
    std::vector<std::uint32_t> count;    ///< points of each trimmed span
    std::vector<SpanShape> shape;        ///< of each trimmed span
    std::vector<std::int8_t> axis;       ///< of prisms
  };
  std::size_t num_blocks() const { return blocks_.size(); }
  const Block& block(std::size_t b) const { return blocks_[b]; }
  /// Rule of the a-th active span, which is trimmed; shape and residual included.
  SpanRule rule(std::size_t a) const;
  void release(std::size_t b) { blocks_[b] = {}; }
  const QuadratureCounts& counts() const { return counts_; }

 private:
  void replace(const std::vector<std::pair<std::size_t, SpanRule>>& rules);
  void report(const std::vector<std::int64_t>& failed, double tolerance) const;

  const SplineGrid* grid_;
  const Trimming* trimming_;
  FarMoments far_;
  std::unique_ptr<FarMoments> gap_end_far_; ///< of cells at gap ends; null without them
  std::vector<Block> blocks_;
  QuadratureCounts counts_;
  bool reduced_ = false;
};

struct Cancelled {};

bool is_interior(const Trimming& trimming, std::size_t active);

} // namespace iga::prep
