// The filter of points and walls, for any machine.
#include "dynamics/moving_walls.inl"
