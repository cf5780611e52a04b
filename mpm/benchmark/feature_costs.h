#pragma once

namespace flowrest::mpm::bench {

/// Prints what each feature of a scene costs: CPU time of a step with it over that of a step without, the two
/// taken in turns so that a machine's other work meets both alike, as the median of many turns.
void print_feature_costs();

}  // namespace flowrest::mpm::bench
