// Any text is a scene or is refused with a SceneError: never a crash, never another exception.
#include <cstdint>
#include <string>

#include "scenes/scene.h"
#include "scenes/summary.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const auto scene = flowrest::scenes::parse_scene(text, "fuzz.toml");
    flowrest::scenes::check_text(scene, {});
    flowrest::scenes::parse_scene(flowrest::scenes::resolved_toml(scene), "again.toml");
  } catch (const flowrest::scenes::SceneError&) {
  }
  return 0;
}
