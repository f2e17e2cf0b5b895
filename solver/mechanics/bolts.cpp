#include "solver/mechanics/bolts.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/run_tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

constexpr double spans_of_shank = 4;
// Sections smaller than this share of a span's face are rounding.
constexpr double no_section = 1e-9;

class Shortening : public StrainField {
 public:
  Shortening(const Bolt& bolt, const SolutionSpace& space) : space_(space), axis_(bolt.axis), boxed_(bolt.box) {
    const TrimmedModel& model = space.model();
    const Point3 h = model.grid.span_size();
    const double length = bolt.length.value_or(spans_of_shank * *std::max_element(h.begin(), h.end()));
    const auto points = space.node_points();
    step_.resize(points.rows());
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const double d = dot(minus({points(i, 0), points(i, 1), points(i, 2)}, bolt.point), bolt.axis) / length;
      step_[i] = std::abs(d) < 0.5 ? 0.5 + d + std::sin(2 * std::numbers::pi * d) / (2 * std::numbers::pi) : (d > 0);
    }
    for (std::int64_t a = 0; a < space.num_cells(); ++a)
      inside_.push_back(!bolt.box || holds(*bolt.box, middle(model, a)));
  }

  Strains at(std::int64_t cell, std::span<const double> parameters) const override {
    Strains all = Strains::Zero(static_cast<Eigen::Index>(parameters.size() / 3), 6);
    if (!inside_[static_cast<std::size_t>(cell)]) return all;
    const auto nodes = space_.nodes(cell);
    const double first = nodes.empty() ? 0 : step_[nodes[0]];
    if (std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return step_[n] == first; })) return all;
    SpanShapes shapes;
    evaluate(space_, cell, parameters, Shapes::Gradients, shapes);
    for (Eigen::Index q = 0; q < all.rows(); ++q) {
      Eigen::Vector3d slope = Eigen::Vector3d::Zero(); // of S
      for (std::size_t i = 0; i < nodes.size(); ++i)
        slope +=
            (step_[nodes[i]] - first) * shapes.gradients.block<1, 3>(q, 3 * static_cast<Eigen::Index>(i)).transpose();
      for (std::size_t i = 0; i < 3; ++i) // -(n ⊗ ∇S + ∇S ⊗ n) / 2, shears twice
        for (std::size_t j = 0; j < 3; ++j)
          all(q, voigt_place[i][j]) -=
              (i == j ? 1 : 0.5) * (axis_[i] * slope[static_cast<Eigen::Index>(j)] +
                                    (i == j ? 0 : axis_[j] * slope[static_cast<Eigen::Index>(i)]));
    }
    return all;
  }
  bool is_smooth() const override { return !boxed_; }

 private:
  static bool holds(const Box3& box, const Point3& x) {
    for (std::size_t d = 0; d < 3; ++d)
      if (x[d] < box.lower[d] || x[d] > box.upper[d]) return false;
    return true;
  }
  // Of a cell's material; several cells of one span are told apart by it.
  static Point3 middle(const TrimmedModel& model, std::int64_t cell) {
    const auto parameters = cell_parameters(model, cell), weights = cell_weights(model, cell);
    const Box3 box = model.grid.span_box(model.grid.span_index(model.cells.span[static_cast<std::size_t>(cell)]));
    Point3 sum{};
    double volume = 0;
    for (std::size_t q = 0; q < weights.size(); ++q) {
      sum = plus(sum, times({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]}, weights[q]));
      volume += weights[q];
    }
    return model.grid.to_position(volume > 0 ? times(sum, 1 / volume) : times(plus(box.lower, box.upper), 0.5));
  }

  const SolutionSpace& space_;
  Point3 axis_;
  bool boxed_;
  Eigen::VectorXd step_;     // (num_nodes)
  std::vector<bool> inside_; // by cell: within the box
};

} // namespace

std::vector<io::TableKeys> bolt_keys() {
  return {{"bolt", {"name", "body", "force", "length", "box"}}, {"bolt.plane", {"point", "normal"}}};
}

std::vector<Bolt> read_bolts(io::SettingsTable& root) {
  std::vector<Bolt> bolts;
  for (io::SettingsTable& table : root.tables("bolt")) {
    Bolt bolt;
    bolt.name = table.text("name").value_or(fmt::format("bolt {}", bolts.size() + 1));
    bolt.body = table.text("body").value_or("");
    io::SettingsTable plane = table.table("plane");
    bolt.point = need_vector(plane, "point", "a point of the plane across the shank");
    bolt.axis = unit_vector(plane, "normal", need_vector(plane, "normal", "the direction of the shank"));
    bolt.force = need_number(table, "force", "the tension of the bolt");
    if (const auto length = table.number("length")) {
      if (!(*length > 0)) refuse(table, "length", fmt::format("found {:g}, expected a length above 0", *length));
      bolt.length = *length;
    }
    if (const auto box = table.numbers("box", {6}))
      bolt.box = Box3{{(*box)[0], (*box)[1], (*box)[2]}, {(*box)[3], (*box)[4], (*box)[5]}};
    for (const Bolt& other : bolts)
      if (other.name == bolt.name)
        refuse(table, "name", fmt::format("there is another bolt '{}'; give each a name of its own", bolt.name));
    bolts.push_back(std::move(bolt));
  }
  return bolts;
}

std::shared_ptr<const StrainField> shortening(const Bolt& bolt, const SolutionSpace& space) {
  return std::make_shared<Shortening>(bolt, space);
}

double shank_section(const Bolt& bolt, const StrainField& shortening, const TrimmedModel& model) {
  // The stress n ⊗ n as if it were that of a field.
  const Point3& n = bolt.axis;
  double section = 0;
  std::size_t q = 0;
  for (std::int64_t a = 0; a < static_cast<std::int64_t>(model.num_cells()); ++a) {
    const Strains strain = shortening.at(a, cell_parameters(model, a));
    for (Eigen::Index i = 0; i < strain.rows(); ++i, ++q)
      section -= model.points.weights[q] *
                 (strain(i, 0) * n[0] * n[0] + strain(i, 1) * n[1] * n[1] + strain(i, 2) * n[2] * n[2] +
                  strain(i, 3) * n[0] * n[1] + strain(i, 4) * n[1] * n[2] + strain(i, 5) * n[2] * n[0]);
  }
  const Point3 h = model.grid.span_size();
  if (!(section > no_section * h[0] * h[0]))
    throw InputError(
        fmt::format("bolt '{}': the part has no material at its plane{}; check point, normal and box, in the "
                    "model's length unit and axes",
                    bolt.name, bolt.box ? " within the box" : ""));
  return section;
}

double section_force(const StrainField& shortening, const TrimmedModel& model, const FieldSamples& fields) {
  double force = 0;
  std::size_t q = 0;
  for (std::int64_t a = 0; a < static_cast<std::int64_t>(model.num_cells()); ++a) {
    const Strains strain = shortening.at(a, cell_parameters(model, a));
    for (Eigen::Index i = 0; i < strain.rows(); ++i, ++q)
      force -=
          model.points.weights[q] * strain.row(i).dot(Eigen::Map<const Eigen::RowVectorXd>(&fields.stress[6 * q], 6));
  }
  return force;
}

} // namespace iga::solve
