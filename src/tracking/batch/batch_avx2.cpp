// The kernel of the batch, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "tracking/batch/batch_kernel.inl"
#endif
