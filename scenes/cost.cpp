#include "scenes/cost.h"

#include <fmt/format.h>

namespace flowrest::scenes {

std::string bytes_in_words(double count) {
  return count < 1e9 ? fmt::format("{:.3g} MB", count / 1e6) : fmt::format("{:.3g} GB", count / 1e9);
}

}  // namespace flowrest::scenes
