// Every setting of igaprep, once: key and flag, what help says of it, and its line in the text that tells equal
// settings. The settings file, the command line, the override of one by the other and the canonical text all come from
// here.
#pragma once

#include "preprocessor/program/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

namespace iga::prep {

/// Lines "name = value", numbers with all their digits.
struct CanonicalText {
  std::string text;

  template <class T> void line(std::string_view name, const T& value) { text += fmt::format("{} = {}\n", name, value); }
  template <class List> void list(std::string_view name, const List& values) {
    line(name, fmt::format("{}", fmt::join(values, " ")));
  }
  template <class T> void optional(std::string_view name, const std::optional<T>& value) {
    if (value) line(name, *value);
  }
};

/// Adds what a setting, validated and complete, does to the data.
using WriteCanonical = void (*)(CanonicalText&, const Settings&);
/// Of settings that the data do not depend on, or that another one's line tells.
constexpr WriteCanonical not_data = nullptr;

/// Numbers that a list may hold.
struct ListLength {
  std::size_t count = 1;
  bool or_one = false; ///< one number holds for all
};

template <class T> struct Setting {
  const char* table; ///< of the settings file, "" for its root
  const char* key;
  std::optional<T> TypedSettings::*member;
  WriteCanonical canonical;
  const char* value; ///< its name in the help, "" for the type's
  const char* help;
  ListLength length = {};
  const char* flag = nullptr; ///< where it is not "--" and the key with hyphens

  std::string flags() const {
    if (flag) return flag;
    std::string name = std::string("--") + key;
    for (char& c : name)
      if (c == '_') c = '-';
    return name;
  }
};

using Numbers = std::vector<double>;
using Integers = std::vector<std::int64_t>;
using WordOrIntegers = std::variant<std::string, Integers>;

/// visit(Setting<T>) for all settings, in the order of the canonical text.
template <class Visit> void each_setting(Visit&& visit) {
  using T = TypedSettings;
  using C = CanonicalText;
  using S = Settings;
  constexpr ListLength one_or_three{3, true};
  visit(Setting<std::filesystem::path>{"", "input", &T::input, not_data, "FILE",
                                       "Surface file, where a settings file comes first"});
  visit(Setting<std::filesystem::path>{"",
                                       "output",
                                       &T::output,
                                       not_data,
                                       "FILE",
                                       "Model file [name of the surface].h5 in the current folder",
                                       {},
                                       "-o,--output"});
  visit(Setting<double>{"", "scale", &T::scale, [](C& c, const S& s) { c.line("scale", s.scale); }, "",
                        "Factor on all coordinates [1]"});
  visit(Setting<std::string>{"", "length_unit", &T::length_unit,
                             [](C& c, const S& s) { c.line("length_unit", s.length_unit); }, "",
                             "Label of the length unit, e.g. mm; CAD files are converted to it [theirs]"});
  visit(Setting<std::string>{"", "title", &T::title, [](C& c, const S& s) { c.line("title", s.title); }, "",
                             "Title in the file [name of the surface, or of the solid]"});

  visit(Setting<double>{"cad", "chord", &T::chord, [](C& c, const S& s) { c.optional("chord", s.cad.chord); }, "",
                        "Largest distance of facets from a CAD face, length [span size / 1000]"});
  visit(Setting<std::string>{"cad", "solid", &T::solid,
                             [](C& c, const S& s) {
                               if (!s.cad.solid.empty()) c.line("solid", s.cad.solid);
                             },
                             "NAME", "The solid to take from a CAD file with several (--list shows them)"});
  visit(Setting<bool>{"cad", "merge", &T::merge,
                      [](C& c, const S& s) {
                        if (s.cad.merge) c.line("merge", true);
                      },
                      "", "One model of all solids of a CAD file, which must touch"});
  visit(Setting<double>{"cad", "sew", &T::sew,
                        [](C& c, const S& s) {
                          if (s.cad.sew > 0) c.line("sew", s.cad.sew);
                        },
                        "", "Join CAD faces without a solid across gaps up to this length"});

  visit(Setting<bool>{"surface", "repair", &T::repair, [](C& c, const S& s) { c.line("repair", s.surface.repair); }, "",
                      "Allow changes of shape: fill holes, resolve self-intersections, unite bodies"});
  visit(Setting<bool>{"surface", "wrap", &T::wrap, [](C& c, const S& s) { c.line("wrap", s.surface.wrap); }, "",
                      "Last resort: alpha wrapping"});
  visit(Setting<double>{"surface", "wrap_alpha", &T::wrap_alpha,
                        [](C& c, const S& s) { c.optional("wrap_alpha", s.surface.wrap_alpha); }, "",
                        "Smallest detail of the wrapping, length [diagonal / 50]"});
  visit(Setting<double>{"surface", "wrap_offset", &T::wrap_offset,
                        [](C& c, const S& s) { c.optional("wrap_offset", s.surface.wrap_offset); }, "",
                        "Distance of the wrapping, length [alpha / 30]"});
  visit(Setting<double>{"surface", "region_angle", &T::region_angle,
                        [](C& c, const S& s) { c.optional("region_angle", s.surface.region_angle); }, "",
                        "Split regions at edges sharper than this, degrees"});
  visit(Setting<bool>{"surface", "accept_leaks", &T::accept_leaks,
                      [](C& c, const S& s) { c.line("accept_leaks", s.surface.accept_leaks); }, "",
                      "Go on with a surface that is not closed"});

  visit(Setting<Numbers>{"grid",
                         "box",
                         &T::box,
                         [](C& c, const S& s) {
                           if (!s.grid.box) return;
                           c.list("A", (*s.grid.box)[0]);
                           c.list("B", (*s.grid.box)[1]);
                         },
                         "AX AY AZ BX BY BZ",
                         "Corners A and B of the grid: no margin then",
                         {6}});
  visit(Setting<Integers>{"grid", "spans", &T::spans, [](C& c, const S& s) { c.list("spans", s.grid.spans); },
                          "N [N N]", "Spans across the part, or across the box", one_or_three});
  visit(Setting<Numbers>{"grid", "span_size", &T::span_size,
                         [](C& c, const S& s) {
                           // One size for all directions and three equal ones are the same grid.
                           const Numbers& size = s.grid.span_size;
                           c.list("span_size", size.size() == 1 ? Numbers(3, size[0]) : size);
                         },
                         "H [H H]", "Size of a span, length [longest side / 20]", one_or_three});
  visit(Setting<Integers>{"grid", "degree", &T::degree, [](C& c, const S& s) { c.list("degree", s.grid.degree); },
                          "P [P P]", "Degree 1 … 4 [2]", one_or_three});
  visit(Setting<std::int64_t>{"grid", "margin", &T::margin,
                              [](C& c, const S& s) { c.optional("margin", s.grid.margin); }, "",
                              "Empty spans on every side [degree]"});
  visit(Setting<Numbers>{"grid",
                         "rotation",
                         &T::rotation,
                         [](C& c, const S& s) {
                           for (const auto& row : s.grid.rotation) c.list("rotation", row);
                         },
                         "R (9 numbers)",
                         "Rotation of the grid about its centre, row by row; columns are its axes",
                         {9}});
  visit(Setting<Numbers>{"grid",
                         "rotate_axis_angle",
                         &T::rotate_axis_angle,
                         not_data,
                         "X Y Z DEG",
                         "The same as axis and angle in degrees",
                         {4}});
  visit(Setting<bool>{"grid", "optimise_offset", &T::optimise_offset,
                      [](C& c, const S& s) { c.line("optimise_offset", s.optimise_offset); }, "",
                      "Shift the grid within one span so that fewest functions are light"});

  visit(Setting<double>{"trim", "sliver_tolerance", &T::sliver_tolerance,
                        [](C& c, const S& s) { c.line("sliver_tolerance", s.trim.sliver_tolerance); }, "",
                        "Depth in spans below which a cut is snapped [2e-5]"});
  visit(Setting<double>{"trim", "min_fraction", &T::min_fraction,
                        [](C& c, const S& s) { c.line("min_fraction", s.trim.min_fraction); }, "",
                        "Drop trimmed spans with a smaller volume fraction [0]"});
  visit(Setting<std::string>{
      "trim", "gap_ends", &T::gap_ends,
      [](C& c, const S& s) { c.line("gap_ends", s.trim.split_gap_ends ? "split" : "glued"); }, "WHAT",
      "Walls of a gap near its end: split (functions of lower continuity there) or glued [split]"});

  visit(Setting<std::string>{"quadrature",
                             "interior",
                             &T::interior,
                             [](C& c, const S& s) { c.line("interior", s.quadrature.interior_rule); },
                             "RULE",
                             "Rule of interior spans: gauss, ggq, ggq-reduced or ggq-reduced2 [ggq]",
                             {},
                             "--quadrature"});
  visit(
      Setting<std::string>{"quadrature", "trimmed", &T::trimmed,
                           [](C& c, const S& s) { c.line("trimmed", s.quadrature.trimmed_rule); }, "RULE",
                           "Rule of trimmed spans: nnls, or minimal: points taken out and moved [minimal up to moment "
                           "degree 2, above it nnls]"});
  visit(Setting<std::string>{"quadrature", "surface_rule", &T::surface_rule,
                             [](C& c, const S& s) { c.line("surface_rule", s.quadrature.surface_rule); }, "RULE",
                             "Points on the surface: exact, or reduced: fewer on facets that are small beside the "
                             "spans, which igasolve makes exact where supports and loads act [exact]"});
  visit(Setting<WordOrIntegers>{"quadrature", "moment_degree", &T::moment_degree,
                                [](C& c, const S& s) { c.list("moment_degree", s.quadrature.moment_degree); },
                                "Q [Q Q]", "Moments kept on trimmed spans: p, 2p or numbers [p]", one_or_three});
  visit(Setting<double>{"quadrature", "tolerance", &T::tolerance,
                        [](C& c, const S& s) { c.line("tolerance", s.quadrature.tolerance); }, "",
                        "Bound on the moment residual of every span [1e-10]"});
  visit(Setting<bool>{"quadrature", "rank_bound", &T::rank_bound,
                      [](C& c, const S& s) { c.line("rank_bound", s.quadrature.rank_bound); }, "",
                      "With minimal: keep in a span as many points as its own stiffness has rank"});
}

} // namespace iga::prep
