#pragma once

#include "compare/apparatus/apparatus.h"

namespace flowrest::compare {

const ApparatusReport& own_report(const scenes::Printing&);

}  // namespace flowrest::compare
