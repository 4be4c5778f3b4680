// The filter of four cells, for any machine.
#include "complex/positive_cells.inl"
