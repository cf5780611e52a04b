#define FLOWREST_KERNEL_SPACE kernels_avx512
#define FLOWREST_LANE_BYTES 64
#include "mpm/solver/kernels_unit.inc"
