// The iterations over packets of contacts, with AVX2.
#if defined(__x86_64__)
#define DARTCAST_AVX2
#include "dynamics/contact_packets_kernel.inl"
#endif
