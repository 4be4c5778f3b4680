// Aims particles in a flow, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "simulation/flow_aim.inl"
#endif
