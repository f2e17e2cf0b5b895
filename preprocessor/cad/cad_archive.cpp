#include "preprocessor/cad/cad_archive.hpp"

#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace iga::prep {

namespace {

// The fields of each struct in order, for writing and reading alike.
void fields(auto& archive, CadFace& f) {
  archive(f.name, f.kind, f.colour, f.area, f.centroid, f.direction, f.axis_point, f.radius);
}
void fields(auto& archive, CadEdge& e) {
  archive(e.name, e.kind, e.length, e.radius, e.middle, e.faces, e.points);
}
void fields(auto& archive, CadVertex& v) {
  archive(v.name, v.position);
}
void fields(auto& archive, CadPlace& p) {
  archive(p.name, p.rotation, p.shift);
}
void fields(auto& archive, TriangleMesh& m) {
  archive(m.vertices, m.triangles, m.region, m.region_names);
}
void fields(auto& archive, CadSolid& s) {
  archive(s.name, s.colour, s.mesh, s.faces, s.edges, s.vertices, s.volume, s.area, s.centroid, s.chord, s.deviation,
          s.places);
}
void fields(auto& archive, CadOverlap& o) {
  archive(o.first, o.second, o.volume);
}
void fields(auto& archive, CadModel& m) {
  archive(m.format, m.sha256, m.length_unit, m.file_unit, m.solids, m.overlaps, m.findings, m.warnings);
}
void fields(auto& archive, CadOptions& o) {
  archive(o.chord, o.chord_share, o.scale, o.length_unit, o.sew, o.merge, o.tessellate, o.overlaps);
}
void fields(auto& archive, CadRequest& r) {
  archive(r.version, r.file, r.options);
}
void fields(auto& archive, CadAnswer& a) {
  archive(a.version, a.error, a.model);
}

struct Writer {
  std::string bytes;

  void operator()(auto&... values) { (put(values), ...); }

 private:
  void raw(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
  template <class T> void put(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>)
      raw(&value, sizeof value);
    else
      fields(*this, value);
  }
  void put(std::string& text) {
    const std::size_t size = text.size();
    raw(&size, sizeof size);
    raw(text.data(), size);
  }
  template <class T> void put(std::vector<T>& values) {
    const std::size_t size = values.size();
    raw(&size, sizeof size);
    if constexpr (std::is_trivially_copyable_v<T>)
      raw(values.data(), size * sizeof(T));
    else
      for (T& value : values) put(value);
  }
};

struct Reader {
  std::string_view bytes;

  void operator()(auto&... values) { (get(values), ...); }

 private:
  std::string_view raw(std::size_t size) {
    if (size > bytes.size()) throw std::runtime_error("the CAD reader's answer ends early");
    const std::string_view part = bytes.substr(0, size);
    bytes.remove_prefix(size);
    return part;
  }
  std::size_t size() {
    std::size_t n = 0;
    get(n);
    return n;
  }
  template <class T> void get(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>)
      std::memcpy(&value, raw(sizeof value).data(), sizeof value);
    else
      fields(*this, value);
  }
  void get(std::string& text) { text = raw(size()); }
  template <class T> void get(std::vector<T>& values) {
    const std::size_t n = size();
    if constexpr (std::is_trivially_copyable_v<T>) {
      const std::string_view part = raw(n * sizeof(T));
      values.resize(n);
      if (n > 0) std::memcpy(values.data(), part.data(), part.size());
    } else {
      for (std::size_t k = 0; k < n; ++k) get(values.emplace_back());
    }
  }
};

std::string written(auto& value) {
  Writer writer;
  writer(value);
  return std::move(writer.bytes);
}

template <class T> T read(std::string_view bytes) {
  T value;
  Reader reader{bytes};
  reader(value);
  return value;
}

} // namespace

std::string to_bytes(CadRequest request) {
  return written(request);
}
std::string to_bytes(CadAnswer answer) {
  return written(answer);
}
CadRequest request_of(std::string_view bytes) {
  return read<CadRequest>(bytes);
}
std::string version_of(std::string_view bytes) {
  std::string version;
  Reader reader{bytes};
  reader(version);
  return version;
}
CadAnswer answer_of(std::string_view bytes) {
  return read<CadAnswer>(bytes);
}

} // namespace iga::prep
