#pragma once

#include "scenes/schema.h"
#include "scenes/value.h"

namespace flowrest::scenes {

/// Refuses what is well formed but physically impossible, unstable or larger than any machine. A rule is
/// passed over where a key that it speaks of is unusable: that fault is known already.
void check(const Given&, const Draft&, Faults&);

}  // namespace flowrest::scenes
