#include "solver/explicit/laws/material_settings.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <initializer_list>
#include <map>

namespace iga::solve {

namespace {

// Keys of each law beside those that all of them share.
const std::vector<std::string> elastic_keys{"E", "nu"}, inversion_keys{"inversion", "min_volume_ratio"};
const std::map<std::string, std::vector<std::string>> law_keys{
    {"linear-elastic", {"C"}},
    {"st-venant-kirchhoff", {}},
    {"neo-hookean", {}},
    {"j2", {"yield_stress", "hardening_modulus", "yield_curve", "rate_law", "rate_reference", "rate_exponent"}},
    {"crushable-foam", {"yield_curve", "tension_limit", "damping", "modulus"}},
    {"elliptic-foam",
     {"yield_curve", "plastic_nu", "plateau", "hardening_linear", "hardening_log", "hardening_power",
      "densification_strain"}}};

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const auto& [name, keys] : law_keys) names.push_back(name);
  return names;
}

// Messages that a law opens with "material:" get the place in the file instead.
template <class Make> auto at(const std::string& where, Make make) {
  try {
    return make();
  } catch (const InputError& error) {
    const std::string message = error.what();
    constexpr std::string_view opening = "material: ";
    if (!message.starts_with(opening)) throw; // names its place itself
    throw InputError(fmt::format("{}: {}", where, message.substr(opening.size())));
  }
}

class Reader {
 public:
  Reader(io::SettingsTable& table, const std::optional<MaterialDefaults>& named) : table_(table) {
    name_ = choose("law", table_.text("law").value_or("neo-hookean"), law_names());
    read_all_keys();
    refuse_keys_of_other_laws();
    if (!named) return;
    if (C_ && named->E)
      throw InputError(fmt::format("{}: give either a name or a matrix C, not both", table_.where("name")));
    if (named->E) numbers_.try_emplace("E", *named->E);
    if (named->nu) numbers_.try_emplace("nu", *named->nu);
    if (named->rho) numbers_.try_emplace("rho", *named->rho);
  }

  MaterialSettings read() {
    MaterialSettings m{.law = NeoHookean{}, .inversion = inversion(default_ratio()), .name = name_, .warnings = {}};
    at(table_.where(name_ == "linear-elastic" && C_ ? "C" : "law"), [&] { m.law = make(m.warnings); });
    const auto viscosity = table_.numbers("bulk_viscosity", {2});
    if (!viscosity) return m;
    const auto& Q = *viscosity;
    if (!(Q[0] >= 0 && Q[1] >= 0 && Q[0] <= 10 && Q[1] <= 1))
      throw InputError(fmt::format("{}: found [{}, {}], expected [Q1, Q2] with Q1 in 0 … 10 and Q2 in 0 … 1, usually "
                                   "[1.5, 0.06]",
                                   table_.where("bulk_viscosity"), Q[0], Q[1]));
    if (Q[0] > 0 || Q[1] > 0)
      m.law = std::visit([&](const auto& law) { return with_viscosity(law, Q[0], Q[1]); }, m.law);
    return m;
  }

 private:
  template <class L> static Law with_viscosity(const L& law, double Q1, double Q2) {
    return BulkViscosity<L>{.law = law, .quadratic = Q1, .linear = Q2};
  }
  template <class L> static Law with_viscosity(const BulkViscosity<L>& law, double, double) { return law; }

  std::string choose(const char* key, const std::string& word, const std::vector<std::string>& known) const {
    if (std::find(known.begin(), known.end(), word) != known.end()) return word;
    const auto near = io::nearest_name(word, known);
    throw InputError(fmt::format("{}: found \"{}\", expected one of {}{}", table_.where(key), word,
                                 fmt::join(known, ", "), near ? fmt::format("; did you mean {}?", *near) : ""));
  }

  void read_all_keys() {
    for (const char* key : {"E", "nu", "rho", "min_volume_ratio", "yield_stress", "hardening_modulus", "rate_reference",
                            "rate_exponent", "tension_limit", "damping", "plastic_nu", "plateau", "hardening_linear",
                            "hardening_log", "hardening_power", "densification_strain"})
      if (const auto value = table_.number(key)) numbers_[key] = *value;
    for (const char* key : {"rate_law", "modulus", "inversion"})
      if (const auto value = table_.text(key)) words_[key] = *value;
    C_ = table_.numbers("C", {21, 36});
    if (table_.holds_text("yield_curve")) {
      const auto file = table_.path("yield_curve");
      curve_ = at(table_.where("yield_curve"), [&] { return Curve::read_csv(*file); });
    } else if (const auto rows = table_.rows("yield_curve", 2)) {
      std::vector<double> x, y;
      for (const auto& row : *rows) {
        x.push_back(row[0]);
        y.push_back(row[1]);
      }
      curve_ = Curve(std::move(x), std::move(y), table_.where("yield_curve"));
    }
  }

  bool given(const std::string& key) const {
    return numbers_.contains(key) || words_.contains(key) || (key == "C" && C_) || (key == "yield_curve" && curve_);
  }

  void refuse_keys_of_other_laws() const {
    std::vector<std::string> mine = law_keys.at(name_);
    mine.insert(mine.end(), elastic_keys.begin(), elastic_keys.end());
    if (name_ != "linear-elastic") mine.insert(mine.end(), inversion_keys.begin(), inversion_keys.end());
    std::vector<std::string> all = inversion_keys;
    for (const auto& [law, keys] : law_keys) all.insert(all.end(), keys.begin(), keys.end());
    for (const std::string& key : all)
      if (given(key) && std::find(mine.begin(), mine.end(), key) == mine.end())
        throw InputError(fmt::format("{}: the law \"{}\" does not take it; its keys are rho, {}", table_.where(key),
                                     name_, fmt::join(mine, ", ")));
  }

  double need(const char* key, const char* what) const {
    if (const auto found = numbers_.find(key); found != numbers_.end()) return found->second;
    throw InputError(fmt::format("{}: missing; the law \"{}\" needs {}", table_.where(key), name_, what));
  }
  double number(const char* key, double otherwise) const {
    const auto found = numbers_.find(key);
    return found == numbers_.end() ? otherwise : found->second;
  }
  std::string word(const char* key, const char* otherwise) const {
    const auto found = words_.find(key);
    return found == words_.end() ? otherwise : found->second;
  }

  Law make(std::vector<std::string>& warnings) const {
    const double rho = need("rho", "a density, mass per length³");
    if (C_) {
      if (given("E") || given("nu"))
        throw InputError(fmt::format("{}: give either C or E and nu, not both", table_.where("C")));
      return LinearElastic(anisotropic(voigt_matrix(*C_), rho));
    }
    const double E = need("E", "Young's modulus, force per length²"), nu = need("nu", "Poisson's ratio");
    if (name_ == "linear-elastic") return LinearElastic(isotropic(E, nu, rho));
    if (name_ == "st-venant-kirchhoff") return st_venant_kirchhoff(E, nu, rho, inversion(default_ratio()));
    if (name_ == "neo-hookean") return neo_hookean(E, nu, rho, inversion(default_ratio()));
    if (name_ == "j2")
      return J2Plasticity(J2Settings{.E = E,
                                     .nu = nu,
                                     .density = rho,
                                     .yield = hardening(),
                                     .rate = rate_factor(),
                                     .inversion = inversion(default_ratio())});
    if (name_ == "crushable-foam") return crushable_foam(E, nu, rho, warnings);
    return elliptic_foam(E, nu, rho);
  }

  // Foams are meant to be crushed further.
  double default_ratio() const { return name_.ends_with("foam") ? 0.02 : 0.05; }

  InversionPolicy inversion(double smallest_J) const {
    const std::string action = choose("inversion", word("inversion", "clamp"), {"clamp", "erode", "stop"});
    const double ratio = number("min_volume_ratio", smallest_J);
    if (!(ratio >= 1e-3 && ratio < 1))
      throw InputError(fmt::format("{}: found {}, expected a volume ratio V/V0 from 0.001 to below 1",
                                   table_.where("min_volume_ratio"), ratio));
    return {.action = action == "erode"  ? InvertedPoints::Erode
                      : action == "stop" ? InvertedPoints::Stop
                                         : InvertedPoints::Clamp,
            .smallest_J = ratio};
  }

  Curve hardening() const {
    if (curve_ && (given("yield_stress") || given("hardening_modulus")))
      throw InputError(fmt::format("{}: give either yield_curve or yield_stress (and hardening_modulus), not both",
                                   table_.where("yield_curve")));
    if (curve_) return *curve_;
    const double Y = need("yield_stress", "a yield stress, or a yield_curve over the plastic strain");
    return {{0, 1}, {Y, Y + number("hardening_modulus", 0)}, table_.where("yield_stress")};
  }

  RateFactor rate_factor() const {
    const std::string law = choose("rate_law", word("rate_law", "none"), {"none", "cowper-symonds", "johnson-cook"});
    if (law == "none") {
      for (const char* key : {"rate_reference", "rate_exponent"})
        if (given(key))
          throw InputError(
              fmt::format("{}: given without a rate_law; choose cowper-symonds or johnson-cook", table_.where(key)));
      return {};
    }
    const bool cowper = law == "cowper-symonds";
    return {.kind = cowper ? RateFactor::Kind::CowperSymonds : RateFactor::Kind::JohnsonCook,
            .rate =
                need("rate_reference", "a rate_reference, 1/time: D of Cowper and Symonds or ε̇0 of Johnson and Cook"),
            .exponent = need("rate_exponent", cowper ? "a rate_exponent: q of Cowper and Symonds"
                                                     : "a rate_exponent: C of Johnson and Cook")};
  }

  Law crushable_foam(double E, double nu, double rho, std::vector<std::string>& warnings) const {
    if (!curve_)
      throw InputError(fmt::format("{}: missing; the law \"{}\" needs the yield stress over the volumetric strain "
                                   "1 - V/V0, as a list of pairs or the name of a CSV file",
                                   table_.where("yield_curve"), name_));
    const std::string modulus = choose("modulus", word("modulus", "E"), {"E", "lcid_final_slope"});
    const CrushableFoam foam({.E = E,
                              .nu = nu,
                              .density = rho,
                              .yield = *curve_,
                              .tension_limit = number("tension_limit", 0),
                              .damping = number("damping", 0),
                              .modulus = modulus == "E" ? FoamModulus::E : FoamModulus::FinalSlope,
                              .inversion = inversion(default_ratio())});
    if (const auto warning = foam.warning())
      warnings.push_back(fmt::format("{}: {}", table_.where("yield_curve"), *warning));
    return foam;
  }

  Law elliptic_foam(double E, double nu, double rho) const {
    EllipticFoamSettings s{.E = E,
                           .nu = nu,
                           .density = rho,
                           .plastic_nu = number("plastic_nu", 0),
                           .inversion = inversion(default_ratio())};
    const bool formula = given("plateau") || given("hardening_linear") || given("hardening_log") ||
                         given("hardening_power") || given("densification_strain");
    if (curve_ && formula)
      throw InputError(fmt::format("{}: give either yield_curve or plateau and the hardening constants, not both",
                                   table_.where("yield_curve")));
    if (curve_)
      s.yield = *curve_;
    else
      s.yield = DensificationHardening{
          .plateau =
              need("plateau", "a plateau stress with hardening constants, or a yield_curve over the plastic strain"),
          .linear = number("hardening_linear", 0),
          .log = number("hardening_log", 0),
          .power = number("hardening_power", 1),
          .densification_strain = number("densification_strain", 1)};
    return EllipticFoam(s);
  }

  io::SettingsTable& table_;
  std::string name_;
  std::map<std::string, double> numbers_;
  std::map<std::string, std::string> words_;
  std::optional<std::vector<double>> C_;
  std::optional<Curve> curve_;
};

} // namespace

std::vector<std::string> material_keys() {
  std::vector<std::string> keys{"law", "name", "rho", "bulk_viscosity"};
  for (const auto& own : {elastic_keys, inversion_keys}) keys.insert(keys.end(), own.begin(), own.end());
  for (const auto& [law, own] : law_keys) keys.insert(keys.end(), own.begin(), own.end());
  return keys;
}

MaterialSettings read_material(io::SettingsTable& table, const std::optional<MaterialDefaults>& named) {
  return Reader(table, named).read();
}

} // namespace iga::solve
