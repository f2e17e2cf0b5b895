#include "solver/mechanics/initial_strain.hpp"

#include "solver/mechanics/assemble.hpp"

#include <algorithm>

namespace iga::solve {

namespace {

class ThermalStrain : public StrainField {
 public:
  ThermalStrain(std::shared_ptr<const TemperatureField> temperature, double reference, double expansion)
      : temperature_(std::move(temperature)), reference_(reference), expansion_(expansion) {}

  Strains at(std::int64_t cell, std::span<const double> parameters) const override {
    const Eigen::VectorXd strain = expansion_ * (temperature_->at(cell, parameters).array() - reference_).matrix();
    Strains all = Strains::Zero(strain.size(), 6);
    for (Eigen::Index d = 0; d < 3; ++d) all.col(d) = strain;
    return all;
  }

 private:
  std::shared_ptr<const TemperatureField> temperature_;
  double reference_, expansion_;
};

class StrainSum : public StrainField {
 public:
  explicit StrainSum(std::vector<StrainShare> shares) : shares_(std::move(shares)) {}

  Strains at(std::int64_t cell, std::span<const double> parameters) const override {
    Strains all = Strains::Zero(static_cast<Eigen::Index>(parameters.size() / 3), 6);
    for (const StrainShare& share : shares_) all += share.factor * share.field->at(cell, parameters);
    return all;
  }
  bool is_smooth() const override {
    return std::all_of(shares_.begin(), shares_.end(),
                       [](const StrainShare& share) { return share.field->is_smooth(); });
  }

 private:
  std::vector<StrainShare> shares_;
};

} // namespace

std::shared_ptr<const StrainField> thermal_strain(std::shared_ptr<const TemperatureField> temperature, double reference,
                                                  double expansion) {
  return std::make_shared<ThermalStrain>(std::move(temperature), reference, expansion);
}

std::shared_ptr<const StrainField> sum_of(std::vector<StrainShare> shares) {
  std::erase_if(shares, [](const StrainShare& share) { return !share.field || share.factor == 0; });
  if (shares.empty()) return nullptr;
  if (shares.size() == 1 && shares[0].factor == 1) return shares[0].field;
  return std::make_shared<StrainSum>(std::move(shares));
}

Eigen::VectorXd initial_strain_load(const SolutionSpace& space, const ElasticMaterial& material) {
  if (!material.initial_strain) return Eigen::VectorXd::Zero(space.num_unknowns());
  return sum_over_cells(space, [&](std::int64_t cell) {
    thread_local SpanShapes shapes;
    thread_local SpanPointStorage storage;
    const auto [parameters, weights] = span_points(space, cell, storage);
    evaluate(space, cell, parameters, Shapes::Gradients, shapes);
    const Strains stress = material.initial_strain->at(cell, parameters) * material.C;
    const Eigen::Index n = shapes.gradients.cols() / 3;
    Eigen::Matrix3Xd nodal = Eigen::Matrix3Xd::Zero(3, n);
    for (Eigen::Index q = 0; q < stress.rows(); ++q) {
      const Eigen::Matrix<double, 1, 6> s = weights[static_cast<std::size_t>(q)] * stress.row(q);
      Eigen::Matrix3d tensor;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) tensor(i, j) = s[voigt_place[i][j]];
      for (Eigen::Index i = 0; i < n; ++i) nodal.col(i) += tensor * shapes.gradients.block<1, 3>(q, 3 * i).transpose();
    }
    return Eigen::MatrixXd(nodal);
  });
}

} // namespace iga::solve
