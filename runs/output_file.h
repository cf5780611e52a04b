#pragma once

#include <filesystem>
#include <string>

namespace flowrest::runs {

/// A file that text is added to, written out at once. Every error is said, with the file's name.
class OutputFile {
 public:
  /// @throws RunError or MachineError where it cannot be opened.
  explicit OutputFile(const std::filesystem::path&, bool afresh = false);
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// @throws MachineError where there is no room left, or the disk fails.
  void append(const std::string& text);
  /// Some file systems say only here that there was no room.
  void close();

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace flowrest::runs
