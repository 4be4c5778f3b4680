// The filter of points and walls, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "dynamics/moving_walls.inl"
#endif
