#pragma once

namespace flowrest::mpm::bench {

/// Prints what all cores give over one, in wall time and stage by stage, and what they cost beside work of
/// others.
void print_thread_gain();

}  // namespace flowrest::mpm::bench
