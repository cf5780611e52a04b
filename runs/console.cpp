#include "runs/console.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

namespace flowrest::runs {

void say(std::FILE* stream, std::string_view text) noexcept {
  if (std::fwrite(text.data(), 1, text.size(), stream) == text.size()) std::fflush(stream);
}

void settle_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", O_RDWR);  // takes the lowest free number: this one
  signal(SIGXFSZ, SIG_IGN);
}

}  // namespace flowrest::runs
