// Applies a motion, for any machine.
#include "simulation/motion.inl"
