// The header that every file of the bindings includes: pybind11 and the conversions of dartcast's types.
#pragma once

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "support/arrays.hpp"
#include "support/docs.hpp"
#include "support/enums.hpp"
#include "support/ids.hpp"
#include "support/in_use.hpp"
#include "support/records.hpp"
