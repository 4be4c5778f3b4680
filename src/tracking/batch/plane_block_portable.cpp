// The first triangles of steps in the plane, for any machine.
#include "tracking/batch/plane_block.inl"
