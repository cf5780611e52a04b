#pragma once

/// How a step is computed, where there is a choice.
namespace flowrest::mpm {

enum class Transfer { quadratic_apic, linear_flip };
/// How the volumetric part of the strain is averaged (B-bar): through the nodes with the functions' own
/// weights, over a cell's particles, or taken at the cell's centre.
enum class Dilatation { smooth, cell_average, centroid };
enum class StressRate { hughes_winget, jaumann };

}  // namespace flowrest::mpm
