#include "format/io/h5_file.hpp"

#include "format/io/chunk_filter.hpp"
#include "format/io/utf8.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>
#include <new>
#include <sys/mman.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

#ifdef __SANITIZE_ADDRESS__
// HDF5 1.10 loses memory of its own while it refuses a damaged file or gives up a file that cannot be written.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}
#endif

namespace iga::io {

namespace {

constexpr std::int64_t compress_above = 64 * 1024; // bytes
constexpr std::int64_t chunk_bytes = 1024 * 1024;
constexpr unsigned gzip_level = 1;          // as named in the file; see chunk_filter.hpp
constexpr std::int64_t chunks_at_once = 32; // packed in parallel, then written in order
// Deflate cannot shrink data by more than this factor, so a dataset that claims more was never written.
constexpr std::int64_t largest_compression = 1032;
// A chunk is unpacked whole, whatever part of it is asked for.
constexpr std::size_t largest_chunk = std::size_t{256} << 20; // bytes

template <class T> struct ElementType;
template <> struct ElementType<double> {
  static constexpr const char* name = "f64";
  static hid_t memory() { return H5T_NATIVE_DOUBLE; }
  static hid_t file() { return H5T_IEEE_F64LE; }
};
template <> struct ElementType<std::int64_t> {
  static constexpr const char* name = "i64";
  static hid_t memory() { return H5T_NATIVE_INT64; }
  static hid_t file() { return H5T_STD_I64LE; }
};
template <> struct ElementType<std::int32_t> {
  static constexpr const char* name = "i32";
  static hid_t memory() { return H5T_NATIVE_INT32; }
  static hid_t file() { return H5T_STD_I32LE; }
};

H5Id type_id(hid_t id) {
  return {id, H5Tclose};
}
H5Id space_id(hid_t id) {
  return {id, H5Sclose};
}
H5Id property_id(hid_t id) {
  return {id, H5Pclose};
}

// HDF5 1.10.8 follows null pointers where it lacks memory for the tables of a file that it opens or makes.
void expect_memory_for_a_file() {
  constexpr std::size_t room = 16 * chunk_bytes;
  void* memory = mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  munmap(memory, room);
}

// To be called before a file is opened or made. The library prints its own stack unless told otherwise, once per
// thread; and at exit it would try once more to write files that could not be closed.
void prepare_library() {
  expect_memory_for_a_file();
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

// The innermost entry of the library's error stack; the system's own words where it holds them.
std::string library_reason() {
  std::string reason;
  const auto visit = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    auto& text = *static_cast<std::string*>(out);
    const std::string_view found = error->desc ? error->desc : "";
    constexpr std::string_view marker = "error message = '";
    if (const auto at = found.find(marker); at != found.npos) {
      const auto rest = found.substr(at + marker.size());
      text = rest.substr(0, rest.find('\''));
      return 1;
    }
    if (text.empty()) text = found;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &reason);
  return reason.empty() ? "no reason given" : reason;
}

// Did the library run out of memory?
bool library_lacks_memory() {
  bool lacks = false;
  const auto visit = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    if (error->maj_num == H5E_RESOURCE && (error->min_num == H5E_NOSPACE || error->min_num == H5E_CANTALLOC))
      *static_cast<bool*>(out) = true;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &lacks);
  return lacks;
}

const char* const lock_advice = "the file cannot be locked, as on some network drives; set the environment variable "
                                "HDF5_USE_FILE_LOCKING=FALSE and run again";

std::int64_t product(const Shape& shape) {
  std::int64_t n = 1;
  for (const auto extent : shape) n *= extent;
  return n;
}

std::string to_text(const Shape& shape) {
  return fmt::format("({})", fmt::join(shape, ", "));
}

// Whole slices of the slowest indices, halved until they fit: (n, 3) splits along n, (n_w, n_v, n_u) into layers.
Shape chunk_shape(Shape shape, std::size_t element_size) {
  for (auto& extent : shape) extent = std::max<std::int64_t>(extent, 1);
  for (auto& extent : shape) {
    const std::int64_t rest = product(shape) / extent * static_cast<std::int64_t>(element_size);
    extent = std::clamp<std::int64_t>(chunk_bytes / rest, 1, extent);
    if (rest <= chunk_bytes) break;
  }
  return shape;
}

bool is_compressed(const Shape& shape, std::size_t element_size) {
  return product(shape) * static_cast<std::int64_t>(element_size) > compress_above;
}

std::vector<hsize_t> extents(const Shape& shape) {
  return {shape.begin(), shape.end()};
}

H5Id simple_space(const Shape& shape) {
  const auto dims = extents(shape);
  // A chunk may be larger than an empty array only where the array could grow.
  std::vector<hsize_t> largest = dims;
  for (auto& extent : largest)
    if (extent == 0) extent = H5S_UNLIMITED;
  return space_id(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), largest.data()));
}

H5Id string_type(std::size_t length) {
  H5Id type = type_id(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), length);
  H5Tset_strpad(type.get(), H5T_STR_NULLTERM);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

// Fixed-length strings, packed one after another: they lie inside the checksummed data, unlike variable-length ones.
struct PackedTexts {
  std::size_t length = 1;
  std::vector<char> bytes;
};

PackedTexts pack(const std::vector<std::string>& values) {
  std::vector<std::string> texts(values.size());
  std::transform(values.begin(), values.end(), texts.begin(), valid_utf8);
  PackedTexts packed;
  for (const auto& value : texts) packed.length = std::max(packed.length, value.size() + 1);
  packed.bytes.assign(std::max<std::size_t>(1, packed.length * texts.size()), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(&packed.bytes[i * packed.length], packed.length);
  return packed;
}

std::string type_name(hid_t type) {
  const auto bits = 8 * H5Tget_size(type);
  switch (H5Tget_class(type)) {
  case H5T_FLOAT:
    return fmt::format("f{}", bits);
  case H5T_INTEGER:
    return fmt::format("{}{}", H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "i", bits);
  case H5T_ENUM:
    return fmt::format("enum of {} bits", bits);
  case H5T_STRING:
    return "string";
  default:
    return "another type";
  }
}

bool same_kind(hid_t a, hid_t b) {
  return H5Tget_class(a) == H5Tget_class(b) && H5Tget_size(a) == H5Tget_size(b) &&
         (H5Tget_class(a) != H5T_INTEGER || H5Tget_sign(a) == H5Tget_sign(b));
}

H5Id enum_type(std::span<const EnumName> names) {
  H5Id type = type_id(H5Tenum_create(H5T_STD_U8LE));
  for (const EnumName& entry : names) H5Tenum_insert(type.get(), entry.name, &entry.value);
  return type;
}

std::string place(const char* object, const char* name) {
  return fmt::format("{} attribute {}", object, name);
}

} // namespace

H5Id& H5Id::operator=(H5Id&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = other.id_;
    close_ = other.close_;
    other.id_ = -1;
  }
  return *this;
}

void H5Id::reset() {
  if (id_ >= 0) close_(release());
}

std::int64_t H5Id::release() {
  const std::int64_t id = id_;
  id_ = -1;
  return id;
}

// ----------------------------------------------------------------------------------------------------------------
// writing

H5Writer::H5Writer(const std::filesystem::path& path) : replacement_(path) {
  prepare_library();
  const H5Id access = property_id(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_file_locking(access.get(), 0, 1); // nobody else knows the temporary file
  const H5Id create = property_id(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_obj_track_times(create.get(), false);
  file_ = {H5Fcreate(replacement_.path().c_str(), H5F_ACC_TRUNC, create.get(), access.get()), H5Fclose};
  if (file_.get() < 0) fail("the file cannot be started");
}

H5Writer::~H5Writer() {
  if (file_.get() >= 0) discard_writes();
}

// A failed write leaves pages in the library that it would try to write again while datasets and file are closed. The
// descriptor is pointed at memory instead, where they succeed and are forgotten. The file itself is closed last, by the
// destructor: closing it under open datasets would leave them without it.
void H5Writer::discard_writes() {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file_.get(), H5P_DEFAULT, &handle) < 0 || !handle) return;
  const int memory = memfd_create("discarded", MFD_CLOEXEC);
  if (memory < 0) return;
  dup2(memory, *static_cast<int*>(handle));
  close(memory);
}

void H5Writer::fail(std::string_view what) {
  const std::string reason = library_reason();
  const bool lacks_memory = library_lacks_memory();
  if (file_.get() >= 0) discard_writes();
  if (lacks_memory) throw std::bad_alloc();
  const auto& target = replacement_.target();
  const auto folder = target.has_parent_path() ? target.parent_path().string() : std::string(".");
  throw InputError(fmt::format("{}: {} in folder {}: {}; nothing was changed, free space or choose another folder",
                               target.string(), what, folder, reason));
}

void H5Writer::group(const char* path, const char* description) {
  {
    const H5Id create = property_id(H5Pcreate(H5P_GROUP_CREATE));
    H5Pset_obj_track_times(create.get(), false);
    const H5Id group{H5Gcreate2(file_.get(), path, H5P_DEFAULT, create.get(), H5P_DEFAULT), H5Gclose};
    if (group.get() < 0) fail(fmt::format("group {} cannot be written", path));
  }
  attribute(path, "description", std::string(description));
}

H5Id H5Writer::create_dataset(const DatasetText& text, std::int64_t type, std::size_t element_size,
                              const Shape& shape) {
  const H5Id create = property_id(H5Pcreate(H5P_DATASET_CREATE));
  const auto chunk = extents(chunk_shape(shape, element_size));
  H5Pset_chunk(create.get(), static_cast<int>(chunk.size()), chunk.data());
  if (is_compressed(shape, element_size)) {
    H5Pset_shuffle(create.get());
    H5Pset_deflate(create.get(), gzip_level);
  }
  H5Pset_fletcher32(create.get());             // last, so that damage is seen before anything is unpacked
  H5Pset_obj_track_times(create.get(), false); // the same model gives the same bytes
  const H5Id space = simple_space(shape);
  H5Id dataset{H5Dcreate2(file_.get(), text.path, type, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT), H5Dclose};
  if (dataset.get() < 0) fail(fmt::format("dataset {} cannot be written", text.path));
  attribute(text.path, "description", std::string(text.description));
  attribute(text.path, "unit", std::string(text.unit));
  attribute(text.path, "order", std::string(text.order));
  return dataset;
}

template <class T> void H5Writer::dataset(const DatasetText& text, const Shape& shape, std::span<const T> values) {
  if (product(shape) != static_cast<std::int64_t>(values.size()))
    throw std::logic_error(fmt::format("{}: {} values for shape {}", text.path, values.size(), to_text(shape)));
  const H5Id dataset = create_dataset(text, ElementType<T>::file(), sizeof(T), shape);
  write_chunks(text, dataset, sizeof(T), shape,
               [bytes = std::as_bytes(values)](std::size_t first, std::span<std::byte> out) {
                 std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
               });
}
template void H5Writer::dataset(const DatasetText&, const Shape&, std::span<const double>);
template void H5Writer::dataset(const DatasetText&, const Shape&, std::span<const std::int64_t>);
template void H5Writer::dataset(const DatasetText&, const Shape&, std::span<const std::int32_t>);

void H5Writer::enums(const DatasetText& text, const Shape& shape, std::span<const std::uint8_t> values,
                     std::span<const EnumName> names) {
  if (product(shape) != static_cast<std::int64_t>(values.size()))
    throw std::logic_error(fmt::format("{}: {} values for shape {}", text.path, values.size(), to_text(shape)));
  const H5Id type = enum_type(names);
  const H5Id dataset = create_dataset(text, type.get(), 1, shape);
  write_chunks(text, dataset, 1, shape, [bytes = std::as_bytes(values)](std::size_t first, std::span<std::byte> out) {
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
  });
}

void H5Writer::strings(const DatasetText& text, const std::vector<std::string>& values) {
  const PackedTexts packed = pack(values);
  const H5Id type = string_type(packed.length);
  const H5Id dataset = create_dataset(text, type.get(), packed.length, {static_cast<std::int64_t>(values.size())});
  if (!values.empty() && H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.bytes.data()) < 0)
    fail(fmt::format("dataset {} cannot be written", text.path));
}

void H5Writer::rows(const DatasetText& text, std::int64_t rows, std::int64_t columns,
                    const std::function<void(std::int64_t, std::span<double>)>& fill) {
  const Shape shape{rows, columns};
  const H5Id dataset = create_dataset(text, H5T_IEEE_F64LE, sizeof(double), shape);
  const std::size_t row_bytes = static_cast<std::size_t>(columns) * sizeof(double);
  write_chunks(text, dataset, sizeof(double), shape, [&](std::size_t first, std::span<std::byte> out) {
    std::vector<double> block(out.size() / sizeof(double));
    fill(static_cast<std::int64_t>(first / row_bytes), block);
    std::memcpy(out.data(), block.data(), out.size());
  });
}

// A chunk is whole along all but one index and 1 along those before it (see chunk_shape): its bytes follow one another
// in the array. The array's last chunk along that index may reach beyond it and is filled up with zeros. Numbers lie in
// memory as in the file: both are little-endian.
void H5Writer::write_chunks(const DatasetText& text, const H5Id& dataset, std::size_t element_size, const Shape& shape,
                            const std::function<void(std::size_t first_byte, std::span<std::byte>)>& copy) {
  if (product(shape) == 0) return;
  const Shape chunk = chunk_shape(shape, element_size);
  std::size_t split = 0;
  while (split + 1 < shape.size() && chunk[split] == 1) ++split;
  const std::int64_t row = product(chunk) / chunk[split] * static_cast<std::int64_t>(element_size); // bytes
  const std::int64_t per_slice = (shape[split] + chunk[split] - 1) / chunk[split];
  const std::int64_t slices = product({shape.begin(), shape.begin() + static_cast<std::ptrdiff_t>(split)});
  const bool compress = is_compressed(shape, element_size);

  std::vector<std::vector<std::byte>> packed(static_cast<std::size_t>(chunks_at_once));
  for (std::int64_t first = 0; first < slices * per_slice; first += chunks_at_once) {
    const std::int64_t count = std::min(chunks_at_once, slices * per_slice - first);
    tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t q) {
      const std::int64_t slice = (first + q) / per_slice, start = (first + q) % per_slice * chunk[split];
      const std::int64_t rows = std::min(chunk[split], shape[split] - start);
      std::vector<std::byte> bytes(static_cast<std::size_t>(chunk[split] * row));
      copy(static_cast<std::size_t>((slice * shape[split] + start) * row),
           std::span(bytes).first(static_cast<std::size_t>(rows * row)));
      packed[static_cast<std::size_t>(q)] = pack_chunk(bytes, element_size, compress);
    });
    for (std::int64_t q = 0; q < count; ++q) {
      std::vector<hsize_t> offset(shape.size(), 0);
      offset[split] = static_cast<hsize_t>((first + q) % per_slice * chunk[split]);
      std::int64_t slice = (first + q) / per_slice;
      for (std::size_t d = split; d-- > 0; slice /= shape[d]) offset[d] = static_cast<hsize_t>(slice % shape[d]);
      const auto& bytes = packed[static_cast<std::size_t>(q)];
      if (H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, offset.data(), bytes.size(), bytes.data()) < 0)
        fail(fmt::format("dataset {} cannot be written", text.path));
    }
  }
}

void H5Writer::write_attribute(const char* object, const char* name, std::int64_t type, const Shape* shape,
                               const void* data) {
  const H5Id space = shape ? simple_space(*shape) : space_id(H5Screate(H5S_SCALAR));
  const H5Id attribute{
      H5Acreate_by_name(file_.get(), object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
  if (attribute.get() < 0 || H5Awrite(attribute.get(), type, data) < 0)
    fail(fmt::format("{} cannot be written", place(object, name)));
}

void H5Writer::write_texts(const char* object, const char* name, const std::vector<std::string>& values, bool scalar) {
  const PackedTexts packed = pack(values);
  const H5Id type = string_type(packed.length);
  const Shape shape{static_cast<std::int64_t>(values.size())};
  write_attribute(object, name, type.get(), scalar ? nullptr : &shape, packed.bytes.data());
}

void H5Writer::attribute(const char* object, const char* name, const std::string& value) {
  write_texts(object, name, {value}, true);
}

void H5Writer::attribute(const char* object, const char* name, const std::vector<std::string>& values) {
  write_texts(object, name, values, false);
}

// Numbers are stored in the file's own type; on the machines this runs on it is the native one.
template <class T> void H5Writer::attribute(const char* object, const char* name, T value) {
  write_attribute(object, name, ElementType<T>::file(), nullptr, &value);
}
template void H5Writer::attribute(const char*, const char*, double);
template void H5Writer::attribute(const char*, const char*, std::int64_t);
template void H5Writer::attribute(const char*, const char*, std::int32_t);

template <class T>
void H5Writer::attribute(const char* object, const char* name, const Shape& shape, std::span<const T> values) {
  if (product(shape) != static_cast<std::int64_t>(values.size()))
    throw std::logic_error(fmt::format("{}: {} values for shape {}", name, values.size(), to_text(shape)));
  write_attribute(object, name, ElementType<T>::file(), &shape, values.data());
}
template void H5Writer::attribute(const char*, const char*, const Shape&, std::span<const double>);
template void H5Writer::attribute(const char*, const char*, const Shape&, std::span<const std::int64_t>);
template void H5Writer::attribute(const char*, const char*, const Shape&, std::span<const std::int32_t>);

void H5Writer::commit() {
  if (H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) < 0) fail("the file cannot be written");
  const hid_t file = file_.release();
  if (H5Fclose(file) < 0) {
    file_ = {file, H5Fclose};
    fail("the file cannot be closed");
  }
  replacement_.commit();
}

// ----------------------------------------------------------------------------------------------------------------
// reading

H5Reader::H5Reader(const std::filesystem::path& path, Writer writer) : name_(path.string()) {
  prepare_library();
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(fmt::format("{}: is a folder, expected a file", name_));
  if (access(path.c_str(), R_OK) != 0)
    throw InputError(fmt::format("{}: cannot be opened: {}", name_, std::strerror(errno)));
  const H5Id properties = property_id(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fclose_degree(properties.get(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(properties.get(), 0, 1); // network file systems without locks; the file is never written in place
  H5Pset_cache(properties.get(), 0, 521, 8 * chunk_bytes, 1.0);
  if (H5Fis_hdf5(path.c_str()) == 0)
    throw FormatError(fmt::format("{}: is not an HDF5 file; expected a file made by igaprep", name_));
  file_ = {H5Fopen(path.c_str(), H5F_ACC_RDONLY, properties.get()), H5Fclose};
  if (file_.get() >= 0) {
    if (writer == Writer::H5Writer) expect_checksums();
    return;
  }
  const std::string reason = library_reason();
  if (reason.find("already open for") != reason.npos)
    throw InputError(fmt::format("{}: is open for writing in another program, or was when that program was killed; "
                                 "close it there, or clear the mark with: h5clear -s {}",
                                 name_, name_));
  if (reason.find("lock the file") != reason.npos)
    throw InputError(fmt::format("{}: {} ({})", name_, lock_advice, reason));
  refuse_damaged("/");
}

// From superblock 2 on, object headers have checksums.
void H5Reader::expect_checksums() const {
  H5F_info2_t info;
  if (H5Fget_info2(file_.get(), &info) < 0) refuse_damaged("/");
  if (info.super.version < 2)
    refuse("/", fmt::format("has an HDF5 superblock of version {}, expected 2 or 3: igasolve writes no other, so the "
                            "file is damaged or was rewritten by another program; make it again with igasolve",
                            info.super.version));
}

void H5Reader::refuse(std::string_view path, std::string_view message) const {
  throw FormatError(fmt::format("{}: {}: {}", name_, path, message));
}

void H5Reader::refuse_damaged(std::string_view path) const {
  if (library_lacks_memory()) throw std::bad_alloc();
  refuse(path, fmt::format("cannot be read ({}): the file is damaged or not complete; make it again with igaprep",
                           library_reason()));
}

bool H5Reader::has(const std::string& path) const {
  for (std::size_t at = path.find('/', 1);; at = path.find('/', at + 1)) {
    const std::string part = path.substr(0, at);
    const htri_t found = H5Lexists(file_.get(), part.c_str(), H5P_DEFAULT);
    if (found < 0) refuse_damaged(path);
    if (found == 0) return false;
    // Links could lead round in circles, or into files that are not part of this one.
    H5L_info_t link;
    if (H5Lget_info(file_.get(), part.c_str(), &link, H5P_DEFAULT) < 0) refuse_damaged(part);
    if (link.type == H5L_TYPE_SOFT) refuse(part, "is a symbolic link, expected the object itself");
    if (link.type != H5L_TYPE_HARD) refuse(part, "is a link into another file, expected the object itself");
    if (at == path.npos) return true;
    const H5Id object{H5Oopen(file_.get(), part.c_str(), H5P_DEFAULT), H5Oclose};
    if (object.get() < 0) refuse_damaged(part);
    if (H5Iget_type(object.get()) != H5I_GROUP) refuse(part, "is a dataset, expected a group");
  }
}

H5Id H5Reader::open_dataset(const char* path) const {
  if (!has(path)) refuse(path, "is missing; expected a dataset");
  H5Id object{H5Oopen(file_.get(), path, H5P_DEFAULT), H5Oclose};
  if (object.get() < 0) refuse_damaged(path);
  if (H5Iget_type(object.get()) != H5I_DATASET) refuse(path, "is a group, expected a dataset");
  return object;
}

H5Id H5Reader::open_attribute(const char* object, const char* name) const {
  if (!has_attribute(object, name)) refuse(place(object, name), "is missing");
  H5Id attribute{H5Aopen_by_name(file_.get(), object, name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
  if (attribute.get() < 0) refuse_damaged(place(object, name));
  return attribute;
}

namespace {

Shape shape_of_space(const H5Id& space) {
  if (space.get() < 0 || H5Sget_simple_extent_type(space.get()) == H5S_NULL) return {0};
  std::vector<hsize_t> dims(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.get()))));
  H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr);
  Shape shape;
  // An extent beyond int64 is refused by every expectation as the negative number it becomes.
  for (const hsize_t extent : dims) shape.push_back(static_cast<std::int64_t>(extent));
  return shape;
}

} // namespace

Shape H5Reader::shape(const char* path, std::size_t rank) const {
  const H5Id dataset = open_dataset(path);
  Shape found = shape_of_space(space_id(H5Dget_space(dataset.get())));
  if (found.size() != rank) refuse(path, fmt::format("has shape {}, expected {} extents", to_text(found), rank));
  for (const auto extent : found)
    if (extent < 0 || extent > (std::int64_t{1} << 48))
      refuse(path, fmt::format("has the impossible shape {}, expected extents of at most 2^48", to_text(found)));
  expect_stored(path, dataset);
  return found;
}

void H5Reader::expect_shape(const char* path, const Shape& found, const Shape& expected) const {
  if (found != expected) refuse(path, fmt::format("has shape {}, expected {}", to_text(found), to_text(expected)));
}

// Stops before memory is asked for that the file cannot fill.
void H5Reader::expect_stored(const char* path, const H5Id& dataset) const {
  const H5Id type = type_id(H5Dget_type(dataset.get())), create = property_id(H5Dget_create_plist(dataset.get()));
  const auto element_size = static_cast<double>(H5Tget_size(type.get()));
  double claimed = element_size, chunk_size = element_size;
  for (const auto extent : shape_of_space(space_id(H5Dget_space(dataset.get()))))
    claimed *= static_cast<double>(extent);
  const H5D_layout_t layout = H5Pget_layout(create.get());
  if (layout == H5D_VIRTUAL || H5Pget_external_count(create.get()) > 0)
    refuse(path, "keeps its data in other files, expected it in this one");
  if (layout == H5D_CHUNKED) {
    std::array<hsize_t, H5S_MAX_RANK> chunk{};
    const int rank = H5Pget_chunk(create.get(), H5S_MAX_RANK, chunk.data());
    for (int d = 0; d < rank; ++d) chunk_size *= static_cast<double>(chunk[static_cast<std::size_t>(d)]);
    if (chunk_size > static_cast<double>(largest_chunk))
      refuse(path, fmt::format("has chunks of {:.0f} bytes, expected at most {}", chunk_size, largest_chunk));
  }
  const auto stored = static_cast<double>(H5Dget_storage_size(dataset.get()));
  if (claimed > stored * largest_compression)
    refuse(path,
           fmt::format("claims {:.0f} bytes but only {:.0f} are stored, expected all of its data", claimed, stored));
}

template <class T> std::vector<T> H5Reader::dataset(const char* path, const Shape& expected) const {
  const H5Id dataset = open_dataset(path);
  const H5Id type = type_id(H5Dget_type(dataset.get()));
  if (!same_kind(type.get(), ElementType<T>::file()))
    refuse(path, fmt::format("holds {}, expected {}", type_name(type.get()), ElementType<T>::name));
  expect_shape(path, shape(path, expected.size()), expected);
  std::vector<T> values(static_cast<std::size_t>(product(expected)));
  if (!values.empty() &&
      H5Dread(dataset.get(), ElementType<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    refuse_damaged(path);
  return values;
}
template std::vector<double> H5Reader::dataset(const char*, const Shape&) const;
template std::vector<std::int64_t> H5Reader::dataset(const char*, const Shape&) const;
template std::vector<std::int32_t> H5Reader::dataset(const char*, const Shape&) const;

std::vector<std::uint8_t> H5Reader::enums(const char* path, const Shape& expected,
                                          std::span<const EnumName> names) const {
  const H5Id dataset = open_dataset(path);
  const H5Id type = type_id(H5Dget_type(dataset.get())), wanted = enum_type(names);
  if (H5Tequal(type.get(), wanted.get()) <= 0) {
    std::string text;
    for (const EnumName& entry : names)
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", entry.name, entry.value);
    refuse(path, fmt::format("holds {}, expected an enum of 8 bits {{{}}}", type_name(type.get()), text));
  }
  expect_shape(path, shape(path, expected.size()), expected);
  std::vector<std::uint8_t> values(static_cast<std::size_t>(product(expected)));
  if (H5Dread(dataset.get(), wanted.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) refuse_damaged(path);
  return values;
}

void H5Reader::rows(const char* path, std::int64_t rows, std::int64_t columns,
                    const std::function<void(std::int64_t, std::span<const double>)>& visit) const {
  const H5Id dataset = open_dataset(path);
  const H5Id type = type_id(H5Dget_type(dataset.get()));
  if (!same_kind(type.get(), H5T_IEEE_F64LE))
    refuse(path, fmt::format("holds {}, expected f64", type_name(type.get())));
  expect_shape(path, shape(path, 2), {rows, columns});
  const H5Id space = space_id(H5Dget_space(dataset.get()));
  const std::int64_t step = chunk_shape({rows, columns}, sizeof(double))[0];
  std::vector<double> block(static_cast<std::size_t>(step * columns));
  for (std::int64_t first = 0; first < rows; first += step) {
    const std::int64_t count = std::min(step, rows - first);
    const auto start = extents({first, 0}), size = extents({count, columns});
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
    const H5Id memory = space_id(H5Screate_simple(2, size.data(), nullptr));
    if (H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, block.data()) < 0)
      refuse_damaged(path);
    visit(first, std::span(block).first(static_cast<std::size_t>(count * columns)));
  }
}

// Strings of fixed or variable length (h5py writes the latter) of a dataset or an attribute.
std::vector<std::string> H5Reader::read_texts(const std::string& path, const H5Id& object, bool is_attribute) const {
  const auto get_type = is_attribute ? H5Aget_type : H5Dget_type;
  const auto get_space = is_attribute ? H5Aget_space : H5Dget_space;
  const H5Id type = type_id(get_type(object.get())), space = space_id(get_space(object.get()));
  if (H5Tget_class(type.get()) != H5T_STRING)
    refuse(path, fmt::format("holds {}, expected a string", type_name(type.get())));
  const auto count = static_cast<std::size_t>(product(shape_of_space(space)));
  const auto read = [&](hid_t memory, void* data) {
    return is_attribute ? H5Aread(object.get(), memory, data)
                        : H5Dread(object.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
  };
  std::vector<std::string> values;
  if (count == 0) return values;
  if (H5Tis_variable_str(type.get()) > 0) {
    std::vector<char*> pointers(count, nullptr);
    if (read(type.get(), pointers.data()) < 0) refuse_damaged(path);
    for (const char* text : pointers) values.emplace_back(text ? text : "");
    H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data());
    return values;
  }
  const std::size_t length = H5Tget_size(type.get());
  std::vector<char> bytes(count * length);
  if (read(type.get(), bytes.data()) < 0) refuse_damaged(path);
  for (std::size_t i = 0; i < count; ++i) values.emplace_back(&bytes[i * length], strnlen(&bytes[i * length], length));
  return values;
}

std::vector<std::string> H5Reader::strings(const char* path) const {
  const H5Id dataset = open_dataset(path);
  shape(path, 1);
  return read_texts(path, dataset, false);
}

bool H5Reader::has_attribute(const char* object, const char* name) const {
  if (std::string_view(object) != "/" && !has(object)) refuse(object, "is missing");
  const htri_t found = H5Aexists_by_name(file_.get(), object, name, H5P_DEFAULT);
  if (found < 0) refuse_damaged(place(object, name));
  return found > 0;
}

std::string H5Reader::text(const char* object, const char* name) const {
  const auto values = texts(object, name);
  if (values.size() != 1) refuse(place(object, name), fmt::format("holds {} strings, expected 1", values.size()));
  return values[0];
}

std::vector<std::string> H5Reader::texts(const char* object, const char* name) const {
  return read_texts(place(object, name), open_attribute(object, name), true);
}

template <class T> std::vector<T> H5Reader::numbers(const char* object, const char* name, const Shape& expected) const {
  const H5Id attribute = open_attribute(object, name);
  const H5Id type = type_id(H5Aget_type(attribute.get()));
  if (H5Tget_class(type.get()) != H5Tget_class(ElementType<T>::file()))
    refuse(place(object, name), fmt::format("holds {}, expected {}", type_name(type.get()), ElementType<T>::name));
  const Shape found = shape_of_space(space_id(H5Aget_space(attribute.get())));
  if (found != expected)
    refuse(place(object, name), fmt::format("has shape {}, expected {}", to_text(found), to_text(expected)));
  std::vector<T> values(static_cast<std::size_t>(product(expected)));
  if (H5Aread(attribute.get(), ElementType<T>::memory(), values.data()) < 0) refuse_damaged(place(object, name));
  return values;
}
template std::vector<double> H5Reader::numbers(const char*, const char*, const Shape&) const;
template std::vector<std::int64_t> H5Reader::numbers(const char*, const char*, const Shape&) const;
template std::vector<std::int32_t> H5Reader::numbers(const char*, const char*, const Shape&) const;

template <class T> T H5Reader::number(const char* object, const char* name) const {
  return numbers<T>(object, name, {})[0];
}
template double H5Reader::number(const char*, const char*) const;
template std::int64_t H5Reader::number(const char*, const char*) const;
template std::int32_t H5Reader::number(const char*, const char*) const;

} // namespace iga::io
