// The filter of four cells, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "complex/positive_cells.inl"
#endif
