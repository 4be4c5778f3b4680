// The faces in reach, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "dynamics/reached_faces.inl"
#endif
