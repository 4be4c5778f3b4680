// Samples, forces and motion, for any machine.
#include "simulation/force_kernel.inl"
