#pragma once

#include <fmt/format.h>

#include <string>

namespace flowrest::foam {

/// The entry of a function object of the plug-in's; `keywords`: its own, a line to each.
inline std::string function_object(const std::string& type, const std::string& keywords) {
  return fmt::format(
      "    {0}\n    {{\n        type            {0};\n        libs            $rheologyLibraries;\n{1}    "
      "}}\n",
      type, keywords);
}

}  // namespace flowrest::foam
