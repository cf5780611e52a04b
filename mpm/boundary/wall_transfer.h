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

}  // namespace flowrest::mpm
