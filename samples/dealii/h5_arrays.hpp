// Arrays, attributes and texts of HDF5 files in a few lines each, with the C library alone.
#pragma once

#include <hdf5.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace h5 {

template <class T> hid_t type() {
  if constexpr (std::is_same_v<T, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::is_same_v<T, int>)
    return H5T_NATIVE_INT;
  else
    return H5T_NATIVE_INT64;
}

/// Handles of a short-lived program are left to H5close.
class File {
 public:
  File(const std::string& path, bool create) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS); // checksums of metadata; readers refuse the older layout
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    file_ = create ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                   : H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    need(file_, path);
  }
  ~File() { H5Fclose(file_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool has(const std::string& path) const { return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0; }
  template <class T> std::vector<T> read(const std::string& path) const {
    const hid_t set = need(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), path), space = H5Dget_space(set);
    std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    need(H5Dread(set, type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
    H5Sclose(space), H5Dclose(set);
    return values;
  }
  template <class T> std::vector<T> attribute(const std::string& object, const std::string& name) const {
    const hid_t a =
        need(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), object + " " + name);
    const hid_t space = H5Aget_space(a);
    std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    need(H5Aread(a, type<T>(), values.data()), object + " " + name);
    H5Sclose(space), H5Aclose(a);
    return values;
  }
  /// Texts of fixed length, as igaprep writes them.
  std::vector<std::string> texts(const std::string& path) const {
    const hid_t set = need(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), path), kind = H5Dget_type(set),
                space = H5Dget_space(set);
    if (H5Tis_variable_str(kind) != 0) throw std::runtime_error(path + ": expected texts of fixed length");
    std::vector<std::string> found(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    const std::size_t length = H5Tget_size(kind);
    std::string bytes(found.size() * length, '\0');
    need(H5Dread(set, kind, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), path);
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = bytes.substr(i * length, length).c_str();
    H5Sclose(space), H5Tclose(kind), H5Dclose(set);
    return found;
  }
  std::string text(const std::string& object, const std::string& name) const {
    const hid_t a =
        need(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), object + " " + name);
    const hid_t kind = H5Aget_type(a);
    if (H5Tis_variable_str(kind) != 0)
      throw std::runtime_error(object + " " + name + ": expected a text of fixed length");
    std::string bytes(H5Tget_size(kind), '\0');
    need(H5Aread(a, kind, bytes.data()), object + " " + name);
    H5Tclose(kind), H5Aclose(a);
    return bytes.c_str();
  }

  void group(const std::string& path) {
    H5Gclose(need(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), path));
  }
  template <class T> void write(const std::string& path, std::vector<hsize_t> shape, const std::vector<T>& values) {
    write(path, shape, type<T>(), values.data());
  }
  void write_texts(const std::string& path, const std::vector<std::string>& values) {
    std::size_t length = 1;
    for (const auto& value : values) length = std::max(length, value.size());
    std::string bytes;
    for (auto value : values) value.resize(length), bytes += value;
    write(path, {values.size()}, text_type(length), bytes.data());
  }
  template <class T>
  void write_attribute(const std::string& object, const std::string& name, std::vector<hsize_t> shape,
                       const std::vector<T>& values) {
    write_attribute(object, name, shape, type<T>(), values.data());
  }
  void write_attribute(const std::string& object, const std::string& name, const std::string& text) {
    write_attribute(object, name, {}, text_type(std::max<std::size_t>(1, text.size())), text.data());
  }

 private:
  hid_t file_;
  static hid_t need(hid_t result, const std::string& what) {
    if (result < 0) throw std::runtime_error(what + ": cannot be read or written (HDF5 says more above)");
    return result;
  }
  static hid_t text_type(std::size_t length) {
    const hid_t kind = H5Tcopy(H5T_C_S1);
    H5Tset_size(kind, length), H5Tset_strpad(kind, H5T_STR_NULLPAD), H5Tset_cset(kind, H5T_CSET_UTF8);
    return kind;
  }
  static hid_t space_of(const std::vector<hsize_t>& shape) {
    return shape.empty() ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  }
  void write(const std::string& path, const std::vector<hsize_t>& shape, hid_t kind, const void* values) {
    const hid_t space = space_of(shape), how = H5Pcreate(H5P_DATASET_CREATE);
    std::vector<hsize_t> chunk(shape);
    for (auto& extent : chunk) extent = std::max<hsize_t>(1, extent);
    chunk[0] = std::min<hsize_t>(chunk[0], 65536);
    H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data()), H5Pset_fletcher32(how);
    const hid_t set = need(H5Dcreate2(file_, path.c_str(), kind, space, H5P_DEFAULT, how, H5P_DEFAULT), path);
    need(H5Dwrite(set, kind, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path);
    H5Dclose(set), H5Pclose(how), H5Sclose(space);
  }
  void write_attribute(const std::string& object, const std::string& name, const std::vector<hsize_t>& shape,
                       hid_t kind, const void* values) {
    const hid_t space = space_of(shape);
    const hid_t a =
        need(H5Acreate_by_name(file_, object.c_str(), name.c_str(), kind, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
             name);
    need(H5Awrite(a, kind, values), name);
    H5Aclose(a), H5Sclose(space);
  }
};

/// Of a file's bytes, lower-case hex: by it results name their model.
inline std::string sha256_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  unsigned char hash[EVP_MAX_MD_SIZE];
  unsigned length = 0;
  if (!in || EVP_Digest(bytes.data(), bytes.size(), hash, &length, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error(path + ": cannot be read");
  std::string text;
  for (unsigned i = 0; i < length; ++i)
    for (const int digit : {hash[i] / 16, hash[i] % 16}) text += "0123456789abcdef"[digit];
  return text;
}

} // namespace h5
