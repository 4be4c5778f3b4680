// Binds dartcast/ranks.hpp: ranks of Python, as mpi4py gives them, for runs of C++. The class Ranks itself is in
// python/dartcast/_ranks.py.
#include "ranks.hpp"

#include <pybind11/numpy.h>

#include <string>
#include <vector>

namespace py = pybind11;

namespace dartcast::python {

PythonRanks::PythonRanks(py::object object)
    : object_(std::move(object)),
      rank_(object_.attr("rank").cast<unsigned>()),
      size_(object_.attr("size").cast<unsigned>()) {}

PythonRanks::~PythonRanks() {
  const py::gil_scoped_acquire acquire;
  object_ = py::object();
}

std::unique_ptr<PythonRanks> python_ranks(const py::object& object) {
  return object.is_none() ? nullptr : std::make_unique<PythonRanks>(object);
}

std::vector<std::string> PythonRanks::gather(std::string bytes) {
  const py::gil_scoped_acquire acquire;
  return object_.attr("gather")(py::bytes(bytes)).cast<std::vector<std::string>>();
}

std::string PythonRanks::broadcast(std::string bytes) {
  const py::gil_scoped_acquire acquire;
  return object_.attr("broadcast")(py::bytes(bytes)).cast<std::string>();
}

std::vector<std::string> PythonRanks::exchange(std::vector<std::string> bytes) {
  const py::gil_scoped_acquire acquire;
  py::list list;
  for (const std::string& b : bytes) list.append(py::bytes(b));
  return object_.attr("exchange")(list).cast<std::vector<std::string>>();
}

void PythonRanks::sum(std::span<std::uint64_t> values) {
  const py::gil_scoped_acquire acquire;
  const py::array_t<std::uint64_t> own(static_cast<py::ssize_t>(values.size()), values.data());
  const auto all = object_.attr("sum")(own).cast<py::array_t<std::uint64_t, py::array::c_style>>();
  if (static_cast<std::size_t>(all.size()) != values.size())
    throw InvalidArgument("Ranks.sum(): the sums are not as many as the values");
  std::copy_n(all.data(), values.size(), values.begin());
}

bool PythonRanks::fail(const std::string& why) noexcept {
  const py::gil_scoped_acquire acquire;
  try {
    return object_.attr("fail")(why).cast<bool>();
  } catch (...) {
    return true;  // the others cannot be reached: each says why it has ended
  }
}

}  // namespace dartcast::python
