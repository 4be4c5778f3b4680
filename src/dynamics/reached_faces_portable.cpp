// The faces in reach, for any machine.
#include "dynamics/reached_faces.inl"
