#pragma once

namespace flowrest::mpm {

/// What takes the error of a transfer to particles and back out of the first row of nodes along a wall that
/// holds, as a share of the second difference v2 - 2 v1 + vg of the velocities of the second and first row
/// and of the ghost nodes behind the wall. Where it holds vg = -v1, and that is v2 - 3 v1.
///
/// APIC's transfer leaves a quadratic profile as it is, but not across the wall: the mirrored body of
/// v = a y + b y^2 is a y - b y^2. Folding it moves the first node by B b h^2, per transfer and in a filled
/// cell; the integral over the particles' places y gives B = 2/21. With the spline's own coefficients
/// b h^2 = (v2 - 3 v1) / 2, which solved for v1 makes the correction B / 2 / (1 - 3 B / 2) = 1/18. Untreated,
/// the error is a drag on the body that grows as 1 / step, and most of what is wrong with a duct's profile.
constexpr double wall_transfer_correction = 1.0 / 18.0;

/// How far the profile beside a wall is known, 0 to 1: not where the second row holds little. `second` over `first`:
/// the masses of the rows. It fades, as a threshold would make the flow jump when a node passes it, and a run without
/// derivatives.
template <class T>
constexpr T known_profile(const T& second, const T& first) {
  const T share = T(2) * second / first - T(0.5);
  return share < T(0) ? T(0) : T(1) < share ? T(1) : share;
}

}  // namespace flowrest::mpm
