// Applies a motion, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "simulation/motion.inl"
#endif
