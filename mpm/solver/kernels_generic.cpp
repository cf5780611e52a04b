#define FLOWREST_KERNEL_SPACE kernels_generic
#define FLOWREST_LANE_BYTES 16
#include "mpm/solver/kernels_unit.inc"
