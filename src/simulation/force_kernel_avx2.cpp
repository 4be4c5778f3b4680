// Samples, forces and motion, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "simulation/force_kernel.inl"
#endif
