// Collects the facets of an STL file; shared by the readers of both kinds.
#pragma once

#include "format/io/stl_reader.hpp"

#include <unordered_map>
#include <unordered_set>

namespace iga::io {

/// Three vertices of its own for each facet.
class StlBuilder {
 public:
  /// @param name   how messages call the file; must outlive the builder
  /// @param scale  factor on all coordinates
  StlBuilder(const std::string& name, double scale) : name_(name), scale_(scale) { out_.mesh.region_names.clear(); }

  /// @throws InputError for more facets than 32 bits can number
  void reserve(std::size_t facets);
  /// Facets that follow belong to a region of this name, with a number behind it where the name is taken.
  void begin_region(std::string_view wanted);
  /// @throws InputError for a corner that is no finite position
  void add(const Point3& normal, const std::array<Point3, 3>& corners);
  void note(std::string text) { out_.notes.push_back(std::move(text)); }
  /// @throws InputError where there is no facet
  StlMesh finish(std::string format);

 private:
  void drop_empty_regions();

  const std::string& name_;
  double scale_;
  StlMesh out_;
  std::size_t odd_normals_ = 0;
  std::unordered_set<std::string> taken_;            // names of regions
  std::unordered_map<std::string, int> last_number_; // that was put behind a name
};

} // namespace iga::io
