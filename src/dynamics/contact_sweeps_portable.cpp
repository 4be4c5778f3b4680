// The iterations over packets of contacts, for any machine.
#include "dynamics/contact_packets_kernel.inl"
