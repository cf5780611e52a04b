#pragma once

/// How noisy a run may be and still count as sound, whichever solver it comes from.
namespace flowrest::runs {

/// By how much noise could have moved the material at most, as a share of the body's height.
constexpr double noise_path_allowed = 0.01;

}  // namespace flowrest::runs
