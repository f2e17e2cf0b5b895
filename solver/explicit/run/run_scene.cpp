#include "solver/explicit/run/run_scene.hpp"

#include "format/io/interrupt.hpp"
#include "format/io/settings_reader.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "format/model/glue_gap_ends.hpp"
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/contact_surface.hpp"
#include "solver/explicit/motion/rotational_inertia.hpp"
#include "solver/report/model_notes.hpp"
#include "solver/report/model_summary.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace iga::solve {

namespace {

// Of the budget of stability of a node, supports of a run with contact leave a quarter: springs of theirs are as stiff
// as ever on a flat face of a solid, and walls thinner than a span, all of whose nodes they hold, can touch.
constexpr double beside_contact = 0.75;

// What is wrong gets the place in the run file where it was asked for.
template <class Make> auto at(const std::string& where, Make make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", where, error.what()));
  }
}

double density_of(const BodyRun& body) {
  return std::visit([](const auto& law) { return static_cast<double>(law.density); }, body.material.law);
}

void check_regions(const std::string& where, const ContactSide& side, const std::vector<ContactSurface>& surfaces) {
  if (side.kind == ContactSide::Kind::Rigid) return;
  const TriangleMesh& mesh = surfaces[side.number].mesh;
  for (const std::string& name : side.regions) {
    const auto& known = mesh.region_names;
    const auto found = std::find(known.begin(), known.end(), name);
    const auto near = io::nearest_name(name, known);
    if (found == known.end())
      throw InputError(fmt::format("{}: body '{}' has no region '{}'{}; its regions: {}", where,
                                   surfaces[side.number].body, name,
                                   near ? fmt::format(", did you mean '{}'?", *near) : "", fmt::join(known, ", ")));
    if (std::find(mesh.region.begin(), mesh.region.end(), found - known.begin()) == mesh.region.end())
      throw InputError(
          fmt::format("{}: region '{}' of body '{}' holds no triangle", where, name, surfaces[side.number].body));
  }
}

} // namespace

ExplicitScene::ExplicitScene(const ExplicitRun& run) : run_(run), warnings_(run.warnings) {
  add_bodies();
  add_loads();
  add_contact();
  warn_of_inertia();
}

// Of bodies that turn, or that nothing keeps from turning.
void ExplicitScene::warn_of_inertia() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const bool is_held = std::any_of(run_.supports.begin(), run_.supports.end(),
                                     [b](const SupportRun& support) { return support.body == b; });
    if (is_held && run_.bodies[b].spin == Point3{}) continue;
    if (const auto warning = inertia_warning(*bodies_[b], run_.bodies[b].spin)) warnings_.push_back(*warning);
  }
}

void ExplicitScene::add_bodies() {
  for (const BodyRun& body : run_.bodies) {
    io::stop_if_interrupted();
    models_.push_back(std::make_unique<TrimmedModel>(io::read_model(body.model)));
    if (body.place != Placement{}) *models_.back() = placed(std::move(*models_.back()), body.place);
    // Light functions beside the end of a gap stay on their own, and a spring may be no stiffer than their masses
    // allow: contact would be far too soft there.
    const std::int64_t glued = run_.contacts.empty() ? 0 : count_cells(*models_.back()).gap_end_cells;
    if (glued > 0) *models_.back() = glue_gap_ends(std::move(*models_.back()));
    const TrimmedModel& model = *models_.back();
    if (run_.units && *run_.units != model.length_unit)
      throw InputError(fmt::format("{}: the length unit of {} is \"{}\", but the run says \"{}\"; convert the material "
                                   "and the loads, or make the model with igaprep --length-unit {}",
                                   body.where, body.model.string(), model.length_unit, *run_.units, *run_.units));
    at(body.where, [&] {
      bodies_.push_back(std::make_unique<ExplicitBody>(model, body.body, body.material.law));
      return 0;
    });
    if (body.velocity != Point3{} || body.spin != Point3{})
      bodies_.back()->set_rigid_velocity(body.velocity, body.spin, body.centre ? *body.centre : centre_of_mass(model));
    const std::string subject = fmt::format("body '{}'", body.body.name);
    const auto add = [&](std::vector<std::string>& to, const std::vector<std::string>& texts) {
      const auto named = prefixed(subject, texts);
      to.insert(to.end(), named.begin(), named.end());
    };
    if (body.words) add(findings_, {material_text(*body.words, summarise(model).volume)});
    add(findings_, model.provenance.findings);
    if (glued > 0) add(findings_, {glued_gap_ends_note(glued, model)});
    if (const auto note = gap_end_note(model)) add(findings_, {*note});
    add(warnings_, model_warnings(model, &bodies_.back()->small_strain()));
    add(warnings_, bodies_.back()->space().warnings());
    if (const auto warning = joined_bodies_warning(bodies_.back()->space())) add(warnings_, {*warning});
  }
}

void ExplicitScene::add_loads() {
  for (const LoadRun& load : run_.loads) {
    loads_.push_back(at(load.where, [&] {
      return std::make_unique<TimedLoads>(bodies_[load.body]->space(), load.body, density_of(run_.bodies[load.body]),
                                          std::vector{load.load});
    }));
    for (const LoadReport& report : loads_.back()->reports()) load_reports_.push_back(report);
    const auto of_places = region_warnings(loads_.back()->reports());
    warnings_.insert(warnings_.end(), of_places.begin(), of_places.end());
  }
  for (const SupportRun& support : run_.supports)
    supports_.push_back(at(support.where, [&] {
      DrivenRegion region = support.region;
      if (!run_.contacts.empty()) region.budget_share = beside_contact;
      return std::make_unique<RegionDrive>(bodies_[support.body]->space(), support.body,
                                           density_of(run_.bodies[support.body]), std::move(region));
    }));
}

void ExplicitScene::add_contact() {
  if (run_.rigid.empty() && run_.contacts.empty()) return;
  std::vector<ContactSurface> surfaces;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    surfaces.push_back(at(run_.bodies[b].where, [&] {
      io::stop_if_interrupted();
      const BodyRun& body = run_.bodies[b];
      MergedEdges merged;
      ContactSurface surface = make_contact_surface(bodies_[b]->space(), body.body.name, density_of(body),
                                                    body.edge_length, body.merge_length, &merged);
      if (merged.vertices_before > 0)
        findings_.push_back(fmt::format(
            "body '{}': contact works on {} of {} vertices, as edges below {:g} are merged; "
            "what was merged lies within {:.3g} of the triangles that stay",
            body.body.name, surface.mesh.vertices.size(), merged.vertices_before, body.merge_length, merged.deviation));
      surface.wave_speed = bodies_[b]->forces().reference_wave_speed();
      return surface;
    }));
  std::vector<RigidBody> rigid;
  for (const RigidRun& body : run_.rigid) rigid.push_back(body.body);
  std::vector<ContactPair> pairs;
  for (const ContactRun& contact : run_.contacts) {
    check_regions(contact.pair.where, contact.pair.first, surfaces);
    check_regions(contact.pair.where, contact.pair.second, surfaces);
    pairs.push_back(contact.pair);
  }
  io::stop_if_interrupted();
  contact_ = at(run_.file.string(), [&] {
    return std::make_unique<ContactModel>(std::move(surfaces), std::move(rigid), std::move(pairs), run_.contact);
  });
}

void ExplicitScene::check_start() {
  if (!contact_) return;
  io::stop_if_interrupted();
  std::vector<BodyState> states(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) states[b].displacement = &bodies_[b]->displacement;
  contact_->refuse_deep_overlaps(states);
}

void ExplicitScene::find_limits() {
  for (const auto& body : bodies_) {
    io::stop_if_interrupted();
    limits_.push_back(body->start_step());
  }
  check_speeds();
}

ExplicitScene::MovingBox ExplicitScene::side_at_start(const ContactSide& side) const {
  if (side.kind == ContactSide::Kind::Deformable) {
    const ExplicitBody& body = *bodies_[side.number];
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
    for (Eigen::Index n = 0; n < body.space().num_nodes(); ++n) momentum += body.momentum.segment<3>(3 * n);
    return {bounding_box(body.space().model().surface.mesh), momentum / body.mass().total()};
  }
  const RigidBody& body = run_.rigid[side.number].body;
  const double r = bounding_radius(body.shape);
  const auto* free = std::get_if<FreeMotion>(&body.motion);
  return {{minus(body.centre, {r, r, r}), plus(body.centre, {r, r, r})},
          free ? Eigen::Vector3d(free->velocity.data()) : Eigen::Vector3d::Zero().eval()};
}

// Sides that would meet, and pass more than half a span in a step, could miss each other: contact refuses to go on
// then.
void ExplicitScene::check_speeds() const {
  double dt = run_.time.largest_dt > 0 ? run_.time.largest_dt : std::numeric_limits<double>::infinity();
  for (const StartStep& limit : limits_) dt = std::min(dt, run_.time.safety * limit.dt);
  if (contact_) dt = std::min(dt, contact_->largest_step());
  for (const ContactRun& contact : run_.contacts) {
    const ContactPair& pair = contact.pair;
    const MovingBox first = side_at_start(pair.first), second = side_at_start(pair.second);
    const Eigen::Vector3d velocity = first.velocity - second.velocity;
    const Point3 h = bodies_[pair.first.number]->space().model().grid.span_size();
    const double span = std::min({h[0], h[1], h[2]}), way = velocity.norm() * dt;
    if (way <= ContactModel::longest_step * span) continue;
    if (pair.second.kind == ContactSide::Kind::Rigid)
      if (const auto* plane = std::get_if<PlaneShape>(&run_.rigid[pair.second.number].body.shape))
        if (velocity.dot(Eigen::Vector3d(plane->normal.data())) >= 0) continue; // leaves it
    Box3 swept = first.box;                                                     // as the second side sees it
    const Eigen::Vector3d path = velocity * run_.time.end_time;
    for (std::size_t d = 0; d < 3; ++d) {
      const double along = path[static_cast<Eigen::Index>(d)];
      (along < 0 ? swept.lower : swept.upper)[d] += along;
    }
    if (!overlap(swept, second.box)) continue;
    throw InputError(
        fmt::format("{}: contact '{}': the sides move against each other at {:.4g}, which is {:.3g} spans in "
                    "a step of {:.4g}; more than {:g} could pass each other: choose a dt_max below {:.3g}, or "
                    "check the velocities",
                    pair.where, pair.name, velocity.norm(), way / span, dt, ContactModel::longest_step,
                    ContactModel::longest_step * span / velocity.norm()));
  }
}

void ExplicitScene::make_integrator() {
  IntegratorSettings settings = run_.time;
  std::size_t limiting = 0;
  for (std::size_t b = 1; b < limits_.size(); ++b)
    if (limits_[b].dt < limits_[limiting].dt) limiting = b;
  const double stable = settings.safety * limits_[limiting].dt;
  if (run_.smallest_dt > 0) {
    if (stable < run_.smallest_dt)
      throw InputError(
          fmt::format("{}: the first time step would be {:.4g} (body '{}'), below dt_min = {:g}; lower dt_min, "
                      "choose larger spans, or treat light functions",
                      run_.time_where, stable, run_.bodies[limiting].body.name, run_.smallest_dt));
    settings.floor = run_.smallest_dt / stable;
  }
  std::vector<ExplicitBody*> bodies;
  for (const auto& body : bodies_) bodies.push_back(body.get());
  integrator_ = std::make_unique<Integrator>(std::move(bodies), settings);
  for (const auto& load : loads_) integrator_->add(*load);
  for (const auto& support : supports_) integrator_->add(*support);
  if (!contact_) return;
  integrator_->add(*contact_);
  contact_->comes_last();
  contact_->use_clock(integrator_->clock());
}

void ExplicitScene::start() {
  make_integrator();
  integrator_->start(limits_);
}

void ExplicitScene::load(const IntegratorState& state, std::vector<StartStep> limits) {
  limits_ = std::move(limits);
  make_integrator();
  integrator_->load(state, limits_);
}

} // namespace iga::solve
