// Aims particles in a flow, for any machine.
#include "simulation/flow_aim.inl"
