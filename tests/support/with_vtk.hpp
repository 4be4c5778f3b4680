// Tests that need VTK, for builds without it.
#pragma once

#include <gtest/gtest.h>

#include "dartcast/mesh_files.hpp"

/// Leaves the test, and says so, where the library was built without VTK.
#define SKIP_WITHOUT_VTK() \
  if (!dartcast::has_vtk()) GTEST_SKIP() << "this build has no VTK"
