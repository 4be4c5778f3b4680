// The first triangles of steps in the plane, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "tracking/batch/plane_block.inl"
#endif
