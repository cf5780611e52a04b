#define FLOWREST_KERNEL_SPACE kernels_avx2
#define FLOWREST_LANE_BYTES 32
#include "mpm/solver/kernels_unit.inc"
