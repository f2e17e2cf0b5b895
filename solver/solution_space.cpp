#include "solver/solution_space.hpp"

#include "format/model/errors.hpp"
#include "solver/light_functions.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

struct LocalSpace {
  std::vector<std::int32_t> nodes;
  Eigen::MatrixXd extension; // empty where the nodes are the span's own functions
};

} // namespace

SolutionSpace::SolutionSpace(const TrimmedModel& model, const LightTreatment& treatment)
    : model_(&model), treatment_(treatment) {
  const std::vector<std::int64_t> rows = function_rows(model);
  LightFunctionPlan plan = plan_light_functions(model, rows, treatment);
  warnings_ = std::move(plan.warnings);
  num_light_ = static_cast<std::int64_t>(plan.slaves.size());

  const std::size_t num_functions = model.active_functions.size();
  std::vector<std::int32_t> slave_of(num_functions, -1), node_of(num_functions, -1);
  for (std::size_t s = 0; s < plan.slaves.size(); ++s)
    slave_of[static_cast<std::size_t>(plan.slaves[s].function)] = static_cast<std::int32_t>(s);
  for (std::size_t f = 0; f < num_functions; ++f)
    if (slave_of[f] < 0) {
      node_of[f] = static_cast<std::int32_t>(node_function_.size());
      node_function_.push_back(static_cast<std::int64_t>(f));
    }
  if (node_function_.empty())
    throw InputError(fmt::format("all {} functions are light (mass fraction below {:.3g}) and removed; lower the "
                                 "threshold or choose smaller spans",
                                 num_functions, treatment.threshold));

  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t f = 0; f < num_functions; ++f) {
    const auto row = static_cast<std::int32_t>(f);
    if (node_of[f] >= 0)
      entries.emplace_back(row, node_of[f], 1.0);
    else
      for (const auto& [master, weight] : plan.slaves[static_cast<std::size_t>(slave_of[f])].masters)
        entries.emplace_back(row, node_of[static_cast<std::size_t>(master)], weight);
  }
  extension_.resize(static_cast<Eigen::Index>(num_functions), static_cast<Eigen::Index>(node_function_.size()));
  extension_.setFromTriplets(entries.begin(), entries.end());

  const auto p = model.grid.degree();
  const std::size_t row_count = static_cast<std::size_t>((p[1] + 1) * (p[2] + 1));
  const std::size_t width = static_cast<std::size_t>(p[0]) + 1;
  std::vector<LocalSpace> local(model.active.size());
  tbb::parallel_for(std::size_t{0}, local.size(), [&](std::size_t a) {
    std::vector<std::int64_t> functions;
    for (std::size_t r = 0; r < row_count; ++r)
      for (std::size_t i = 0; i < width; ++i)
        functions.push_back(rows[a * row_count + r] + static_cast<std::int64_t>(i));
    bool plain = true;
    auto& nodes = local[a].nodes;
    for (const std::int64_t f : functions) {
      plain = plain && node_of[static_cast<std::size_t>(f)] >= 0;
      for (decltype(extension_)::InnerIterator it(extension_, static_cast<Eigen::Index>(f)); it; ++it)
        nodes.push_back(static_cast<std::int32_t>(it.col()));
    }
    if (plain) return;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    auto& E = local[a].extension;
    E.setZero(static_cast<Eigen::Index>(functions.size()), static_cast<Eigen::Index>(nodes.size()));
    for (std::size_t f = 0; f < functions.size(); ++f)
      for (decltype(extension_)::InnerIterator it(extension_, static_cast<Eigen::Index>(functions[f])); it; ++it)
        E(static_cast<Eigen::Index>(f),
          std::lower_bound(nodes.begin(), nodes.end(), static_cast<std::int32_t>(it.col())) - nodes.begin()) =
            it.value();
  });

  offsets_.push_back(0);
  local_extensions_.emplace_back();
  for (auto& [nodes, E] : local) {
    nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
    offsets_.push_back(static_cast<std::int64_t>(nodes_.size()));
    local_extension_index_.push_back(0);
    if (E.rows() == 0) continue;
    local_extension_index_.back() = static_cast<std::int32_t>(local_extensions_.size());
    local_extensions_.push_back(std::move(E));
  }
}

const Eigen::MatrixXd& SolutionSpace::local_extension(std::int64_t a) const {
  return local_extensions_[static_cast<std::size_t>(local_extension_index_[static_cast<std::size_t>(a)])];
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> SolutionSpace::node_points() const {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(num_nodes(), 3);
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    const std::int64_t f =
        model_->active_functions[static_cast<std::size_t>(node_function_[static_cast<std::size_t>(n)])];
    const Point3 x = model_->grid.control_point(model_->grid.function_index(f));
    points.row(n) << x[0], x[1], x[2];
  }
  return points;
}

Eigen::VectorXd SolutionSpace::expand(const Eigen::Ref<const Eigen::VectorXd>& unknowns) const {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Eigen::Map<const Rows> nodes(unknowns.data(), num_nodes(), 3);
  Eigen::VectorXd all(3 * extension_.rows());
  Eigen::Map<Rows>(all.data(), extension_.rows(), 3).noalias() = extension_ * nodes;
  return all;
}

} // namespace iga::solve
