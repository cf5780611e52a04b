// Any text is a study or is refused with a SceneError.
#include <cstdint>
#include <string>

#include "studies/study.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    flowrest::studies::parse_study(std::string(reinterpret_cast<const char*>(data), size), "fuzz.toml");
  } catch (const flowrest::scenes::SceneError&) {
  }
  return 0;
}
