// The kernel of the batch, for any machine.
#include "tracking/batch/batch_kernel.inl"
