#include "solver/explicit/contact/contact_model.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// A touch counts as entered from outside where it is no deeper than the way of the last step, this much more for the
// turn of faces, …
constexpr double entry_allowance = 1.5;
// … and this much for rounding, in spans.
constexpr double entry_rounding = 1e-6;
// What begins to touch when the step has become shorter gets stiffer springs: those of a step longer than the present
// one by this, so that a step that varies a little leaves them as they are.
constexpr double step_margin = 1.1;

constexpr std::size_t chunk = 1024;          // touches whose cheap sums one thread takes
constexpr std::size_t numbers_of_touch = 15; // that a restart keeps

constexpr std::uint64_t pair_key(std::size_t pair, std::uint64_t key) {
  return static_cast<std::uint64_t>(pair) << 56 | key;
}

} // namespace

ContactModel::ContactModel(std::vector<ContactSurface> surfaces, std::vector<RigidBody> rigid,
                           std::vector<ContactPair> pairs, ContactOptions options) {
  double largest_span = 0;
  for (std::size_t b = 0; b < surfaces.size(); ++b) {
    largest_span = std::max(largest_span, surfaces[b].span_size);
    const auto touches = [&](const ContactPair& pair) {
      const auto is_it = [&](const ContactSide& s) { return s.kind == ContactSide::Kind::Deformable && s.number == b; };
      return is_it(pair.first) || is_it(pair.second);
    };
    largest_steps_.push_back(std::numeric_limits<double>::infinity());
    if (surfaces[b].wave_speed > 0 && std::any_of(pairs.begin(), pairs.end(), touches))
      largest_steps_.back() = options.step * surfaces[b].span_size / surfaces[b].wave_speed;
    last_force_.emplace_back(Eigen::VectorXd::Zero(3 * surfaces[b].S.cols()));
    surfaces_.emplace_back(std::move(surfaces[b]), b);
  }
  last_touched_.resize(last_force_.size());
  std::vector<std::ptrdiff_t> tool;
  for (RigidBody& body : rigid) {
    tool.push_back(-1);
    if (const auto* mesh = std::get_if<MeshShape>(&body.shape)) {
      tool.back() = static_cast<std::ptrdiff_t>(surfaces_.size());
      surfaces_.emplace_back(*mesh, rigid_.size(), 3 * largest_span);
    }
    rigid_.emplace_back(std::move(body));
  }
  for (ContactPair& pair : pairs) {
    report_.pairs.push_back({pair.name, {}, 0, 0, 0, {}, 0, 0, 0});
    searches_.emplace_back(std::move(pair), surfaces_, rigid_, tool, options.skin);
    report_.pairs.back().span_size = surfaces_[searches_.back().first()].span_size();
  }
  for (const MovingSurface& s : surfaces_) {
    vertex_sum_.emplace_back(s.mesh().vertices.size(), 0);
    vertex_force_.emplace_back(s.mesh().vertices.size(), Point3{});
    node_load_.emplace_back(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(s.columns().rows())));
  }
  rigid_load_.assign(rigid_.size(), 0);
}

PenaltyEnergy ContactModel::add_forces(const StepTimes& times, std::span<const BodyState> bodies) {
  lap(Phase::Loads);
  for (RigidState& body : rigid_) body.clear_force();
  report_.energy = {};
  report_.least_scale = 1;
  if (!started_ && !overlaps_are_checked_) refuse_deep_overlaps(bodies);
  look_where_stale(bodies);
  lap(Phase::Search);
  move(bodies);
  find(times);
  lap(Phase::Touches);
  if (reference_dt_ == 0 || times.dt > 1.05 * reference_dt_) share_budget(bodies, times);
  set_springs();
  keep_within_budget(bodies, times);
  want_step(times);
  apply_forces(times);
  hand_back(bodies, times);
  lap(Phase::Contact);
  started_ = true;
  return report_.energy;
}

double ContactModel::largest_step() const {
  double least = wanted_step_;
  for (const double step : largest_steps_) least = std::min(least, step);
  return least;
}

void ContactModel::advance(const StepTimes& times) {
  for (RigidState& body : rigid_) body.advance(times);
}

double ContactModel::kinetic_energy() const {
  double sum = 0;
  for (const RigidState& body : rigid_) sum += body.kinetic_energy();
  return sum;
}

double ContactModel::external_work() const {
  double sum = 0;
  for (const RigidState& body : rigid_) sum += body.external_work();
  return sum;
}

void ContactModel::look_where_stale(std::span<const BodyState> bodies) {
  std::vector<std::uint8_t> stale(searches_.size(), 0);
  std::vector<std::uint8_t> wanted(surfaces_.size(), 0);
  for (std::size_t p = 0; p < searches_.size(); ++p) {
    if (!searches_[p].may_be_stale(surfaces_, bodies, rigid_)) continue;
    stale[p] = 1;
    wanted[searches_[p].first()] = 1;
    if (searches_[p].second() != PairSearch::npos) wanted[searches_[p].second()] = 1;
  }
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (!wanted[s]) continue;
    if (surfaces_[s].is_rigid())
      surfaces_[s].move_all(rigid_[surfaces_[s].owner()]);
    else
      surfaces_[s].move_all(bodies[surfaces_[s].owner()]);
  }
  bool any = false;
  for (std::size_t p = 0; p < searches_.size(); ++p) {
    stale[p] = stale[p] && searches_[p].is_stale(surfaces_, bodies, rigid_);
    any = any || stale[p];
  }
  if (!any) return;
  std::vector<std::vector<std::uint8_t>> active;
  for (const MovingSurface& s : surfaces_) active.emplace_back(s.mesh().vertices.size(), 0);
  report_.candidates = 0;
  for (std::size_t p = 0; p < searches_.size(); ++p) {
    if (stale[p]) {
      searches_[p].look(surfaces_, bodies, rigid_, [&](std::size_t pass, std::int32_t vertex) {
        const Memory* memory = remembered(pair_key(p, vertex_key(pass, vertex)));
        return memory ? memory->depth : 0.0;
      });
      ++report_.looks;
    }
    searches_[p].mark(surfaces_, active);
    report_.candidates += static_cast<std::int64_t>(searches_[p].num_candidates());
  }
  for (std::size_t s = 0; s < surfaces_.size(); ++s) surfaces_[s].activate(std::move(active[s]));
}

void ContactModel::move(std::span<const BodyState> bodies) {
  for (MovingSurface& s : surfaces_) {
    if (s.is_rigid())
      s.move_active(rigid_[s.owner()]);
    else
      s.move_active(bodies[s.owner()]);
  }
}

// Place of the first memory with this key or a later one.
std::ptrdiff_t ContactModel::first_from(std::uint64_t key) const {
  return std::lower_bound(memory_.begin(), memory_.end(), key,
                          [](const Memory& m, std::uint64_t k) { return m.key < k; }) -
         memory_.begin();
}

const ContactModel::Memory* ContactModel::remembered(std::uint64_t key) const {
  const std::size_t place = at(first_from(key));
  return place < memory_.size() && memory_[place].key == key ? &memory_[place] : nullptr;
}

Point3 ContactModel::relative_velocity(const Touch& touch, const StepTimes& times) const {
  Point3 v{};
  for (int i = 0; i < touch.count; ++i) {
    const Touch::Entry& e = touch.entries[at(i)];
    v = plus(v, iga::times(surfaces_[e.surface].v(e.vertex), e.weight));
  }
  if (touch.rigid >= 0)
    v = plus(v, iga::times(rigid_[at(touch.rigid)].velocity_at(touch.point, times), touch.rigid_sign));
  return v;
}

void ContactModel::find(const StepTimes& times) {
  std::size_t num_pieces = 0;
  for (std::size_t p = 0; p < searches_.size(); ++p)
    for (const CandidatePiece& candidates : candidate_pieces(searches_[p])) {
      if (num_pieces == pieces_.size()) pieces_.emplace_back();
      pieces_[num_pieces].pair = p;
      pieces_[num_pieces++].candidates = candidates;
    }
  is_used_.assign(memory_.size(), 0);
  for_indices(num_pieces, 1, [&](std::size_t i) { find(pieces_[i], times); });
  std::vector<std::size_t> first{0};
  for (const FoundPiece& piece : std::span(pieces_).first(num_pieces)) {
    if (piece.too_fast) refuse(*piece.too_fast, piece.pair, piece.way, times.time);
    first.push_back(first.back() + piece.touches.size());
  }
  touches_.resize(first.back());
  pair_of_.resize(first.back());
  springs_.resize(first.back());
  next_memory_.resize(first.back());
  for_indices(num_pieces, 4, [&](std::size_t i) { take_over(pieces_[i], first[i]); });
  // What springs that are gone held in reserve.
  std::vector<double> lost(num_chunks(memory_.size(), chunk), 0);
  for_chunks(memory_.size(), chunk, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (!is_used_[k]) lost[c] += memory_[k].spring.reserve;
  });
  for (const double part : lost) report_.energy.damping += part;
  memory_.swap(next_memory_);
  at_vertices_.find(touches_, surfaces_);
  if (started_) return;
  for (const Touch& touch : touches_) {
    if (!(touch.depth > 0)) continue;
    report_.initial_depth = std::max(report_.initial_depth, touch.depth);
    ++report_.initial_touches;
  }
}

void ContactModel::refuse(const Touch& touch, std::size_t p, double way, double time) const {
  throw NumericalError(fmt::format("contact '{}' at time {:.6g}: sides move {:.3g} against each other in one "
                                   "step near ({:.6g}, {:.6g}, {:.6g}), spans are {:.3g}: they could pass each "
                                   "other; take shorter steps or look for a body that blows up",
                                   searches_[p].pair().name, time, way, touch.point[0], touch.point[1], touch.point[2],
                                   surfaces_[searches_[p].first()].span_size()));
}

void ContactModel::find(FoundPiece& piece, const StepTimes& times) {
  const PairSearch& search = searches_[piece.pair];
  const double h = surfaces_[search.first()].span_size();
  // A single step cut short, as the last one of a run, says nothing.
  const double shorter = reference_dt_ / (step_margin * std::max(times.dt, times.dt_last));
  const double factor = std::max(1.0, shorter * shorter);
  piece.touches.clear();
  piece.memory.clear();
  piece.velocity.clear();
  piece.too_fast.reset();
  std::ptrdiff_t known = -1;
  for (std::size_t k = piece.candidates.first; k < piece.candidates.last; ++k) {
    auto touch = touch_of(search, piece.candidates, k, surfaces_, rigid_);
    if (!touch) continue;
    touch->key = pair_key(piece.pair, touch->key);
    const Point3 velocity = relative_velocity(*touch, times);
    const double way = norm(velocity) * (started_ ? times.dt_last : 0);
    if (way > longest_step * h) {
      piece.too_fast = touch;
      piece.way = way;
      return;
    }
    // Both ascend.
    if (known < 0) known = first_from(touch->key);
    while (at(known) < memory_.size() && memory_[at(known)].key < touch->key) ++known;
    Memory memory;
    if (!remember(piece.pair, *touch, way, factor, at(known), memory)) continue;
    piece.touches.push_back(*touch);
    piece.memory.push_back(memory);
    piece.velocity.push_back(velocity);
  }
}

// Does the touch count, and what is known of it?
bool ContactModel::remember(std::size_t p, const Touch& touch, double way, double factor, std::size_t place,
                            Memory& memory) {
  const double h = surfaces_[searches_[p].first()].span_size();
  const double entered = entry_allowance * way + entry_rounding * h;
  if (place < memory_.size() && memory_[place].key == touch.key) {
    is_used_[place] = 1;
    memory = memory_[place];
    memory.baseline = std::min(memory.baseline, touch.depth);
    SpringEnergy& spring = memory.spring;
    // Depth that no motion explains, because another face is the nearest one now, is no work put into the spring.
    spring.shift += std::max(0.0, touch.depth - memory.depth - entered);
    spring.shift = std::min(spring.shift, touch.depth - memory.baseline);
    memory.depth = touch.depth;
    memory.area = std::max(memory.area, touch.area);
    return true;
  }
  memory = {touch.key, {}, 0, touch.depth, 0, factor, touch.area, {}};
  const bool from_outside = started_ && touch.depth <= entered;
  // A vertex of the same body that did not come from outside lies on the far side of its own wall.
  if (!from_outside && searches_[p].is_self()) return false;
  if (!from_outside) memory.baseline = started_ ? touch.depth - entered : touch.depth;
  return true;
}

void ContactModel::take_over(const FoundPiece& piece, std::size_t first) {
  for (std::size_t k = 0; k < piece.touches.size(); ++k) {
    touches_[first + k] = piece.touches[k];
    next_memory_[first + k] = piece.memory[k];
    pair_of_[first + k] = piece.pair;
    springs_[first + k] = {};
    springs_[first + k].velocity = piece.velocity[k];
  }
}

std::vector<SavedArray> ContactModel::save() const {
  std::vector<SavedArray> arrays{{"contact/numbers", {started_ ? 1.0 : 0.0, reference_dt_, wanted_step_}, 0}};
  for (const RigidState& body : rigid_) arrays.push_back({"rigid_bodies/" + body.body().name, body.save(), 0});
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (surfaces_[s].is_rigid()) continue;
    std::vector<double> density(surfaces_[s].mesh().vertices.size(), 0);
    if (!density_.empty()) density = density_[s];
    arrays.push_back({"contact/density/" + surfaces_[s].name(), std::move(density), 0});
    const Eigen::VectorXd& f = last_force_[surfaces_[s].owner()];
    arrays.push_back({"contact/last_force/" + surfaces_[s].name(), {f.data(), f.data() + f.size()}, 0});
  }
  std::vector<double> touches;
  for (const Memory& m : memory_) {
    // A key has fewer than 64 bits but more than the 53 of a double: in two halves.
    touches.push_back(static_cast<double>(m.key >> 32));
    touches.push_back(static_cast<double>(m.key & 0xffffffffu));
    touches.insert(touches.end(), m.traction.begin(), m.traction.end());
    touches.insert(touches.end(), {m.baseline, m.depth, m.sliding, m.factor, m.area});
    const SpringEnergy& spring = m.spring;
    touches.insert(touches.end(), {spring.elastic, spring.shift, spring.stored, spring.reserve, spring.largest_ratio});
  }
  arrays.push_back({"contact/touches", std::move(touches), numbers_of_touch});
  return arrays;
}

void ContactModel::load(std::span<const SavedArray> arrays) {
  auto next = arrays.begin();
  started_ = next->values[0] > 0;
  reference_dt_ = next->values[1];
  wanted_step_ = next->values[2];
  for (RigidState& body : rigid_) body.restore((++next)->values);
  density_.assign(surfaces_.size(), {});
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (surfaces_[s].is_rigid()) continue;
    density_[s] = (++next)->values;
    Eigen::VectorXd& f = last_force_[surfaces_[s].owner()];
    f = Eigen::Map<const Eigen::VectorXd>((++next)->values.data(), f.size());
    last_touched_[surfaces_[s].owner()].clear();
  }
  memory_.clear();
  const std::vector<double>& touches = (++next)->values;
  for (std::size_t k = 0; k < touches.size(); k += numbers_of_touch)
    memory_.push_back({static_cast<std::uint64_t>(touches[k]) << 32 | static_cast<std::uint64_t>(touches[k + 1]),
                       {touches[k + 2], touches[k + 3], touches[k + 4]},
                       touches[k + 5],
                       touches[k + 6],
                       touches[k + 7],
                       touches[k + 8],
                       touches[k + 9],
                       {touches[k + 10], touches[k + 11], touches[k + 12], touches[k + 13], touches[k + 14]}});
  for (PairSearch& search : searches_) search.expire();
}

} // namespace iga::solve
