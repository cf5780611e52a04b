#include "runs/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <utility>

#include "runs/machine.h"

namespace flowrest::runs {

OutputFile::OutputFile(const std::filesystem::path& path, bool afresh) : path_(path) {
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (afresh ? O_TRUNC : O_APPEND), 0666);
  if (file_ < 0) cannot_be_written(path, errno);
}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}

void OutputFile::append(const std::string& text) {
  for (std::string_view left = text; !left.empty();) {
    const ssize_t written = ::write(file_, left.data(), left.size());
    if (written < 0 && errno != EINTR) cannot_be_written(path_, errno);
    left.remove_prefix(static_cast<std::size_t>(written < 0 ? 0 : written));
  }
}

void OutputFile::close() {
  if (::close(std::exchange(file_, -1)) != 0 && errno != EINTR) cannot_be_written(path_, errno);
}

}  // namespace flowrest::runs
