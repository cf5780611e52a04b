#include "mpm/output/hdf5_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <utility>

#include "runs/machine.h"

namespace flowrest::mpm {

namespace {

/// An HDF5 identifier and the function that closes it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Errors are reported by our own messages. Every file is closed here, whatever happens; at exit the library
/// would close once more those whose last bytes found no room on the disk, and fall over them.
void prepare_library() {
  static const herr_t prepared = H5dont_atexit();
  static_cast<void>(prepared);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  prepare_library();
  Hdf5File file;
  file.path_ = path;
  file.temporary_ = path.string() + ".part";
  file.file_ = H5Fcreate(file.temporary_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file.file_ < 0) runs::cannot_be_written(file.temporary_, errno);
  return file;
}

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
  prepare_library();
  Hdf5File file;
  file.path_ = path;
  file.file_ = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file.file_ < 0) file.fail("cannot be opened as HDF5");
  return file;
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      file_(std::exchange(other.file_, -1)) {}

Hdf5File::~Hdf5File() {
  if (file_ >= 0) {
    H5Fclose(file_);
    std::error_code ignored;
    if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  }
}

void Hdf5File::fail(const std::string& what) const {
  throw runs::RunError(fmt::format("{}: {}", path_.string(), what));
}

/// In a file that could be created nothing but the machine is in the way of more.
void Hdf5File::no_room(const std::string& what) const {
  throw runs::MachineError(fmt::format("{}: {} (is the disk full?)", path_.string(), what));
}

void Hdf5File::group(const std::string& path) {
  const Handle made(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  if (!made.valid()) no_room("cannot hold the group " + path);
}

hid_t Hdf5File::make_dataset(const std::string& path, hid_t type, std::size_t rows, std::size_t columns) {
  const hsize_t size[2] = {rows, columns};
  const Handle space(H5Screate_simple(columns ? 2 : 1, size, nullptr), H5Sclose);
  const hid_t set = H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (set < 0) refuse_dataset(path);
  return set;
}

void Hdf5File::refuse_dataset(const std::string& path) const { no_room("cannot hold the dataset " + path); }

void Hdf5File::write(const std::string& path, hid_t type, const void* data, std::size_t count,
                     std::size_t columns) {
  const Handle set(make_dataset(path, type, columns ? count / columns : count, columns), H5Dclose);
  if (H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) refuse_dataset(path);
}

void Hdf5File::write(const std::string& path, std::span<const double> v, std::size_t columns) {
  write(path, H5T_NATIVE_DOUBLE, v.data(), v.size(), columns);
}
void Hdf5File::write(const std::string& path, std::span<const float> v, std::size_t columns) {
  write(path, H5T_NATIVE_FLOAT, v.data(), v.size(), columns);
}
void Hdf5File::write(const std::string& path, std::span<const std::int64_t> v, std::size_t columns) {
  write(path, H5T_NATIVE_INT64, v.data(), v.size(), columns);
}
void Hdf5File::write(const std::string& path, std::span<const std::int32_t> v, std::size_t columns) {
  write(path, H5T_NATIVE_INT32, v.data(), v.size(), columns);
}
void Hdf5File::write(const std::string& path, std::span<const std::uint8_t> v, std::size_t columns) {
  write(path, H5T_NATIVE_UINT8, v.data(), v.size(), columns);
}

void Hdf5File::attribute(const std::string& group, const std::string& name,
                         std::span<const std::int64_t> values) {
  const hsize_t size = values.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Handle made(H5Acreate_by_name(file_, group.c_str(), name.c_str(), H5T_NATIVE_INT64, space,
                                      H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                    H5Aclose);
  if (!made.valid() || H5Awrite(made, H5T_NATIVE_INT64, values.data()) < 0)
    no_room("cannot hold the attribute " + name);
}

void Hdf5File::attribute(const std::string& group, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.empty() ? 1 : text.size());
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle made(H5Acreate_by_name(file_, group.c_str(), name.c_str(), type, space, H5P_DEFAULT,
                                      H5P_DEFAULT, H5P_DEFAULT),
                    H5Aclose);
  if (!made.valid() || H5Awrite(made, type, text.c_str()) < 0) no_room("cannot hold the attribute " + name);
}

namespace {

template <class T>
bool read_all(hid_t file, const std::string& path, hid_t type, std::vector<T>& out) {
  const Handle set(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set.valid()) return false;
  const Handle space(H5Dget_space(set), H5Sclose);
  out.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  return H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) >= 0;
}

}  // namespace

std::vector<double> Hdf5File::read_doubles(const std::string& path) const {
  std::vector<double> out;
  if (!read_all(file_, path, H5T_NATIVE_DOUBLE, out))
    fail("the dataset " + path + " is missing or unreadable");
  return out;
}

std::vector<std::int32_t> Hdf5File::read_integers(const std::string& path) const {
  std::vector<std::int32_t> out;
  if (!read_all(file_, path, H5T_NATIVE_INT32, out))
    fail("the dataset " + path + " is missing or unreadable");
  return out;
}

std::string Hdf5File::read_text(const std::string& group, const std::string& name) const {
  const Handle attribute(H5Aopen_by_name(file_, group.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (!attribute.valid()) fail("the attribute " + name + " is missing");
  const Handle type(H5Aget_type(attribute), H5Tclose);
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) fail("the attribute " + name + " is unreadable");
  return text;
}

std::size_t Hdf5File::size_of(const std::string& path) const {
  const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set.valid()) fail("the dataset " + path + " is missing or unreadable");
  const Handle space(H5Dget_space(set), H5Sclose);
  return static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
}

void Hdf5File::commit() {
  const herr_t closed = H5Fclose(file_);
  file_ = -1;
  std::error_code error;
  if (closed < 0) {
    std::filesystem::remove(temporary_, error);
    no_room("cannot be completed");
  }
  std::filesystem::rename(temporary_, path_, error);
  if (error) runs::cannot_be_written(path_, error.value());
}

namespace {

hid_t type_of(double) { return H5T_NATIVE_DOUBLE; }
hid_t type_of(float) { return H5T_NATIVE_FLOAT; }
hid_t type_of(std::int64_t) { return H5T_NATIVE_INT64; }
hid_t type_of(std::int32_t) { return H5T_NATIVE_INT32; }
hid_t type_of(std::uint8_t) { return H5T_NATIVE_UINT8; }

}  // namespace

template <class T>
Hdf5Rows<T>::Hdf5Rows(Hdf5File& file, std::string path, std::size_t rows, std::size_t columns)
    : file_(file),
      path_(std::move(path)),
      columns_(columns),
      dataset_(file.make_dataset(path_, type_of(T()), rows, columns)) {}

template <class T>
Hdf5Rows<T>::~Hdf5Rows() {
  if (dataset_ >= 0) H5Dclose(dataset_);
}

template <class T>
void Hdf5Rows<T>::write_out() {
  if (waiting_.empty()) return;
  const hsize_t first[2] = {written_, 0};
  const hsize_t size[2] = {columns_ ? waiting_.size() / columns_ : waiting_.size(), columns_};
  const Handle in_file(H5Dget_space(dataset_), H5Sclose);
  const Handle in_memory(H5Screate_simple(columns_ ? 2 : 1, size, nullptr), H5Sclose);
  if (H5Sselect_hyperslab(in_file, H5S_SELECT_SET, first, nullptr, size, nullptr) < 0 ||
      H5Dwrite(dataset_, type_of(T()), in_memory, in_file, H5P_DEFAULT, waiting_.data()) < 0)
    file_.refuse_dataset(path_);
  written_ += size[0];
  waiting_.clear();
}

template <class T>
void Hdf5Rows<T>::finish() {
  write_out();
  const herr_t closed = H5Dclose(std::exchange(dataset_, -1));
  if (closed < 0) file_.refuse_dataset(path_);
}

template class Hdf5Rows<double>;
template class Hdf5Rows<float>;
template class Hdf5Rows<std::int64_t>;
template class Hdf5Rows<std::int32_t>;
template class Hdf5Rows<std::uint8_t>;

}  // namespace flowrest::mpm
