#pragma once

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <system_error>
#include <thread>

namespace flowrest::foam::testing {

/// Asks this process to stop, by a signal that is not ignored in the background, some time after a file has
/// more than `bytes`, or after half a minute. Gone before that, as where the run has thrown, it sends none.
inline std::jthread interrupt_at(const std::filesystem::path& file, std::uintmax_t bytes,
                                 std::chrono::milliseconds later = {}) {
  return std::jthread([=](std::stop_token gone) {
    using namespace std::chrono_literals;
    const auto latest = std::chrono::steady_clock::now() + 30s;
    const auto has_grown = [&] {
      std::error_code ignored;
      const auto size = std::filesystem::file_size(file, ignored);
      return !ignored && size > bytes;
    };
    while (!has_grown() && !gone.stop_requested() && std::chrono::steady_clock::now() < latest)
      std::this_thread::sleep_for(10ms);
    std::this_thread::sleep_for(later);
    if (!gone.stop_requested()) kill(getpid(), SIGTERM);
  });
}

}  // namespace flowrest::foam::testing
