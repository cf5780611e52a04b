#pragma once

#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace flowrest::mpm {

/// An HDF5 file written to a temporary name and put in place by `commit`, or read; closed by itself.
/// Every method throws where HDF5 refuses, naming the file and the dataset: runs::MachineError on writing,
/// runs::RunError on reading.
class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path&);
  static Hdf5File open(const std::filesystem::path&);
  ~Hdf5File();
  Hdf5File(Hdf5File&&) noexcept;
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void group(const std::string& path);
  /// One- or two-dimensional data; `columns` 0 makes it one-dimensional.
  void write(const std::string& path, std::span<const double>, std::size_t columns = 0);
  void write(const std::string& path, std::span<const float>, std::size_t columns = 0);
  void write(const std::string& path, std::span<const std::int64_t>, std::size_t columns = 0);
  void write(const std::string& path, std::span<const std::int32_t>, std::size_t columns = 0);
  void write(const std::string& path, std::span<const std::uint8_t>, std::size_t columns = 0);
  void attribute(const std::string& group, const std::string& name, std::span<const std::int64_t>);
  /// A fixed-length ASCII string, as VTKHDF asks for.
  void attribute(const std::string& group, const std::string& name, const std::string& text);

  std::vector<double> read_doubles(const std::string& path) const;
  std::vector<std::int32_t> read_integers(const std::string& path) const;
  /// Numbers in a dataset.
  std::size_t size_of(const std::string& path) const;
  std::string read_text(const std::string& group, const std::string& name) const;

  /// Puts a created file in place of what stood there, atomically.
  void commit();

 private:
  Hdf5File() = default;
  template <class T>
  friend class Hdf5Rows;
  void write(const std::string& path, hid_t type, const void* data, std::size_t count, std::size_t columns);
  hid_t make_dataset(const std::string& path, hid_t type, std::size_t rows, std::size_t columns);
  [[noreturn]] void refuse_dataset(const std::string& path) const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void no_room(const std::string& what) const;

  std::filesystem::path path_, temporary_;
  hid_t file_ = -1;
};

/// A dataset that is written from its first row to its last, in pieces of any size; so that no more than a
/// piece of it need be in memory. Its file must stay where it is, and be committed after finish().
template <class T>
class Hdf5Rows {
 public:
  /// `columns` 0 makes it one-dimensional.
  Hdf5Rows(Hdf5File& file, std::string path, std::size_t rows, std::size_t columns = 0);
  ~Hdf5Rows();
  Hdf5Rows(const Hdf5Rows&) = delete;
  Hdf5Rows& operator=(const Hdf5Rows&) = delete;

  void add(T value) {
    waiting_.push_back(value);
    if (waiting_.size() == rows_at_once * std::max<std::size_t>(1, columns_)) write_out();
  }
  /// After the last row.
  void finish();

 private:
  static constexpr std::size_t rows_at_once = 1 << 14;
  void write_out();

  Hdf5File& file_;
  std::string path_;
  std::size_t columns_, written_ = 0;
  std::vector<T> waiting_;
  hid_t dataset_;
};

}  // namespace flowrest::mpm
