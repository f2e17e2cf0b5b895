// Which functions carry unknowns, span by span, and their values: the spline space after light functions were treated.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/space/light_treatment.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace iga::solve {

/// Spline space of vector fields u(x) = Σ N_i(x) c_i on the cells of a model.
/// A *node* is an unknown of the model that carries a coefficient of its own: a function, or beside the end of a gap a
/// Bernstein function. Nodes are numbered 0 … num_nodes() - 1 in the order of the model's unknowns; component d of node
/// i is unknown 3 i + d of the equations. Coefficients are vectors in the frame of the part. Under an extension the
/// shape functions of a node are its own function plus the extrapolated share of the light ones: everything built on
/// `evaluate` (matrices, loads, samples) is extended without knowing it.
class SolutionSpace {
 public:
  /// The model must outlive the space. @throws InputError where no function is left
  SolutionSpace(const TrimmedModel& model, const LightTreatment& treatment);

  const TrimmedModel& model() const { return *model_; }
  const LightTreatment& treatment() const { return treatment_; }
  std::int64_t num_nodes() const { return static_cast<std::int64_t>(node_unknown_.size()); }
  std::int64_t num_unknowns() const { return 3 * num_nodes(); }
  std::int64_t num_cells() const { return static_cast<std::int64_t>(model_->num_cells()); }
  std::int64_t num_light() const { return num_light_; }
  /// Are there slaves?
  bool is_extended() const { return extends(treatment_.remedy) && num_light_ > 0; }
  /// Share of the material that fills the a-th cell's span beside the part's own (finite-cell method): above 0 only in
  /// parts so thin that none of their functions is well filled. Stiffness and mass both count it.
  double fictitious_share(std::int64_t a) const {
    return fictitious_.empty() ? 0 : fictitious_[static_cast<std::size_t>(a)];
  }
  /// What the user should know: thin parts, lowered thresholds, functions that found no master.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Nodes whose shape functions do not vanish on the a-th cell, ascending.
  std::span<const std::int32_t> nodes(std::int64_t a) const {
    const auto first = static_cast<std::size_t>(offsets_[static_cast<std::size_t>(a)]);
    return {nodes_.data() + first, static_cast<std::size_t>(offsets_[static_cast<std::size_t>(a) + 1]) - first};
  }
  /// Each node's unknown of the model (its function, where no gap ends); (num_nodes), ascending.
  std::span<const std::int64_t> node_unknowns() const { return node_unknown_; }
  /// Is every function a node?
  bool is_plain() const { return num_light_ == 0 && model_->unknowns.empty(); }
  /// Greville point (length, the part's frame) of each node; a linear field has these coefficients:
  /// Σ N_i(x) (G g_i + c) = G x + c. (num_nodes × 3)
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> node_points() const;
  /// Coefficients of all functions from those of the nodes: (n_f × num_nodes); identity rows for nodes.
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& extension() const { return extension_; }
  /// The model's unknowns from those of the nodes: (n_u × num_nodes); the same as extension() where no gap ends.
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& unknown_extension() const {
    return model_->unknowns.empty() ? extension_ : unknown_extension_;
  }
  /// (num_unknowns) → (3 n_f), component fastest.
  Eigen::VectorXd expand(const Eigen::Ref<const Eigen::VectorXd>& unknowns) const;

  /// Cells whose shape functions differ from the plain B-splines (slaves present, gap ends): what the (p+1)³ B-splines,
  /// or Bernstein functions where is_bernstein, have for coefficients from those of the nodes; (p+1)³ ×
  /// nodes(a).size(), empty for plain cells.
  const Eigen::MatrixXd& local_extension(std::int64_t a) const;
  /// Are a cell's shape functions made of Bernstein functions of its span? Those at gap ends, where combinations of
  /// B-splines would lose up to 5 digits at p = 4.
  bool is_bernstein(std::int64_t a) const { return model_->is_at_gap_end(static_cast<std::size_t>(a)); }

 private:
  const TrimmedModel* model_;
  LightTreatment treatment_;
  std::int64_t num_light_ = 0;
  std::vector<std::string> warnings_;
  std::vector<double> fictitious_; // (num_active), or empty: nowhere
  std::vector<std::int64_t> node_unknown_;
  std::vector<std::int64_t> offsets_;
  std::vector<std::int32_t> nodes_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> extension_, unknown_extension_;
  std::vector<std::int32_t> local_extension_index_; // per span: entry of local_extensions_, -1 for plain spans
  std::vector<Eigen::MatrixXd> local_extensions_;
};

/// Shape functions at n points of one span; work space to be reused. Column-major: the points of a column lie together.
struct SpanShapes {
  Eigen::MatrixXd values;    ///< (n × nodes(a).size())
  Eigen::MatrixXd gradients; ///< (n × 3 nodes(a).size()); column 3 i + d is ∂N_i/∂x_d in the part's frame, 1/length
  Eigen::MatrixXd work[2];   ///< plain functions, where an extension follows
};

enum class Shapes { Values, Gradients, Both };

/// @param a           active span that owns the points
/// @param parameters  (n × 3), row-major, in or near the closed span (polynomials continue beyond it)
void evaluate(const SolutionSpace& space, std::int64_t a, std::span<const double> parameters, Shapes what,
              SpanShapes& shapes);

/// Gauss–Legendre rule with n points on [0, 1]: nodes in the first column, weights in the second.
Eigen::MatrixX2d gauss_rule(int n);

/// Product of three such rules over the unit cube, first direction fastest.
struct CubeRule {
  Eigen::MatrixX3d points;
  std::vector<double> weights; ///< they sum to 1
};
/// @param n  points by direction
CubeRule cube_rule(const std::array<int, 3>& n);

/// Quadrature points of one span; views into the model or into a SpanPointStorage.
struct SpanPoints {
  std::span<const double> parameters; ///< (n × 3), row-major
  std::span<const double> weights;    ///< (n), length³
};
struct SpanPointStorage {
  std::vector<double> parameters, weights;
};
/// Under a generalised rule the points of an interior span integrate nothing alone, only those of its whole box do.
enum class InteriorPoints {
  Model, ///< the model's own points, whatever the rule: for sums over all spans
  Gauss  ///< p + 1 Gauss points a direction where the rule stands for boxes: exact in every single span
};
/// Quadrature points of the a-th active span as matrices see them, and Gauss points of the fictitious material where
/// the span has a share of it.
SpanPoints span_points(const SolutionSpace& space, std::int64_t a, SpanPointStorage& storage,
                       InteriorPoints interior = InteriorPoints::Model);
/// True where span_points gives an interior span's points anew.
bool replaces_points(const TrimmedModel& model, std::int64_t a, InteriorPoints interior);

/// The points of a cell: its rows of model().points.parameters and .weights; and those on its surface.
std::span<const double> cell_parameters(const TrimmedModel& model, std::int64_t a);
std::span<const double> cell_weights(const TrimmedModel& model, std::int64_t a);
std::span<const double> surface_parameters(const TrimmedModel& model, std::int64_t a);

} // namespace iga::solve
