// Binds dartcast/ids.hpp. Numbers are plain integers in Python; here is the enumeration.
#include "bind.hpp"
#include "support/python.hpp"

namespace dartcast::python::ids {

void bind(pybind11::module_& m) {
  bind_enum<Kind>(m, "Kind",
                  {{"VERTEX", Kind::vertex}, {"EDGE", Kind::edge}, {"FACE", Kind::face}, {"VOLUME", Kind::volume}});
}

}  // namespace dartcast::python::ids
